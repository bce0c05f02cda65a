"""Bifurcation diagrams: the labels of single points, whatever the company."""

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.steady.settling import Settling
from whirlmap.errors import InputError, RangeError
from whirlmap.integrate.ranges import Range
from whirlmap.results.regime import Regime
from whirlmap.sweep.diagrams.diagram import bifurcation_diagram

GAMMA = np.array([0.20, 0.28, 0.29, 0.37, 0.50, 0.65])


@pytest.fixture(scope="module")
def ladder():
    return bifurcation_diagram(whirlmap.load("duffing"), "gamma", GAMMA, settling=Settling(transient=200), lyapunov=400)


def test_the_ladder_of_duffing(ladder):
    assert ladder["period_T"].values.tolist() == [1, 2, 4, 5, 0, 2]
    assert ladder["regime"].values.tolist() == [Regime.periodic] * 4 + [Regime.chaotic, Regime.periodic]
    assert (ladder["confidence"].values > 0.6).all()
    assert ladder["lyapunov"].values[4] > 3 * ladder["lyapunov_error"].values[4] > 0
    assert np.isnan(ladder["lyapunov"].values[[0, 1, 2, 3, 5]]).all()


def test_nonperiodic_points_are_labelled_only_with_evidence():
    """Without exponents a point that does not return stays undecided; a torus needs its winding."""
    system, at = whirlmap.load("van_der_pol"), np.array([0.93, 1.387, 2.1])
    bare = bifurcation_diagram(system, "omega", at, lyapunov=0)
    assert bare["regime"].values.tolist() == [Regime.periodic, Regime.undecided, Regime.undecided]
    ds = bifurcation_diagram(system, "omega", at, lyapunov=1024)
    assert ds["regime"].values.tolist() == [Regime.periodic, Regime.quasi_periodic, Regime.quasi_periodic]
    assert np.isfinite(ds["rotation_number"].values).tolist() == [False, True, True]
    alone = bifurcation_diagram(system, "omega", at[1:2], lyapunov=1024)
    for name in ("lyapunov", "rotation_number", "confidence"):
        assert alone[name].values[0] == ds[name].values[1]


def test_points_that_contract_slowly_are_given_their_time():
    """Pendulum near g = 1.2677: contracts by 7 % a period and does not return in the first windows."""
    system, at = whirlmap.load("pendulum"), np.linspace(0.9, 1.5, 32)[[19, 27, 29]]
    ds = bifurcation_diagram(system, "g", at, lyapunov=512)
    assert (ds["regime"].values == Regime.periodic).all()
    assert (ds["period_T"].values > 0).all() and np.isfinite(ds["section"].values).all()


def test_a_point_alone_has_the_same_bits(ladder):
    alone = bifurcation_diagram(whirlmap.load("duffing"), "gamma", GAMMA[2:3], settling=Settling(transient=200))
    np.testing.assert_array_equal(alone["section"].values[0], ladder["section"].values[2])


def test_workers_do_not_change_a_bit(ladder):
    again = bifurcation_diagram(
        whirlmap.load("duffing"), "gamma", np.linspace(0.2, 0.65, 70), settling=Settling(transient=20), workers=2
    )
    one = bifurcation_diagram(
        whirlmap.load("duffing"), "gamma", np.linspace(0.2, 0.65, 70), settling=Settling(transient=20), workers=1
    )
    np.testing.assert_array_equal(again["section"], one["section"])


def test_following_shows_hysteresis():
    """A hardening Duffing oscillator has two amplitudes between its folds: up and down differ there, and agree outside."""
    system = whirlmap.load("duffing", delta=0.1, alpha=1.0, beta=0.2, gamma=0.5)
    values = np.linspace(0.8, 2.2, 15)
    ds = bifurcation_diagram(system, "omega", values, follow="both", settling=Settling(transient=150, most=8, keep=4))
    swing = (ds["maximum"] - ds["minimum"]).sel(quantity="x")
    gap = np.abs(swing.sel(direction="up") - swing.sel(direction="down")).values
    assert gap.max() > 1.0
    assert gap[0] < 1e-5 * swing.values.max()
    assert gap[-1] < 1e-5 * swing.values.max()


def test_every_variable_says_its_unit(ladder):
    for name, values in ladder.data_vars.items():
        assert values.attrs["units"], name
        assert values.attrs["long_name"], name
    for name in ("status", "regime"):
        assert len(ladder[name].attrs["flag_values"]) == len(ladder[name].attrs["flag_meanings"].split())


@pytest.mark.parametrize(
    ("text", "says"),
    [("s=1:2", "expected name=start:stop:count"), ("s=2:1:5", "swap"), ("s=1:2:1", "count"), ("s=0:1:5:log", "logarithmic"),
     ("s=a:1:5", "numbers"), ("s=1:nan:5", "finite"), ("s=1:2:5:lin", "only 'log'"), ("s=1:2:1e3", "whole number")],
)  # fmt: skip
def test_bad_ranges_are_refused(text, says):
    with pytest.raises(RangeError, match=says):
        Range.parse(text)


def test_orders_cannot_be_varied_and_limits_hold():
    system = whirlmap.load("gear-psfd/reference")
    with pytest.raises(RangeError, match="order of a harmonic"):
        bifurcation_diagram(system, "r_p", [0.1, 0.2])
    with pytest.raises(RangeError, match="s = -1 must be above 0"):
        bifurcation_diagram(system, "s", [-1.0, 0.2])


def test_a_point_alone_in_a_diagram_in_shares_and_after_a_refinement():
    """Steps are chosen by each point for itself; whoever else is computed, the bits are the same."""
    system = whirlmap.load("duffing", gamma=0.2)
    values = np.linspace(0.6, 2.0, 41)
    options = {"settling": Settling(transient=40, most=8, keep=4), "accuracy": 1e-7}
    whole = bifurcation_diagram(system, "omega", values, **options)
    assert np.unique(whole["steps"]).size > 1  # several rungs of the ladder, hence several groups of lanes
    assert (whole["step_error"] <= 1e-7).all()
    parts = {
        "alone": bifurcation_diagram(system, "omega", values[17:18], **options),
        "first share": bifurcation_diagram(system, "omega", values[::2], **options),
        "second share": bifurcation_diagram(system, "omega", values[1::2], **options),
        "refinement": bifurcation_diagram(system, "omega", np.linspace(0.6, 2.0, 81)[20:61], **options),
    }
    for name, part in parts.items():
        shared = np.intersect1d(part["omega"], values)
        assert shared.size, name
        a, b = whole.sel(omega=shared), part.sel(omega=shared)
        for variable in ("section", "steps", "step_error", "regime", "period_T", "settled_after", "maximum", "rms"):
            np.testing.assert_array_equal(a[variable], b[variable], err_msg=f"{name}: {variable}")


def test_values_that_are_no_numbers_are_refused_by_a_sentence():
    with pytest.raises(InputError, match="s has no dimension in jeffcott, found the unit 'rpm'"):
        whirlmap.bifurcation_diagram(whirlmap.load("jeffcott"), "s", ["1000 rpm"])
