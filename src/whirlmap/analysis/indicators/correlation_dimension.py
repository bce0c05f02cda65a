"""Correlation dimension of a cloud of points, with its scaling range and its error.

The estimator is the correlation sum of Grassberger and Procaccia (1983) with the exclusion of neighbours in
time of Theiler (1986). All pairs are counted exactly (no box-assisted search, no sampling of pairs), so
the counts, and with them the dimension, do not depend on the number of threads.
"""

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.indicators.correlation_sum import pair_counts
from whirlmap.analysis.indicators.scaling_range import Curves, is_finite_set, scaling_range
from whirlmap.errors import RangeError
from whirlmap.results.findings import Findings, Variable, gives_dataset

Norm = Literal["euclidean", "maximum"]

STATUS = ("ok", "no-scaling-range", "too-few-points", "degenerate")
"""Meaning of ``status`` by value."""


@gives_dataset
def correlation_dimension(
    points: ArrayLike,
    *,
    theiler: int,
    trajectories: ArrayLike | None = None,
    scale: ArrayLike | None = None,
    norm: Norm = "euclidean",
    cyclic: Mapping[int, float] | None = None,
    tolerance: float = 0.05,
    least_decades: float = 1.0,
    least_pairs: int = 200,
    least_points: int = 500,
    largest_sum: float = 0.1,
    resolution: float = 1e-8,
    blocks: int = 16,
    workers: int = 1,
) -> Findings:
    """Correlation dimension D2, the range of radii it was read from, and one standard error.

    Parameters
    ----------
    points : array, shape (point, coordinate)
        Points on the attractor, transients dropped; within one trajectory in the order of time.
    theiler : int
        Pairs less than this number of samples apart on the same trajectory are left out. 1 leaves out nothing
        but a point with itself and suits sections of a chaotic motion; for a flow take some correlation
        times.
    trajectories : array of int, shape (point,), optional
        Which trajectory each point belongs to; trajectories may be interleaved. Left out: all points are one.
    scale : array, shape (coordinate,) or float, optional
        Coordinates are divided by it. Default: the standard deviation of each.
    norm : {"euclidean", "maximum"}
        D2 is the same with either. The default is Euclidean, because turning the coordinates then changes
        nothing.
    cyclic : mapping of coordinate to period, optional
        Coordinates, such as a pendulum's angle, whose differences are taken modulo a period (unscaled units).
    tolerance : float
        Largest departure of a local slope from the fitted one within the range, as a fraction of the fitted
        slope; twice the slope's own standard error is granted on top.
    least_decades : float
        A shorter range does not count as scaling.
    least_pairs : int
        Radii with fewer pairs inside are not used.
    least_points : int
        With fewer points the answer is ``too-few-points``.
    largest_sum : float
        Radii whose correlation sum exceeds this feel the size of the attractor and are not used.
    resolution : float
        Smallest distance that means anything, as a fraction of the root mean square distance of two points;
        below it lie the errors of the integration. No smaller radius is used.
    blocks : int
        Number of parts in the resampling; whole trajectories where there are as many.
    workers : int
        Threads. The result has the same bits for any number.

    Returns
    -------
    xr.Dataset
        ``correlation_sum(radius)``, ``local_slope(radius)``, ``local_slope_error(radius)`` (NaN where fewer
        than ``least_pairs`` pairs lie inside, as ``radius_status`` says), and the scalars ``D2``,
        ``D2_error``, ``D2_error_resampling``, ``D2_error_range``, ``radius_low``, ``radius_high``,
        ``decades``, ``n_pairs``, ``n_points``, ``n_trajectories``, ``size`` (root mean square distance),
        ``D2_limit`` and ``status``. The scalars from ``D2`` to ``decades`` are NaN unless ``status`` is
        ``ok``. ``coordinate_used(coordinate)`` is 0 where a coordinate is constant to within ``resolution``
        of its magnitude and was left out.

    Raises
    ------
    RangeError
        The points are not finite or not two-dimensional, or an option is out of range.

    Notes
    -----
    1. C(r) = share of admitted pairs closer than r (Grassberger and Procaccia 1983), Theiler (1986) window.
    2. Local slope: least squares of ln C on ln r over a factor of 4 in r, so that the log-periodic swing of a
       self-similar set (ratio 1/3 in the Cantor set) averages out.
    3. ``degenerate``: C is flat (slope below 0.02) over two decades, or over one decade that reaches down to
       ``resolution``, at a level which means that the points sit in heaps of ten or more: a finite set, as
       the section of a periodic orbit is.
    4. Scaling range: the widest range of usable radii on which every local slope stays within ``tolerance``
       of D2, the slope of ln C over the range; ties go to the smaller radii.
    5. ``D2_error_resampling``: jackknife over ``blocks``, each left out with all its pairs, range held. It
       needs no random numbers. ``D2_error_range``: half the difference between the extremes of the slopes
       fitted to the three thirds of the range. ``D2_error`` is the root of the sum of squares.
    6. D2 above ``D2_limit`` = 2 log10(points) cannot be told from noise with one decade (Eckmann and Ruelle
       1992): ``too-few-points``.

    The sum converges slowly where the density has singularities: the logistic map at r = 4 has C ~ r ln(1/r)
    and slopes of 0.9 where D2 = 1, and no range-based error sees all of that. Time grows as points squared.

    References
    ----------
    [grassberger1983] Grassberger and Procaccia, Physica D 9 (1983) 189. [theiler1986] Theiler, Phys. Rev. A 34 (1986) 2427.
    [eckmann1992] Eckmann and Ruelle, Physica D 56 (1992) 185.
    """
    x, ids = _checked(points, trajectories)
    limits = {"theiler": (theiler, 1, len(x)), "blocks": (blocks, 4, 64), "workers": (workers, 1, 1024)}
    for name, (value, least, most) in limits.items():
        if not least <= value <= most:
            raise RangeError(f"{name} = {value}: a whole number from {least} to {most} is needed.")
    if norm not in ("euclidean", "maximum"):
        raise RangeError(f"norm = {norm!r}: 'euclidean' or 'maximum' is needed.")
    n = len(x)
    order = np.argsort(ids, kind="stable")  # trajectories one after the other, time order kept within each
    x, ids = x[order], ids[order]
    x, wrap, used = _scaled(x, scale, dict(cyclic or {}), resolution)
    starts = np.flatnonzero(np.r_[True, ids[1:] != ids[:-1]])
    ends = np.r_[starts[1:], n]
    end_of = np.repeat(ends, ends - starts)
    first = np.minimum(np.arange(n) + theiler, end_of)  # the first partner of each point
    n_pairs = int(np.sum(n - first))
    size = float(np.sqrt(2.0 * x.var(axis=0).sum()))
    answer: dict[str, Any] = {"n_points": n, "n_trajectories": starts.size, "n_pairs": n_pairs}
    answer |= {"size": size, "D2_limit": 2.0 * np.log10(n)}
    answer["options"] = {
        "norm": norm,
        "theiler": theiler,
        "tolerance": tolerance,
        "least_decades": least_decades,
        "least_pairs": least_pairs,
        "largest_sum": largest_sum,
        "resolution": resolution,
        "blocks": blocks,
    }
    if n < least_points or n_pairs < 100 * least_pairs:
        return _findings(answer, STATUS.index("too-few-points"), used, size)
    if size == 0.0:
        return _findings(answer, STATUS.index("degenerate"), used, size)

    if starts.size >= blocks:  # whole trajectories, as near as can be to equal shares
        cuts = np.r_[0, ends[np.linspace(-1, starts.size - 1, blocks + 1)[1:].astype(int)]]
    else:
        cuts = np.linspace(0, n, blocks + 1).astype(np.int64)
    tasks = [(a, b) for a in range(blocks) for b in range(a, blocks)]
    radius, inside, all_pairs = pair_counts(
        x / size, wrap / size, first, cuts, tasks, maximum=norm == "maximum", resolution=resolution, workers=workers
    )
    total = inside.sum(axis=0)
    without = np.array([total - inside[[k in t for t in tasks]].sum(axis=0) for k in range(blocks)])
    pairs_without = np.array([n_pairs - all_pairs[[k in t for t in tasks]].sum() for k in range(blocks)])
    curves = Curves(radius, total / n_pairs, without / pairs_without[:, None], total >= least_pairs)
    answer["curves"] = curves
    if is_finite_set(curves, n):
        return _findings(answer, STATUS.index("degenerate"), used, size)
    found = scaling_range(curves, tolerance, least_decades, largest_sum)
    if found is None:
        return _findings(answer, STATUS.index("no-scaling-range"), used, size)
    answer |= curves.fit(*found)
    status = "too-few-points" if answer["D2"] > answer["D2_limit"] else "ok"
    return _findings(answer, STATUS.index(status), used, size)


