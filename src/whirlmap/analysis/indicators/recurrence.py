"""Recurrence rate and determinism: how often states come back, and whether they then stay together."""


import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.errors import RangeError
from whirlmap.kernels.running.loops import compiled
from whirlmap.results.findings import Findings, gives_dataset

Array = NDArray[np.float64]


@compiled(
    {"x": "doubles", "n": "int", "d": "int", "radius": "doubles", "theiler": "int", "least": "int", "out": "ints"}
)
def _diagonals(
    x: Array, n: int, d: int, radius: Array, theiler: int, least: int, out: NDArray[np.int64]
) -> None:
    """Recurrent pairs of x (n, d), those on diagonal lines of at least ``least``, the number of such lines, the longest."""
    square = radius[0] * radius[0]
    recurrent = on_lines = lines = longest = 0
    for lag in range(theiler, n):
        run = 0
        for i in range(n - lag):
            total = 0.0
            for k in range(d):
                total += (x[i * d + k] - x[(i + lag) * d + k]) ** 2
            close = total <= square
            if close:
                run += 1
                recurrent += 1
            if run > 0 and (i == n - lag - 1 or not close):
                if run >= least:
                    on_lines += run
                    lines += 1
                longest = max(longest, run)
                run = 0
    out[0], out[1], out[2], out[3] = recurrent, on_lines, lines, longest


@gives_dataset
def recurrence(
    points: ArrayLike, *, radius: float | None = None, rate: float = 0.05, theiler: int = 1, least: int = 2
) -> Findings:
    """Recurrence rate, determinism and diagonal lines of a trajectory.

    Parameters
    ----------
    points : array, shape (time,) or (time, coordinate)
        Successive section points, or an embedded series. Coordinates that matter alike must be of one size.
    radius : float, optional
        Two points are recurrent within it; where absent the one that gives ``rate``.
    rate : float
        Share of recurrent pairs wanted where no radius is given, in (0, 0.5).
    theiler : int
        Pairs less than this number of samples apart are left out.
    least : int
        Shortest line that counts.

    Returns
    -------
    xr.Dataset
        ``recurrence_rate``, share of recurrent pairs; ``determinism``, share of these on lines of at least ``least``
        samples; ``mean_line`` and ``longest_line`` [samples]; ``radius``.

    Raises
    ------
    RangeError
        Fewer than 50 points, numbers that are not finite, or options out of range.

    Notes
    -----
    [eckmann1987], [marwan2007]. Independent values with rate p have determinism 1 - (1 - p)^2 (``least`` = 2): only what
    exceeds that is structure. Periodic and quasi-periodic motion show 1, deterministic chaos little less, so that
    determinism tells noise from dynamics but not chaos from a torus. The radius that gives a rate is the quantile of
    the distances of at most 2000 evenly spaced points. Time grows as points squared.
    """
    x = np.asarray(points, dtype=np.float64)
    x = np.ascontiguousarray(x[:, None] if x.ndim == 1 else x)
    if x.ndim != 2 or x.shape[0] < 50 or not np.isfinite(x).all():
        raise RangeError(f"points has shape {x.shape}: at least 50 points with finite coordinates are needed.")
    if not (1 <= theiler < x.shape[0] // 2 and least >= 2 and 0 < rate < 0.5) or (radius is not None and not radius > 0):
        raise RangeError(
            f"theiler = {theiler}, least = {least}, rate = {rate}, radius = {radius}: theiler from 1 to half the points, "
            "least from 2, rate in (0, 0.5), radius positive."
        )
    if radius is None:
        some = x[:: max(x.shape[0] // 2000, 1)]
        apart = [np.linalg.norm(some[k] - some[k + 1 :], axis=1) for k in range(len(some) - 1)]  # each fits into cache
        radius = float(np.quantile(np.concatenate(apart), rate))
    counts = np.empty(4, dtype=np.int64)
    n, d = x.shape
    _diagonals(x=x, n=n, d=d, radius=np.array([radius], dtype=float), theiler=theiler, least=least, out=counts)
    recurrent, on_lines, lines, longest = counts.tolist()
    m = x.shape[0] - theiler
    values = {
        "recurrence_rate": (recurrent / (m * (m + 1) / 2), "share of pairs that are recurrent"),
        "determinism": (on_lines / max(recurrent, 1), "share of recurrent pairs on diagonal lines"),
        "mean_line": (on_lines / max(lines, 1), "mean length of the diagonal lines, samples"),
        "longest_line": (longest, "longest diagonal line, samples"),
        "radius": (radius, "distance within which points are recurrent"),
    }
    variables = {name: ((), v, {"units": "1", "long_name": meaning}) for name, (v, meaning) in values.items()}
    return Findings(variables, attrs={"theiler": theiler, "least": least})
