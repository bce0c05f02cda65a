"""Schema of every Dataset that whirlmap returns: names of dimensions, units and meanings of every variable."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from whirlmap.errors import ModelError
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status, flags

if TYPE_CHECKING:
    import xarray as xr


def variable(dims: str | Sequence[str], values: ArrayLike, units: str, long_name: str, **more: Any) -> tuple[Any, ...]:
    """One variable of a Dataset, with its unit and meaning."""
    return (dims, np.asarray(values), {"units": units, "long_name": long_name, **more})


def status_variable(dims: str | Sequence[str], values: ArrayLike) -> tuple[Any, ...]:
    """The status of every operating point, with CF flags."""
    return variable(dims, np.asarray(values, dtype=np.int8), "1", "how the run ended", **flags(Status))


def regime_variable(dims: str | Sequence[str], values: ArrayLike) -> tuple[Any, ...]:
    """The regime of every operating point, with CF flags."""
    return variable(dims, np.asarray(values, dtype=np.int8), "1", "regime", **flags(Regime))


def names_coordinate(dim: str, names: Sequence[str], long_name: str) -> tuple[Any, ...]:
    """A coordinate of names."""
    return (dim, np.array(list(names), dtype=object).astype(str), {"long_name": long_name})


def validate(ds: "xr.Dataset") -> "xr.Dataset":
    """Return the Dataset where every variable says its unit and meaning, else raise `ModelError`."""
    for name, values in ds.data_vars.items():
        missing = [key for key in ("units", "long_name") if key not in values.attrs]
        if missing:
            raise ModelError(f"variable {name!r} of a result lacks {' and '.join(missing)}")
    return ds


def plain_attributes(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Attributes as NetCDF can hold them; None is left out."""
    kept = {k: v for k, v in attributes.items() if v is not None}
    return {k: int(v) if isinstance(v, bool) else v for k, v in kept.items()}


def with_attributes(ds: "xr.Dataset", attributes: Mapping[str, Any]) -> "xr.Dataset":
    """Return the Dataset, validated, with attributes that NetCDF can hold."""
    return validate(ds).assign_attrs(plain_attributes(attributes))
