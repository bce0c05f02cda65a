"""Lengths of series and records where the forcing hardly ever repeats: two hunting pairs, 37/113 and 29/71 teeth."""

from fractions import Fraction

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.diagnosis.perturbed_ensemble import record_series
from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.analysis.motion.record_length import (
    LONGEST,
    LONGEST_SETTLED,
    NUMBERS,
    record_periods,
    recorded,
    settled_periods,
    shown_periods,
    slowest_turn,
    spectrum_periods,
    turns_per_T,
)
from whirlmap.analysis.spectra.line_names import named_shares
from whirlmap.analysis.spectra.spectral_lines import spectral_lines
from whirlmap.analysis.spectra.spectrum import power_spectrum
from whirlmap.equations import Model, Parameter, State, cos, t
from whirlmap.integrate import ensemble as ensembles
from whirlmap.integrate.accuracy import choose_steps
from whirlmap.integrate.system import System
from whirlmap.sweep.diagrams.waterfall import waterfall

x, v = State("x", "1", "deflection"), State("v", "1", "its rate")
zeta = Parameter("zeta", "1", "damping", above=0)
k = Parameter("k", "1", "stiffness", above=0)
pinion, gear, third = (Parameter(name, "1", "order", order=True) for name in ("pinion", "gear", "third"))
SIZES = {"mesh": 1.0, "pinion": 0.5, "gear": 0.25, "third": 0.1}

HUNTING = Model(
    name="hunting",
    states=(x, v),
    parameters=(zeta, k, pinion, gear, third),
    equations={
        x: v,
        v: cos(t) + 0.5 * cos(pinion * t) + 0.25 * cos(gear * t) + 0.1 * cos(third * t) - 2 * zeta * v - k * x,
    },
    harmonics=(1, pinion, gear, third),
    clocks={"mesh": 1, "pinion": pinion, "gear": gear, "third": third},
    swing=(x,),
)
ORDERS = {"pinion": Fraction(1, 37), "gear": Fraction(-1, 113), "third": Fraction(1, 71)}
CLOCKS = {"mesh": 1, **ORDERS}


def hunting(**changes):
    return System(HUNTING, {"zeta": 0.1, "k": 0.3, **ORDERS, **changes})


def amplitudes(stiffness=0.3):
    """Of x at each clock, by the frequency response."""
    w = np.array([abs(float(order)) for order in CLOCKS.values()])
    return np.array(list(SIZES.values())) / np.hypot(stiffness - w**2, 0.2 * w)


def test_lengths_are_turns_of_the_slowest_clock():
    system = hunting()
    assert system.common_multiple == 37 * 113 * 71
    assert slowest_turn(system) == pytest.approx(113, rel=1e-14)
    assert settled_periods(system) == 200 * 113
    assert settled_periods(hunting(gear=Fraction(1, 10**7))) == LONGEST_SETTLED
    assert shown_periods(system, 100) == 20 * 113
    assert spectrum_periods(system, 512) == 16 * 113  # no whole common period: it would be 164 times as long
    assert shown_periods(hunting(gear=Fraction(1, 10**9)), 100) * 100 * 2 <= NUMBERS
    assert spectrum_periods(hunting(gear=Fraction(1, 10**9)), 512) == LONGEST


def test_the_record_of_a_point_holds_turns_of_the_slowest_harmonic():
    orders = tuple(ORDERS.values())
    assert record_periods((Fraction(1), *orders), 64) == 2 * 113
    assert record_periods((Fraction(1), *orders), 64, turns=8) == 8 * 113
    assert record_periods((Fraction(1), *orders), 1000) == 1000
    assert record_periods((Fraction(1), Fraction(1, 10**6)), 64) == 8192
    assert record_periods((Fraction(1), Fraction(1, 100)), 64, turns=8) == 200  # common periods
    assert record_periods((), 64) == 64


def test_a_record_holds_whole_common_periods_where_these_are_short():
    reference, gearbox = whirlmap.load("gear-psfd/reference"), whirlmap.load("machines/turbo-gearbox")
    assert reference.common_multiple == 8 and spectrum_periods(reference, 509) == 512
    assert gearbox.common_multiple == 93 and spectrum_periods(gearbox, 512) == 16 * 93
    assert shown_periods(whirlmap.load("duffing"), 100) == 20
    assert spectrum_periods(whirlmap.load("lorenz"), 512) == 512


