"""Oscillators with kinks, jumps, stops and friction against their solution with event location (`truth_events`)."""

import kinked_cases
import numpy as np
import pytest
from asking import EXTREME, STATE, Refused, asked, diagram, extreme_error, label, load
from dead_zone import DeadZone
from truth_numbers import compute, kept

import whirlmap

NUMBERS = kept()
WRITTEN = [pytest.param(case, model, id=f"{case.name}-{model.name}") for case in kinked_cases.ALL for model in case.models]
ONCE = [pytest.param(case, case.models[0], id=case.name) for case in kinked_cases.ALL]


@pytest.mark.parametrize(("case", "model"), WRITTEN)
def test_the_pieces_are_the_model(case, model):
    """Rates of the pieces and of the model's plain reference agree at random states and times."""
    system, motion = load(model, case.values, case.start), case.pieces.at(**case.values)
    rng = np.random.default_rng(1)
    for time, *z in rng.uniform(-3, 3, (20, 1 + motion.n)):
        sides = motion.sides_at(time, z)
        np.testing.assert_allclose(system.reference_rhs(time, np.array(z)), motion.field(sides)[0](time, *z), rtol=1e-12)


@pytest.mark.parametrize(("case", "model"), WRITTEN)
def test_label_state_and_extremes(case, model):
    truth = NUMBERS[case.name]
    ds = diagram(load(model, case.values, case.start))
    said = label(ds, 0)
    if truth["slides"] and said == "sticks":
        return  # allowed: the run ends where the motion sticks, and says so
    assert said == f"{truth['n']}T"
    assert extreme_error(ds, ds["state"].values, truth["low"], truth["high"]) < EXTREME
    size = np.subtract(truth["high"], truth["low"])
    section = ds["section"].values[0]
    assert np.min(np.max(np.abs(section - truth["z"]) / size, axis=1)) < STATE


@pytest.mark.parametrize(("case", "model"), ONCE)
def test_multipliers(case, model):
    truth = NUMBERS[case.name]
    found = asked(whirlmap.floquet_multipliers, load(model, case.values, case.start), truth["z"], truth["n"] * case.period)
    if isinstance(found, Refused):
        assert case.jumps and found.names_the_jump, found.sentence
        return
    exact = np.array(truth["real"]) + 1j * np.array(truth["imaginary"])
    value = found["real"].values + 1j * found["imaginary"].values
    for one in exact:  # in any order
        assert np.abs(value - one).min() < 1e-9 + 1e-8 * np.abs(exact).max()
    assert bool(found["stable"]) and float(found["closure"]) < 1e-8


@pytest.mark.parametrize(("case", "model"), ONCE)
def test_diagnosis(case, model):
    """The label is the same, and every exponent is as near to the truth as its error says."""
    truth = NUMBERS[case.name]
    ds = asked(whirlmap.diagnose, load(model, case.values, case.start))
    if isinstance(ds, Refused):
        assert case.jumps and ds.names_the_jump, ds.sentence
        return
    said = label(ds)
    if truth["slides"] and said == "sticks":
        return
    assert said == f"{truth['n']}T" and float(ds["confidence"]) > 0.5
    if "lyapunov" not in ds:
        return
    with np.errstate(divide="ignore"):
        exact = np.log(np.hypot(truth["real"], truth["imaginary"])) / (truth["n"] * case.period)
    value, error = ds["lyapunov"].values, ds["lyapunov_error"].values
    strong = exact < -30 / case.period  # a direction that a slide ends, or nearly so
    assert np.all(np.abs(value - exact)[~strong] < 3 * error[~strong] + 1e-6 / case.period)


@pytest.mark.parametrize("case", kinked_cases.TEETH, ids=lambda c: c.name)
def test_two_solutions_of_the_dead_zone_agree(case):
    """The pieces by SciPy, and by the closed forms between the corners."""
    truth, v = NUMBERS[case.name], case.values
    orbit, multipliers = DeadZone(v["zeta"], v["F_m"], v["F_ah"] * v["Omega"] ** 2, v["Omega"]).orbit(
        np.array(truth["z"]), truth["n"]
    )
    np.testing.assert_allclose(orbit, truth["z"], atol=1e-10)
    np.testing.assert_allclose(np.sort(np.abs(multipliers)), np.sort(np.hypot(truth["real"], truth["imaginary"])), atol=1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("case", kinked_cases.ALL, ids=lambda c: c.name)
def test_the_truth_comes_out_again(case):
    again, truth = compute(case), NUMBERS[case.name]
    assert (again["n"], again["slides"]) == (truth["n"], truth["slides"])
    np.testing.assert_allclose(np.hypot(again["real"], again["imaginary"]), np.hypot(truth["real"], truth["imaginary"]), atol=1e-8)
    np.testing.assert_allclose([again["low"], again["high"]], [truth["low"], truth["high"]], rtol=0, atol=1e-8)
