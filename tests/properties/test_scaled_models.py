"""Models in other units: lengths in nanometres, time in microseconds. A twin has the labels and the numbers of its original.

The twin of a model is declared by substitution: each state that is a length is ``length`` times as large a number, each
velocity ``length / time`` times, and the clock counts ``time`` times as many units.
"""

from dataclasses import replace
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from sympy import Rational, sympify

import whirlmap
from whirlmap.analysis.steady.settling import Settling
from whirlmap.equations import State, t
from whirlmap.integrate.system import System
from whirlmap.results.regime import Regime
from whirlmap.sweep.points.label_points import label_points

#: Case, replaced values, varied parameter, its range: oscillators and rotors, forced and not.
CASES = {
    "duffing": ({}, "gamma", 0.2, 0.65),
    "pendulum": ({}, "g", 0.9, 1.5),
    "van_der_pol": ({}, "omega", 0.6, 1.6),
    "gear_backlash": ({"zeta": 0.1}, "Omega", 0.6, 1.4),
    "jeffcott": ({"b": 0.1}, "s", 0.6, 1.6),
    "gear-psfd/reference": ({"psi": 0.0}, "s", 0.5, 3.5),
    "lorenz": ({}, "rho", 20.0, 160.0),
    "roessler": ({}, "c", 2.5, 6.0),
}
QUICK = [(Fraction(1, 10**9), Fraction(10**6)), (Fraction(1000), Fraction(1, 10**6))]
LENGTHS, TIMES = (tuple(map(Fraction, f)) for f in (("1e-9", "1e-6", "1e3", "1"), ("1e-6", "1e6", "1")))
SLOW = [(length, time) for length in LENGTHS for time in TIMES]


def original(case):
    changes, *_ = CASES[case]
    system = whirlmap.load(case).replace(**changes)
    # Films serve the linear analysis alone; a declared bound would have to be rewritten by hand.
    return System(replace(system.plain_model(), films={}, plain={}, bound=None), system.values, system.start)


def twin(system, length, time):
    """The system in other units, and what the numbers of its states are multiplied by."""
    model = system.model
    factor = {s: Fraction(1) if s.cyclic else length for s in model.states}
    for s, rate in model.equations.items():
        if rate in model.states:
            factor[rate] = factor[s] / time
    exact = {s: Rational(f.numerator, f.denominator) for s, f in factor.items()}
    clock = Rational(time.numerator, time.denominator)
    new = {
        s: State(s.name, s.unit, s.meaning, start=s.start * float(factor[s]), cyclic=s.cyclic) for s in model.states
    }  # fmt: skip
    into = {**{s: new[s] / exact[s] for s in model.states}, t: t / clock}

    def told(e):
        return sympify(e).xreplace(into)

    made = replace(
        model, name=f"{model.name}-twin", states=tuple(new.values()),
        equations={new[s]: told(rate) * exact[s] / clock for s, rate in model.equations.items()},
        harmonics=tuple(sympify(w) / clock for w in model.harmonics), clocks={},
        outputs={n: replace(o, expression=told(o.expression)) for n, o in model.outputs.items()},
        stops={n: replace(s, gap=told(s.gap)) for n, s in model.stops.items()},
        switchings={n: replace(q, surface=told(q.surface)) for n, q in model.switchings.items()},
        teeth=None, section=model.section and replace(model.section, surface=told(model.section.surface)),
        typical_time=sympify(model.typical_time) * clock, swing=tuple(new[s] for s in model.swing),
        start_where_none={new[s]: v * float(factor[s]) for s, v in model.start_where_none.items()},
    )  # fmt: skip
    start = {name: value * float(factor[model.state(name)]) for name, value in system.start.items()}
    return System(made, system.values, start), np.array([float(factor[s]) for s in model.states])


@cache
def ours_of(case, count):
    """The original of a case and its labels, computed once for all units."""
    system = original(case)
    return system, labelled(system, case, count)


def labelled(system, case, count):
    _, name, low, high = CASES[case]
    values = np.linspace(low, high, count)
    settling = Settling(transient=200) if system.model.forced else Settling(transient=100, most=32)
    return label_points(system, {name: values}, settling=settling)


def compare(case, length, time, count, moved):
    """Labels and numbers; ``moved`` points at most may come out otherwise, at a boundary between regimes."""
    system, ours = ours_of(case, count)
    other, factor = twin(system, length, time)
    theirs = labelled(other, case, count)
    same = np.ones(count, dtype=bool)
    for name in ("regime", "status", "period_T", "period_common"):
        same &= ours[name].values == theirs[name].values
    assert (~same).sum() <= moved, [
        (float(ours[CASES[case][1]][i]), *(f"{d['regime'].values[i]}/{d['period_T'].values[i]}" for d in (ours, theirs)))
        for i in np.flatnonzero(~same)
    ]
    regime = ours["regime"].values
    # A chaotic transient ends on one of several motions (mirrored, or whole turns apart), after a time and with an exponent
    # on the way that roundings decide.
    regular = same & (regime == Regime.periodic) & (ours["settled_after"].values == theirs["settled_after"].values)
    exponents = float(time) * theirs["lyapunov"].values, ours["lyapunov"].values
    regular &= np.isclose(*exponents, rtol=1e-6, atol=0, equal_nan=True)
    assert not (regime == Regime.periodic).any() or regular.sum() >= 0.8 * (regime == Regime.periodic).sum()
    states = len(factor)
    size = ours["peak_to_peak"].values[:, :states]
    for name in ("minimum", "maximum", "mean", "rms"):
        apart = np.abs(theirs[name].values[:, :states] / factor - ours[name].values[:, :states])
        assert (apart[regular] <= 1e-6 * size[regular].max(axis=0, initial=0)).all(), (name, case)
    chaotic = same & (regime == Regime.chaotic)
    scaled = float(time) * theirs["lyapunov"].values, float(time) * theirs["lyapunov_error"].values
    apart = np.abs(scaled[0] - ours["lyapunov"].values)[chaotic]
    assert (apart <= 3 * np.hypot(scaled[1], ours["lyapunov_error"].values)[chaotic]).mean() > 0.9 if chaotic.any() else True
    return same


@pytest.mark.parametrize("case", [c for c in CASES if c != "gear-psfd/reference"])
def test_a_model_in_other_units_has_the_same_labels(case):
    for length, time in QUICK:
        compare(case, length, time, 24, 0)


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize(("length", "time"), SLOW[:-1])
def test_a_model_in_any_units_has_the_same_labels(case, length, time):
    """Other roundings move the end of chaotic transients: one point in 200 at most."""
    compare(case, length, time, 200, 1)
