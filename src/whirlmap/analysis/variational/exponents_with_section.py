"""Lyapunov exponents and section points from one run, for non-periodic operating points."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.indicators.section_indicators import LEAST
from whirlmap.analysis.motion.divergence import ensemble_divergence, missed, off_zero
from whirlmap.analysis.motion.section_crossing import run_with_crossings
from whirlmap.analysis.variational.lyapunov import BLOCKS, in_phase, mean_and_error
from whirlmap.analysis.variational.tangent_accuracy import FINE, tuned
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.results.status import Status

Array = NDArray[np.float64]

#: Errors of the largest exponent at which its run stops: relative, and in units of 2 pi/T.
ENOUGH = (0.02, 0.002)
#: Error of every exponent over the largest one, or over 2 pi/T, at least: rounding.
ROUNDING = 1e-13
#: T in the first stretch of its run, which doubles until the error is small enough; T before, while vectors align.
FIRST_STRETCH, ALIGN = 512, 16


@dataclass(frozen=True)
class TangentRun:
    """Exponents of one operating point from many runs, and the section points that came with them.

    Attributes
    ----------
    value, error : array, shape (exponent,)
        Largest first, per unit of the model's time.
    running : array, shape (period, exponent)
        Mean up to each T.
    section : array, shape (time, state, run)
    alive : array of bool, shape (run,)
        Which runs reached the end.
    periods : int
        T.
    stopped : str
        Why the run stopped.
    rate : float
        2 pi/T, what an exponent is small against.
    divergence, divergence_error : float
        Mean divergence along the motion and one standard error.
    status : array of int, shape (run,)
        How each run ended.
    """

    value: Array
    error: Array
    running: Array
    section: Array
    alive: NDArray[np.bool_]
    periods: int
    stopped: str
    rate: float
    divergence: float
    divergence_error: float
    status: NDArray[np.int8]


def run_with_section(
    ensemble: Ensemble, periods: int, *, align: int, progress: Callable[[int], None] | None = None
) -> tuple[Array, Array]:
    """Local exponents of successive periods T, and the section points of the run.

    Parameters
    ----------
    ensemble : Ensemble
        On its attractor, with tangent vectors; advanced in place.
    periods : int
        T that count (for an unforced model: typical times).
    align : int
        Those run before, while the tangent vectors align.

    Returns
    -------
    rates : array, shape (period, exponent, point)
        Per unit of time; NaN in points that ended.
    section : array, shape (time, state, point)
        Once per T, or the crossings of an unforced model, as many as each point has: the rows beyond are NaN.
    """
    ensemble.advance(align, progress=progress)
    if ensemble.model.forced:
        segment = ensemble.advance(periods, save_periods=1, progress=progress)
        growth, section = segment.growth, segment.saved
    else:
        section, _, growth = run_with_crossings(ensemble, periods, progress=progress)
    rates = growth / ensemble.period
    rates[:, :, ensemble.status != Status.ok] = np.nan
    return rates, section


def _shared(section: Array, running: NDArray[np.bool_]) -> Array:
    """As many rows as all runs share that have at least `LEAST`; NaN in runs that have fewer."""
    count = np.isfinite(section[:, 0]).sum(axis=0)
    enough = count >= LEAST
    section = section[: count[enough & running].min(initial=section.shape[0]) if (enough & running).any() else 0].copy()
    section[:, :, count < section.shape[0]] = np.nan
    return section


def exponents_to_error(
    ensemble: Ensemble, *, least: int, most: int, multiple: int, progress: Callable[[int], None] | None = None
) -> TangentRun:
    """Run a perturbed ensemble of one operating point until the error of its largest exponent is small enough.

    Parameters
    ----------
    ensemble : Ensemble
        Start states on one attractor, with tangent vectors; stays as it is.
    multiple : int
        Common periods (of an unforced model: crossings) after which the motion returns, 0 where it does not.
    least, most : int
        T run at least, for the section, and at most; whole returns.

    Notes
    -----
    The run doubles until the error is below `ENOUGH` of the exponent, or of 2 pi/T. The error is the largest of the
    scatter between runs, the block error within them, a quarter of the difference between the halves of the record, which
    shows tangent vectors that have not aligned yet, and what the steps leave (`tangent_accuracy`); and of what the sum of
    all exponents misses of the mean divergence, and the time direction of a cycle of zero.
    """
    carried = tuned(ensemble, FINE, returns=multiple > 0)
    ensemble, floor = carried.ensemble, carried.of_ensemble
    rate = 2 * np.pi / float(ensemble.period.max())  # of one operating point
    pieces: list[Array] = []
    sections: list[Array] = []
    cycle = ensemble.strobe * max(multiple, 1) if ensemble.model.forced else 1  # whole returns: within one rates change
    whole = lambda periods: -(-periods // cycle) * cycle  # noqa: E731
    done, stretch = 0, min(whole(max(FIRST_STRETCH, BLOCKS, least)), whole(most))
    while True:
        rates, section = run_with_section(ensemble, stretch, align=0 if pieces else whole(ALIGN), progress=progress)
        pieces.append(rates)
        sections.append(_shared(section, ensemble.running))
        done += stretch
        rates = np.concatenate(pieces)
        good = ensemble.running
        value, error = _ensemble_mean(rates[:, :, good], cycle)
        if not good.any():
            reason = "no run went on to the end"
            break
        if error[0] <= max(ENOUGH[0] * abs(value[0]), ENOUGH[1] * rate):
            reason = "error small enough"
            break
        if done >= most:
            reason = f"stopped at {done} T"
            break
        stretch = min(done, max(whole(most) - done, cycle))
    divergence, spread = ensemble_divergence(ensemble, good, multiple)
    error = np.maximum(np.maximum(error, floor), ROUNDING * np.abs(value).max(initial=rate))
    order = np.argsort(-value)  # nearly equal exponents may come out of the kernel in either order
    value, error = value[order], missed(value[order], error[order], divergence, spread, ensemble.model.dimension)
    if multiple and not ensemble.model.forced:
        error = off_zero(value, error, float(ensemble.period.max()))
    mean = rates[:, order][:, :, good].mean(axis=2) if good.any() else np.full(rates.shape[:2], np.nan)
    running = np.cumsum(mean, axis=0) / np.arange(1, done + 1)[:, None]
    return TangentRun(
        value, error, running, np.concatenate(sections), good, done, reason, rate, divergence, spread, ensemble.status
    )  # fmt: skip


def _ensemble_mean(rates: Array, cycle: int) -> tuple[Array, Array]:
    """Mean over runs, and its error, of rates per T, of which the forcing or the motion repeats after so many."""
    if rates.shape[2] == 0:
        return np.full(rates.shape[1], np.nan), np.full(rates.shape[1], np.nan)
    means, errors = mean_and_error(rates, cycle)
    runs = means.shape[1]
    within = np.sqrt((errors**2).sum(axis=1)) / runs
    between = means.std(axis=1, ddof=1) / np.sqrt(runs) if runs > 1 else within
    half = rates.shape[0] // 2
    drift = np.abs(rates[:half].mean(axis=(0, 2)) - rates[half:].mean(axis=(0, 2))) / 4
    return means.mean(axis=1), np.max([within, between, drift, in_phase(rates, cycle)], axis=0)
