"""Animation of an orbit: a short GIF that repeats."""

import os
from itertools import pairwise
from pathlib import Path
from textwrap import fill

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.animation import PillowWriter
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.patches import Circle

from whirlmap.errors import OutputError, RangeError
from whirlmap.plot.common.labels import axis_label, with_breaks
from whirlmap.plot.common.limits import limits
from whirlmap.plot.common.style import BLUE, GREY, INK, SCREEN_DPI, VERMILION, new_figure, set_by_user, styled, text_size
from whirlmap.plot.panels.orbit import equal_limits
from whirlmap.plot.panels.phase_portrait import at_turns
from whirlmap.plot.panels.time_series import how_ended, last_turns, values_of
from whirlmap.results.files import replace_file

#: Length of the film [s], and pictures in a second.
SECONDS, RATE = 2.0, 25
#: Pieces of the trail, each paler than the one before it, and how many T it is long at least.
PIECES, TRAIL = 24, 0.5


@styled
def animate_orbit(
    ds: xr.Dataset,
    path: str | os.PathLike[str],
    x: str,
    y: str,
    *,
    clearance: float | None = None,
    plane: bool = False,
    marks: bool = True,
    turns: float = 4.0,
    title: str = "",
    size: tuple[float, float] | None = None,
    dpi: float | None = None,
    force: bool = False,
) -> Path:
    """Write the last ``turns`` T of a motion as a film of two seconds (GIF): a point with its trail, and a mark once per T.

    Reads ``x(time, state)``, ``turn``, ``status`` and ``end_time`` of `whirlmap.simulate`. The axes are fixed, the
    whole path is seen behind.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.simulate`, one operating point.
    path : path
        Ends in ``.gif``; its folder exists.
    x, y : str
        States along the axes.
    clearance : float, optional
        Radius of the clearance circle, for a journal relative to its bearing.
    plane : bool
        Whether both states are displacements in one plane, drawn to the same scale; so it is with a clearance.
    marks : bool
        Whether the states at whole T, which stay marked, mean something: not for a motion without forcing.
    turns : float
        T at the end of the record that are shown.
    title : str
        Over the axes; nothing where empty.
    size, dpi : optional
        Inches and dots per inch; 4.2 x 4.4 and 110 where absent.
    force : bool
        Replace what is there.

    Returns
    -------
    Path
        Of the file that was written.

    Raises
    ------
    OutputError
        Another suffix, or a place that cannot be written.
    RangeError
        Where the motion has fewer than two points.
    """
    target = Path(path)
    if target.suffix.lower() != ".gif":
        raise OutputError(f"{target}: an animation ends in .gif, not {target.suffix or 'nothing'!r}")
    alive = ds.isel(time=np.flatnonzero(np.isfinite(ds["x"].values).all(axis=1)))
    if alive.sizes["time"] < 2:
        raise RangeError(f"nothing to animate: {how_ended(ds) or 'no numbers'}")
    shown = last_turns(alive, turns)
    trail = max(TRAIL, (shown["turn"].values[-1] - shown["turn"].values[0]) / 12)
    figure = new_figure(4.2, 4.4)
    if size:
        figure.set_size_inches(size)
    ax = figure.add_subplot()
    _still(ax, ds, shown, x, y, clearance, plane=plane or clearance is not None)
    figure.suptitle(fill(title, 52) if title else "")
    moving = _Moving(ax, last_turns(alive, turns + trail), x, y, trail, marks=marks)
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # the axes are fixed from here on
    writer = PillowWriter(fps=RATE, metadata={"comment": "whirlmap"})
    dots = float(dpi or set_by_user("savefig.dpi") or SCREEN_DPI)

    def film(trial: Path) -> None:
        with mpl.rc_context({"savefig.bbox": None}), writer.saving(figure, str(trial), dots):
            for now in np.linspace(shown["turn"].values[0], shown["turn"].values[-1], int(SECONDS * RATE) + 1)[1:]:
                moving.to(float(now))
                writer.grab_frame()

    return replace_file(target, film, force=force)


def _still(ax: Axes, ds: xr.Dataset, part: xr.Dataset, x: str, y: str, clearance: float | None, *, plane: bool) -> None:
    """Draw what does not move: the whole path, the circle, the axes."""
    u, v = values_of(part, x), values_of(part, y)
    largest = float(np.abs(part["x"].values).max())
    ax.plot(with_breaks(part, x, u), with_breaks(part, y, v), color=GREY, lw=0.5, alpha=0.6, zorder=1)
    if plane:
        ax.set_aspect("equal", adjustable="box")
    if clearance:
        ax.add_patch(Circle((0, 0), clearance, fill=False, ec="#555555", lw=1.1, zorder=1.5))
    if clearance and max(np.ptp(u), np.ptp(v)) >= 0.5 * clearance:
        ax.set(xlim=(-1.08 * clearance, 1.08 * clearance), ylim=(-1.08 * clearance, 1.08 * clearance))
    elif plane:
        equal_limits(ax, u, v, largest)
    else:
        ax.set(xlim=limits(u, others=largest), ylim=limits(v, others=largest))
    ax.locator_params(nbins=5)
    ax.set(xlabel=axis_label(ds, x), ylabel=axis_label(ds, y))


class _Moving:
    """The point, its trail, the marks that it has left, and the time."""

    def __init__(self, ax: Axes, part: xr.Dataset, x: str, y: str, trail: float, *, marks: bool) -> None:
        self.turn, self.trail = part["turn"].values, trail
        self.path = with_breaks(part, x, values_of(part, x)), with_breaks(part, y, values_of(part, y))
        self.marks = at_turns(part, x, y)
        first = np.ceil(self.turn[0] - 1e-6) if marks else np.inf
        self.marked = first + np.arange(self.marks[0].size)
        pale = np.linspace(0.85, 0, PIECES)[:, None]  # mixed, not transparent: pieces overlap at their ends
        colours = pale * to_rgb(ax.get_facecolor()) + (1 - pale) * to_rgb(BLUE)
        self.line = LineCollection([], colors=colours, linewidths=1.6, capstyle="round", zorder=2)
        ax.add_collection(self.line, autolim=False)
        (self.left,) = ax.plot([], [], ls="", marker="o", ms=4, mew=0, color=VERMILION, zorder=3)
        (self.point,) = ax.plot([], [], ls="", marker="o", ms=6, mec="white", mew=0.8, color=INK, zorder=4)
        self.words = ax.text(0.985, 0.985, "", transform=ax.transAxes, ha="right", va="top", size=text_size(7.5))

    def to(self, now: float) -> None:
        """Move on to a time, in T."""
        edges = np.linspace(now - self.trail, now, PIECES + 1)
        self.line.set_segments([self._between(a, b) for a, b in pairwise(edges)])
        self.point.set_data(*self._between(now, now)[:1].T)
        old = self.marked <= now + 1e-9
        self.left.set_data(self.marks[0][old], self.marks[1][old])
        self.words.set_text(f"$t$ = {now:.1f} $T$")

    def _between(self, begin: float, end: float) -> np.ndarray:
        """Points of the path from one time to another, both ends included."""
        inside = (self.turn > begin) & (self.turn < end)
        turn = np.concatenate([[begin], self.turn[inside], [end]])
        return np.stack([np.interp(turn, self.turn, values) for values in self.path], axis=1)
