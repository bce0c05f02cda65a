"""Figure of safe speed windows: amplitude, film thickness and load against speed, with the reasons between the windows."""

import json
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from whirlmap.plot.common.labels import speed_of, unit_text
from whirlmap.plot.common.style import BLUE, GREEN, GREY, INK, ORANGE, PURPLE, SKY, VERMILION, WIDE, new_figure, styled

#: How each verdict is drawn: its ground, and its word in the legend.
LOOKS = {
    "safe": (GREEN, "safe"), "amplitude": (ORANGE, "amplitude"), "separation": (BLUE, "teeth part"),
    "coexisting": (PURPLE, "coexisting"), "quasi_periodic": (SKY, "quasi-periodic"), "chaotic": (VERMILION, "chaotic"),
    "contact": ("#555555", "contact"), "diverged": ("#222222", "diverged"), "undecided": (GREY, "undecided"),
}  # fmt: skip
#: Depth of the grounds.
ALPHA = 0.3


@styled
def speeds_figure(
    ds: xr.Dataset, *, unit: float = 1.0, length: str = "1", force: float = 1.0, force_unit: str = "1", title: str = ""
) -> Figure:
    """Draw the Dataset of `safe_speeds`.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.safe_speeds`.
    unit, force : float
        Size of the model's length in ``length``, and of its force in ``force_unit``.
    length, force_unit : str
        Units of the vertical axes.
    title : str
        Over the whole figure; nothing where empty.

    Returns
    -------
    Figure
        Not known to pyplot; `save` writes it.
    """
    bearings = [name for name in ("min_film", "max_load") if name in ds]
    chance = ["probability"] if "probability" in ds else []
    heights = [2.6, *[1.0] * len(bearings + chance)]
    fig = new_figure(WIDE, 1.05 * sum(heights) + 0.5)
    first, *rest = fig.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    speed = speed_of(ds)
    along = "rpm" if "rpm" in ds else speed
    at = ds[along].values
    _grounds([first, *rest[: len(bearings)]], ds, at[-1] / ds[speed].values[-1])
    _legend(first, ds)
    _amplitude(first, ds, at, unit, length)
    fig.suptitle(title)
    for ax, name in zip(rest, bearings, strict=False):
        film = name == "min_film"
        _bearings(ax, ds[name] * (unit if film else force), at, names=ax is rest[0])
        ax.set_ylabel(f"film {unit_text(length)}" if film else f"load {unit_text(force_unit)}")
    if chance:
        _probability(rest[-1], ds, at)
    fig.align_ylabels()
    (rest or [first])[-1].set(
        xlim=(at[0], at[-1]), xlabel="speed of the first shaft [rpm]" if along == "rpm" else f"speed ratio {speed}"
    )
    return fig


def _grounds(panels: list[Axes], ds: xr.Dataset, scale: float) -> None:
    """Colour the whole range by verdict."""
    for row in json.loads(ds.attrs["stretches"]):
        for ax in panels:
            ax.axvspan(row["start"] * scale, row["end"] * scale, color=LOOKS[row["verdict"]][0], alpha=ALPHA, lw=0)


def _probability(ax: Axes, ds: xr.Dataset, at: np.ndarray) -> None:
    """Shares of the drawn machines by verdict, one upon the other, safe at the bottom with its interval."""
    kinds = _drawn(ds)
    ax.stackplot(at, ds["probability_of"].sel(why=kinds), colors=[LOOKS[kind][0] for kind in kinds], alpha=ALPHA, lw=0)
    ax.fill_between(at, ds["probability_low"], ds["probability_high"], color=INK, alpha=0.25, lw=0)
    ax.plot(at, ds["probability"], color=INK)
    ax.set(ylim=(0, 1), ylabel="probability")


def _drawn(ds: xr.Dataset) -> list[str]:
    return [str(why) for why in ds["why"].values if ds["probability_of"].sel(why=why).values.any()]


def _legend(ax: Axes, ds: xr.Dataset) -> None:
    kinds = dict.fromkeys([row["verdict"] for row in json.loads(ds.attrs["stretches"])])
    kinds |= dict.fromkeys(_drawn(ds) if "probability_of" in ds else [])
    handles = [Patch(color=LOOKS[kind][0], alpha=ALPHA, lw=0, label=LOOKS[kind][1]) for kind in kinds]
    ax.legend(handles=handles, ncols=6, loc="lower left", bbox_to_anchor=(0.25, 1.0), borderaxespad=0.3)


def _amplitude(ax: Axes, ds: xr.Dataset, at: np.ndarray, unit: float, length: str) -> None:
    worst, cold = ds["amplitude"].values * unit, ds["amplitude_cold"].values * unit
    limit = ds.attrs["limit"] * unit
    ax.plot(at, cold, ".-", color=INK, ms=3, lw=0.8)
    higher = np.isfinite(worst) & (worst > 1.01 * cold)  # a motion that a cold start does not meet
    ax.plot(at[higher], worst[higher], "^", color=PURPLE, mec=INK, mew=0.4, ms=4)
    ax.axhline(limit, color=VERMILION, lw=1, ls="--")
    top = np.nanmax([limit, *cold, *worst]) if np.isfinite([*cold, *worst]).any() else limit
    ax.set(ylim=(0, 1.08 * top), ylabel=f"peak to peak {unit_text(length)}")


def _bearings(ax: Axes, values: xr.DataArray, at: np.ndarray, *, names: bool) -> None:
    styles: tuple[Any, ...] = ("-", "--", ":", "-.")
    for k, bearing in enumerate(values["bearing"].values):
        ax.plot(at, values.sel(bearing=bearing), styles[k % len(styles)], color=INK, lw=0.9, label=f"bearing {bearing}")
    if np.isfinite(values).any():
        ax.set_ylim(0, 1.12 * float(values.max()))
    if names and values.sizes["bearing"] > 1:
        ax.legend(ncols=4, loc="best")
