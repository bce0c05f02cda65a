"""States and outputs against time."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from whirlmap.errors import RangeError
from whirlmap.plot.common.labels import symbol, unit_of, unit_text, with_breaks, within_period
from whirlmap.plot.common.limits import limits
from whirlmap.plot.common.style import (
    BLUE,
    GREEN,
    INK,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    axes_or_new,
    styled,
    write_reason,
)
from whirlmap.results.status import Status

COLOURS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, INK)


def values_of(ds: xr.Dataset, name: str) -> np.ndarray:
    """Series of one state or output of a simulation."""
    for variable, dim in (("x", "state"), ("outputs", "output")):
        if variable in ds and name in ds[dim].values:
            return within_period(ds, name, np.asarray(ds[variable].sel({dim: name}).values, dtype=float))
    known = [str(n) for dim in ("state", "output") if dim in ds for n in ds[dim].values]
    raise RangeError(f"the time series hold no {name!r}; they hold: {' '.join(known)}")


def how_ended(ds: xr.Dataset) -> str:
    """Sentence about a run that ended early: ``contact at time 12.3``; empty for one that did not."""
    status = Status(int(ds["status"]))
    if status == Status.ok:
        return ""
    time = float(ds["end_time"]) if "end_time" in ds else np.nan
    stop = str(ds.attrs.get("stop", status.name))
    unit = f" {words}" if (words := unit_of(ds, "end_time")) not in ("1", "time") else ""
    return f"{stop.replace('_', ' ')} at time {time:.6g}{unit}" if np.isfinite(time) else stop


def last_turns(ds: xr.Dataset, turns: float | None) -> xr.Dataset:
    """Keep the last so many T of what was recorded before the run ended; everything where None."""
    if turns is None:
        return ds
    alive = np.isfinite(ds["x"].values).all(axis=1)
    end = float(ds["turn"].values[alive][-1]) if alive.any() else float(ds["turn"].values[-1])
    return ds.isel(time=np.flatnonzero(ds["turn"].values >= end - turns - 1e-9))


@styled
def draw_time_series(
    ds: xr.Dataset,
    names: Sequence[str] | str,
    *,
    ax: Axes | None = None,
    turns: float | None = None,
    in_T: bool = True,
) -> Axes:
    """States or outputs of one operating point against time.

    Reads ``x(time, state)``, ``outputs(time, output)``, ``turn``, ``status`` and ``end_time``. A run that
    ended early is hatched from its end on, with the reason.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.simulate`, one operating point.
    names : str or sequence of str
        States or outputs.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.
    turns : float, optional
        Show the last so many T only.
    in_T : bool
        Time in periods T; else in the model's time.

    Returns
    -------
    Axes
        Those that were drawn into; ``.figure`` is the figure.

    Raises
    ------
    RangeError
        A name that is neither a state nor an output of the series.
    """
    ax = axes_or_new(ax, height=2.4)
    names = [names] if isinstance(names, str) else list(names)
    ended = how_ended(ds)
    if np.isfinite(ds["x"].values).all(axis=1).sum() < 2:
        return write_reason(ax, f"nothing recorded:\n{ended or 'no numbers'}")
    # What lies beyond an event stays, so that the hatched end is seen.
    part = ds if ended else last_turns(ds, turns)
    clock = part["turn"] if in_T else part["time"]
    curves = [values_of(part, name) for name in names]
    for name, curve, colour in zip(names, curves, COLOURS * (len(names) // len(COLOURS) + 1), strict=False):
        ax.plot(
            clock.values, with_breaks(part, name, curve), color=colour, label=symbol(name, ds),
            rasterized=curve.size > 20_000,
        )  # fmt: skip
    if ended:
        alive = np.isfinite(part["x"].values).all(axis=1)
        end = float(clock.values[alive][-1])
        ax.axvspan(
            end,
            float(clock.values[-1]),
            facecolor="none",
            edgecolor="#A8A8A8",
            hatch="///",
            lw=0,
            gid="ended",
        )
        ax.set_title(ended)
        # Of the time after the end only so much is shown as says that there is nothing.
        last = min(float(clock.values[-1]), end + 0.25 * (end - float(clock.values[0])))
    else:
        last = float(clock.values[-1])
    ax.set_xlim(float(clock.values[0]), last)
    ax.set_ylim(limits(np.concatenate(curves)))
    ax.set_xlabel("time, $t/T$ [–]" if in_T else f"time, $t$ {unit_text(unit_of(ds, 'time'))}")
    units, symbols = {unit_of(ds, name) for name in names}, ", ".join(symbol(name, ds) for name in names)
    ax.set_ylabel(f"{symbols} {unit_text(units.pop() if len(units) == 1 else 'mixed units')}")
    if len(names) > 1:
        ax.legend(loc="lower right", bbox_to_anchor=(1.0, 0.98), ncols=min(len(names), 5), handlelength=1.2)
    return ax
