"""Lyapunov exponents from the tangent dynamics, with an error that covers correlated and periodic records."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Unpack

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.motion.divergence import ensemble_divergence, missed
from whirlmap.analysis.motion.ensembles import make_ensemble, run_attributes
from whirlmap.analysis.variational.tangent_accuracy import FINE, tuned
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.system import System
from whirlmap.options.computed import BLOCKS, INTEGRATION, Integration
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import IntegrationParts, takes_options
from whirlmap.results.schema import status_variable, variable, with_attributes
from whirlmap.results.status import Status

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]


def exponents(ensemble: Ensemble, periods: int, *, align: int, progress: Callable[[int], None] | None = None) -> Array:
    """Local exponents of every point in successive stretches, largest vector first.

    The tangent vectors are carried through the kernel and orthonormalised (modified Gram-Schmidt) [benettin1980] as
    often as needed, at least once per T (`tangent_accuracy`); the vectors align in the first ``align`` common periods, which
    do not count.

    Parameters
    ----------
    ensemble : Ensemble
        On its attractor, with tangent vectors; advanced in place.
    periods : int
        Common periods that count (`Ensemble.strobe`: T where the common period is longer than 128 T).

    Returns
    -------
    array, shape (period, exponent, point)
        Growth rate per unit of the model's time in each common period; NaN in points that have ended.
    """
    common = ensemble.strobe
    ensemble.advance(align * common, progress=progress)
    segment = ensemble.advance(periods * common, progress=progress)
    growth = segment.growth.reshape(periods, common, ensemble.tangents, ensemble.points).sum(axis=1)
    rates: Array = growth / (common * ensemble.period)
    rates[:, :, ensemble.status != Status.ok] = np.nan
    return rates


def mean_and_error(rates: Array, cycle: int = 1) -> tuple[Array, Array]:
    """Mean over periods and its error; rates have shape (period, ...).

    ``cycle`` is the number of periods after which the forcing repeats: where the record is long enough whole cycles count,
    for within one the rates change with its phase.

    The error is the standard error from `BLOCKS` block means, and at least a third of the range of the accumulated deviation
    from the mean, over the length: three errors bound what the length leaves of a growth that returns, such as that of the
    time direction of an unforced cycle, which blocks in step with the cycle do not show. For a random record it is 0.4
    standard errors.
    """
    rates = _over_cycles(rates, cycle)
    n = rates.shape[0] // BLOCKS
    if n == 0:
        raise RangeError(f"an error needs at least {BLOCKS} periods, not {rates.shape[0]}")
    # Each series in one piece: sums down the columns of a table would round by how many columns there are.
    series = np.ascontiguousarray(np.moveaxis(rates, 0, -1))
    blocks = series[..., : n * BLOCKS].reshape(*series.shape[:-1], BLOCKS, n).mean(axis=-1)
    return series.mean(axis=-1), np.maximum(blocks.std(axis=-1, ddof=1) / np.sqrt(BLOCKS), _swing(series))


def _over_cycles(rates: Array, cycle: int) -> Array:
    """Means over whole cycles, where the record holds enough of them."""
    whole = rates.shape[0] // cycle
    if whole < BLOCKS:
        return rates
    return np.asarray(rates[: whole * cycle].reshape(whole, cycle, *rates.shape[1:]).mean(axis=1))


def _swing(series: Array) -> Array:
    """A third of the range of the accumulated deviation from the mean along the last axis, over its length."""
    off = np.cumsum(series - series.mean(axis=-1, keepdims=True), axis=-1)
    return np.asarray((np.fmax(off.max(axis=-1), 0.0) - np.fmin(off.min(axis=-1), 0.0)) / (3 * series.shape[-1]))


def in_phase(rates: Array, cycle: int = 1) -> Array:
    """Error, shape (exponent,), that runs in phase share; rates have shape (period, exponent, run).

    Runs of one cycle are no independent ones, and the mean over them is no better than each.
    """
    return _swing(np.ascontiguousarray(_over_cycles(rates, cycle).mean(axis=2).T))


@takes_options("exponents", former={"periods": "common_periods"})
def lyapunov_spectrum(
    system: System,
    *,
    count: int | None = None,
    transient: int = 200,
    common_periods: int = 400,
    starts: int = 8,
    integration: Integration = INTEGRATION,
    execution: Execution = EXECUTION,
    **_given: Unpack[IntegrationParts],
) -> "xr.Dataset":
    """Largest Lyapunov exponents of a system, one run from each of several start states.

    Parameters
    ----------
    system : System
        Its values and start states count.
    count : int, optional
        Number of exponents, largest first; all of them where absent.
    transient, common_periods : int
        Common periods dropped, and counted (T where the common period is longer than 128 T; for an unforced model: typical
        times).
    starts : int
        Runs from starts that differ by 1e-6, which decorrelate in chaos; the error is the largest of the scatter
        between runs and the mean error within them, both for the mean over runs, of a quarter of the difference between the
        halves of the record, of what the steps leave (`tangent_accuracy`) and of what the sum misses of the divergence.
    integration : Integration, optional
        Method, and steps or accuracy; or its parts as keywords, ``method``, ``steps``, ``accuracy``.
    execution : Execution, optional
        How it is run, which changes no number; or its parts as keywords, ``workers``, ``progress``.

    Returns
    -------
    xr.Dataset
        ``lyapunov`` and ``lyapunov_error`` (exponent) per unit of the model's time, without the zero of the forcing's
        phase, which ``phase_exponent`` states; ``divergence`` and its error; ``running(period, exponent)``,
        the mean up to each common period over all runs; ``run_exponent(run, exponent)`` and ``status(run)``.

    Raises
    ------
    RangeError
        Counts that make no sense, an unknown method, or several exponents of a motion that sticks.

    Notes
    -----
    Where rates jump, tangent vectors are multiplied by the saltation matrix.
    A run's own block error alone is too small by up to 2.6 times on Duffing's oscillator, hence the several starts.
    An unforced system's spectrum holds the zero of its own time direction.

    References
    ----------
    [benettin1980] tangent vectors, orthonormalised on the way. [parker1989] saltation.
    """
    import xarray as xr

    count = system.model.dimension if count is None else count
    if not 1 <= count <= system.model.dimension:
        raise RangeError(f"{system.model.name} has {system.model.dimension} exponents; {count} were asked for")
    if starts < 1:
        raise RangeError(f"starts must be at least 1, not {starts}")
    repeat = {system.parameters[0]: np.full(starts, system.vector[0])}
    ensemble, _ = make_ensemble(
        system, repeat, tangents=count, perturbed=True, integration=integration, execution=execution
    )
    progress = execution.progress
    ensemble = tuned(ensemble).ensemble  # vectors that vanish during the run would stay zero
    align = max(transient // 10, 5)
    ensemble.advance(max(transient - align, 0) * ensemble.strobe, progress=progress)
    carried = tuned(ensemble, FINE, returns=True)
    ensemble = carried.ensemble
    rates = exponents(ensemble, common_periods, align=align, progress=progress)
    if count > 1 and (ensemble.status == Status.sticks).any():
        raise RangeError(
            f"{system.model.name} sticks to a surface at which its rates jump: its largest exponent alone can be had,"
            " with count=1 (the smallest are minus infinity)"
        )
    means, errors = mean_and_error(rates)
    good = ensemble.status == Status.ok
    divergence, spread = ensemble_divergence(ensemble, good)
    if good.any():
        value = means[:, good].mean(axis=1)
        within = np.sqrt((errors[:, good] ** 2).sum(axis=1)) / good.sum()
        between = means[:, good].std(axis=1, ddof=1) / np.sqrt(good.sum()) if good.sum() > 1 else within
        early, late = np.array_split(rates[:, :, good].mean(axis=2), 2)
        half = early.mean(axis=0) - late.mean(axis=0)
        error = np.max([within, between, np.abs(half) / 2, carried.of_ensemble, in_phase(rates[:, :, good])], axis=0)
        order = np.argsort(-value)  # nearly equal exponents may come out of the kernel in either order
        value, means, rates = value[order], means[order], rates[:, order]
        error = missed(value, error[order], divergence, spread, system.model.dimension)
        running = np.cumsum(rates[:, :, good].mean(axis=2), axis=0) / np.arange(1, common_periods + 1)[:, None]
    else:
        value = error = np.full(count, np.nan)
        running = np.full((common_periods, count), np.nan)
    phase = variable((), 0.0 if system.model.forced else np.nan, "1/time", "exponent of the forcing's phase, left out above")
    ds = xr.Dataset(
        {
            "lyapunov": variable("exponent", value, "1/time", "Lyapunov exponent, largest first"),
            "lyapunov_error": variable("exponent", error, "1/time", "one standard error of the exponent"),
            "running": variable(("period", "exponent"), running, "1/time", "mean exponent up to each common period"),
            "run_exponent": variable(("run", "exponent"), means.T, "1/time", "exponent of each run"),
            "status": status_variable("run", ensemble.status),
            "steps": variable("run", ensemble.point_steps, "1/T", "steps per T"),
            "phase_exponent": phase,
            "divergence": variable((), divergence, "1/time", "mean divergence, which all exponents add up to"),
            "divergence_error": variable((), spread, "1/time", "one standard error of it"),
        },
        coords={"period": np.arange(1, common_periods + 1), "exponent": np.arange(1, count + 1), "run": np.arange(starts)},
    )
    return with_attributes(
        ds,
        run_attributes(
            system, ensemble, transient=transient, periods=common_periods,
            **({"common_period": system.common_period} if system.repeats else {}),
        ),
    )  # fmt: skip