def _checked(
    points: ArrayLike, trajectories: ArrayLike | None
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Points and trajectory ids as arrays, or a RangeError."""
    x = np.asarray(points, dtype=np.float64)
    if x.ndim != 2 or 0 in x.shape:
        raise RangeError(
            f"points has shape {x.shape}: (point, coordinate) is needed; a series is x[:, None]."
        )
    if not np.isfinite(x).all():
        raise RangeError(
            f"{np.sum(~np.isfinite(x).all(axis=1))} of {len(x)} points are not finite: leave them out."
        )
    ids = np.zeros(len(x), dtype=np.int64) if trajectories is None else np.asarray(trajectories)
    if ids.shape != x.shape[:1] or not np.issubdtype(ids.dtype, np.integer):
        raise RangeError(
            f"trajectories must be {len(x)} integers, one per point; got {ids.dtype} {ids.shape}."
        )
    return x, ids.astype(np.int64)


def _scaled(
    x: NDArray[np.float64], scale: ArrayLike | None, cyclic: dict[int, float], resolution: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
    """Centred and scaled coordinates, cyclic ones last; their periods; which coordinates are used."""
    d = x.shape[1]
    for k, period in cyclic.items():
        if not (0 <= k < d and period > 0):
            raise RangeError(
                f"cyclic = {{{k}: {period}}}: coordinates run from 0 to {d - 1}, periods are positive."
            )
    magnitude, centred = np.abs(x).max(axis=0), x - x.mean(axis=0)
    for k, period in cyclic.items():
        mean = np.angle(np.exp(2j * np.pi * x[:, k] / period).mean()) * period / (2 * np.pi)
        centred[:, k] = x[:, k] - mean - period * np.rint((x[:, k] - mean) / period)
        magnitude[k] = period
    deviation = centred.std(axis=0)
    # Scaling a coordinate that only holds rounding errors to unit size would drown the others in noise.
    used = deviation > resolution * magnitude
    divisor = deviation if scale is None else np.broadcast_to(np.asarray(scale, dtype=np.float64), (d,))
    if not (divisor[used] > 0).all():
        raise RangeError(f"scale = {scale!r}: positive numbers are needed, one or {d}.")
    columns = [k for k in range(d) if used[k] and k not in cyclic] + [
        k for k in range(d) if used[k] and k in cyclic
    ]
    wrap = np.array([cyclic[k] / divisor[k] for k in columns if k in cyclic], dtype=np.float64)
    return centred[:, columns] / divisor[columns], wrap, used.astype(np.int64)


def _findings(answer: dict[str, Any], status: int, used: NDArray[np.int64], size: float) -> Findings:
    """Name the numbers, with units and CF flags."""
    names = {
        "D2": "correlation dimension",
        "D2_error": "standard error of the correlation dimension",
        "D2_error_resampling": "part of the error from leaving out blocks of points",
        "D2_error_range": "part of the error from the slopes of three parts of the range",
        "radius_low": "lower end of the scaling range, scaled distance",
        "radius_high": "upper end of the scaling range, scaled distance",
        "decades": "length of the scaling range, decades of radius",
    }
    fitted = {name: answer.get(name, np.nan) for name in names}  # NaN exactly where status is not ok
    if STATUS[status] != "ok":
        fitted = dict.fromkeys(names, np.nan)
    for name in ("radius_low", "radius_high"):
        fitted[name] = fitted[name] * size
    names |= {
        "n_points": "number of points",
        "n_trajectories": "number of trajectories",
        "n_pairs": "number of pairs outside the Theiler window",
        "size": "root mean square distance of two points, scaled",
        "D2_limit": "largest dimension that so many points can show (Eckmann and Ruelle 1992)",
    }
    values = answer | fitted
    variables: dict[str, Variable] = {k: ((), values[k], {"units": "1", "long_name": names[k]}) for k in names}
    variables["status"] = ((), np.int8(status), _flags("status of the correlation dimension", STATUS))
    variables["coordinate_used"] = ("coordinate", used.astype(np.int8), _flags("coordinate varies", ("no", "yes")))
    coordinates: dict[str, Variable] = {}
    curves: Curves | None = answer.get("curves")
    if curves is not None:
        attributes = {"units": "1", "long_name": "scaled distance"}
        coordinates["radius"] = ("radius", curves.radius * size, attributes)
        for name, curve, long_name in (
            ("correlation_sum", curves.whole, "share of pairs closer than radius"),
            ("local_slope", curves.slope, "slope of ln C on ln r over a factor of 4 in radius"),
            ("local_slope_error", curves.error, "standard error of the local slope"),
        ):
            variables[name] = ("radius", curve, {"units": "1", "long_name": long_name})
        flags = _flags("local slope", ("slope-given", "too-few-pairs"))
        variables["radius_status"] = ("radius", np.isnan(curves.slope).astype(np.int8), flags)
    options = answer["options"] | {"algorithm": "Grassberger and Procaccia 1983, Theiler 1986"}
    return Findings(variables, coordinates, options)


def _flags(long_name: str, meanings: tuple[str, ...]) -> dict[str, Any]:
    """CF attributes of an integer flag."""
    values = np.arange(len(meanings), dtype=np.int8)
    return {"units": "1", "long_name": long_name, "flag_values": values, "flag_meanings": " ".join(meanings)}
