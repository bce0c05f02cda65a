"""Order of locking: the n of a motion locked to a forcing that has no reasonable common period.

The phases of the forcing are a torus. A motion locked to it is a smooth function of them, or of their n-th parts: it has no
frequency but sums of the forcing's and sums of their n-th parts.
"""

from collections.abc import Iterator, Mapping
from fractions import Fraction
from itertools import combinations
from math import gcd, lcm

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.labels.forced_lines import Array, Integers, Lines, Turns, strongest, sums_of
from whirlmap.analysis.labels.forced_parts import MOST, SHORT, TURNS, fold, sum_near
from whirlmap.analysis.steady.periodicity import period_of
from whirlmap.errors import RangeError

#: Largest scaled difference that counts as a return after whole common periods: that of `periodicity`.
RETURN = 1e-6
#: Largest scaled misfit of a sum of lines that explains the motion: between the return's 1e-6 and a subharmonic of 1e-4.
EXPLAINED = 1e-5
#: Terms of the attempts, as parts of the number of points: with three points a term no fit is by chance.
ATTEMPTS = (10, 3)
#: No more terms than this.
TERMS = 1200
#: Subharmonics that do not follow from each other; one of a quarter may need a half first.
SUBHARMONICS = 2
#: Least strength of a subharmonic in one half of a record over that in the other half: what is weaker decays, or is no line.
LASTS = 0.85
#: A line that belongs to no sum leaves more than this part: one of 1e-4 of the range leaves more than `EXPLAINED`.
LEFT = 0.1
#: Bytes of points that are judged at a time.
AT_A_TIME = 2**26