def test_lines_of_a_record_stand_at_the_forcings_orders_with_the_amplitudes_of_the_response():
    """Hann's window: off a bin a line keeps its place to 0.02 steps, and its power summed over the lobe to a percent."""
    system = hunting()
    ds = whirlmap.simulate(system, periods=spectrum_periods(system, 512), transient=100, every=5)
    series = ds["x"].sel(state="x").values[:-1]
    spectrum = power_spectrum(series, rate=20)
    lines, step = spectral_lines(spectrum), float(spectrum["frequency_step"])
    order = np.argsort(-amplitudes())
    expected = np.array([abs(float(o)) for o in CLOCKS.values()])[order]
    assert int(lines["count"]) == 4 and float(lines["broadband_fraction"]) < 1e-4
    np.testing.assert_allclose(lines["line_frequency"], expected, rtol=0, atol=0.02 * step)
    np.testing.assert_allclose(np.sqrt(2 * lines["line_power"]), amplitudes()[order], rtol=5e-3)
    named = named_shares(lines, turns_per_T(system), step=step)
    assert [one["name"] for one in named] == [list(CLOCKS)[i] for i in order]


def test_the_record_of_a_diagnosis_names_its_lines():
    system = hunting()
    part, _ = make_ensemble(system)
    part.advance(100)
    data, coords = {}, {}
    vote = record_series(system, part, 512, data, coords, turns_per_T(system))
    assert vote["vote"] == "lines"
    assert {line["name"] for line in vote["named"]} == set(CLOCKS)
    assert len(coords["turn"][1]) == 16 * 113 * 32


def test_a_waterfall_of_two_hunting_pairs():
    """At the mesh, which stands on a bin, the amplitude is that of the response at every stiffness."""
    stiffness = np.array([0.2, 0.4])
    ds = waterfall(hunting(), "k", stiffness, "x", transient=100)
    assert ds.attrs["window"] == "hann" and float(ds["frequency_step"]) == pytest.approx(1 / (8 * 113))
    found = np.sqrt(2 * ds["power"].sel(frequency=1.0, method="nearest"))
    np.testing.assert_allclose(found, 1 / np.hypot(stiffness - 1, 0.2), rtol=1e-4)


def test_stretches_of_a_record_change_nothing(monkeypatch):
    system, every = hunting(), Fraction(1, 4)
    one, other = (make_ensemble(system, {"k": [0.3, 0.5]}, steps=16)[0] for _ in range(2))
    whole = one.advance(50, save_periods=every).saved[:, [0]]
    monkeypatch.setattr("whirlmap.analysis.motion.record_length.KEPT", 16 * 4 * 7)
    np.testing.assert_array_equal(recorded(other, 50, every, [0]), whole)


def test_trials_do_not_wait_for_the_common_period():
    system, done = hunting(), []
    ensemble, _ = make_ensemble(system, steps=16)
    assert ensemble.rung_periods == 128
    choose_steps(ensemble, 1e-6, progress=done.append)
    assert max(done) == 128


def test_trials_of_several_sections_at_different_phases(monkeypatch):
    """The error over three stretches is the largest of those over each, from where the motion stands then."""
    monkeypatch.setattr(ensembles, "RUNG", 5)
    monkeypatch.setattr(ensembles, "LONG_RUNG", 20)
    ensemble, _ = make_ensemble(hunting(zeta=0.02), steps=24)
    together = choose_steps(ensemble, 1e-9, sections=3)
    each = []
    for _ in range(3):
        each.append(choose_steps(ensemble, 1e-9, least=together.steps))
        ensemble.advance(20)
    assert [int(one.steps[0]) <= int(together.steps[0]) for one in each] == [True] * 3
    assert together.error[0] == pytest.approx(max(one.error[0] for one in each), rel=1e-9)


def test_an_order_that_is_not_resolved_leaves_the_others_their_names():
    """279 T of a machine whose gear turns in 93 T: fractions of that cannot be told apart, the pinion's line can."""
    time = np.arange(279 * 8) / 8
    series = np.cos(2 * np.pi * time / 31) + 0.02 * np.cos(2 * np.pi * time + 1)
    spectrum = power_spectrum(series, rate=8)
    orders = {"mesh": 1.0, "pinion": 1 / 31, "gear": -1 / 93}
    found = named_shares(spectral_lines(spectrum), orders, step=float(spectrum["frequency_step"]))
    assert [one["name"] for one in found] == ["pinion", "mesh"]
