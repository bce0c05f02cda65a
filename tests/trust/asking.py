"""What whirlmap says about an operating point, through its public functions, in a form that a truth can be held against.

The tests of this folder hold whirlmap against truths that it had no part in:

| file | what is asked | where the truth comes from |
|---|---|---|
| test_kinks_and_jumps | friction, stops, backlash, relays, switched stiffness, rub | `truth_orbits`: event location |
| test_blind_oscillators | twenty oscillators drawn at random | the same, at test time |
| test_ends_of_runs | contact, growth and escape that come late | the same; SciPy's events for times |
| test_scaled_twins | the same systems in metres, micrometres, nanoseconds | the unscaled twin, and closed forms |
| test_unforced_cycles | cycles, stiff, with kinks and sliding | closed forms, `truth_cycles` (Radau, DOP853), events |
| test_exponents_exact | exponents and their errors | closed forms, Liouville, monodromy matrices, saltation |
| test_two_frequencies | sweeps of one of several frequencies | superposition in closed form (`truth_linear`), SciPy |
| test_extremes | extremes, means, rms between the steps | closed forms, SciPy's interpolant |
| test_rest_drift_poles | rest, drift, growth, poles | equilibria, closed forms, Hill and Meissner, SciPy |
| test_blind_labels | eighty labels that are hard to tell | closed forms, Newton and long runs of `blind_truth` |

Event location is SciPy's, with a new start at every surface, saltation matrices, and sliding by Filippov's rule; the dead
zone is also solved in closed form (`tests/independent/dead_zone.py`).

Models stand in `kinked_models`, `unforced_models` and `scaled_models`, or in the test where only it needs them, as users
write them; where a truth has equations of its own, a test holds the two against each other at random states. Numbers that
take long are kept (`numbers.json`, `numbers_late.json`, tables in the tests), and slow tests compute them anew. A quantity
may be refused, in a sentence, where the test says so (a jump without saltation), and a
run may end as `sticks` where the truth slides. A wrong label or number may not come out anywhere.
"""

from dataclasses import dataclass

import numpy as np
import pytest

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


def some(names, quick):
    """All names as parameters of a test, those that are not in ``quick`` marked slow."""
    return [pytest.param(n, id=str(n), marks=() if n in quick else pytest.mark.slow) for n in names]


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
