"""Runs still in their transients: which of the known periodic orbits each converges to."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.periodic_orbits.closed_orbit import LEAST_RETURNS, RETURNS, ClosedOrbit, flows_into
from whirlmap.integrate.ensemble import Ensemble

Array = NDArray[np.float64]


def arrivals(
    ensemble: Ensemble,
    orbits: Sequence[ClosedOrbit],
    *,
    every: int,
    most: int,
    cyclic: Mapping[int, float] | None = None,
    allowed: NDArray[np.bool_] | None = None,
    progress: Callable[[int], None] | None = None,
) -> NDArray[np.int64]:
    """Run on until it is known to which orbit each run converges.

    Parameters
    ----------
    ensemble : Ensemble
        Runs on, each for its own time.
    orbits : sequence of ClosedOrbit
    every : int
        T between the rows of the orbits.
    most : int
        Rows after which a run is given up.
    allowed : array of bool, shape (run, orbit), optional
        Orbits that each run is compared with; all of them where absent.

    Returns
    -------
    array of int, shape (run,)
        Index of the orbit; -1 where a run does not come nearer to one from one check to the next, ends, or has not arrived
        in the longest time. Each check comes after as many rows as were run before.
    """
    into = np.full(ensemble.points, -1)
    allowed = np.ones((into.size, len(orbits)), dtype=bool) if allowed is None else allowed
    allowed = allowed & np.array([orbit.closed for orbit in orbits], dtype=bool)
    going = np.flatnonzero(ensemble.running & allowed.any(axis=1))
    rows = max((LEAST_RETURNS + 1) * max((len(orbit.points) for orbit in orbits), default=0), RETURNS + 1)
    before, ran = np.full(into.size, np.inf), 0
    while going.size and ran < most:
        now = max(rows, ran)
        ensemble.advance((now - rows) * every, members=going, progress=progress)
        saved = ensemble.advance(rows * every, members=going, save_periods=every, progress=progress).saved
        ran += now
        nearest = np.full(going.size, np.inf)
        for number, orbit in enumerate(orbits):
            mine = np.flatnonzero(allowed[going, number])
            into[going[mine[flows_into(saved[:, :, mine], orbit, cyclic)]]] = number
            away = np.max([orbit.distance(x, cyclic)[0] for x in saved[:, :, mine]], axis=0)
            nearest[mine] = np.fmin(nearest[mine], away)
        on = (into[going] < 0) & ensemble.running[going] & (nearest < before[going])
        before[going] = nearest
        going = going[on]
    return into