def locked_multiple(
    section: ArrayLike, orders: Turns, *, scale: ArrayLike, cyclic: Mapping[int, float] | None = None
) -> tuple[Integers, Array]:
    """Smallest n such that n times every frequency of a locked motion is a sum of the frequencies of its forcing.

    Parameters
    ----------
    section : array, shape (time, state, point)
        Section points once per period T of the fastest harmonic, settled: ask only where the largest exponent is clearly
        negative. 1024 times decide most motions of two or three frequencies, strongly nonlinear ones need more.
    orders : tuple of Fraction
        Frequencies of the forcing's harmonics over the fastest one, exact; equal ones count once.
        The fractions of numbers such as 0.618... may have denominators of any size.
    scale : array, shape (state,) or (state, point)
        Range of each state over the motion (1 for a state that is constant).
    cyclic : mapping of state index to period, optional
        Angles; they count by their places on a circle.

    Returns
    -------
    n : array of int, shape (point,)
        1 to 12; 0 where the data do not decide, or numbers are not finite.
    misfit : array, shape (point,)
        Largest difference, over times and states, in units of the scale, that n leaves unexplained; for n = 0 the smallest
        of the attempts, infinite where none was made. It may be small with n = 0: lines too close to say anything.

    Raises
    ------
    RangeError
        The shape of the section, scales that are not positive, or an order that is not positive.

    Notes
    -----
    n counts common periods where there is one: a motion that returns after m of them has n = m. An order up to 1/128 counts
    with all its multiples, so that half the frequency of the mesh of a gear with 36 teeth is the 18th harmonic of its shaft,
    and n = 1. Of other orders n-th parts are told from sums of up to eight.

    1. Where all orders have denominators up to 128 and the record holds 4/3 common periods: returns after 1 to 12 of
       them, within 1e-6 of the scale, the tolerance of `periodicity`. Nothing need be smooth.
    2. Else least squares on lines at sums of the orders (`forced_lines`), the lightest first, weighed by how fast the
       lines fall with the multiple of each order. What is explained to 1e-5 of the scale, everywhere, by a third as many
       terms as there are times has n = 1, if these would not explain lines at fractions of the fastest frequency too.
    3. What is not: the strongest line that is left, if it lies within 0.5/times of an n-th part of a small sum of orders
       that chance would not put there (`forced_parts`), joins the orders, and 2 is repeated; up to two such. The smallest n
       whose lines explain the motion is returned, if what the forcing's own lines leave is as strong in both halves of the
       record: a slow decay is not.

    A subharmonic of 1e-4 of the scale is seen, one of 1e-6 counts as none; in between both may happen. Undecided: records
    with fewer than two turns of the slowest forcing, of the slowest beat of two, or of their n-th part; motion that is not
    smooth enough for the terms (contact, kinks). A slow decay beside slow beats may pass for one of them. Where several slow
    forcings have sums in every step of frequency, a subharmonic of one of them below about 1e-2 may be taken for such a sum.

    Fourier analysis of quasi-periodic functions [gomez2010], the frequencies being known. At 1024 times, four orders and
    two states it costs 10 ms a point in company of 50; every set of lines costs 20 ms, however many points share it.
    """
    x = np.asarray(section, dtype=np.float64)
    if x.ndim != 3 or x.shape[0] < 64 or 0 in x.shape:
        raise RangeError(f"section has shape {x.shape}: (time, state, point) with at least 64 times is needed.")
    size = np.asarray(scale, dtype=np.float64)
    size = np.broadcast_to(size[:, None] if size.ndim == 1 else size, x.shape[1:])
    period = period_of(cyclic, x.shape[1])
    if not all(o > 0 for o in orders):
        raise RangeError(f"orders = {orders}: all must be positive.")
    turns = tuple(sorted({min(Fraction(o) % 1, -Fraction(o) % 1) for o in orders} - {Fraction(0)}, reverse=True))
    n, misfit = np.zeros(x.shape[2], np.int64), np.full(x.shape[2], np.inf)
    finite = np.flatnonzero(np.isfinite(x).all(axis=(0, 1)))
    if not (size[:, finite] > 0).all():
        raise RangeError("scale holds numbers that are not positive.")
    for part in np.array_split(finite, max(1, x[:, :, finite].nbytes // AT_A_TIME)):
        y = _scaled(x[:, :, part], size[:, part], period)
        n[part], misfit[part] = _judged(y, turns)
    return n, misfit


def _scaled(x: Array, size: Array, period: Array) -> Array:
    """Points as (point, time, coordinate), in units of their scales; an angle is two coordinates on a circle."""
    parts = []
    for k, p in enumerate(period):
        if np.isfinite(p):
            angle, radius = x[:, k] * (2 * np.pi / p), p / (2 * np.pi) / size[k]
            parts += [np.cos(angle) * radius, np.sin(angle) * radius]
        else:
            parts.append((x[:, k] - x[:, k].mean(axis=0)) / size[k])
    return np.ascontiguousarray(np.array(parts).transpose(2, 1, 0))


def _judged(y: Array, turns: Turns) -> tuple[Integers, Array]:
    """Returns n and misfit: by returns where common periods are short enough to be seen, else by sums of lines."""
    n, misfit = np.zeros(len(y), np.int64), np.full(len(y), np.inf)
    common = lcm(*(o.denominator for o in turns))
    visible = all(t.denominator <= SHORT for t in turns)
    multiples = [m for m in range(1, MOST + 1) if visible and 4 * m * common <= 3 * y.shape[1]]
    for m in multiples:
        apart = np.abs(y[:, m * common :] - y[:, : -m * common]).max(axis=(1, 2))
        n[(n == 0) & (apart < RETURN)] = m
        misfit = np.where(n == m, apart, np.where(n == 0, np.minimum(misfit, apart), misfit))
    slow = [*turns, *(abs(a - b) for a, b in combinations(turns, 2))]
    if len(multiples) == MOST or (turns and y.shape[1] * min(slow) < TURNS):
        return n, misfit
    earlier: dict[tuple[int, Turns], Fraction | None] = {}  # few lines hide less of a subharmonic, many leave less beside it
    for part in ATTEMPTS:
        most = min(y.shape[1] // part, TERMS)
        trials = {turns: np.flatnonzero(n == 0)}
        for _ in range(SUBHARMONICS + 1):
            following: dict[Turns, list[int]] = {}
            for generators, points in trials.items():
                for those, rest, lines in _fits(y, points, generators, most):
                    worst = np.abs(rest).max(axis=(1, 2))
                    misfit[those] = np.minimum(misfit[those], worst)
                    explained = worst < EXPLAINED
                    if explained.any() and _tells(lines):
                        n[those[explained]] = _smallest(y[those[explained]], lines, generators, turns)
                    for point, line in zip(those[~explained], strongest(rest[~explained]), strict=True):
                        found = sum_near(line, turns, y.shape[1]) or earlier.get((point, generators))
                        earlier[point, generators] = found
                        if found is not None and found not in generators:
                            following.setdefault((*generators, found), []).append(point)
            trials = {g: np.array(p) for g, p in following.items()}
    return n, misfit


def _fits(y: Array, points: Integers, generators: Turns, most: int) -> Iterator[tuple[Integers, Array, Lines]]:
    """Points whose lines decay alike, what no sum of ``most`` lines explains of them, and those lines."""
    if points.size == 0:
        return
    alike = Lines(*sums_of(generators, (1.0,) * len(generators), most // 2), y.shape[1])
    weights = alike.weights(alike.fitted(y[points])[1])
    for each in np.unique(weights, axis=0):
        those = points[(weights == each).all(axis=1)]
        lines = Lines(*sums_of(generators, tuple(each), most), y.shape[1])
        yield those, lines.fitted(y[those])[0], lines


def _tells(lines: Lines) -> bool:
    """Whether parts of T that are not among the lines would be left: where lines lie too close they explain anything."""
    parts = np.array([j / n for n in range(2, MOST + 1) for j in range(1, n) if gcd(j, n) == 1])
    among = np.abs(np.minimum(parts, 1 - parts)[:, None] - lines.frequency).min(axis=1) < 1e-12
    return among.all() or bool(np.quantile(lines.unexplained(parts[~among]), 0.25) > LEFT)


def _smallest(y: Array, lines: Lines, generators: Turns, turns: Turns) -> Integers:
    """Smallest n whose lines alone explain points that all lines together explain."""
    folds = np.ones(len(lines.sums), np.int64)
    for generator, multiple in zip(generators[len(turns) :], lines.sums.T[len(turns) :], strict=True):
        n_of_it = fold(generator, turns)
        folds = np.lcm(folds, n_of_it // np.gcd(n_of_it, multiple))
    n = np.full(len(y), lcm(*folds.tolist()))
    for fewer in range(n.max(initial=1) - 1, 0, -1) if len(y) else ():
        if lcm(*folds.tolist()) % fewer == 0:
            n[np.abs(_left(y, lines, fewer % folds == 0)).max(axis=(1, 2)) < EXPLAINED] = fewer
    if (n > 1).any():
        rest = _left(y, lines, folds == 1)
        first, last = (np.sqrt((half**2).mean(axis=(1, 2))) for half in np.array_split(rest, 2, axis=1))
        n[(n > 1) & (np.minimum(first, last) < LASTS * np.maximum(first, last))] = 0
    return n


def _left(y: Array, lines: Lines, some: NDArray[np.bool_]) -> Array:
    """What some of the lines leave of points."""
    return np.asarray(Lines(lines.sums[some], lines.frequency[some], y.shape[1]).fitted(y)[0])
