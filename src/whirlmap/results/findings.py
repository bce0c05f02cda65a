"""What an analysis found, before it is a Dataset.

xarray takes longer to start than most analyses take, so it is imported where somebody wants a Dataset.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import wraps
from inspect import signature
from typing import TYPE_CHECKING, Any, ParamSpec, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from whirlmap.results.schema import validate

if TYPE_CHECKING:
    import xarray as xr

P = ParamSpec("P")

#: Dimensions, values and attributes, as `whirlmap.results.schema.variable` and a Dataset take them.
Variable = tuple[Any, ...]


@dataclass(frozen=True)
class Findings:
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

    def dataset(self) -> "xr.Dataset":
        """Make the Dataset; `ModelError` where a variable does not say its unit and meaning."""
        import xarray as xr

        return validate(xr.Dataset(self.variables, self.coordinates, self.attrs))


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
