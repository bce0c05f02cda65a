"""Bifurcation diagrams: section values of a state against a parameter."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from numpy.typing import NDArray

from whirlmap.plot.common.labels import axis_label, check_name, within_period
from whirlmap.plot.common.limits import is_log, limits
from whirlmap.plot.common.style import axes_or_new, look_of, styled
from whirlmap.plot.common.sweep_axes import parameter_axis, shade_ended, shade_hysteresis, sweeps, varied


@styled
def draw_diagram(
    ds: xr.Dataset,
    state: str,
    *,
    ax: Axes | None = None,
    colour_by_regime: bool = False,
    markersize: float | None = None,
    log: bool | None = None,
) -> Axes:
    """Section values of one state against the varied parameter.

    Reads ``section(parameter, period, state)``, ``regime``, ``status`` and, for the shortest axis,
    ``minimum`` and ``maximum``; with a dimension ``direction`` the two sweeps get a colour each, and
    the values at which they differ (``hysteresis``) a ground of their own. Values at
    which no run came to its end are hatched: contact, divergence and unresolved steps are results, not gaps.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.bifurcation_diagram`.
    state : str
        The one along the vertical axis, whose section the Dataset holds.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.
    colour_by_regime : bool
        Colour points by their regime instead of in ink (single sweeps only).
    markersize : float, optional
        In points; by the number of section points where absent.
    log : bool, optional
        Logarithmic parameter axis; where absent, if the values are spaced by a constant factor.

    Returns
    -------
    Axes
        Those that were drawn into; ``.figure`` is the figure.

    Raises
    ------
    RangeError
        A state whose section the Dataset does not hold; no or several varied parameters.
    """
    ax = axes_or_new(ax, height=3.0)
    parameter = varied(ds)
    check_name(state, [str(s) for s in ds["state"].values], "state")
    at = ds[parameter].values.astype(float)
    log = is_log(at) if log is None else log
    cloud = ds["section"].sel(state=state)
    size = _markersize(at.size, ds.sizes["period"]) if markersize is None else markersize
    for order, (sweep, colour) in enumerate(sweeps(ds)):
        values = within_period(ds, state, sweep["section"].sel(state=state).transpose(parameter, "period").values)
        if colour_by_regime and "direction" not in ds.dims:
            for regime in np.unique(sweep["regime"].values):
                chosen = sweep["regime"].values == regime
                _points(ax, at[chosen], values[chosen], look_of(int(regime)).colour, size)
        else:
            # Where two sweeps agree, the later is drawn within the earlier, so that both are seen.
            _points(ax, at, values, colour, size * 1.8 if "direction" in ds.dims and order == 0 else size)
    parameter_axis(ax, ds, at, log)
    shade_ended(ax, ds, at, log)
    shade_hysteresis(ax, ds, at, log)
    swing = _swing(ds, state)
    ax.set_ylim(limits(within_period(ds, state, cloud.values), amplitude=swing, others=_largest(ds)))
    ax.set_ylabel(axis_label(ds, state))
    return ax


def _markersize(values: int, periods: int) -> float:
    return float(np.clip(32.0 / np.sqrt(values) / periods**0.15, 0.8, 2.6))


def _points(ax: Axes, at: NDArray[np.float64], values: NDArray[np.float64], colour: str, size: float) -> None:
    x = np.repeat(at, values.shape[1])
    ax.plot(x, values.ravel(), ls="", marker="o", ms=size, mew=0, color=colour, rasterized=True)


def _swing(ds: xr.Dataset, state: str) -> float:
    """Largest peak-to-peak of the state at any one value, over the record; zero where not given."""
    if "maximum" not in ds or state not in ds["quantity"].values:
        return 0.0
    size = (ds["maximum"] - ds["minimum"]).sel(quantity=state).values
    return float(np.nanmax(size)) if np.isfinite(size).any() else 0.0


def _largest(ds: xr.Dataset) -> float:
    values = np.abs(ds["section"].values)
    return float(np.nanmax(values)) if np.isfinite(values).any() else 0.0
