"""An empty store: made beside its place, then named."""

import threading
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
import zarr

from whirlmap.results.files import write_beside
from whirlmap.results.schema import variable
from whirlmap.results.status import flags
from whirlmap.sweep.parameters.space import Chunks
from whirlmap.sweep.store.store_folder import CHUNKS, EVALUATION, MANIFEST, exists, passing
from whirlmap.sweep.store.zarr_store import REASON, Evaluation

#: Filters of warnings are the process's, not the thread's.
_QUIET = threading.Lock()


def create(
    folder: Path, template: xr.Dataset, coordinates: Mapping[str, Any], dims: tuple[str, ...], chunks: Chunks,
    manifest: Mapping[str, Any], attributes: Mapping[str, Any],
) -> None:  # fmt: skip
    """Make an empty store: beside its place first, then under its name, so that it exists whole or not at all.

    Parameters
    ----------
    template : xr.Dataset
        Some labelled points, over ``point``: the arrays of the store are made after its variables.
    coordinates : mapping
        Of the dimensions, as `xarray.Dataset` takes them.

    Where another process was faster its store stands, and this one is dropped.
    """
    def fill(trial: Path) -> None:
        _build(trial, template, coordinates, dims, chunks, manifest, attributes)

    try:
        write_beside(folder, fill, Path.rename, passing(folder.with_name(f".{folder.name}")))
    except OSError:
        if not exists(folder):
            raise


def _build(
    trial: Path, template: xr.Dataset, coordinates: Mapping[str, Any], dims: tuple[str, ...], chunks: Chunks,
    manifest: Mapping[str, Any], attributes: Mapping[str, Any],
) -> None:  # fmt: skip
    group = zarr.create_group(trial, zarr_format=3, attributes=_plain(attributes))
    whole = {name: variable_of(template[name]) for name in map(str, template.coords) if template[name].dims != ("point",)}
    for name, (along, values, attrs) in {**coordinates, **whole}.items():
        along = (along,) if isinstance(along, str) else along
        array = group.create_array(
            name, shape=values.shape, chunks=values.shape, dtype=str if values.dtype.kind == "U" else values.dtype,
            dimension_names=along, attributes=_plain(attrs),
        )  # fmt: skip
        array[...] = values
    trailing = {}
    evaluation = variable("point", np.zeros(1, np.int8), "1", "where the label comes from", **flags(Evaluation))
    data = {str(n): variable_of(v) for n, v in template.data_vars.items()} | {EVALUATION: evaluation}
    for name, (along, values, attrs) in data.items():
        more = values.shape[1:]
        real = values.dtype.kind == "f"
        group.create_array(
            name, shape=(*chunks.shape, *more), chunks=(*chunks.size, *more), dtype=values.dtype,
            fill_value=np.nan if real else 0, dimension_names=(*dims, *(along[1:] if isinstance(along, tuple) else ())),
            attributes=_plain(attrs),
        )  # fmt: skip
        trailing[name] = len(more)
    inner = group.create_group(
        CHUNKS, attributes={MANIFEST: _plain({
            **manifest, "dims": dims, "shape": chunks.shape, "chunk": chunks.size, "variables": trailing
        })},
    )  # fmt: skip
    one = (1,) * len(chunks.grid)
    places = tuple(f"chunk_{d}" for d in dims)
    inner.create_array(
        "receipt", shape=chunks.grid, chunks=one, dtype="u8", fill_value=0, compressors=None, dimension_names=places,
        attributes={"units": "1", "long_name": "checksum of a chunk, 0 where it is absent"},
    )  # fmt: skip
    inner.create_array(
        "reason", shape=(*chunks.grid, REASON), chunks=(*one, REASON), dtype="u1", fill_value=0,
        dimension_names=(*places, "letter"), attributes={"units": "1", "long_name": "why a chunk failed, as text"},
    )  # fmt: skip
    with _QUIET, warnings.catch_warnings():  # Zarr v3 does not define this yet; without it xarray complains at every opening
        warnings.filterwarnings("ignore", message="Consolidated metadata")
        zarr.consolidate_metadata(trial)



def variable_of(values: xr.DataArray) -> tuple[Any, ...]:
    """Dimensions, values and attributes."""
    return (values.dims, values.values, dict(values.attrs))


def _plain(value: Any) -> Any:
    """Attributes as JSON holds them."""
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if hasattr(value, "tolist"):
        return value.tolist()
    return [_plain(v) for v in value] if isinstance(value, list | tuple) else value
