"""Poincaré maps: section points in the plane of two states."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from whirlmap.plot.common.labels import axis_label, check_name, velocity_of, within_period
from whirlmap.plot.common.limits import limits
from whirlmap.plot.common.limits import markersize as size_of_points
from whirlmap.plot.common.style import INK, axes_or_new, styled, write_reason
from whirlmap.results.status import Status


def ranges_of(ds: xr.Dataset | None, name: str) -> tuple[float, float]:
    """Measure the peak-to-peak range of a state over an orbit, and the largest magnitude of all states."""
    if ds is None or "x" not in ds or name not in ds["state"].values or not np.isfinite(ds["x"].values).any():
        return 0.0, 0.0
    own = within_period(ds, name, ds["x"].sel(state=name).values)
    return float(np.nanmax(own) - np.nanmin(own)), float(np.nanmax(np.abs(ds["x"].values)))


@styled
def draw_section(
    ds: xr.Dataset,
    x: str,
    y: str | None = None,
    *,
    ax: Axes | None = None,
    orbit: xr.Dataset | None = None,
    colour: str = INK,
    markersize: float | None = None,
) -> Axes:
    """Poincaré map of two states; runs and periods together are one cloud.

    Reads ``section(..., period, state)`` and ``status``. The axes are never shorter than a share of the
    peak-to-peak of the motion, so that a periodic orbit is its few points.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.section`.
    x, y : str
        States; the velocity of ``x`` where ``y`` is absent.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.
    orbit : xr.Dataset, optional
        The time series of the same motion, which gives its peak-to-peak.
    colour : str
        Of the points.
    markersize : float, optional
        In points; by the number of section points where absent.

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
    known = [str(s) for s in ds["state"].values]
    u, v = (within_period(ds, n, ds["section"].sel(state=check_name(n, known, "state")).values.ravel()) for n in (x, y))
    keep = np.isfinite(u) & np.isfinite(v)
    if not keep.any():
        worst = Status(int(np.max(ds["status"].values)))
        return write_reason(ax, f"no section points:\n{worst.sentence}" if worst else "no section points")
    largest = float(np.nanmax(np.abs(ds["section"].values)))
    for name, values, setter in ((x, u, ax.set_xlim), (y, v, ax.set_ylim)):
        swing, all_states = ranges_of(orbit, name)
        setter(*limits(values, amplitude=swing, others=max(all_states, largest), margin=0.08))
    seen = float(np.diff(ax.get_xlim())[0]), float(np.diff(ax.get_ylim())[0])
    points = size_of_points(u[keep], v[keep], seen) if markersize is None else markersize
    ax.plot(
        u[keep],
        v[keep],
        ls="",
        marker="o",
        ms=points,
        mew=0,
        color=colour,
        rasterized=keep.sum() > 2000,
        gid="section",
    )
    ax.set_xlabel(axis_label(ds, x))
    ax.set_ylabel(axis_label(ds, y))
    ax.locator_params(axis="x", nbins=5)  # numbers of many digits must not run into each other
    ax.set_title(f"{keep.sum()} point{'s' * bool(keep.sum() > 1)}" + _how_often(ds))
    return ax


def _how_often(ds: xr.Dataset) -> str:
    _, _, often = str(ds["section"].attrs.get("long_name", "")).partition("once per ")
    often = {"T": "$T$", "common": "common period"}.get(str(ds.attrs.get("once_per", often)), often)
    return f", one per {often}" if often else ""
