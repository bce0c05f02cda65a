"""Power spectra with named orders and found lines, and full spectra with forward and backward whirl apart."""

from collections.abc import Mapping
from fractions import Fraction

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from whirlmap.plot.common.labels import symbol, unit_text
from whirlmap.plot.common.style import BLUE, GREY, INK, ORANGE, VERMILION, axes_or_new, styled, text_size

Orders = Mapping[str, Fraction | float]

#: Decades of power that are shown below the highest line; below lie rounding and truncation.
DECADES = 14


@styled
def draw_power_spectrum(
    ds: xr.Dataset,
    *,
    ax: Axes | None = None,
    lines: xr.Dataset | None = None,
    orders: Orders | None = None,
    highest: float | None = 3.0,
    clock: str = "mesh",
    name: str = "",
    decibel: bool = True,
) -> Axes:
    """One-sided power spectrum over frequency in multiples of 1/T.

    Reads ``power(frequency)`` of `power_spectrum`, taken with the samples per T as rate, and
    ``line_frequency`` and ``line_power`` of `spectral_lines`. A line of amplitude a stands at a^2/2.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.power_spectrum`, one series.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.
    lines : xr.Dataset, optional
        The lines that were found: they get a triangle each, and the title their share of the power.
    orders : mapping of str to number
        Named orders in multiples of 1/T: ``{"mesh": 1, "pinion": 1/4, "gear": 1/8}``; labelled above the
        panel.
    highest : float, optional
        Highest frequency shown; all where None.
    clock : str
        What 1/T is called in the axis label; ``1/T`` itself where empty.
    name : str
        The quantity, for the label: ``yp``.
    decibel : bool
        Decibels relative to one; else a logarithmic axis.

    Returns
    -------
    Axes
        Those that were drawn into; ``.figure`` is the figure.
    """
    ax = axes_or_new(ax, 4.2, 2.8)
    frequency, power = ds["frequency"].values, ds["power"].values
    top = float(frequency[-1]) if highest is None else min(float(highest), float(frequency[-1]))
    seen = (frequency <= top) & (frequency > 0)
    floor = max(float(power[1:].max()), np.finfo(float).tiny * 1e30) * 10.0**-DECADES
    shown = np.maximum(power, floor / 10)

    def level(p: np.ndarray) -> np.ndarray:
        return 10 * np.log10(p) if decibel else p

    ax.plot(frequency[seen], level(shown[seen]), color=BLUE, lw=0.7, gid="power", rasterized=seen.sum() > 20_000)
    title = "power spectrum"
    if lines is not None:
        at, height = lines["line_frequency"].values, lines["line_power"].values
        keep = np.isfinite(at) & (at <= top) & (height > floor)
        ax.plot(
            at[keep],
            level(height[keep]),
            ls="",
            marker="v",
            ms=3.2,
            mfc="none",
            mec=VERMILION,
            mew=0.7,
            gid="lines",
            zorder=3,
        )
        share = f"{100 * float(lines['line_fraction']):.3g} % of the power"
        title = f"1 line holds {share}" if int(lines["count"]) == 1 else f"{int(lines['count'])} lines hold {share}"
    ax.set_xlim(0, top)
    if not decibel:
        ax.set_yscale("log")
    lowest = max(floor, 0.1 * float(shown[seen].min(initial=np.inf)))
    peak = max(float(shown[seen].max(initial=0.0)), 10 * lowest)
    room = 0.3 if orders else 0.05  # above the highest line, for the names of the orders
    ends = level(np.array([lowest, peak * (peak / lowest) ** room]))
    ax.set_ylim(float(ends[0]), float(ends[1]))
    ax.set_xlabel(f"frequency / {clock} frequency [–]" if clock else "frequency, in $1/T$ [–]")
    what = f"power of {symbol(name, ds)}" if name else "power"
    unit = str(ds["power"].attrs.get("units", "1"))
    level_unit = f"[dB re {'1' if unit == '1' else f'1 {unit}'}]"
    ax.set_ylabel(f"{what} {level_unit}" if decibel else f"{what}, $a^2/2$ {unit_text(unit)}")
    mark_orders(ax, orders or {})
    ax.set_title(title)
    return ax


