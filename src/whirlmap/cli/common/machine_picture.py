"""Picture of a machine from parts, as ``whirlmap show --out`` writes it."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from whirlmap.analysis.linear.truncation import machine_of
from whirlmap.cli.common.outputs import Looks
from whirlmap.errors import InputError
from whirlmap.results.files import check_writable

if TYPE_CHECKING:
    from whirlmap.integrate.system import System

PICTURES = (".png", ".svg", ".pdf")


def refuse_picture(system: "System", out: Path, *, force: bool) -> None:
    """Refuse a case without parts, another kind of file, and a place that cannot be written."""
    if machine_of(system) is None:
        raise InputError(f"--out: {system.case} is not described by parts, and there is nothing to draw; expected a"
                         " case with"
                         ' model = "machine", such as machines/two-shaft-gearbox')  # fmt: skip
    if out.suffix.lower() not in PICTURES:
        raise InputError(f"--out: found {out}, expected a picture: {', '.join(PICTURES)}")
    check_writable(out, force=force)


def draw(facts: dict[str, Any], out: Path, looks: Looks, *, force: bool) -> Path:
    """Draw what ``show`` says of a machine's parts."""
    from whirlmap.plot.common.save import save
    from whirlmap.plot.figures.machine import machine_figure

    check_writable(out, force=force)
    title = str(facts["case"]) if looks.title is None else looks.title
    figure = looks.figure(lambda: machine_figure(facts["parts"], title=title))
    return save(figure, out, dpi=looks.dpi)
