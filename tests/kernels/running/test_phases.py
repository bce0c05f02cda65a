"""Phases of harmonics are exact however long a cycle or a run is."""

from fractions import Fraction

import numpy as np
import pytest

from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.equations import Model, Parameter, State, Stop, cos, sin, t
from whirlmap.errors import RangeError
from whirlmap.integrate.system import System
from whirlmap.kernels.running import lanes
from whirlmap.kernels.running.lanes import HarmonicTables
from whirlmap.results.status import Status

x, v = State("x", "1", "deflection"), State("v", "1", "its rate")
limit = Parameter("limit", "1", "where it is stopped", above=0)
a, b = (Parameter(name, "1", "order", order=True) for name in "ab")

OSCILLATOR = Model(
    name="long_cycles",
    states=(x, v),
    parameters=(limit, a, b),
    equations={x: v, v: cos(t) + cos(a * t) + sin(b * t) - 0.2 * v - 2 * x},
    harmonics=(1, a, b),
    stops={"wall": Stop(limit - x, "the wall")},
)
GOLDEN, LONG = Fraction(618033988749, 10**12), Fraction(-29, 71 * 97 * 101)


def oscillator(limit=1e3, a=GOLDEN, b=LONG):
    return System(OSCILLATOR, {"limit": limit, "a": a, "b": b})


def truth(system, turn):
    """Settled x after exactly so many T."""
    forces = {Fraction(1): 1, system.values["a"]: 1, system.values["b"]: -1j}
    phases = [(w, f, 2 * np.pi * float(w * turn % 1)) for w, f in forces.items()]
    return sum((f * np.exp(1j * at) / (2 - float(w) ** 2 + 0.2j * float(w))).real for w, f, at in phases)


def test_no_phase_is_lost_after_a_hundred_thousand_T():
    """Orders with 1e12 and 7e5 in their denominators, against the frequency response at the exact phase."""
    system = oscillator()
    ensemble, _ = make_ensemble(system, steps=96)
    assert ensemble.common_multiple > 1e17
    ensemble.advance(100_000)
    saved = ensemble.advance(2, save_every=1).saved[:, 0, 0]
    expected = [truth(system, 100_000 + Fraction(n + 1, 96)) for n in range(saved.size)]
    np.testing.assert_allclose(saved, expected, rtol=0, atol=1e-13)


def test_a_common_period_beyond_64_bits():
    system = oscillator(b=Fraction(10**9 + 7, 10**10 + 19))
    ensemble, _ = make_ensemble(system, steps=32)
    assert ensemble.common_multiple > 2**63
    ensemble.advance(60)
    assert ensemble.x[0, 0] == pytest.approx(truth(system, 60), abs=1e-9)


@pytest.mark.parametrize("tangents", [0, 1, 2])
def test_counted_phases_are_those_of_a_table(monkeypatch, tangents):
    """The same short cycles, read from tables and counted; begun in the middle of a cycle too."""
    system = oscillator(a=Fraction(3, 7), b=Fraction(-2, 5))
    found = []
    for longest in (lanes.LONGEST, 1):
        monkeypatch.setattr(lanes, "LONGEST", longest)
        ensemble, _ = make_ensemble(system, steps=16, tangents=tangents)
        assert ensemble._groups[0].harmonic_tables.far.tolist() == [[int(longest == 1)]] * 3
        first = ensemble.advance(9, extremes="between")
        ensemble.advance(11)
        found.append((ensemble.x, ensemble.vectors, *first.extremes.values()))
    for near, far in zip(*found, strict=True):
        np.testing.assert_allclose(far, near, rtol=0, atol=1e-13)


def test_an_end_is_located_at_the_exact_phase_however_late():
    """A run into a stop, from phase zero and from 1e9 common periods later: the same state, to rounding."""
    system = oscillator(limit=0.8, a=Fraction(3, 7), b=Fraction(-2, 5))
    early, _ = make_ensemble(system, steps=24)
    late, _ = make_ensemble(system, steps=24)
    late.turns[:] = 35 * 10**9
    for ensemble in (early, late):
        ensemble.advance(40)
        assert ensemble.status[0] == Status.contact
    np.testing.assert_allclose(late.x, early.x, rtol=0, atol=1e-13)
    assert early.x[0, 0] == pytest.approx(0.8, abs=1e-12)


def test_angles_within_a_step():
    steps, turns, done = np.full(2, 48), np.array([0, 10**8]), np.array([0, 7])
    waves = HarmonicTables.of((Fraction(1), GOLDEN, LONG), steps, (0.0, 0.5))
    step, part = steps * turns + done, np.array([0.25, 0.75])
    for row, order in zip(waves.angles(steps, turns, done, part), waves.orders, strict=True):
        turns = [order * (n + Fraction(p)) / 48 % 1 for n, p in zip(step.tolist(), part.tolist(), strict=True)]
        away = row / (2 * np.pi) - np.array([float(turn) for turn in turns])
        np.testing.assert_allclose(away - np.rint(away), 0, atol=1e-15)


def test_orders_that_cannot_be_counted_are_refused():
    with pytest.raises(RangeError, match="smaller integers"):
        HarmonicTables.of((Fraction(1), Fraction(1, 10**18)), np.array([100]), (0.0,))
