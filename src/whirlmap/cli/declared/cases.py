"""Options and help of ``whirlmap cases``."""

from whirlmap.cli.common import options

EXAMPLES = (
    "whirlmap cases",
    "whirlmap cases --json",
)


def cases(json: options.Json = False) -> None:
    """List the stock cases: named sets of parameters, each number with its source.

    Every other command takes one of these names, or the path of a case file of your own. `whirlmap show CASE`
    prints all that is in a case.
    """
