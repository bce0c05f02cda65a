"""Options and help of ``whirlmap cache``."""

from typing import Annotated

import typer

from whirlmap.cli.common import options

EXAMPLES = (
    "whirlmap cache",
    "whirlmap cache --clear",
    "WHIRLMAP_CACHE=/tmp/kernels whirlmap cache",
    "WHIRLMAP_ROOTS=divisions whirlmap cache",
)


def cache(
    clear: Annotated[bool, typer.Option("--clear", help="Delete all that is kept.")] = False,
    json: options.Json = False,
) -> None:
    """Show the folder of compiled kernels, its size and what kernels are compiled for, or clear it.

    A model is lowered and compiled the first time that it is run, which takes some seconds to a minute; the
    expressions and the machine code are kept in this folder. The variable WHIRLMAP_CACHE chooses another one.
    Clearing is always safe.

    Kernels compute roots and reciprocals by the processor's estimates or by divisions, whichever was measured to be faster
    on its model. WHIRLMAP_ROOTS=estimates or divisions overrides that; results differ by rounding. WHIRLMAP_CPU=x86-64-v3
    compiles for a common processor.
    """
