"""Options that commands share."""

from collections.abc import Callable
from inspect import Parameter, signature
from pathlib import Path
from typing import Annotated, Any

import typer

from whirlmap.options.computed import Integration, Labelling, Settling
from whirlmap.options.execution import Execution

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
        help="Longest transient of a point, in common periods. A point whose motion returns earlier stops there.",
        rich_help_panel=COMPUTING,
    ),
]  # fmt: skip
_LYAPUNOV = (
    "Longest run, in T, for the largest Lyapunov exponent of a point that does not return: it tells quasi-periodic from"
    " chaotic. A point stops when its label is decided. Without this option the run is as long as labels may need. "
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
Keep = Annotated[
    int,
    typer.Option(
        "--keep", metavar="N", rich_help_panel=COMPUTING,
        help="Section points kept of each point, once per T; at least two common periods are.",
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


#: Options that are parts of values: of `Settling`, of `Integration`, and the others.
SETTLING = {"transient": Transient, "keep": Keep, "most": Most, "tolerance": Tolerance}
INTEGRATION = {"steps": Steps, "accuracy": Accuracy, "method": Method}
OTHERS = {"lyapunov": Lyapunov, "workers": Workers}
#: Those of commands that label points.
LABELS = ("transient", "most", "tolerance", "lyapunov", *INTEGRATION, "workers")


def computing(*names: str, **different: Any) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a declared command these options, whose defaults are those of Python.

    They stand in the place of its ``labelling`` or ``integration`` and ``execution``, as which the function that does what
    the command says gets them: ``whole`` makes these of them. ``different`` are declarations that replace the usual ones.
    """
    declared = SETTLING | INTEGRATION | OTHERS | different

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        own = signature(command)
        values = [name for name in own.parameters if name in ("labelling", "integration", "execution")]
        defaults, kind = {name: getattr(Settling, name, None) for name in names}, Parameter.POSITIONAL_OR_KEYWORD
        flat = [Parameter(name, kind, default=defaults[name], annotation=declared[name]) for name in names]
        kept = list(own.parameters.values())
        place = list(own.parameters).index(values[0])
        shown = [*kept[:place], *flat, *(p for p in kept[place:] if p.name not in values)]

        def whole(**given: Any) -> dict[str, Any]:
            parts = {name: given.pop(name) for name in names}
            integration = Integration(**{name: parts[name] for name in INTEGRATION if name in parts})
            settling = Settling(**{name: parts[name] for name in SETTLING if name in parts})
            made = {
                "labelling": Labelling(settling, parts.get("lyapunov"), integration), "integration": integration,
                "execution": Execution(parts["workers"]),
            }  # fmt: skip
            return given | {name: made[name] for name in values}

        changed: Any = command
        changed.__signature__ = own.replace(parameters=shown)
        changed.__annotations__ = {p.name: p.annotation for p in shown}
        changed.whole = whole
        return command

    return decorate
