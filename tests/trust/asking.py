"""What whirlmap says about an operating point, through its public functions, in a form that a truth can be held against."""

from dataclasses import dataclass

import numpy as np

import whirlmap
from whirlmap.errors import WhirlmapError
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status

#: Errors that extremes may have, over their range (issue: read from the interpolant), and states of an orbit at phase zero.
EXTREME, STATE = 2e-5, 1e-5


@dataclass(frozen=True)
class Refused:
    """A quantity was refused, in a sentence."""

    sentence: str

    @property
    def names_the_jump(self):
        return any(word in self.sentence.lower() for word in ("jump", "saltation", "stick", "slid"))


def asked(call, *args, **options):
    """The answer, or the sentence by which it is refused; anything else that is raised is a fault."""
    try:
        return call(*args, **options)
    except WhirlmapError as error:
        assert len(str(error)) > 20, f"a refusal without a sentence: {error!r}"
        return Refused(str(error))


def load(model, values, start):
    return whirlmap.load(model, start=dict(zip((s.name for s in model.states), start, strict=True)), **values)


def label(ds, at=()):
    """``2T``, ``chaotic``, ``sticks`` ...: the status where the run ended early, else the regime with its period."""
    status = Status(int(np.asarray(ds["status"])[at]))
    if status.name in ("sticks", "unresolved", "failed"):
        return status.name
    regime = Regime(int(np.asarray(ds["regime"])[at])).label
    return f"{int(np.asarray(ds['period_T'])[at])}T" if regime == "periodic" else regime


def diagram(system, **options):
    """Bifurcation diagram of the one point."""
    name = system.parameters[0]
    options = {"lyapunov": 0, **options}
    return whirlmap.bifurcation_diagram(system, name, [float(system.values[name])], states=list(system.states), **options)


def extreme_error(ds, states, low, high):
    """Largest error of the extremes over the range of the state."""
    low, high = np.asarray(low), np.asarray(high)
    found = [ds[name].sel(quantity=list(states)).values.reshape(-1, len(low))[0] for name in ("minimum", "maximum")]
    return float(np.max(np.abs(np.array(found) - [low, high]) / (high - low)))
