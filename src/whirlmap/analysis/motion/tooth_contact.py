"""Whether the teeth of a mesh stay in contact over a settled motion."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.equations.quantities import t
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.kernels.lowering.formulas import Formula, numpy_function
from whirlmap.kernels.writing.routine import LANES

Array = NDArray[np.float64]

#: Least steps per T at which tooth contact is evaluated.
LEAST_STEPS = 48
#: Numbers of saved states that are in memory at once.
KEPT = 8_000_000


def tooth_contact(ensemble: Ensemble, periods: NDArray[np.int64], progress: Callable[[int], None] | None = None) -> Array:
    """Share of the time in which the driving flanks press on each other (`Model.teeth`), from the present states on.

    Parameters
    ----------
    ensemble : Ensemble
        Points of a model with teeth, so many T after phase zero as its ``turns`` say. It is left where it is.
    periods : array of int, shape (point,)
        T to evaluate: one return of a periodic motion, some turns of the slowest clock of another one; 0 where no contact is
        asked for.

    Returns
    -------
    array, shape (point,)
        Exactly 1 only where the teeth touch at every one of at least `LEAST_STEPS` steps per T. NaN where nothing was
        asked or the run ended.
    """
    steps = np.maximum(ensemble.point_steps, LEAST_STEPS)
    deflection = _deflection(ensemble.model)
    out = np.full(ensemble.points, np.nan)
    for count, length in np.unique(np.stack([steps, periods])[:, (periods > 0) & ensemble.running], axis=1).T.tolist():
        members = np.flatnonzero((steps == count) & (periods == length) & ensemble.running)
        size = max(KEPT // (count * length * ensemble.model.dimension), LANES)
        for part in np.split(members, np.arange(size, members.size, size)):
            run = ensemble.subset(part, steps=count)
            x = run.advance(length, save_every=1, progress=progress).saved
            time = (np.arange(1, x.shape[0] + 1)[:, None] / count + ensemble.turns[part]) * run.period
            pressed = np.broadcast_to(deflection(time, list(np.moveaxis(x, 1, 0)), list(run.values))[0], time.shape) > 0
            out[part] = np.where(run.running, pressed.mean(axis=0), np.nan)
    return out


def _deflection(model: Model) -> Callable[..., Sequence[Any]]:
    return numpy_function(model, "teeth", lambda: Formula([t, model.states, model.parameters], [model.teeth]))
