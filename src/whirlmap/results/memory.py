"""Limits on memory and on the number of points, checked before a result is computed."""

import os
from collections.abc import Iterable
from math import prod

from whirlmap.errors import RangeError

#: More points than this take years on any machine.
MOST_POINTS = 1_000_000_000


def refuse_points(counts: Iterable[int]) -> None:
    """Refuse work on too many points, from the counts of its axes alone: before anything of their size is made.

    Raises
    ------
    RangeError
        Naming the counts and their product.
    """
    counts = tuple(counts)
    if prod(counts) > MOST_POINTS:
        times = " x ".join(map(str, counts))
        found = f"{times} = {prod(counts):.3g}" if len(counts) > 1 else times
        raise RangeError(f"found {found} points, expected at most {MOST_POINTS:.0e}: ask for fewer")


def memory() -> int:
    """Bytes of memory of this machine."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):  # not a POSIX system
        return 16 * 2**30


def refuse_memory(what: str, numbers: int) -> None:
    """Refuse work whose result, so many 8-byte numbers, would not fit into half of the memory.

    Raises
    ------
    RangeError
        Saying what would be needed and what there is.
    """
    most = memory() // 2
    if 8 * numbers > most:
        raise RangeError(
            f"{what} would need {8 * numbers / 2**30:.3g} GB, expected at most {most / 2**30:.3g} GB, half"
            " of this machine's memory: ask for fewer points or periods, or save every so many steps"
        )
