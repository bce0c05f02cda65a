"""Options that commands share, and how their text is read."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from whirlmap.errors import CaseError, InputError, RangeError

if TYPE_CHECKING:
    from whirlmap.integrate.system import System

SYSTEM, COMPUTING, OUTPUT = "System", "Computing", "Output"

CaseName = Annotated[
    str,
    typer.Argument(
        metavar="CASE",
        help="Name of a stock case (listed by `whirlmap cases`), or the path of a case file, my.toml.",
    ),
]
Changes = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="NAME=VALUE",
        help='Change a symbol, a dimensional input with its unit ("speed=1500 rpm") or a switch'
        " (arc=positive). May be repeated. `whirlmap show CASE` lists the names.",
        rich_help_panel=SYSTEM,
    ),
]
Start = Annotated[
    list[str] | None,
    typer.Option(
        "--start",
        metavar="STATE=VALUE",
        help="Start value of a state, of a case with dimensions also with a unit ('y=-150 um'). May be repeated.",
        rich_help_panel=SYSTEM,
    ),
]
Out = Annotated[
    Path | None,
    typer.Option(
        "--out",
        metavar="PLACE",
        help="Where to write: NAME.nc the data, NAME.png, .svg or .pdf the picture, a folder's name both."
        " Without it no file is written.",
        rich_help_panel=OUTPUT,
    ),
]
Force = Annotated[bool, typer.Option("--force", help="Replace what --out names.", rich_help_panel=OUTPUT)]
Size = Annotated[
    str | None,
    typer.Option(
        "--size", metavar="WxH", rich_help_panel=OUTPUT,
        help="Width and height of the picture, in inches (7x4.5) or with a unit (180x120mm).",
    ),
]  # fmt: skip
Dpi = Annotated[
    int | None,
    typer.Option(
        "--dpi", metavar="N", min=20, max=2400, rich_help_panel=OUTPUT,
        help="Dots per inch of the picture; 200 where absent, 110 of an animation.",
    ),
]  # fmt: skip
Title = Annotated[
    str | None, typer.Option("--title", metavar="TEXT", help="Title of the picture.", rich_help_panel=OUTPUT)
]
Json = Annotated[
    bool,
    typer.Option("--json", help="Print one JSON object, and nothing else, to stdout.", rich_help_panel=OUTPUT),
]
Dimensionless = Annotated[
    bool,
    typer.Option(
        "--dimensionless",
        help="Show numbers in the model's own units (clearances, radians of the clock), not in um, mm/s, N, rpm, Hz and s,"
        " where the case has dimensions.",
        rich_help_panel=OUTPUT,
    ),
]
Quiet = Annotated[bool, typer.Option("--quiet", help="Show no progress.", rich_help_panel=OUTPUT)]
Workers = Annotated[
    int | None,
    typer.Option(
        "--workers", metavar="N", min=1, max=4096, rich_help_panel=COMPUTING,
        help="Threads; all cores where absent. The numbers do not depend on it.",
    ),
]  # fmt: skip
Steps = Annotated[
    int | None,
    typer.Option(
        "--steps",
        metavar="N",
        help="Integration steps per period T, instead of those that the accuracy asks for.",
        rich_help_panel=COMPUTING,
    ),
]
Accuracy = Annotated[
    float | None,
    typer.Option(
        "--accuracy",
        metavar="X",
        help="Largest error over one common period (unforced models: one typical time) that the steps per T are chosen"
        " for; 1e-6 (1e-9) where absent.",
        rich_help_panel=COMPUTING,
    ),
]
Method = Annotated[
    str | None,
    typer.Option(
        "--method",
        metavar="NAME",
        help="Integration method: dop853, tsit5 or rk4; dop853 where absent.",
        rich_help_panel=COMPUTING,
    ),
]
Transient = Annotated[
    int,
    typer.Option(
        "--transient", metavar="N",
        help="Common periods of the transient of a point that does not return; a point that returns stops earlier.",
        rich_help_panel=COMPUTING,
    ),
]  # fmt: skip
_LYAPUNOV = (
    "T over which points that do not return run with a tangent vector, which gives their largest Lyapunov exponent"
    " and tells quasi-periodic from chaotic, at most: each stops when its label is decided. Where absent: as"
    " long as labels may need. "
)
Lyapunov = Annotated[
    int | None,
    typer.Option(
        "--lyapunov", metavar="N",
        help=_LYAPUNOV + "0: not measured, and undecided; fewer than 256 leave them undecided.",
        rich_help_panel=COMPUTING, show_default=False,
    ),
]  # fmt: skip
MeasuredLyapunov = Annotated[
    int | None,
    typer.Option(
        "--lyapunov", metavar="N", help=_LYAPUNOV + "256 or more.", rich_help_panel=COMPUTING, show_default=False,
    ),
]  # fmt: skip
Most = Annotated[
    int,
    typer.Option(
        "--most",
        metavar="N",
        help="Longest return that is sought, in common periods.",
        rich_help_panel=COMPUTING,
    ),
]
Tolerance = Annotated[
    float,
    typer.Option(
        "--tolerance",
        metavar="X",
        help="Largest difference that counts as a return, relative to the range of each state.",
        rich_help_panel=COMPUTING,
    ),
]


#: What the text of an option looks like, where it is not that of --set.
EXAMPLES = {
    "--start": "--start x=0.5", "--box": "--box x=-2:2", "--input-tolerance": "--input-tolerance c=5%",
    "--threshold": "--threshold s=0.5:4", "--draw": "--draw xi_m=normal:0.1:0.01",
}  # fmt: skip


def assignments(texts: Sequence[str] | None, option: str) -> dict[str, str]:
    """Read ``name=value`` texts of a repeatable option.

    Raises
    ------
    InputError
        Where a text has another form, or a name is given two different values.
    """
    example = EXAMPLES.get(option, '--set gamma=0.3, --set "speed=1500 rpm"')
    found: dict[str, str] = {}
    for text in texts or ():
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise InputError(f"{option}: found {text!r}, expected name=value, as in {example}")
        if found.setdefault(name, value) != value:
            raise InputError(f"{option}: {name} is given twice: found {found[name]!r} and {value!r}, expected one of them")
    return found


def brackets(texts: Sequence[str] | None, option: str) -> dict[str, tuple[float, float]]:
    """Read ``name=low:high`` texts of a repeatable option.

    Raises
    ------
    InputError
        Where a text has another form, or a name is given two different values.
    RangeError
        Where a low end is not below its high end.
    """
    found = {}
    for name, text in assignments(texts, option).items():
        try:
            low, high = (float(part) for part in text.split(":"))
        except ValueError:
            raise InputError(f"{option}: found {name}={text}, expected name=low:high, as in {EXAMPLES[option]}") from None
        if not low < high:
            raise RangeError(f"{option}: found {name}={text}, but ranges ascend: swap the ends")
        found[name] = (low, high)
    return found


def _in_states(system: "System", begin: dict[str, str]) -> dict[str, float | str]:
    """Start values in the model's own numbers; what is no number with a unit stays text, for who says what is wrong."""
    from whirlmap.cli.common.ranges import in_state
    from whirlmap.units import split

    made: dict[str, float | str] = dict(begin)
    for name, text in begin.items():
        try:
            number, unit = split(text)
        except CaseError:
            continue
        value = in_state(system, name, float(number), unit, "--start")
        made[name] = value if unit else text
    return made


def open_system(case: str, changes: Sequence[str] | None, start: Sequence[str] | None) -> "System":
    """Load a case with the changes and the start state of the command line; refuse an impossible start."""
    changed, begin = assignments(changes, "--set"), assignments(start, "--start")
    if "start" in changed:
        raise InputError("--set: found start, expected a symbol or a switch; start values are given with --start")
    from whirlmap.integrate.loading import load

    given: dict[str, Any] = dict(changed)
    system = load(case, start=_in_states(load(case, **given), begin) if begin else None, **given)
    if system.start:
        from whirlmap.sweep.attractors.start_states import refuse_start

        refuse_start(system)
    return system
