"""Divergence of neighbours in one recorded motion: the growth of their distance, measured across the flow.

Shared by `rosenstein` and `kantz`, which differ in what they average.

Between samples a motion goes far: at 40 samples per oscillation the nearest sample of a neighbouring pass lies up to 1/13 of
the radius ahead or behind, which is more than the passes are apart. That part of a distance belongs to the zero exponent of
the flow and does not grow. For a part ``a`` along the flow and a part ``u exp(L t)`` across it the mean logarithm over all
directions is ln(1 + exp(L t)) + const: it starts with half of the exponent and reaches it only when the attractor's
size is felt. So a neighbour is a point of the interpolated motion, at the time at which it passes nearest.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.signal import resample_poly, savgol_coeffs, welch
from scipy.spatial import cKDTree

from whirlmap.analysis.signals.embedding import delay_embedding
from whirlmap.errors import RangeError
from whirlmap.kernels.running.loops import compiled

Array = NDArray[np.float64]

#: Frequencies per sample at which there is noise alone; higher ones may have been filtered out.
FASTEST = (0.35, 0.42)
#: Largest noise of a flow, over the standard deviation: a map has about 1, a motion of 13 samples per swing 0.01 to 0.04.
SMOOTH = 0.1
#: Nearest samples among which neighbours are sought at most.
MOST_CANDIDATES = 1500
#: Samples per swing that motions are interpolated to, and samples at their ends that the interpolation spoils.
FINE, EDGE = 40, 20
#: Samples that cubic interpolation needs at either side.
MARGIN = 2
#: Distances below this part of the largest value are rounding.
ROUNDING = 1e-12
#: Distance, over that of two random points of the attractor, from which pairs feel its size.
FAR = 0.2


@dataclass(frozen=True)
class Passes:
    """Neighbours of reference points, nearest first, infinitely far where missing; shape (reference, neighbour)."""

    own: NDArray[np.intp]  # sample of each reference, shape (reference,)
    other: NDArray[np.intp]  # nearest sample of the neighbouring pass
    distance: Array  # across the flow
    size: float  # root mean square distance of two random points


def noise(x: Array) -> float:
    """Standard deviation of white noise on a motion, from the power at frequencies that a well sampled one lacks."""
    frequency, power = welch(x, nperseg=min(1024, x.size))
    return float(np.sqrt(power[(frequency > FASTEST[0]) & (frequency < FASTEST[1])].mean() / 2))


def resolved(x: Array, swing: int) -> tuple[Array, int, float]:
    """Give a motion at `FINE` samples per swing or more, without most of its noise.

    Returns
    -------
    series : array
    factor : int
        Samples of it for one of ``x``, by band-limited interpolation; the cubics of `follow` need that many.
    noise : float
        Standard deviation of what is left of white noise.

    Notes
    -----
    Smoothed by the cubic fitted to a quarter of a swing around each sample [savitzky1964]: a filter of finite length, which
    changes neither exponents nor dimensions.
    """
    sigma, factor = noise(x), -(-FINE // swing)
    if factor > 1:
        x = resample_poly(x - x.mean(), factor, 1)[EDGE * factor : -EDGE * factor]
    half = factor * swing // 8
    weights = savgol_coeffs(2 * half + 1, 3)
    left = min(factor * float(weights @ weights), 1.0)  # interpolated noise repeats itself
    return np.convolve(x, weights, mode="valid"), factor, sigma * float(np.sqrt(left))


def is_flow(x: Array) -> bool:
    """Whether the samples follow a smooth motion."""
    return noise(x) < SMOOTH * float(x.std())


def checked(series: ArrayLike) -> Array:
    """Give the series as an array, or a RangeError."""
    x = np.asarray(series, dtype=np.float64)
    if x.ndim != 1 or not np.isfinite(x).all() or np.ptp(x) == 0:
        raise RangeError(f"series has shape {x.shape}: one series of finite numbers that vary is needed.")
    return x


def near_passes(
    x: Array, *, dimension: int, lag: int, theiler: int, steps: int, flow: bool, references: int, wanted: int, least: float
) -> Passes:
    """Find the neighbours of random reference points.

    Parameters
    ----------
    x : array, shape (time,)
    dimension, lag : int
        Delay embedding.
    theiler : int
        Neighbours less than this number of samples apart in time do not count; twice as many for a flow, where the
        neighbour may move by half of it while it is followed (`follow`).
    steps : int
        Samples over which they are to be followed.
    references, wanted : int
        Reference points, and neighbours of each. Drawn at random, for even spacing may lock to the motion's phase.
    flow : bool
        The samples follow a motion in time: distances are across it, and of each pass only the nearest sample counts.
    least : float
        Neighbours nearer than this do not count.

    Raises
    ------
    RangeError
        Too few samples.
    """
    if min(dimension, lag, theiler, steps, references) < 1:
        raise RangeError(f"dimension = {dimension}, lag = {lag}, theiler = {theiler}, steps = {steps}: at least 1 each.")
    points = delay_embedding(x, dimension=dimension, lag=lag)
    margin, apart = (MARGIN + theiler // 2, 2 * theiler) if flow else (0, theiler)
    usable = len(points) - steps - 2 * margin
    if usable < max(100, 4 * apart):
        raise RangeError(f"{x.size} samples leave {usable} vectors to follow for {steps} samples: too few.")
    own = margin + np.sort(np.random.default_rng(0).choice(usable, size=min(references, usable), replace=False))
    tree = cKDTree(points[margin : margin + usable])
    other, distance = np.zeros((own.size, wanted), dtype=np.intp), np.full((own.size, wanted), np.inf)
    left, candidates = np.arange(own.size), 20 * wanted if wanted < 4 else 4 * wanted
    while left.size and candidates <= MOST_CANDIDATES:
        for rows in np.array_split(left, max(left.size * candidates // 50_000, 1)):
            here = own[rows]
            # As many more as may lie within the Theiler window, so that enough are left.
            _, near = tree.query(points[here], k=min(candidates + 2 * apart - 1, usable))
            near += margin
            offset = points[near] - points[here, None]
            valid = np.abs(near - here[:, None]) >= apart
            if flow:
                velocity = (points[near + 1] - points[near - 1]) / 2
                along, speed = (np.einsum("rkc,rkc->rk", v, velocity) for v in (offset, velocity))
                ahead = np.divide(along, speed, out=np.zeros_like(along), where=speed > 0)  # a signal may stand still
                offset -= ahead[..., None] * velocity
                valid &= np.abs(ahead) <= 0.5
            across = np.linalg.norm(offset, axis=2)
            across[~valid | (across < least)] = np.inf
            order = np.argsort(across, axis=1, kind="stable")[:, :wanted]
            other[rows], distance[rows] = np.take_along_axis(near, order, 1), np.take_along_axis(across, order, 1)
        left = left[~np.isfinite(distance[left, -1])]
        candidates *= 4
    return Passes(own, other, distance, float(np.sqrt(2 * points.var(axis=0).sum())))


def follow(x: Array, own: NDArray[np.intp], other: NDArray[np.intp], *, dimension: int, lag: int, theiler: int, steps: int,
           flow: bool) -> Array:  # fmt: skip
    """Distances of pairs of samples, after 0 to ``steps`` samples, shape (pair, step + 1).

    Notes
    -----
    For a flow the second one is a point of the cubic through the four samples around it, and moves along its motion to
    where it is nearest, by one Gauss-Newton step per sample (four at the start): two motions that stay close in space drift
    apart in time. It stays within half of ``theiler`` of its own time, beyond which the two have nothing in common.
    """
    out = np.empty((own.size, steps + 1))
    _follow(
        x=np.ascontiguousarray(x), own=own.astype(np.int64), other=other.astype(np.int64), pairs=own.size,
        dimension=dimension, lag=lag, steps=steps, reach=theiler // 2 if flow else 0, flow=int(flow),
        offset=np.empty(dimension), velocity=np.zeros(dimension), out=out,
    )  # fmt: skip
    return out


def mean_logarithms(distance: Array, blocks: int) -> Array:
    """Mean logarithms of distances (pair, step) in consecutive blocks of pairs, shape (block, step).

    Zeros are left out; NaN where nothing else is there.
    """
    apart = distance > 0
    parts = np.array_split(np.log(distance, out=np.zeros_like(distance), where=apart), blocks)
    counts = np.array([part.sum(axis=0) for part in np.array_split(apart, blocks)])
    sums = np.array([part.sum(axis=0) for part in parts])
    return np.where(counts > 0, sums / np.maximum(counts, 1), np.nan)


@compiled(
    {
        "x": "doubles", "own": "ints", "other": "ints", "pairs": "int", "dimension": "int", "lag": "int", "steps": "int",
        "reach": "int", "flow": "int", "offset": "doubles", "velocity": "doubles", "out": "doubles",
    }
)  # fmt: skip
def _follow(
    x: Array, own: NDArray[np.int64], other: NDArray[np.int64], pairs: int, dimension: int, lag: int, steps: int,
    reach: int, flow: int, offset: Array, velocity: Array, out: Array,
) -> None:  # fmt: skip
    """Distances of pairs; ``offset`` and ``velocity`` (zero at first) are room for one vector each."""
    for p in range(pairs):
        shift = 0.0
        for n in range(steps + 1):
            for _ in range(4 if n == 0 and flow else 1):
                at = other[p] + n + int(np.floor(shift))
                s = shift - np.floor(shift)
                along = speed = 0.0
                for c in range(dimension):
                    i, k = own[p] + n + c * lag, at + c * lag
                    value = x[k]
                    if flow:
                        before, here, after, beyond = x[k - 1], x[k], x[k + 1], x[k + 2]
                        third = (beyond - before) / 6 + (here - after) / 2
                        second = (before + after) / 2 - here
                        first = after - before / 3 - here / 2 - beyond / 6
                        value = here + s * (first + s * (second + s * third))
                        velocity[c] = first + s * (2 * second + 3 * s * third)
                    offset[c] = x[i] - value
                    along += offset[c] * velocity[c]
                    speed += velocity[c] * velocity[c]
                ahead = along / speed if speed > 0 else 0.0
                shift = min(max(shift + min(max(ahead, -1.0), 1.0), -float(reach)), float(reach))
            total = 0.0
            for c in range(dimension):
                total += (offset[c] - ahead * velocity[c]) ** 2
            out[p * (steps + 1) + n] = np.sqrt(total)
