"""Phase portraits: the orbit in the plane of two states, with its section points."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from whirlmap.plot.common.labels import axis_label, velocity_of, with_breaks
from whirlmap.plot.common.limits import limits, markersize
from whirlmap.plot.common.style import INK, REGIMES, SKY, VERMILION, axes_or_new, styled, write_reason
from whirlmap.plot.panels.time_series import how_ended, last_turns, values_of
from whirlmap.results.regime import Regime


def at_turns(ds: xr.Dataset, x: str, y: str, per_T: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Read two states at the whole turns of a shaft that makes ``per_T`` turns in one T.

    Turns between two samples are taken on the line between them, which is the line that is drawn.
    """
    alive = np.isfinite(ds["x"].values).all(axis=1)
    turn = ds["turn"].values[alive]
    counts = np.arange(np.ceil(turn[0] * per_T - 1e-6), np.floor(turn[-1] * per_T + 1e-6) + 1)
    wanted = counts / per_T
    nearest = np.rint(np.interp(wanted, turn, np.arange(turn.size))).astype(int)
    exact = np.abs(turn[nearest] - wanted) < 1e-6
    u, v = (
        np.where(exact, values[alive][nearest], np.interp(wanted, turn, values[alive]))
        for values in (values_of(ds, x), values_of(ds, y))
    )
    return u, v


def line_style(samples: int) -> dict[str, object]:
    """Width of an orbit's line: thin where it is long and covers itself."""
    return {"lw": 0.9 if samples < 4000 else 0.5 if samples < 20_000 else 0.3, "rasterized": samples > 20_000}


@styled
def draw_phase_portrait(
    ds: xr.Dataset,
    x: str,
    y: str | None = None,
    *,
    ax: Axes | None = None,
    turns: float | None = None,
    section: bool = True,
) -> Axes:
    """Orbit in the plane of two states, by default a coordinate and its velocity.

    Reads ``x(time, state)``, ``turn``, ``status`` and ``end_time``. Section points are the states at whole T
    of a forced model. The end of a run that ended early is marked.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.simulate`, one operating point.
    x, y : str
        States along the axes; the velocity of ``x`` where ``y`` is absent.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.
    turns : float, optional
        Show the last so many T only.
    section : bool
        Mark the states at whole T.

    Returns
    -------
    Axes
        Those that were drawn into; ``.figure`` is the figure.

    Raises
    ------
    RangeError
        A state that the Dataset does not hold.
    """
    ax = axes_or_new(ax, 3.4, 3.2)
    y = velocity_of(ds, x) if y is None else y
    ended = how_ended(ds)
    part = last_turns(ds, turns)
    u, v = values_of(part, x), values_of(part, y)
    alive = np.isfinite(u) & np.isfinite(v)
    if alive.sum() < 2:
        return write_reason(ax, f"nothing recorded:\n{ended or 'no numbers'}")
    path = with_breaks(ds, x, u), with_breaks(ds, y, v)
    ax.plot(*path, color=SKY, gid="orbit", **line_style(alive.sum()))  # type: ignore[arg-type]
    if section:
        at_u, at_v = at_turns(part, x, y)
        size = markersize(at_u, at_v, (float(np.ptp(u[alive])), float(np.ptp(v[alive]))), most=4.0)
        ax.plot(at_u, at_v, ls="", marker="o", ms=size, mew=0, color=INK, gid="section", zorder=3)
    if ended:
        last = np.flatnonzero(alive)[-1]
        marker = REGIMES[Regime.contact].marker
        ax.plot(
            u[last],
            v[last],
            ls="",
            marker=marker,
            ms=6,
            color=VERMILION,
            mec="white",
            mew=0.6,
            gid="ended",
            zorder=4,
        )
    largest = float(np.nanmax(np.abs(part["x"].values)))
    ax.set_xlim(limits(u, others=largest))
    ax.set_ylim(limits(v, others=largest))
    ax.set_xlabel(axis_label(ds, x))
    ax.set_ylabel(axis_label(ds, y))
    ax.set_title(ended or f"phase portrait, {_count(part)} $T$")
    return ax


def _count(ds: xr.Dataset) -> str:
    turn = ds["turn"].values
    return f"{np.ceil(turn[-1] - turn[0] - 1e-6):.0f}"
