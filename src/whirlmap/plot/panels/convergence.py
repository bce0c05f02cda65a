"""Convergence of Lyapunov exponents: the running mean, and the final value with its error."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from whirlmap.plot.common.labels import unit_of, unit_text
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

COLOURS = (VERMILION, BLUE, GREEN, PURPLE, ORANGE, SKY)


@styled
def draw_convergence(ds: xr.Dataset, *, ax: Axes | None = None, count: int = 1, errors: float = 2.0) -> Axes:
    """Draw the running mean of the largest exponents, with the error band of the final value.

    Reads ``running`` (period by exponent), ``lyapunov``, ``lyapunov_error`` and ``status``.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.lyapunov_spectrum` or `whirlmap.diagnose`.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.
    count : int
        How many exponents are shown, largest first.
    errors : float
        Half-width of the band, in standard errors.

    Returns
    -------
    Axes
        Those that were drawn into; ``.figure`` is the figure.
    """
    ax = axes_or_new(ax, 3.6, 2.8)
    running = ds["running"].values[:, :count]
    if not np.isfinite(running).any():
        worst = Status(int(np.max(ds["status"].values)))
        return write_reason(ax, "no exponent:\n" + (worst.sentence if worst else "nothing measured"))
    period = np.arange(1, running.shape[0] + 1)
    final, error = ds["lyapunov"].values[:count], ds["lyapunov_error"].values[:count]
    ax.axhline(0.0, color=INK, lw=0.7, zorder=0.5)
    for k in range(running.shape[1]):
        colour = COLOURS[k % len(COLOURS)]
        low, high = final[k] - errors * error[k], final[k] + errors * error[k]
        ax.axhspan(low, high, color=colour, alpha=0.2, lw=0, gid="band")
        ax.plot(period, running[:, k], color=colour, gid="running", label=rf"$\lambda_{{{k + 1}}}$")
    # The first means are of a few periods: they may run off the axis, so that the rest can be read.
    settled = running[len(running) // 10 :]
    bounds = np.concatenate([settled.ravel(), final - errors * error, final + errors * error, [0.0]])
    size = max(float(np.ptp(bounds)), 4 * errors * float(error.max()), np.finfo(float).tiny)
    ax.set_ylim(float(bounds.min()) - 0.15 * size, float(bounds.max()) + 0.15 * size)
    ax.set_xlim(0, float(period[-1]))
    ax.set_xlabel("common periods [–]")
    ax.set_ylabel((r"$\lambda_1$ " if running.shape[1] == 1 else r"$\lambda$ ") + unit_text(unit_of(ds, "lyapunov")))
    ax.set_title(rf"$\lambda_1$ = {with_error(float(final[0]), float(error[0]))} (band: {errors:g} s.e.)")
    if running.shape[1] > 1:
        ax.legend(loc="center right", ncols=2)
    return ax


def with_error(value: float, error: float) -> str:
    """Write a number with its standard error, cut to two digits of the error: ``0.1234 ± 0.0021``."""
    if not (np.isfinite(error) and error > 0):
        return f"{value:.4g}".replace("-", "−")
    if error < 1e-4 * abs(value):
        return f"{value:.6g} ± {error:.1g}".replace("-", "−")
    digits = int(max(1 - np.floor(np.log10(error)), 0))
    if digits > 8:  # of a clock whose unit is long: powers of ten read better than zeros
        return f"{value:.4g} ± {error:.2g}".replace("-", "−")
    return f"{value:.{digits}f} ± {error:.{digits}f}".replace("-", "−")
