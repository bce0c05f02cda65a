"""What is explored: a system, the quantities that vary, and the map or diagram over them, from a store, a file or a case."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from whirlmap.errors import InputError, RangeError
from whirlmap.explorer.control import Control, controls_of
from whirlmap.explorer.recorded_system import recorded_system
from whirlmap.explorer.switch import Switch, switches_of
from whirlmap.integrate.in_units import in_units
from whirlmap.integrate.ranges import Range
from whirlmap.integrate.system import System
from whirlmap.options.computed import LABELLING, Integration, Labelling, Settling
from whirlmap.results.files import read
from whirlmap.sweep.parameters.axis import Axis, read_axis
from whirlmap.sweep.store.restoring import lost_parts
from whirlmap.sweep.store.store_folder import exists
from whirlmap.sweep.store.zarr_store import Evaluation, Store

#: Dimension of a diagram that was swept up and down.
DIRECTION = "direction"
#: Points at most that a page computes: all of them are drawn, and sent in one answer.
MOST = 1_000_000


@dataclass(frozen=True)
class Exploration:
    """A system with its map or diagram.

    Attributes
    ----------
    system : System
    axes : mapping of str to (values, unit)
        What varies: none, one quantity or two; values ascend, in the unit, "1" of a parameter.
    labelling : Labelling
        How its points were, or are, measured.
    overview : xr.Dataset, optional
        The labelled points in the model's own units; None where they are still to be computed.
    follow : str, optional
        Direction in which a diagram carries the state along.
    title : str
    branches : sequence of xr.Dataset
        Of a diagram, branches along its parameter; of a map, curves of bifurcations in its two parameters.
    store : Path, optional
        The store that the points came from.
    instead : mapping of str to Control
        Controls in place of the system's own, where a page counts a quantity otherwise than the case does.
    """

    system: System
    axes: Mapping[str, tuple[Sequence[float], str]]
    labelling: Labelling = LABELLING
    overview: xr.Dataset | None = None
    follow: Any = None
    title: str = ""
    branches: Sequence[xr.Dataset] = field(default_factory=list)
    store: Path | None = None
    instead: Mapping[str, Control] = field(default_factory=dict)

    @cached_property
    def controls(self) -> dict[str, Control]:
        """Quantities that can be changed."""
        return {**controls_of(self.system, self.axes), **self.instead}

    @cached_property
    def switches(self) -> dict[str, Switch]:
        """Switches of the case, which choose terms of its model."""
        return switches_of(self.system)


def opened(place: str, case: str | None = None) -> Exploration | None:
    """Open a store or a NetCDF file of a map or a diagram; None where ``place`` is neither, but may be a case.

    Raises
    ------
    InputError
        A file that cannot be read, is no labelled map or diagram, or whose case is not to be had.
    """
    path = Path(place)
    if path.is_dir():
        if not exists(path):
            raise InputError(f"{place}: found a folder that is no store, expected one that `whirlmap map --store` made")
        return replace(of_result(_loaded(Store(path), place), place, case), store=path)
    if path.suffix == ".nc":
        return of_result(read(path), place, case)
    return None


def read_again(exploration: Exploration) -> Exploration:
    """The exploration with the points that its store holds now, where some were missing when it was read.

    Raises
    ------
    InputError
        A store whose files are damaged by now.
    """
    e = exploration
    if e.store is None or e.overview is None or bool((e.overview["evaluation"] != Evaluation.absent).all()):
        return e
    return replace(e, overview=_ordered(_loaded(Store(e.store), str(e.store)), list(e.axes)))


def _ordered(ds: xr.Dataset, dims: list[str]) -> xr.Dataset:
    """Points over these dimensions, which come before those of each point."""
    return ds.transpose(..., *dims, *(d for d in ds.dims if d not in dims and d != DIRECTION))


def _loaded(store: Store, place: str) -> xr.Dataset:
    """All points of a store whose files are whole: Zarr reads a chunk that is missing as one without labels."""
    lost = lost_parts(store)
    damaged = [] if lost else store.standing().damaged.tolist()
    if lost or damaged:
        what = ", ".join(lost) if lost else f"{len(damaged)} of {store.chunks.count} chunks"
        raise InputError(f"{place}: {what} are damaged; `whirlmap map` with the same options and --resume repairs the store")
    return store.open().load()


def of_result(ds: xr.Dataset, source: str, case: str | None = None) -> Exploration:
    """The exploration of a labelled map or diagram.

    Raises
    ------
    InputError
        No labelled points over one or two quantities.
    """
    if "regime" not in ds or "varied" not in ds.attrs:
        raise InputError(f"{source}: found no labelled points, expected a result of `whirlmap map` or `bifurcation`")
    if "in_units" in ds.attrs:
        raise InputError(f"{source}: found a result in engineering units, expected one in the model's own")
    dims = [str(d) for d in ds["regime"].dims if d != DIRECTION]
    if not 1 <= len(dims) <= 2 or "draw" in dims:
        raise InputError(f"{source}: found points over {' '.join(dims)}, expected a grid over one or two quantities")
    ds = _ordered(ds, dims)
    system = recorded_system(ds.attrs, source, case)
    axes = {}
    for name in dims:
        unit = "1" if name in system.parameters else str(ds[name].attrs.get("units", "1"))
        axes[name] = np.asarray(ds[name], dtype=float).tolist(), unit
    follow = str(ds.attrs.get("follow", "none"))
    return Exploration(
        system, axes, labelling_of(ds.attrs), ds, None if follow == "none" else follow, f"{system.case}, {source}"
    )


def explored_case(system: System, ranges: Mapping[str, Range], labelling: Labelling, follow: str | None) -> Exploration:
    """The exploration of a case whose map or diagram is still to be computed.

    Raises
    ------
    InputError, RangeError
        A range of what is no parameter and no input, or with a unit that it does not have; more points than a page holds.
    """
    points = prod(given.count for given in ranges.values())
    if points > MOST:
        raise RangeError(f"--vary: found {points} points, expected at most {MOST} in a page: `whirlmap map` computes more")
    axes = {}
    for given in ranges.values():
        name, values, unit = read_axis(system, given.name, given, "--vary", beside=len(ranges) > 1)
        axes[name] = values.tolist(), unit or "1"
        Axis.of(system, name, axis_values(*axes[name]))  # refuses now what the first point would meet
    return Exploration(system, axes, labelling, None, follow, system.case)


def labelling_of(attributes: Mapping[str, Any]) -> Labelling:
    """How the points of a result were measured, as far as its attributes say it."""
    names = {"transient": int, "most": int, "tolerance": float}
    settling = Settling(**{name: kind(attributes[name]) for name, kind in names.items() if name in attributes})
    method, accuracy = attributes.get("method"), attributes.get("accuracy")
    return Labelling(settling, None, Integration(
        None if method is None else str(method), None, None if accuracy is None else float(accuracy)
    ))  # fmt: skip


def axis_of(system: System, name: str, values: Sequence[float], unit: str) -> Axis:
    """An axis of a diagram, from its values in their unit."""
    return Axis.of(system, name, axis_values(values, unit))


def axis_values(values: Sequence[float], unit: str) -> Any:
    """Values of an axis as `Axis.of` and `space_of` take them: texts where they have a unit."""
    return np.asarray(values, dtype=float) if unit == "1" else [f"{v!r} {unit}" for v in values]


def shown(system: System, ds: xr.Dataset) -> xr.Dataset:
    """A result in engineering units where the case has dimensions."""
    made: xr.Dataset = in_units(system, ds)
    return made
