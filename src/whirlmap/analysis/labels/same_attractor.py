"""Which settled runs of one operating point are on the same attractor.

Two runs are on one attractor where a shift in time takes the one motion to the other, or both trace one set. What shifts
take solutions to solutions is decided by the equations: those by the time after which the equations are the same. That is
the common period of the whole forcing, or less where harmonics do not act (`whirlmap.sweep.attractors.repeat_time`); T is
such a time only where T is a period of the whole forcing. So a motion that returns after m common periods is one attractor
at whichever of its m phases a run stands, and two motions that a shift by T takes to each other though the forcing is not
the same after T are two.

- Periodic orbits are one where they have a point in common at such a phase. Runs settle to a tolerance only; so orbits are
  closed by Newton's method first (`closed_orbit`), and one that still approaches belongs to the orbit to which it converges.
- Tori and strange attractors (and sampled cycles of unforced models) are one where the points of the one lie on the other
  (`on_set`, which needs a few points of a run), or where nothing tells their distributions apart (`distribution.compare`,
  which needs thousands). They are two where both say so, and say it again of longer records.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.indicators.distribution import compare, coordinates, own_scale, visits_like
from whirlmap.integrate.scales import FLOOR

Array = NDArray[np.float64]

#: Least part of the range of a set that counts as a distance.
LEAST = 1e-4
#: Spacings between the points of a set within which other points lie on it, at the median and at the upper decile.
SPACINGS = 4.0
#: Neighbours that say in which directions a smooth set goes on there: those in which they spread by more than `FLAT` of the
#: largest spread; and how far, over the range of the set, the nearest may be.
NEIGHBOURS, FLAT, GAP = 12, 0.1, 0.03


def same_set(
    one: Array, other: Array, scale: Array, cyclic: Mapping[int, float] | None = None, *, smooth: bool = False
) -> bool:
    """Whether two long records trace one set.

    Parameters
    ----------
    one, other : array, shape (time, state)
        Section points, thousands.
    scale : array, shape (state,)
        What differences of each state are divided by (`whirlmap.integrate.scales`).
    smooth : bool
        Whether both are tori.

    Notes
    -----
    The distributions decide where their averages are good enough. A record that does not average, as beside a resonance,
    says nothing about its distribution; then they are one where the points of either lie on the other.
    """
    found = compare(one, other, scale, cyclic, smooth=smooth)
    if found.known:
        return not found.different
    pairs = ((one, other), (other, one))
    return any(bool(on_set(a[:, :, None], b, cyclic, smooth=smooth, scale=scale)[0]) for a, b in pairs)


def on_set(
    records: Array, known: Array, cyclic: Mapping[int, float] | None = None, *, smooth: bool = False,
    scale: Array | None = None,
) -> NDArray[np.bool_]:  # fmt: skip
    """Whether runs are on the set that a long record traces.

    Parameters
    ----------
    records : array, shape (time, state, run)
        A few successive section points of each run.
    known : array, shape (long time, state)
        Section points that trace the set.
    smooth : bool
        The set is a smooth curve or surface, as of quasi-periodic motion: distances are taken across it, for near a
        resonance its points leave gaps that are wider than their usual spacing.
    scale : array, shape (state,), optional
        What differences of each state are divided by (`whirlmap.integrate.scales`); its range where absent.

    Returns
    -------
    array of bool, shape (run,)

    Notes
    -----
    Distances to the nearest point of the set, in units of the set's range, are compared with the distances of its own points
    from each other's nearest: median and upper decile within `SPACINGS` of the set's. Across a smooth set: what is left
    of them without the directions in which the `NEIGHBOURS` nearest of its points spread, if they are no further than
    `GAP` away; and the same of the set's own points. On a strange set the averages over each run must be among those over
    stretches of the trace as well (`visits_like`): in many dimensions its points are so far apart that others lie between.
    Two sets closer to each other than that are taken for one; a longer record tells them apart. Some runs in a thousand on
    a strange set visit its rare parts and are not found on it, so that only a yes counts.
    """
    from scipy.spatial import cKDTree

    own = own_scale(known) if scale is None else np.maximum(scale, FLOOR * np.abs(known).max(axis=0))
    placed = coordinates(known, cyclic, own)
    tree = cKDTree(placed)
    count = NEIGHBOURS if smooth else 1
    near, at = tree.query(placed, k=count + 1)
    spacing = near[:, 1]
    if smooth:  # each point against its neighbours without itself
        spacing = _across(placed - placed[at[:, 1]], placed[at[:, 1:]])
    limit = np.maximum(SPACINGS * np.quantile(spacing, (0.5, 0.9)), LEAST)
    out = np.zeros(records.shape[2], dtype=bool)
    good = np.flatnonzero(np.isfinite(records).all(axis=(0, 1)))
    if good.size:
        runs = np.moveaxis(records[:, :, good], 2, 0).reshape(-1, records.shape[1])
        here = coordinates(runs, cyclic, own)
        near, at = tree.query(here, k=count)
        if smooth:
            near = np.where(near[:, 0] <= GAP, _across(here - placed[at[:, 0]], placed[at]), 1 / FLOOR)
        near = near.reshape(good.size, -1)
        out[good] = (np.quantile(near, (0.5, 0.9), axis=1) <= limit[:, None]).all(axis=0)
        if not smooth:
            out[good] &= visits_like(here.reshape(*near.shape, -1), placed)
    return out


def _across(offset: Array, cloud: Array) -> Array:
    """Length of offsets (point, coordinate) without the directions in which clouds (point, neighbour, coordinate) spread."""
    _, size, axes = np.linalg.svd(cloud - cloud.mean(axis=1, keepdims=True), full_matrices=False)
    along = np.einsum("pkc,pc->pk", axes, offset)
    spreads = size > FLAT * size[:, :1]
    rest = offset - np.einsum("pk,pkc->pc", np.where(spreads, along, 0.0), axes)
    return np.asarray(np.linalg.norm(rest, axis=1))
