"""Mean divergence along a motion: the mean trace of the Jacobian, which the sum of all Lyapunov exponents must equal.

It needs no tangent vectors, so that it checks them (Liouville's formula): all exponents add up to it. Where only the largest
were measured it bounds them from below, since no exponent that was not measured exceeds the smallest that was.
"""

from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.equations.model import Model
from whirlmap.integrate.division import variants
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.evaluation import Evaluator
from whirlmap.kernels.lowering.surfaces import sided

Array = NDArray[np.float64]

#: Growth in T of a perturbation along an unforced motion that is taken for an error of the integration.
ZERO = 1e-3
#: Parts of a record whose means give the error, and steps that are kept, and evaluated, at once.
PARTS, TOGETHER = 8, 4096
#: T of the record of a perturbed ensemble, about.
LENGTH = 128
#: Errors that a sum of exponents may be away from the mean divergence.
SURE = 3.0


def mean_divergence(ensemble: Ensemble, periods: int) -> tuple[Array, Array]:
    """Mean of the trace of the Jacobian from the present states on, and its standard error.

    Parameters
    ----------
    ensemble : Ensemble
        Stays as it is.
    periods : int
        Common periods of the record: a whole number of returns where the motion returns.

    Returns
    -------
    mean, error : array, shape (point,)
        Per unit of time; NaN in points that end before, and for models whose rates jump, where volumes change at once.

    Notes
    -----
    Trapezoidal rule over the steps. The error is that of `PARTS` part means; zero where the trace is constant.
    """
    sums = np.zeros((PARTS, ensemble.points))
    length = max(-(-periods // PARTS), 1)
    constant = np.zeros(ensemble.points, dtype=bool)
    run = _without_vectors(ensemble)
    for form, members in variants(ensemble.model, ensemble.values):
        trace = _Trace(form, ensemble.values[:, members])
        if trace.jumps:
            sums[:, members] = np.nan
            continue
        if trace.constant:
            sums[:, members], constant[members] = trace(0.0, ensemble.x[:, members], np.arange(members.size)), True
            continue
        for steps in np.unique(run.point_steps[members]):
            local = np.flatnonzero(run.point_steps[members] == steps)
            for part in range(PARTS):
                sums[part, members[local]] = _mean(run, members[local], local, int(steps), length, trace)
    mean, error = sums.mean(axis=0), sums.std(axis=0, ddof=1) / np.sqrt(PARTS)
    bad = ~run.running
    mean[bad], error[bad], error[constant] = np.nan, np.nan, 0.0
    return mean, error


def shrinks_areas(ensemble: Ensemble) -> NDArray[np.bool_]:
    """Whether a forced model of two states, none an angle, has a constant negative divergence, shape (point,).

    No invariant curve of its section encloses an area then, for the area would shrink: there is no torus.
    """
    out = np.zeros(ensemble.points, dtype=bool)
    model = ensemble.model
    if not model.forced or model.dimension != 2 or any(s.cyclic is not None for s in model.states):
        return out
    for form, members in variants(model, ensemble.values):
        trace = _Trace(form, ensemble.values[:, members])
        if trace.constant and not trace.jumps:
            out[members] = trace(0.0, ensemble.x[:, members], np.arange(members.size)) < 0
    return out


def ensemble_divergence(ensemble: Ensemble, good: NDArray[np.bool_], multiple: int = 0) -> tuple[float, float]:
    """Mean divergence over the good runs of a perturbed ensemble and its standard error, over whole returns."""
    if not good.any():
        return np.nan, np.nan
    whole = max(multiple, 1)
    length = max(LENGTH // (ensemble.strobe * whole), 1) * whole
    mean, error = mean_divergence(ensemble.subset(np.flatnonzero(good)), length)
    seen = np.isfinite(mean)
    if not seen.any():
        return np.nan, np.nan
    between = mean[seen].std() / np.sqrt(seen.sum())
    return float(mean[seen].mean()), float(max(np.sqrt((error[seen] ** 2).sum()) / seen.sum(), between))


def missed(value: Array, error: Array, divergence: float, spread: float, dimension: int) -> Array:
    """Errors of exponents that are no smaller than what their sum misses of the mean divergence.

    Parameters
    ----------
    value, error : array, shape (exponent,)
        Largest first, with their standard errors.
    divergence, spread : float
        Mean divergence and its standard error; the errors stay where it is NaN.
    dimension : int
        Number of all exponents. Where fewer were measured, the others are at most as large as the last of them, so that only
        a sum that leaves too little room misses something.
    """
    if not (np.isfinite(divergence) and np.isfinite(value).all()):
        return error
    left = dimension - value.size
    gap = divergence - value.sum() - left * value[-1]
    gap = max(gap, 0.0) if left else abs(gap)
    doubt = SURE * np.hypot(np.linalg.norm(error[:-1]), np.hypot((1 + left) * error[-1], spread))
    return np.maximum(error, gap / (1 + left)) if gap > doubt else error


def off_zero(value: Array, error: Array, period: float) -> Array:
    """Errors of the exponents of a cycle that are no smaller than what the exponent of its time direction misses of zero.

    Parameters
    ----------
    value, error : array, shape (exponent,)
        Of an unforced motion that returns: one exponent is zero.
    period : float
        T. An exponent further from zero than `ZERO` over it is another one: that of an orbit that repels.
    """
    least = float(np.abs(value).min(initial=np.inf))
    return np.maximum(error, least) if least < ZERO / period else error


def _without_vectors(ensemble: Ensemble) -> Ensemble:
    made = Ensemble(
        ensemble.model, ensemble.values, ensemble.x.copy(), orders=ensemble.orders, steps=ensemble.point_steps,
        method=ensemble.method, workers=ensemble.workers, turn=ensemble.period, beyond=ensemble.limits,
    )  # fmt: skip
    made.status[:] = ensemble.status
    return made


def _mean(
    run: Ensemble, points: NDArray[np.intp], local: NDArray[np.intp], steps: int, length: int, trace: "_Trace"
) -> Array:
    """Mean over the next ``length`` common periods of some points that share their steps."""
    common = run.strobe
    total, left, turns = np.zeros(points.size), length, max(TOGETHER // (steps * common * points.size), 1)
    while left:
        now = min(turns, left)
        begin, x = run.turns[points] * run.period[points], run.x[None, :, points]
        saved = run.advance(now * common, members=points, save_periods=Fraction(1, steps)).saved
        path = np.concatenate([x, saved])
        times = begin + np.arange(len(path))[:, None] * (run.period[points] / steps)
        values = trace(times.ravel(), np.moveaxis(path, 1, 0).reshape(path.shape[1], -1), np.tile(local, len(path)))
        values = values.reshape(len(path), points.size)
        total += values[1:-1].sum(axis=0) + (values[0] + values[-1]) / 2
        left -= now
    return total / (length * common * steps)


class _Trace:
    """Trace of the Jacobian of a model at many operating points."""

    def __init__(self, model: Model, values: Array) -> None:
        self.evaluate = Evaluator.of(model, values, jacobian=True)
        source = self.evaluate.kernel.source
        self.jumps = source.sizes.surfaces > 0 and any(sided(model).jumps)
        self.constant = not any(term.row == term.column and term.kind == "slot" for term in source.entries)

    def __call__(self, time: ArrayLike, x: Array, points: NDArray[np.intp]) -> Array:
        """Evaluate, shape (column,), for columns of the points given."""
        parts = [slice(k, k + TOGETHER) for k in range(0, x.shape[1], TOGETHER)]
        when = np.broadcast_to(np.asarray(time, dtype=float), points.shape)
        return np.concatenate([self.evaluate.trace(when[part], x[:, part], points[part]) for part in parts])
