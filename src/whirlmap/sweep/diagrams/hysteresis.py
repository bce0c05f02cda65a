"""Hysteresis: values at which a sweep up and a sweep down reach different motions."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.analysis.labels.same_attractor import on_set
from whirlmap.analysis.motion.ensembles import cyclic_states
from whirlmap.integrate.harmonics import strobe_of
from whirlmap.integrate.scales import scales
from whirlmap.integrate.system import System
from whirlmap.results.regime import Regime
from whirlmap.results.schema import variable
from whirlmap.results.status import Status

Array = NDArray[np.float64]

#: Part of each state's range within which section points of two periodic branches are the same. Both are settled to
#: 1e-6, but close to a fold or a doubling, and where the right-hand side is not smooth, the branches settle less well.
SAME_BRANCH = 1e-3
#: Section points below which two sets are not compared.
LEAST = 16
#: Meaning of ``hysteresis`` by value.
MEANINGS = {-1: "not-compared", 0: "same", 1: "different"}


def with_hysteresis(ds: xr.Dataset, system: System, parameter: str) -> xr.Dataset:
    """Add ``hysteresis(parameter)`` to a diagram in both directions: whether its branches are different motions.

    Notes
    -----
    Different are: two labels of which none is undecided and one is not the other's; two periodic orbits, none of whose
    points at the phase of the common period agree to `SAME_BRANCH` of the range; two sets without a period, where the one
    does not lie on the other (`on_set`; with the few points that a diagram keeps only those far apart are told apart).
    Not compared are values that one of the sweeps did not reach, or where its run failed.
    """
    up, down = (ds.sel(direction=d) for d in ("up", "down"))
    labels = np.stack([side["regime"].values for side in (up, down)])
    status = np.stack([side["status"].values for side in (up, down)])
    out = np.zeros(labels.shape[1], dtype=np.int8)
    decided = (labels != Regime.undecided).all(axis=0)
    out[decided & (labels[0] != labels[1])] = 1
    ran = (status == Status.ok).all(axis=0)
    a, b = (_once_per_common_period(s, system, parameter) for s in (up, down))
    kept = [str(name) for name in ds["state"].values]
    cyclic = {kept.index(system.states[k]): p for k, p in cyclic_states(system).items() if system.states[k] in kept}
    extent = ds["peak_to_peak"].max("direction").sel(quantity=kept).transpose("quantity", ...).values
    periodic = ran & (labels == Regime.periodic).all(axis=0) & bool(system.model.forced)
    largest = np.abs(np.stack([s[name].sel(quantity=kept).transpose("quantity", ...).values
                               for s in (up, down) for name in ("minimum", "maximum")])).max(axis=0)  # fmt: skip
    period = np.full(labels.shape[1], system.period)
    scale = scales(system.model, period, extent, largest, rows=[system.states.index(name) for name in kept])
    out[periodic] = _apart(a[:, :, periodic], _last(b)[:, periodic], scale[:, periodic], cyclic) > SAME_BRANCH
    for k in np.flatnonzero(ran & ~periodic & (out == 0)):
        pair = [side[np.isfinite(side[:, 0, k]), :, k] for side in (a, b)]
        if min(map(len, pair)) >= LEAST:
            same = (on_set(p[:, :, None], q, cyclic, scale=scale[:, k])[0] for p, q in (pair, pair[::-1]))
            out[k] = not any(same)
    out[np.isin(status, (Status.failed, Status.unresolved)).any(axis=0)] = -1
    flags = {"flag_values": np.array(list(MEANINGS), dtype=np.int8), "flag_meanings": " ".join(MEANINGS.values())}
    ds["hysteresis"] = variable(parameter, out, "1", "whether the branches of the sweeps up and down differ", **flags)
    return ds


def _once_per_common_period(ds: xr.Dataset, system: System, parameter: str) -> Array:
    """Section at the phase of the common period, shape (time, state, point); NaN beyond the end of shorter ones."""
    section = ds["section"].transpose("period", "state", parameter).values
    if not system.model.forced:
        return np.asarray(section)
    if "common_multiple" not in ds:
        return np.asarray(section[system.strobe - 1 :: system.strobe])
    out = np.full_like(section, np.nan)
    multiple = ds["common_multiple"].values
    for common in np.unique(multiple):
        these = np.flatnonzero(multiple == common)
        every = strobe_of(int(common))
        rows = section[every - 1 :: every, :, these]
        out[: rows.shape[0], :, these] = rows
    return out


def _last(section: Array) -> Array:
    """Last row of each point that is no padding, shape (state, point)."""
    ends = np.maximum(np.isfinite(section[:, 0]).sum(axis=0) - 1, 0)
    return np.take_along_axis(section, ends[None, None, :], axis=0)[0]


def _apart(points: Array, other: Array, scale: Array, cyclic: dict[int, float]) -> Array:
    """Smallest scaled distance of any of the points (time, state, point) from one other (state, point)."""
    apart = points - other
    for k, period in cyclic.items():
        apart[:, k] -= period * np.rint(apart[:, k] / period)
    distance = (np.abs(apart) / scale).max(axis=1, initial=0.0)
    found: Array = np.fmin.reduce(distance, axis=0, initial=np.inf)  # NaN pads what is shorter
    return found


def intervals(ds: xr.Dataset, parameter: str) -> list[tuple[float, float]]:
    """First and last value of each stretch in which the branches differ."""
    differs = np.concatenate([[False], ds["hysteresis"].values == 1, [False]])
    edges = np.flatnonzero(differs[1:] != differs[:-1])
    at = ds[parameter].values
    return [(float(at[i]), float(at[j - 1])) for i, j in zip(edges[::2], edges[1::2], strict=True)]
