"""The style of all figures: sizes, fonts, colours, and the colour and marker of each regime.

Nothing here touches matplotlib's global settings for longer than a call: drawing functions carry `styled`,
which sets `house` around them: the settings of `HOUSE` that the user has left at matplotlib's own values. The colours
are those of Okabe and Ito, told apart with any colour vision; a regime also has a marker, and an ended run a hatch, so
that a print in grey can be read.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from io import BytesIO
from textwrap import fill
from typing import Any, ParamSpec, TypeVar

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from whirlmap.results.regime import Regime
from whirlmap.results.status import Status

P = ParamSpec("P")
R = TypeVar("R")

BLUE, VERMILION, GREEN, ORANGE = "#0072B2", "#D55E00", "#009E73", "#E69F00"
SKY, PURPLE, INDIGO, INK, GREY, PALE = "#56B4E9", "#CC79A7", "#332288", "#1A1A1A", "#B8B8B8", "#E9E9E9"

#: Ground behind values at which sweeps in both directions differ.
HYSTERESIS = "#FBF0D2"

#: Mean width of a letter over the size of the font, and share of a panel's width that a sentence in it may take.
LETTER, ROOM = 0.53, 0.92

#: Dots per inch of a picture on a screen.
SCREEN_DPI = 110

#: Width of a figure over both columns of a page, and over one [inch].
WIDE, NARROW = 7.2, 4.2

HOUSE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 8.0,
    "mathtext.fontset": "dejavusans",
    "axes.titlesize": 8.5,
    "axes.titlelocation": "left",
    "axes.titlepad": 5.0,
    "axes.labelsize": 8.5,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "axes.axisbelow": True,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "lines.linewidth": 0.9,
    "hatch.linewidth": 0.6,
    "figure.titlesize": 9.5,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "path.simplify": True,
}


#: Settings of `HOUSE` that grow with a font size that the user has set.
SIZES = frozenset(name for name in HOUSE if name.endswith(("labelsize", "titlesize", "fontsize")))


def house() -> dict[Any, Any]:
    """Settings of `HOUSE` where matplotlib's have their default: what the user has set (rcParams, a style, a file) stays."""
    return {
        name: text_size(value) if name in SIZES else value
        for name, value in HOUSE.items()
        if mpl.rcParams[name] == mpl.rcParamsDefault[name]
    }


def text_size(size: float) -> float:
    """Size of a text [pt] that is ``size`` with the font of `HOUSE`, and follows a font size that the user has set."""
    font = float(mpl.rcParams["font.size"])
    return size if font == mpl.rcParamsDefault["font.size"] else size * font / float(HOUSE["font.size"])


@dataclass(frozen=True)
class Look:
    """How one kind of operating point is drawn: face colour, marker, hatch, and its word in legends."""

    label: str
    colour: str
    marker: str
    hatch: str = ""
    text: str = "white"


#: How each regime is drawn, everywhere.
REGIMES: dict[Regime, Look] = {
    Regime.undecided: Look("undecided", GREY, "d", text=INK),
    Regime.periodic: Look("periodic", BLUE, "o"),
    Regime.quasi_periodic: Look("quasi-periodic", GREEN, "s"),
    Regime.chaotic: Look("chaotic", VERMILION, "^"),
    Regime.contact: Look("contact", "#FFFFFF", "X", "//////", INK),
    Regime.diverged: Look("diverged", "#F3DCE8", "P", "\\\\\\\\", INK),
    Regime.at_rest: Look("at rest", PALE, "h", text=INK),
    Regime.drifting: Look("drifting", ORANGE, ">", "....", INK),
    Regime.growing: Look("growing", PURPLE, "*", "++++", INK),
    Regime.locked: Look("locked", "#5B9BD5", "D"),
    Regime.not_settled: Look("not settled", SKY, "p", "----", INK),
    Regime.not_steady: Look("not steady", ORANGE, "v", text=INK),
}

#: How points are drawn whose run did not come to a regime at all.
UNFINISHED: dict[Status, Look] = {
    Status.unresolved: Look("unresolved", "#FFFFFF", ".", "......", INK),
    Status.failed: Look("not computed", "#FFFFFF", "_", "------", INK),
}

#: Sweeps that carry the state along, by direction.
DIRECTIONS: dict[str, Look] = {
    "up": Look("speeding up", INDIGO, "^"),
    "down": Look("slowing down", ORANGE, "v"),
}


def look_of(regime: int, status: int = 0) -> Look:
    """How an operating point of this regime and status is drawn."""
    ended = Status(int(status))
    return UNFINISHED[ended] if ended in UNFINISHED else REGIMES[Regime(int(regime))]


def styled(function: Callable[P, R]) -> Callable[P, R]:
    """Run a drawing function in the house style, and leave matplotlib's settings as they were."""

    @wraps(function)
    def inside(*args: P.args, **kwargs: P.kwargs) -> R:
        with mpl.rc_context(house()):
            return function(*args, **kwargs)

    return inside


class Picture(Figure):
    """A figure that a notebook shows by itself, without pyplot."""

    def _repr_png_(self) -> bytes:
        buffer = BytesIO()
        with mpl.rc_context(house()):
            self.savefig(buffer, format="png", dpi=set_by_user("figure.dpi") or SCREEN_DPI)
        return buffer.getvalue()


class Panel(Axes):
    """The only Axes of a `Picture`, which a notebook shows as the picture."""

    def _repr_png_(self) -> bytes | None:
        figure = self.get_figure(root=True)
        return figure._repr_png_() if isinstance(figure, Picture) else None


def set_by_user(name: Any) -> Any:
    """A setting of matplotlib that is not its default; None where it is."""
    value = mpl.rcParams[name]
    return None if value == mpl.rcParamsDefault[name] else value


def new_figure(width: float = WIDE, height: float = 4.5) -> Picture:
    """Give an empty figure [inch] that lays out its panels so that no label is cut; the user's ``figure.figsize`` counts."""
    return Picture(figsize=set_by_user("figure.figsize") or (width, height), layout="constrained")


def axes_or_new(ax: Axes | None, width: float = NARROW, height: float = 3.2) -> Axes:
    """Return the given Axes, or those of a new figure."""
    return new_figure(width, height).add_subplot(axes_class=Panel) if ax is None else ax


def write_reason(ax: Axes, reason: str) -> Axes:
    """Turn a panel into the sentence that says why it is empty."""
    ax.set_xticks([])
    ax.set_yticks([])
    for spine in ax.spines.values():
        spine.set(visible=True, color=GREY, linestyle=(0, (4, 3)))
    wide = ax.get_position().width * ax.figure.get_figure(root=True).get_size_inches()[0] * 72  # points
    letters = max(int(ROOM * wide / (LETTER * float(mpl.rcParams["font.size"]))), 8)
    text = "\n".join(fill(line, min(letters, 38)) for line in reason.splitlines())
    written = ax.text(0.5, 0.5, text, transform=ax.transAxes, ha="center", va="center", color="#555555")
    written.set_in_layout(False)  # a long sentence must not squeeze the panel
    return ax
