"""Run-up and run-down: every steady motion starts the neighbouring speeds, until no new motion is found.

All speeds start cold, side by side. Then each settled state starts the speed above and the speed below it, all of them
together; where that ends on another motion than those that are known there, the new one is carried on, and so forth. What a
run-up from the lowest and a run-down from the highest speed meet is among what is found: their first speed starts cold, and
every motion that they come to is carried on from each speed to the next as they do. They would do it one speed after the
other; here most speeds are done in the first round, and later rounds hold only the speeds next to new motions.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.analysis.motion.ensembles import cyclic_states
from whirlmap.equations.model import Model
from whirlmap.integrate.scales import scales
from whirlmap.results.regime import Regime
from whirlmap.results.schema import variable
from whirlmap.results.status import Status
from whirlmap.sweep.points.point_variables import doubts
from whirlmap.sweep.speeds.arriving import arriving, same_orbits
from whirlmap.sweep.speeds.verdicts import Judge, Verdict, verdict_variable

Array = NDArray[np.float64]
Places = NDArray[np.intp]

#: Part of each state's range within which the extremes of two periodic motions are the same: a motion is carried on while it
#: still settles at the new speed.
SAME = 1e-2
#: Part of the largest range among the states that are alike (`scales`) below which differences of a state do not count.
LEAST = 1e-3


def cold_motions(judge: Judge, values: Mapping[str, Array], limits: Array) -> xr.Dataset:
    """Motions from cold starts alone, over ``point``, with their ``place`` among the points."""
    return judge(values, limits).assign_coords(place=("point", np.arange(limits.size)))


def cold_at(parts: Sequence[xr.Dataset], model: Model) -> xr.Dataset:
    """Join motions from cold starts at successive places."""
    ds = joined(*parts)
    ds.attrs = {k: v for k, v in ds.attrs.items() if k not in ("accuracy_not_met", "grazing")} | doubts(ds, model)
    return ds.assign_coords(place=("point", np.arange(ds.sizes["point"])))


def motions_met(judge: Judge, values: Mapping[str, Array], limits: Array, length: int) -> xr.Dataset:
    """All motions met at the speeds of one machine or several.

    Parameters
    ----------
    values : mapping of str to array, shape (machine x length,)
        Speeds ascend within each machine.
    limits : array, of the same shape
    length : int
        Speeds of each machine.

    Returns
    -------
    xr.Dataset
        That of `Judge` over ``point``, with ``place``, the index of its machine and speed. The first are the cold starts.

    Notes
    -----
    Motions that do not return count as one at each speed: only the first is carried on. One that is in its transient and
    converges to a periodic motion is none of its own (`whirlmap.sweep.speeds.arriving`), unless a cold start came to it.
    There are as many rounds as speeds at most, which take the last motion from one end of the range to the other.
    """
    cold = met = cold_motions(judge, values, limits)
    for met in rounds_met(judge, values, limits, length, cold):  # noqa: B007 (the last round counts)
        pass
    return met


def rounds_met(
    judge: Judge, values: Mapping[str, Array], limits: Array, length: int, cold: xr.Dataset
) -> Iterator[xr.Dataset]:
    """All motions met by the end of each round of `motions_met`, whose cold starts are given."""
    met = new = cold
    for _ in range(length - 1):
        source, place = _neighbours(new, length)
        if not place.size:
            break
        found = carried(judge, {name: v[place] for name, v in values.items()}, limits[place], new, source, place)
        both = joined(met, found.isel(point=unseen(judge, values, found, met)))
        fresh = np.arange(both.sizes["point"]) >= met.sizes["point"]
        stays = ~arriving(judge, values, both, fresh)
        stays[: limits.size] = True  # a cold start is a verdict of its own
        met, new = both.isel(point=np.flatnonzero(stays)), both.isel(point=np.flatnonzero(stays & fresh))
        yield met


def carried(
    judge: Judge, values: Mapping[str, Array], limits: Array, motions: xr.Dataset, source: Places, place: Places
) -> xr.Dataset:
    """Judge points from the states in which other motions were left."""
    starts = motions["end_state"].values[source].T
    return judge(values, limits, starts=starts).assign_coords(place=("point", place))


def joined(*parts: xr.Dataset) -> xr.Dataset:
    """Motions of all parts, in their order."""
    filled = [part for part in parts if part.sizes["point"]]
    return xr.concat(filled or parts[:1], "point", data_vars="minimal", coords="minimal", compat="override", join="override")


def _neighbours(motions: xr.Dataset, length: int) -> tuple[Places, Places]:
    """Indices of motions that ran, and the places above and below each."""
    running = np.flatnonzero(motions["status"].values == Status.ok)
    at = motions["place"].values[running]
    up, down = at % length < length - 1, at % length > 0
    return np.concatenate([running[up], running[down]]), np.concatenate([at[up] + 1, at[down] - 1])


def unseen(judge: Judge, values: Mapping[str, Array], found: xr.Dataset, met: xr.Dataset | None = None) -> Places:
    """Indices of motions that differ from all that were met at their place, and from those found there before them.

    ``values`` are those of the places.
    """
    marks = _Marks(judge, values, [found] if met is None else [met, found])
    first = 0 if met is None else met.sizes["point"]
    known, fresh = np.arange(first), []
    left = first + np.arange(found.sizes["point"])
    while left.size:  # one motion of each place at a time, beside those that are known by then
        _, heads = np.unique(marks.place[left], return_index=True)
        these = left[heads]
        new = these[~marks.among(these, known)]
        fresh.append(new)
        known, left = np.concatenate([known, new]), np.delete(left, heads)
    return np.sort(np.concatenate([*fresh, np.zeros(0, dtype=np.intp)])) - first


class _Marks:
    """What motions are told apart by: how they ended, whether they return, their extremes, and where these agree orbits.

    Extremes say that two motions differ, at no cost; that they are one is said by their orbits (`same_orbits`).
    """

    def __init__(self, judge: Judge, values: Mapping[str, Array], parts: list[xr.Dataset]) -> None:
        system = judge.system
        self.judge, self.values = judge, values

        def column(name: str) -> NDArray:
            return np.concatenate([part[name].values for part in parts])

        states = len(system.states)
        steady = [k for k in range(states) if k not in cyclic_states(system)]  # an angle that turns has no extremes
        self.model, self.period, self.steady = system.model, system.period, steady
        self.place, status = column("place"), column("status")
        self.kind = np.where(status != Status.ok, 2 + status, column("regime") != Regime.periodic)
        self.motions = xr.Dataset({  # what their orbits are asked for
            name: (("point", "state")[: values.ndim], values)
            for name, values in ((n, column(n)) for n in ("place", "end_state", "steps", "period_common"))
        })  # fmt: skip
        self.low, self.high = column("minimum")[:, steady], column("maximum")[:, steady]

    def among(self, these: Places, known: Places) -> NDArray[np.bool_]:
        """Whether each motion is one of the known ones of its place."""
        order = known[np.argsort(self.place[known], kind="stable")]
        begin, end = (np.searchsorted(self.place[order], self.place[these], side=side) for side in ("left", "right"))
        out = np.zeros(these.size, dtype=np.bool_)
        for k in range(int((end - begin).max(initial=0))):
            some = np.flatnonzero(begin + k < end)
            out[some] |= self._same(these[some], order[begin[some] + k])
        return out

    def _same(self, a: Places, b: Places) -> NDArray[np.bool_]:
        extent = np.maximum(self.high[a] - self.low[a], self.high[b] - self.low[b])
        size = np.maximum(np.abs(self.high[a]), np.abs(self.low[a]))
        scale = scales(self.model, np.full(a.size, self.period), extent.T, size.T, share=LEAST, rows=self.steady).T
        apart = np.maximum(np.abs(self.high[a] - self.high[b]), np.abs(self.low[a] - self.low[b]))
        alike = (self.kind[a] != 0) | (apart <= SAME * scale).all(axis=1)
        same = np.asarray((self.kind[a] == self.kind[b]) & alike)
        asked = np.flatnonzero(same & (self.kind[a] == 0))
        if asked.size:
            same[asked] = same_orbits(self.judge, self.values, self.motions, b[asked], a[asked])
        return same


def outcome(met: xr.Dataset, places: int) -> xr.Dataset:
    """What all motions met at each place come to.

    Returns
    -------
    xr.Dataset
        Over ``point``: that of the cold start, and in place of its own the worst of all motions for ``amplitude`` (NaN where
        one ended early), ``tooth_contact``, ``min_film`` and ``max_load``; ``amplitude_cold``; ``motions``, how many
        different ones; ``verdict``, coexisting where the cold start alone is safe, and ``other``, the first verdict that is
        not safe among the motions beside it.
    """
    ds = met.isel(point=slice(0, places)).drop_vars("place")
    place, verdict = met["place"].values, met["verdict"].values
    ds["amplitude_cold"] = ds["amplitude"].assign_attrs(long_name=f"{ds['amplitude'].attrs['long_name']}, from a cold start")
    for name, worse in (("amplitude", np.maximum), ("max_load", np.fmax), ("min_film", np.fmin), ("tooth_contact", np.fmin)):
        if name in ds:
            worst = ds[name].values.copy()
            with np.errstate(invalid="ignore"):  # NaN is meant, and said in the docstring
                worse.at(worst, place, met[name].values)
            ds[name] = ds[name].copy(data=worst)
    other = np.zeros(places, dtype=np.int8)
    unsafe = places + np.flatnonzero(verdict[places:] != Verdict.safe)
    at, first = np.unique(place[unsafe], return_index=True)
    other[at] = verdict[unsafe[first]]
    cold = verdict[:places]
    ds["verdict"] = verdict_variable("point", np.where((cold == Verdict.safe) & (other > 0), Verdict.coexisting, cold))
    ds["other"] = verdict_variable("point", other)
    ds["other"].attrs["long_name"] = "first verdict that is not safe among the motions that a cold start does not meet"
    ds["motions"] = variable("point", np.bincount(place, minlength=places), "1", "different motions met")
    return ds
