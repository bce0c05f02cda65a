"""Words for the codes of a Dataset: regimes, statuses and verdicts as the commands print them."""

from typing import TYPE_CHECKING

import numpy as np

from whirlmap.errors import RangeError

if TYPE_CHECKING:
    import xarray as xr


def labels(ds: "xr.Dataset", name: str = "regime") -> "xr.DataArray":
    """Words of a variable that holds codes, read from its CF attributes.

    Parameters
    ----------
    ds : xr.Dataset
        Result of any whirlmap function, or one that was read from a NetCDF file or a Zarr store.
    name : str
        Variable with ``flag_values`` and ``flag_meanings``: ``regime``, ``status``, ``verdict`` of `whirlmap.safe_speeds`.

    Returns
    -------
    xr.DataArray of str
        With the dimensions and coordinates of the variable: ``periodic``, ``quasi-periodic``, ``chaotic``. Empty where the
        variable holds a code that its attributes do not explain.

    Raises
    ------
    RangeError
        Where the Dataset has no such variable, or the variable holds no codes.
    """
    coded = [str(key) for key, values in ds.variables.items() if "flag_meanings" in values.attrs]
    if name not in coded:
        known = f"those are here: {', '.join(coded)}" if coded else "there is none here"
        raise RangeError(f"found {name!r}, expected a variable whose codes have words; {known}")
    codes = ds[name]
    words = dict(zip(np.ravel(codes.attrs["flag_values"]).tolist(), codes.attrs["flag_meanings"].split(), strict=True))
    text = [words.get(code, "").replace("_", "-") for code in codes.values.ravel().tolist()]
    said = codes.copy(data=np.array(text, dtype=str).reshape(codes.shape))
    said.attrs = {"long_name": codes.attrs.get("long_name", name)}
    return said
