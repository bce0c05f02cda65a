"""Comparison of the motions found at one speed: periodic ones, and transients that converge to a periodic one."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.analysis.motion.ensembles import cyclic_states, parameter_values
from whirlmap.analysis.periodic_orbits.arrivals import arrivals
from whirlmap.analysis.periodic_orbits.closed_orbit import FAR, SAME_POINT, ClosedOrbit, closed_orbits
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.orders import order_groups
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status
from whirlmap.sweep.attractors.repeat_time import repeat_of_forcing
from whirlmap.sweep.speeds.verdicts import Judge

Array = NDArray[np.float64]
Places = NDArray[np.intp]

#: Labels of motions that may not have settled.
UNSETTLED = (Regime.quasi_periodic, Regime.undecided, Regime.not_settled)
#: Common periods in which a run must converge to an orbit.
PATIENCE = 1024


def arriving(judge: Judge, values: Mapping[str, Array], motions: xr.Dataset, fresh: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which motions converge to a periodic one at the same speed.

    Parameters
    ----------
    values : mapping of str to array
        Over the places.
    motions : xr.Dataset
        Those of `Judge`, with ``end_state`` and ``place``.
    fresh : array of bool, shape (point,)
        Which motions are new: two that are not have been compared before.

    Returns
    -------
    array of bool, shape (point,)
    """
    label, place, status = (motions[name].values for name in ("regime", "place", "status"))
    ran = status == Status.ok
    open_ones = np.flatnonzero(ran & np.isin(label, UNSETTLED))
    periodic = np.flatnonzero(ran & (label == Regime.periodic))
    a, b = np.nonzero((place[open_ones, None] == place[periodic]) & (fresh[open_ones, None] | fresh[periodic]))
    runs, orbits = open_ones[a], periodic[b]
    out = np.zeros(place.size, dtype=bool)
    if not runs.size or not judge.system.model.forced:
        return out
    columns = {name: column[place[runs]] for name, column in values.items()}
    for group in order_groups(judge.system, parameter_values(judge.system, columns), columns):
        these = group.members
        some = {name: column[these] for name, column in columns.items()}
        out[runs[these[_flow(judge, some, motions, runs[these], orbits[these])]]] = True
    return out


def _flow(judge: Judge, values: Mapping[str, Array], motions: xr.Dataset, runs: Places, orbits: Places) -> NDArray[np.bool_]:
    """Whether each run converges to the orbit beside it; all of one common period."""
    known = _closed(judge, values, motions, orbits, orbits)
    ensemble = _ensemble(judge, values, motions, runs, orbits)
    into = arrivals(
        ensemble, known, every=ensemble.strobe, most=PATIENCE,
        cyclic=cyclic_states(judge.system), allowed=np.eye(runs.size, dtype=bool), progress=judge.execution.progress,
    )  # fmt: skip
    return np.asarray(into >= 0)


def same_orbits(
    judge: Judge, values: Mapping[str, Array], motions: xr.Dataset, one: Places, other: Places
) -> NDArray[np.bool_]:
    """Whether pairs of periodic motions of one place are on one orbit.

    Parameters
    ----------
    one, other : array of int, shape (pair,)
        Indices of motions.

    Returns
    -------
    array of bool, shape (pair,)
        Also True where a pair is no further apart than orbits are that cannot be closed, or where one of them cannot be.
    """
    out = np.ones(one.size, dtype=bool)
    place = motions["place"].values[one]
    columns = {name: column[place] for name, column in values.items()}
    if not (one.size and judge.system.model.forced):
        return out
    for group in order_groups(judge.system, parameter_values(judge.system, columns), columns):
        these = group.members
        some = {name: column[these] for name, column in columns.items()}
        out[these] = _on_one(judge, some, motions, one[these], other[these])
    return out


def _on_one(judge: Judge, values: Mapping[str, Array], motions: xr.Dataset, one: Places, other: Places) -> NDArray[np.bool_]:
    """Whether the motions of each pair are on one orbit: all of one common period."""
    cyclic = cyclic_states(judge.system)
    out, left = np.ones(one.size, dtype=bool), motions["end_state"].values
    plain = _closed(judge, values, motions, one, one, newton=False)
    near = np.array([o.distance(left[[k]].T, cyclic)[0][0] for o, k in zip(plain, other, strict=True)])
    apart = np.flatnonzero(near > SAME_POINT)
    every = np.array([
        repeat_of_forcing(judge.system.replace(**{n: c[k] for n, c in values.items()}), left[[one[k], other[k]]].T)
        for k in apart  # few: motions whose extremes agree are as a rule left on one orbit
    ])  # fmt: skip
    for turns in np.unique(every):
        these = apart[every == turns]
        some = {name: column[these] for name, column in values.items()}
        pairs = (_closed(judge, some, motions, which[these], one[these], every=int(turns)) for which in (one, other))
        for k, a, b in zip(these, *pairs, strict=True):
            out[k] = not (a.closed and b.closed) or a.distance(b.points[0][:, None], cyclic)[0][0] <= max(a.within, b.within)
    return out


def _ensemble(judge: Judge, values: Mapping[str, Array], motions: xr.Dataset, at: Places, steps: Places) -> Ensemble:
    """Motions where they were left, with the steps of others, so that both settle on the same orbit to the bit."""
    return judge.left(values, motions["end_state"].values[at], motions["steps"].values[steps])


def _closed(
    judge: Judge,
    values: Mapping[str, Array],
    motions: xr.Dataset,
    at: Places,
    steps: Places,
    *,
    newton: bool = True,
    every: int | None = None,
) -> list[ClosedOrbit]:
    """Orbits of periodic motions; as they were left where Newton's method is not asked."""
    ensemble = _ensemble(judge, values, motions, at, steps)
    return closed_orbits(
        ensemble, motions["period_common"].values[at].astype(np.int64), every=every or ensemble.strobe,
        tolerance=judge.labelling.settling.tolerance, cyclic=cyclic_states(judge.system), far=FAR if newton else None,
    )  # fmt: skip
