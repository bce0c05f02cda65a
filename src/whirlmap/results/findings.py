"""Results of an analysis as plain values, before they become a Dataset.

Importing xarray takes longer than most analyses, so it is imported only where a Dataset is needed.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import wraps
from inspect import signature
from typing import TYPE_CHECKING, Any, ParamSpec, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from whirlmap.results.listing import Listed, Listing, Rows
from whirlmap.results.schema import validate

if TYPE_CHECKING:
    import xarray as xr

P = ParamSpec("P")

#: Dimensions, values and attributes, as `whirlmap.results.schema.variable` and a Dataset take them.
Variable = tuple[Any, ...]


@dataclass(frozen=True, repr=False)
class Findings(Listed):
    """Variables, coordinates and attributes of a Dataset, as plain values.

    ``found["power"]`` are the numbers of a variable or coordinate.
    """

    variables: Mapping[str, Variable]
    coordinates: Mapping[str, Variable] = field(default_factory=dict)
    attrs: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, ds: "xr.Dataset") -> "Findings":
        """Return what a Dataset holds."""
        variables, coordinates = (
            {str(name): (v.dims, v.values, v.attrs) for name, v in part.items()} for part in (ds.data_vars, ds.coords)
        )
        return cls(variables, coordinates, ds.attrs)

    def variable(self, name: str) -> Variable:
        """A variable or a coordinate: its dimensions, values and attributes."""
        return self.variables[name] if name in self.variables else self.coordinates[name]

    def __getitem__(self, name: str) -> NDArray[Any]:
        return np.asarray(self.variable(name)[1])

    def __contains__(self, name: str) -> bool:
        return name in self.variables or name in self.coordinates

    def listing(self) -> Listing:
        """Every variable with its dimensions, numbers and meaning."""
        rows = [
            (str(name), ", ".join(_names(dims)), _shown(np.asarray(values)), of.get("units", ""), of.get("long_name", ""))
            for name, (dims, values, of) in self.variables.items()
        ]
        attributes = [(name, str(value)) for name, value in self.attrs.items()]
        return Listing(
            f"Findings of {self.attrs['case']}" if self.attrs.get("case") else "Findings",
            [f"coordinates: {', '.join(map(str, self.coordinates))}", ".dataset() gives the xarray.Dataset"],
            [
                Rows("Variables", ("name", "dimensions", "value or range", "unit", "meaning"), rows),
                Rows("Attributes", ("name", "value"), attributes, details=True),
            ],
        )

    def dataset(self) -> "xr.Dataset":
        """Make the Dataset; `ModelError` where a variable does not say its unit and meaning."""
        import xarray as xr

        return validate(xr.Dataset(self.variables, self.coordinates, self.attrs))


def _names(dims: Any) -> tuple[str, ...]:
    return (dims,) if isinstance(dims, str) else tuple(map(str, dims))


def _shown(values: NDArray[Any]) -> str:
    """The number, or how many there are and between which they lie."""
    if values.size == 1:
        return f"{values.item():.6g}" if values.dtype.kind == "f" else str(values.item())
    count = " x ".join(map(str, values.shape))
    if values.dtype.kind not in "iufb" or not (known := values[np.isfinite(values)]).size:
        return count
    return f"{count}: {known.min():.4g} to {known.max():.4g}"


class Analysis(Protocol[P]):
    """A function that gives a Dataset; ``find``, with the same arguments, gives its `Findings`."""

    find: Callable[P, Findings]

    def __call__(self, *arguments: P.args, **options: P.kwargs) -> "xr.Dataset":
        """Give the Dataset."""


def gives_dataset(find: Callable[P, Findings]) -> Analysis[P]:
    """Have an analysis give a Dataset to those who call it; its own name and docstring are those of the result."""

    @wraps(find)
    def analysis(*arguments: P.args, **options: P.kwargs) -> "xr.Dataset":
        return find(*arguments, **options).dataset()

    made = cast(Any, analysis)
    made.find, made.__signature__ = find, signature(find).replace(return_annotation="xr.Dataset")
    return cast(Analysis[P], made)
