"""Orbits of a journal in its clearance, or of any other centre, marked at every turn of a shaft."""

from fractions import Fraction
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from whirlmap.plot.common.labels import axis_label
from whirlmap.plot.common.limits import limits, markersize
from whirlmap.plot.common.style import BLUE, GREY, VERMILION, axes_or_new, styled, text_size, write_reason
from whirlmap.plot.panels.phase_portrait import at_turns, line_style
from whirlmap.plot.panels.time_series import how_ended, last_turns, values_of


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
    ds : xr.Dataset
        Of `whirlmap.simulate`, one operating point.
    x, y : str
        States that are the horizontal and the vertical displacement.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.
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

    Returns
    -------
    Axes
        Those that were drawn into; ``.figure`` is the figure.

    Raises
    ------
    RangeError
        A state that the Dataset does not hold.
    """
    ax = axes_or_new(ax, 3.4, 3.4)
    ended = how_ended(ds)
    part = last_turns(ds, turns)
    u, v = values_of(part, x), values_of(part, y)
    alive = np.isfinite(u) & np.isfinite(v)
    if not alive.any():
        return write_reason(ax, f"nothing recorded:\n{ended or 'no numbers'}")
    ax.set_aspect("equal", adjustable="box")
    if clearance:
        ax.add_patch(Circle((0, 0), clearance, fill=False, ec="#555555", lw=1.1, gid="clearance", zorder=1.5))
        ax.plot(0, 0, marker="+", ms=6, color=GREY, mew=0.8, ls="", zorder=0.8)
    marks = np.stack(at_turns(part, x, y, float(order)))
    _path(ax, u, v, marks)
    if ended:
        last = np.flatnonzero(alive)[-1]
        ax.plot(
            u[last],
            v[last],
            ls="",
            marker="X",
            ms=7,
            color="black",
            mec="white",
            mew=0.6,
            gid="ended",
            zorder=4,
        )
    if clearance and not zoom:
        ax.set(xlim=(-1.08 * clearance, 1.08 * clearance), ylim=(-1.08 * clearance, 1.08 * clearance))
        if not ended and max(np.ptp(u), np.ptp(v)) < 0.5 * clearance:
            _inset(ax, u, v, marks, clearance)
    else:
        equal_limits(ax, u, v, float(np.nanmax(np.abs(part["x"].values))))
    ax.set_xlabel(axis_label(ds, x))
    ax.set_ylabel(axis_label(ds, y))
    ax.set_title(ended or f"orbit, marked once per turn{' of the ' + shaft if shaft else ''}")
    return ax


def _path(ax: Axes, u: np.ndarray, v: np.ndarray, marks: np.ndarray) -> None:
    """Draw the orbit and its marks; the first mark is ringed."""
    ax.plot(u, v, color=BLUE, gid="orbit", **line_style(u.size))  # type: ignore[arg-type]
    alive = np.isfinite(u) & np.isfinite(v)
    seen = float(np.ptp(u[alive])), float(np.ptp(v[alive]))
    size = markersize(marks[0], marks[1], seen, most=3.5, least=1.2)
    ax.plot(*marks, ls="", marker="o", ms=size, mew=0, color=VERMILION, gid="marks", zorder=3)
    ring: dict[str, Any] = {"ms": size + 2.5, "mfc": "none", "mec": VERMILION, "mew": 0.8}
    ax.plot(*marks[:, :1], ls="", marker="o", zorder=3, **ring)


def _inset(ax: Axes, u: np.ndarray, v: np.ndarray, marks: np.ndarray, clearance: float) -> None:
    """Show a small orbit a second time, enlarged, in the half of the clearance that it leaves free."""
    left = 0.16 if np.mean(v) > 0 or np.mean(u) > 0 else 0.44
    bottom = 0.52 if np.mean(v) <= 0 else 0.08
    inset = ax.inset_axes((left, bottom, 0.4, 0.4), gid="inset")
    _path(inset, u, v, marks)
    equal_limits(inset, u, v, clearance)
    inset.set_aspect("equal", adjustable="box")
    for spine in inset.spines.values():
        spine.set(visible=True, color=GREY)
    inset.set_xticks([])
    inset.set_yticks([])
    inset.text(
        0.5,
        0.03,
        f"width {np.diff(inset.get_xlim())[0]:.2g}",
        transform=inset.transAxes,
        ha="center",
        fontsize=text_size(6.5),
    )
    ax.indicate_inset_zoom(inset, edgecolor="#777777", lw=0.6)


def equal_limits(ax: Axes, u: np.ndarray, v: np.ndarray, others: float) -> None:
    """Give both axes the same length, so that the plane is not stretched."""
    (a, b), (c, d) = limits(u, others=others), limits(v, others=others)
    half = max(b - a, d - c) / 2
    ax.set(xlim=((a + b) / 2 - half, (a + b) / 2 + half), ylim=((c + d) / 2 - half, (c + d) / 2 + half))