@styled
def draw_full_spectrum(
    ds: xr.Dataset,
    *,
    ax: Axes | None = None,
    orders: Orders | None = None,
    highest: float | None = 1.5,
    clock: str = "mesh",
    least: float = 1e-7,
) -> Axes:
    """Two-sided amplitude spectrum of the orbit x + iy: forward whirl to the right, backward to the left.

    Reads ``forward(whirl_frequency)`` and ``backward(whirl_frequency)`` of `full_spectrum`: radii of the
    circular orbits. Forward turns from x to y; a shaft that spins the other way is named by a negative order.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.full_spectrum`, one orbit.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.
    orders : mapping of str to number
        Named orders in multiples of 1/T, with the sign of the shaft's spin.
    highest : float, optional
        Highest frequency shown, in multiples of 1/T; all where None.
    clock : str
        What 1/T is called in the axis label; ``1/T`` itself where empty.
    least : float
        Lowest amplitude shown, over the highest.

    Returns
    -------
    Axes
        Those that were drawn into; ``.figure`` is the figure.
    """
    ax = axes_or_new(ax, 5.0, 2.8)
    frequency = ds["whirl_frequency"].values
    top = float(frequency[-1]) if highest is None else min(float(highest), float(frequency[-1]))
    seen = frequency <= top
    forward, backward = ds["forward"].values[seen], ds["backward"].values[seen]
    peak = max(float(forward.max(initial=0.0)), float(backward.max(initial=0.0)), np.finfo(float).tiny * 1e30)
    for sign, curve, colour, label in ((1, forward, BLUE, "forward"), (-1, backward, ORANGE, "backward")):
        ax.semilogy(sign * frequency[seen], np.maximum(curve, 0.1 * least * peak), color=colour, lw=0.7, gid=label)
        ax.set_title(f"{label} whirl", loc="right" if sign > 0 else "left", color=colour, fontweight="bold")
    ax.axvline(0.0, color=INK, lw=0.6)
    ax.set_xlim(-top, top)
    ax.set_ylim(least * peak, peak * least ** (-0.3 if orders else -0.05))
    ax.set_xlabel(f"frequency / {clock} frequency [–]" if clock else "frequency, in $1/T$ [–]")
    ax.set_ylabel("radius of the circular orbit [–]")
    mark_orders(ax, orders or {})
    return ax


def mark_orders(ax: Axes, orders: Orders) -> None:
    """Thin lines at named orders, their names under the upper edge, moved apart where they overlap."""
    low, high = ax.get_xlim()
    chosen = sorted((float(at), name) for name, at in orders.items() if low <= float(at) <= high)
    width = ax.get_position().width * ax.figure.get_figure(root=True).get_size_inches()[0]
    gap = (high - low) * 0.115 / max(float(width), 0.5)  # one line of text
    places = _apart([at for at, _ in chosen], gap)
    for (at, name), place in zip(chosen, places, strict=True):
        ax.axvline(at, color=GREY, lw=0.6, ls=(0, (3, 2)), zorder=0.6, gid=f"order-{name}")
        ax.annotate(
            name,
            (place, 0.985),
            xycoords=("data", "axes fraction"),
            ha="center",
            va="top",
            rotation=90,
            fontsize=text_size(6.5),
            color="#444444",
            annotation_clip=False,
            bbox={"fc": "white", "ec": "none", "pad": 0.6},
        )


def _apart(places: list[float], gap: float) -> list[float]:
    """Ascending positions, moved as little as needed to keep a gap between neighbours."""
    out = list(places)
    for _ in range(200):
        moved = False
        for k in range(len(out) - 1):
            short = gap - (out[k + 1] - out[k])
            if short > 1e-9 * gap:
                out[k], out[k + 1], moved = out[k] - short / 2, out[k + 1] + short / 2, True
        if not moved:
            break
    return out
