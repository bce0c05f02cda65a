"""The sheet of a recorded signal: six panels, each an indicator of `diagnose_series`."""

import json
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from whirlmap.errors import counted
from whirlmap.plot.common.labels import unit_text
from whirlmap.plot.common.style import (
    BLUE,
    GREEN,
    GREY,
    INK,
    ORANGE,
    VERMILION,
    WIDE,
    axes_or_new,
    look_of,
    new_figure,
    styled,
    text_size,
    write_reason,
)
from whirlmap.plot.panels.dimension import draw_correlation_sum
from whirlmap.results.regime import Regime

#: Swings of the signal that are shown in time, and in the portrait.
SHOWN, DRAWN = 20, 200
#: Decades of power shown below the highest line.
DECADES = 10


@styled
def series_figure(ds: xr.Dataset, *, title: str = "") -> Figure:
    """Six panels of a signal: time, delay portrait, spectrum, embedding, divergence of neighbours, correlation sum.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.diagnose_series`.
    title : str
        Over the whole figure; nothing where empty.

    Returns
    -------
    Figure
        Not known to pyplot; `save` writes it.
    """
    slides = "window_regime" in ds
    fig = new_figure(WIDE, 7.4 if slides else 5.6)
    grid = fig.add_gridspec(3 if slides else 2, 3)
    axes = [fig.add_subplot(grid[k // 3, k % 3]) for k in range(6)]
    if slides:
        draw_windows(ds, ax=fig.add_subplot(grid[2, :]))
    unit = str(ds.attrs["unit"])
    votes = json.loads(ds.attrs["indicators"])
    x, time = ds["series"].values, ds["time"].values
    swing = max(int(float(ds.attrs["swing"]) / (time[1] - time[0])), 1)
    shown = slice(0, SHOWN * swing)
    start, quantity = float(ds.attrs.get("start", 0.0)), str(ds.attrs.get("quantity", ""))
    size = unit_text(str(ds["series"].attrs["units"]))
    axes[0].plot(start + time[shown], x[shown], color=BLUE, lw=0.7)
    axes[0].set(xlabel=f"time {unit_text(unit)}", ylabel=f"{quantity or 'signal'} {size}", title="signal")
    lag, drawn = int(ds.attrs["lag"]), DRAWN * swing
    axes[1].plot(x[: -lag or None][:drawn], x[lag:][:drawn], color=BLUE, lw=0.4, alpha=0.7)
    axes[1].set(xlabel=f"$x(t)$ {size}", ylabel=f"$x(t + {lag}\\,\\Delta)$ {size}", title="delay portrait")
    draw_series_spectrum(ds, ax=axes[2])
    draw_embedding(ds, ax=axes[3])
    draw_divergence(ds, ax=axes[4])
    if "dimension_status" in ds:
        names = [str(n) for n in ds.variables if str(n).startswith("dimension_")]
        draw_correlation_sum(ds[names].rename({n: n.removeprefix("dimension_") for n in names}), ax=axes[5])
    else:
        write_reason(axes[5], f"correlation sum:\n{_unasked(votes)}")
    zero_one, label = votes["zero_one"]["value"], Regime(int(ds["regime"])).label
    words = f"{label} (confidence {float(ds['confidence']):.2g})"
    words += "" if zero_one is None else f"; 0-1 test: {zero_one:.2f}"
    named = ", ".join(part for part in (title, quantity) if part)
    fig.suptitle(f"{named}: {words}" if named else words)
    return fig


def _per(unit: str) -> str:
    """Unit of frequencies over a unit of time."""
    return "Hz" if unit == "s" else "–" if unit == "1" else f"1/{unit}"


def _unasked(votes: dict[str, Any]) -> str:
    """Why there is no embedded indicator."""
    reasons = {"neighbours-coincide": "the signal returns: neighbours coincide",
        "lines-hold-all": "regular: lines hold all of the power", "not-steady": "the motion is not steady"}
    return reasons.get(votes["neighbours"]["vote"], "no embedding dimension unfolds the signal")


@styled
def draw_windows(ds: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Regime, rms and frequency of the windows of a record, over time.

    Reads ``window_regime``, ``window_rms``, ``window_frequency`` and, where it is there, ``window_speed`` of a
    diagnosis with windows.
    """
    ax = axes_or_new(ax, height=1.6)
    start, length = ds["window_start"].values, float(ds.attrs["window_length"])
    middle, half = start + length / 2, length / 4  # windows lie half a window apart
    looks = [look_of(int(r)) for r in ds["window_regime"].values]
    for at, look in zip(middle, looks, strict=True):
        ax.axvspan(at - half, at + half, facecolor=look.colour, alpha=0.35, lw=0, gid=f"window-{look.label}")
    ax.plot(middle, ds["window_rms"].values, "o-", ms=2.5, color=INK, lw=0.8)
    unit = str(ds["window_start"].attrs["units"])
    size = unit_text(str(ds["window_rms"].attrs["units"]))
    ax.set(xlabel=f"time {unit_text(unit)}", ylabel=f"rms {size}", xlim=(start[0], start[-1] + length))
    ax.set_ylim(bottom=0)
    beside = ax.twinx()
    beside.plot(middle, ds["window_frequency"].values, "s", ms=2.5, color=VERMILION)
    if "window_speed" in ds:
        beside.plot(middle, ds["window_speed"].values, color=VERMILION, lw=0.7, ls="--", gid="speed")
        beside.annotate("1x", (middle[-1], ds["window_speed"].values[-1]), color=VERMILION, fontsize=text_size(6.0))
    beside.set_ylabel(f"frequency [{_per(unit)}]", color=VERMILION)
    beside.spines["right"].set_visible(True)
    shown = {look.label: look for look in looks}
    ax.legend(handles=[Patch(facecolor=look.colour, alpha=0.35, label=name) for name, look in shown.items()],
        loc="upper left",
              bbox_to_anchor=(0.0, 1.25), ncols=len(shown), fontsize=text_size(6.5))  # fmt: skip
    return ax


@styled
def draw_series_spectrum(ds: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Power spectrum of a signal with its strongest lines named: as orders of the shaft where its speed is known."""
    ax = axes_or_new(ax)
    frequency, power = ds["frequency"].values, ds["power"].values
    top = power[1:].max()
    seen = np.flatnonzero(power > top * 1e-6)
    last = min(int(seen[-1] * 1.15) + 8, frequency.size - 1)
    floor = top * 10.0**-DECADES
    ax.semilogy(frequency[1:last], np.maximum(power[1:last], floor), color=BLUE, lw=0.6)
    spectrum = json.loads(ds.attrs["indicators"])["spectrum"]
    speed = ds.attrs.get("speed")
    if speed is not None and speed <= frequency[last]:
        ax.axvline(speed, color=GREY, lw=0.6, ls=(0, (3, 2)), zorder=0.6, gid="order-1x")
    for line in spectrum["named"][:6]:
        name = line["name"] if speed is None else line["order_name"] or f"{line['order']:.3g}x"
        if name and line["frequency"] <= frequency[last]:
            height = power[int(np.abs(frequency - line["frequency"]).argmin())]
            ax.annotate(name, (line["frequency"], height), xytext=(0, 3), textcoords="offset points",
                        fontsize=text_size(6.0), ha="center", color=VERMILION)  # fmt: skip
    share = 100 * (1 - spectrum["broadband_fraction"])
    count = spectrum["lines"]
    held = f"{counted(count, 'line')} hold{'s' if count == 1 else ''} {share:.3g} %" if count else "no line stands out"
    unit = _per(str(ds.attrs["unit"]))
    turning = "" if speed is None else f", 1x = {speed:.5g}"
    squared = unit_text(str(ds["power"].attrs["units"]).replace("^2", "²"))
    ax.set(xlabel=f"frequency [{unit}]{turning}", ylabel=f"power, $a^2/2$ {squared}", title=held)
    ax.set_ylim(floor, 10 * top)
    return ax


@styled
def draw_embedding(ds: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Mutual information over the lag, and false neighbours over the dimension, on an axis of its own."""
    ax = axes_or_new(ax)
    ax.plot(ds["lag"].values, ds["mutual_information"].values, color=BLUE)
    ax.axvline(int(ds.attrs["lag"]), color=BLUE, lw=0.6, ls=":")
    ax.set(xlabel="lag [samples]", ylabel="mutual information [bit]")
    ax.yaxis.label.set_color(BLUE)
    if "false_neighbours" not in ds:
        ax.set_title(f"lag {int(ds.attrs['lag'])}")
        return ax
    inset = ax.inset_axes((0.5, 0.5, 0.46, 0.4))
    inset.semilogy(ds["dimension"].values, np.maximum(ds["false_neighbours"].values, 1e-4), "o-", ms=2.5, color=ORANGE)
    inset.set_title("false neighbours", fontsize=text_size(6.5), color=ORANGE)
    inset.tick_params(labelsize=text_size(5.5))
    found = int(ds.attrs["embedding_dimension"])
    ax.set_title(f"lag {int(ds.attrs['lag'])}, " + (f"dimension {found}" if found else "no dimension"))
    return ax


@styled
def draw_divergence(ds: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Mean logarithm of the distance of neighbours over time, with the fitted ranges of both methods."""
    ax = axes_or_new(ax)
    votes = json.loads(ds.attrs["indicators"])
    if "rosenstein" not in ds:
        return write_reason(ax, f"exponents:\n{_unasked(votes)}")
    step = float(ds["time"][1] - ds["time"][0])
    time = ds["step"].values * step
    for name, colour in (("rosenstein", VERMILION), ("kantz", GREEN)):
        curve, vote = ds[name].values, votes[name]
        found = "no range" if vote["value"] is None else f"{vote['value']:.3g} ± {vote['error']:.1g}"
        label = f"{name.capitalize()}: {found}"
        ax.plot(time, curve, color=colour, lw=0.8, alpha=0.7, label=label)
        if vote["range"]:
            a, b = vote["range"]
            level = np.mean(curve[a : b + 1] - vote["value"] * time[a : b + 1])
            ax.plot(time[[a, b]], level + vote["value"] * time[[a, b]], color=INK, lw=1.2, ls="--", gid=f"fit-{name}")
    unit = unit_text(str(ds.attrs["unit"]))
    ax.set(xlabel=f"time {unit}", ylabel=r"$\langle \ln d \rangle$", title="divergence of neighbours")
    ax.legend(loc="lower right", fontsize=text_size(6.5))
    return ax
