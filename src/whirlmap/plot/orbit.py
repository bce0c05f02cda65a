"""Orbits of a journal in its clearance, or of a rotor or housing centre, with a mark at every turn of a shaft."""

from fractions import Fraction

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from whirlmap.plot.labels import axis_label
from whirlmap.plot.limits import limits
from whirlmap.plot.phase_portrait import at_turns, line_style
from whirlmap.plot.style import BLUE, GREY, VERMILION, axes_or_new, styled, write_reason
from whirlmap.plot.time_series import how_ended, last_turns, values_of


@styled
def draw_orbit(
    ds: xr.Dataset,
    x: str,
    y: str,
    *,
    ax: Axes | None = None,
    clearance: float | None = None,
    zoom: bool = False,
    order: Fraction | float = 1,
    shaft: str = "",
    turns: float | None = None,
) -> Axes:
    """Orbit of a centre in its own plane, both axes to the same scale.

    Reads ``x(time, state)``, ``turn``, ``status`` and ``end_time``.

    Parameters
    ----------
    x, y : str
        States that are the horizontal and the vertical displacement.
    clearance : float, optional
        Radius of the clearance circle, for a journal relative to its bearing: 1 where lengths are over c.
    zoom : bool
        Show the orbit large instead of the whole clearance circle.
    order : Fraction or float
        Turns of the shaft in one T: 1/4 for the paper's pinion. Every turn gets a mark; the first is hollow.
    shaft : str
        Its name, for the legend.
    turns : float, optional
        Show the last so many T only.
    """
    ax = axes_or_new(ax, 3.4, 3.4)
    ended = how_ended(ds)
    part = last_turns(ds, turns)
    u, v = values_of(part, x), values_of(part, y)
    alive = np.isfinite(u) & np.isfinite(v)
    ax.set_aspect("equal", adjustable="box" if clearance and not zoom else "datalim")
    if not alive.any():
        return write_reason(ax, f"nothing recorded:\n{ended or 'no numbers'}")
    if clearance:
        ax.add_patch(Circle((0, 0), clearance, fill=False, ec="#555555", lw=1.1, gid="clearance", zorder=1.5))
        ax.plot(0, 0, marker="+", ms=6, color=GREY, mew=0.8, ls="", zorder=0.8)
    ax.plot(u, v, color=BLUE, gid="orbit", **line_style(alive.sum()))  # type: ignore[arg-type]
    marks = at_turns(part, float(order))
    size = float(np.clip(24.0 / np.sqrt(max(marks.size, 1)), 1.2, 4.0))
    label = f"once per turn{' of the ' + shaft if shaft else ''}"
    ax.plot(u[marks], v[marks], ls="", marker="o", ms=size, mew=0, color=VERMILION, label=label, gid="marks", zorder=3)
    if marks.size:
        ax.plot(u[marks[0]], v[marks[0]], ls="", marker="o", ms=size + 2, mfc="none", mec=VERMILION, mew=0.8, zorder=3)
    if ended:
        last = np.flatnonzero(alive)[-1]
        ax.plot(u[last], v[last], ls="", marker="X", ms=7, color="black", mec="white", mew=0.6, gid="ended", zorder=4)
    if clearance and not zoom:
        ax.set(xlim=(-1.08 * clearance, 1.08 * clearance), ylim=(-1.08 * clearance, 1.08 * clearance))
    else:
        _equal_limits(ax, u, v, float(np.nanmax(np.abs(part["x"].values))))
    ax.set_xlabel(axis_label(ds, x))
    ax.set_ylabel(axis_label(ds, y))
    ax.set_title(ended or "orbit" + (", clearance circle" if clearance else ""))
    ax.legend(loc="lower right" if clearance else "upper right", handletextpad=0.1, borderaxespad=0.2)
    return ax


def _equal_limits(ax: Axes, u: np.ndarray, v: np.ndarray, others: float) -> None:
    """Give both axes the same length, so that the plane is not stretched."""
    (a, b), (c, d) = limits(u, others=others), limits(v, others=others)
    half = max(b - a, d - c) / 2
    ax.set(xlim=((a + b) / 2 - half, (a + b) / 2 + half), ylim=((c + d) / 2 - half, (c + d) / 2 + half))
