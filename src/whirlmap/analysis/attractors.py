"""Which settled runs of one operating point are on the same attractor: orbits by a point in common, sets by their spacing.

All runs stand at the same phase of the forcing, one common period between their points. Two runs whose states agree there
have the same future, so that one point in common makes a periodic orbit the same orbit. Sets without a period (tori,
strange attractors, sampled cycles of unforced models) are compared by the distances to nearest neighbours.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from whirlmap.integrate.scales import FLOOR

Array = NDArray[np.float64]

#: Part of each state's range within which a point is the same as one of a periodic orbit: the accuracy of the steps and
#: of the return is 1e-6.
SAME_POINT = 1e-4
#: Spacings between the points of a set within which other points lie on it, at the median and at the upper decile.
SPACINGS = 4.0
#: Neighbours that say in which directions a smooth set goes on there: those in which they spread by more than `FLAT` of the
#: largest spread; and how far, over the range of the set, the nearest may be.
NEIGHBOURS, FLAT, GAP = 12, 0.1, 0.03


def on_orbit(states: Array, orbit: Array, scale: Array, cyclic: Mapping[int, float] | None = None) -> NDArray[np.bool_]:
    """Whether runs are on a periodic orbit.

    Parameters
    ----------
    states : array, shape (state, run)
        Where settled runs stand, at phase zero of the common period.
    orbit : array, shape (m, state)
        All points of the orbit at that phase.
    scale : array, shape (state,)
        What differences of each state are divided by (`whirlmap.integrate.scales`).

    Returns
    -------
    array of bool, shape (run,)
        True within `SAME_POINT` of any of its points, in every state.
    """
    nearest = np.full(states.shape[1], np.inf)
    for point in orbit:  # m of them, at most 64
        apart = states - point[:, None]
        for k, period in (cyclic or {}).items():
            apart[k] -= period * np.rint(apart[k] / period)
        nearest = np.minimum(nearest, (np.abs(apart) / scale[:, None]).max(axis=0))
    return nearest <= SAME_POINT


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
    `GAP` away. Two sets closer to each other than that are taken for one; a longer record tells them apart.
    """
    from scipy.spatial import cKDTree

    placed = _coordinates(known, cyclic)
    own = np.ptp(known, axis=0) if scale is None else np.array(scale, dtype=float)
    for k in cyclic or {}:
        own[k] = 1.0  # of its cosine and sine
    own = np.maximum(own, FLOOR * np.abs(known).max(axis=0))
    own = np.where(own > 0, own, 1.0)
    spread = np.concatenate([np.full(2 if k in (cyclic or {}) else 1, own[k]) for k in range(own.size)])
    placed = placed / spread
    tree = cKDTree(placed)
    own = tree.query(placed, k=2)[0][:, 1]
    limit = np.maximum(SPACINGS * np.quantile(own, (0.5, 0.9)), SAME_POINT)
    out = np.zeros(records.shape[2], dtype=bool)
    good = np.flatnonzero(np.isfinite(records).all(axis=(0, 1)))
    if good.size:
        here = _coordinates(np.moveaxis(records[:, :, good], 2, 0).reshape(-1, records.shape[1]), cyclic) / spread
        near, at = tree.query(here, k=NEIGHBOURS if smooth else 1)
        if smooth:
            near = np.where(near[:, 0] <= GAP, _across(here - placed[at[:, 0]], placed[at]), np.inf)
        out[good] = (np.quantile(near.reshape(good.size, -1), (0.5, 0.9), axis=1) <= limit[:, None]).all(axis=0)
    return out


def _across(offset: Array, cloud: Array) -> Array:
    """Length of offsets (point, coordinate) without the directions in which clouds (point, neighbour, coordinate) spread."""
    _, size, axes = np.linalg.svd(cloud - cloud.mean(axis=1, keepdims=True), full_matrices=False)
    along = np.einsum("pkc,pc->pk", axes, offset)
    spreads = size > FLAT * size[:, :1]
    rest = offset - np.einsum("pk,pkc->pc", np.where(spreads, along, 0.0), axes)
    return np.asarray(np.linalg.norm(rest, axis=1))


def _coordinates(points: Array, cyclic: Mapping[int, float] | None) -> Array:
    """Points (..., state) as coordinates in which angles are cosine and sine."""
    columns = []
    for k in range(points.shape[-1]):
        if cyclic and k in cyclic:
            angle = 2 * np.pi * points[..., k] / cyclic[k]
            columns += [np.cos(angle), np.sin(angle)]
        else:
            columns.append(points[..., k])
    return np.stack(columns, axis=-1)
