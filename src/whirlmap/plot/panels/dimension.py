"""Correlation sums and their local slopes, with the scaling range that was fitted."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from whirlmap.plot.common.style import BLUE, INK, VERMILION, axes_or_new, styled, write_reason
from whirlmap.plot.panels.convergence import with_error

REASONS = {
    "no-scaling-range": "no scaling range",
    "too-few-points": "too few points for this dimension",
    "degenerate": "a finite set of points:\nno dimension",
}


def reason_without(ds: xr.Dataset) -> str:
    """Why there is no dimension; empty where there is one."""
    words = str(ds["status"].attrs.get("flag_meanings", "ok")).split()
    word = words[int(ds["status"])]
    return "" if word == "ok" else REASONS.get(word, word.replace("-", " "))


@styled
def draw_correlation_sum(ds: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Correlation sum against radius, both logarithmic, with the fitted line over the scaling range.

    Reads ``correlation_sum(radius)``, ``D2``, ``D2_error``, ``radius_low``, ``radius_high`` and ``status``.
    Without a scaling range the sum is drawn alone and the title says why.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.correlation_dimension`.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.

    Returns
    -------
    Axes
        Those that were drawn into; ``.figure`` is the figure.
    """
    ax = axes_or_new(ax, 3.6, 3.0)
    reason = reason_without(ds)
    if "correlation_sum" not in ds:
        return write_reason(ax, reason or "no correlation sum")
    radius, total = ds["radius"].values, ds["correlation_sum"].values
    seen = total > 0
    ax.loglog(radius[seen], total[seen], color=INK, ls="", marker="o", ms=1.8, mew=0, gid="sum")
    if reason:
        ax.set_title(reason.replace("\n", " "))
    else:
        low, high, slope = float(ds["radius_low"]), float(ds["radius_high"]), float(ds["D2"])
        inside = seen & (radius >= low * (1 - 1e-9)) & (radius <= high * (1 + 1e-9))
        level = np.mean(np.log(total[inside]) - slope * np.log(radius[inside]))
        ax.axvspan(low, high, color=VERMILION, alpha=0.12, lw=0, gid="range")
        ends = np.array([low, high])
        ax.plot(ends, np.exp(level) * ends**slope, color=VERMILION, lw=1.4, gid="fit")
        ax.set_title(f"$D_2$ = {with_error(slope, float(ds['D2_error']))}")
    ax.set_xlabel("radius, $r$ [–]")
    ax.set_ylabel("correlation sum, $C(r)$ [–]")
    return ax


@styled
def draw_local_slope(ds: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Local slope of the correlation sum against radius, with its error and the scaling range.

    Reads ``local_slope(radius)``, ``local_slope_error``, ``D2``, ``D2_error``, ``radius_low`` and
    ``radius_high``.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.correlation_dimension`.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.

    Returns
    -------
    Axes
        Those that were drawn into; ``.figure`` is the figure.
    """
    ax = axes_or_new(ax, 3.6, 3.0)
    reason = reason_without(ds)
    if "local_slope" not in ds or not np.isfinite(ds["local_slope"].values).any():
        return write_reason(ax, reason or "no local slopes")
    radius, slope, error = (ds[name].values for name in ("radius", "local_slope", "local_slope_error"))
    ax.set_xscale("log")
    ax.fill_between(radius, slope - 2 * error, slope + 2 * error, color=BLUE, alpha=0.2, lw=0, gid="band")
    ax.plot(radius, slope, color=BLUE, gid="slope")
    if not reason:
        low, high, value = float(ds["radius_low"]), float(ds["radius_high"]), float(ds["D2"])
        ax.axvspan(low, high, color=VERMILION, alpha=0.12, lw=0, gid="range")
        ax.plot([low, high], [value, value], color=VERMILION, lw=1.4, gid="fit")
        ax.set_title(f"scaling range: {float(ds['decades']):.2f} decades")
    else:
        ax.set_title(reason.replace("\n", " "))
    sharp = slope[np.isfinite(slope) & (error < 0.3)]
    ax.set_ylim(0, 1.2 * float(np.max(sharp)) if sharp.size and np.max(sharp) > 0 else 1.0)
    ax.set_xlabel("radius, $r$ [–]")
    ax.set_ylabel(r"$\mathrm{d}\,\ln C/\mathrm{d}\,\ln r$ [–]")
    return ax
