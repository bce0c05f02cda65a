"""Subharmonics of sums of the forcing's frequencies: which one a spectral line is, and its order n."""

from fractions import Fraction
from functools import lru_cache
from itertools import product
from math import lcm
from operator import mul

import numpy as np

from whirlmap.analysis.labels.forced_lines import Array, Integers, Turns

#: Largest n that is tried.
MOST = 12
#: Turns of the slowest forcing, and of the slowest beat of two, that a record must hold.
TURNS = 2
#: A sum of orders lies at a line by chance less often than this.
CHANCE = 0.3
#: What is left of a line stands this many steps of frequency (1/N) from it, for the fitted lines beside it took a part.
SHARP = 0.5
#: Orders with denominators up to this are harmonics of a period that a record holds; sums of theirs count without limit.
SHORT = 128


def seen(line: Fraction, turns: Turns, times: int) -> bool:
    """Whether a record holds enough turns of an n-th part; parts of T itself are always seen."""
    n = fold(line, turns)
    return n == 1 or (line * n).denominator == 1 or times * min(turns) >= TURNS * n


@lru_cache(maxsize=16)
def _small_sums(turns: Turns) -> tuple[Integers, Array, Array]:
    most = 8 if len(turns) < 3 else 6 if len(turns) < 4 else 4
    p = np.array([q for q in product(range(-most, most + 1), repeat=len(turns)) if sum(map(abs, q)) <= most])
    p = p.reshape(-1, len(turns))
    size = np.abs(p).sum(axis=1)
    order = np.argsort(size, kind="stable")
    return p[order], p[order] @ np.array([float(t) for t in turns]), np.searchsorted(size[order], size[order], side="right")


def sum_near(line: float, turns: Turns, times: int) -> Fraction | None:
    """The least surprising n-th part of a sum of orders at a line."""
    p, value, rank = _small_sums(turns)
    best, found = CHANCE, None
    for n in range(1, MOST + 1):
        away = n * line - value
        chance = 2 * SHARP / times * rank * n * n
        fits = np.flatnonzero((np.abs(away - np.rint(away)) < n * SHARP / times) & (chance < best))
        if fits.size:
            i = fits[0]
            best = chance[i]
            found = (int(np.rint(away[i])) + sum(map(mul, p[i].tolist(), turns), Fraction(0))) / n % 1
    return found if found is not None and fold(found, turns) > 1 and seen(found, turns, times) else None


@lru_cache(maxsize=1024)
def fold(line: Fraction, turns: Turns) -> int:
    """Smallest n whose n-fold of a frequency is a sum of orders."""
    short = lcm(*(t.denominator for t in turns if t.denominator <= SHORT))
    long = [t for t in turns if t.denominator > SHORT]
    for n in range(1, MOST + 1):
        for m in product(range(-8, 9), repeat=len(long)):
            if (short * (n * line - sum((a * t for a, t in zip(m, long, strict=True)), Fraction(0)))).denominator == 1:
                return n
    return 0
