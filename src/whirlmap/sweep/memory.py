"""Whether a result fits into the memory of this machine: asked before it is computed."""

import os

from whirlmap.errors import RangeError


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
