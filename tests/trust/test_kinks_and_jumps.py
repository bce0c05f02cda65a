"""Oscillators with kinks, jumps, stops and friction against their solution with event location (`truth_orbits`)."""

from functools import cache

import numpy as np
import pytest
from sympy import lambdify
from tests.independent.dead_zone import DeadZone
from tests.trust import kinked_cases
from tests.trust.asking import EXTREME, STATE, Refused, asked, diagram, extreme_error, label, load, some
from tests.trust.truth_numbers import compute, kept

import whirlmap
from whirlmap.equations import t

NUMBERS = kept()
PERIODIC = [*kinked_cases.STRICT, *kinked_cases.TEETH]
WRITTEN = [pytest.param(case, model, id=f"{case.name}-{model.name}") for case in PERIODIC for model in case.models]
ONCE = [pytest.param(case, case.models[0], id=case.name) for case in PERIODIC]


@cache
def answer(name, model):
    case = kinked_cases.BY_NAME[name]
    return diagram(load(model, case.values, case.start), settling=case.settling)


def moduli(truth):
    return np.hypot(truth["real"], truth["imaginary"])


def allowed_to_stick(truth, said):
    """A run may end where the motion sticks, and say so."""
    return truth["slides"] > 0 and said == "sticks"


@pytest.mark.parametrize("case", kinked_cases.ALL, ids=lambda c: c.name)
def test_the_pieces_are_the_model(case):
    """Rates of the pieces and of every way in which the model is written agree at random states and times."""
    motion = case.pieces.at(**case.values)
    for model in case.models:
        values = {p: case.values[p.name] for p in model.parameters}
        rates = lambdify([t, *model.states], [model.equations[s].subs(values) for s in model.states])
        rng = np.random.default_rng(1)
        for time, *z in rng.uniform(-3, 3, (20, 1 + motion.n)):
            sides = motion.sides_at(time, z)
            np.testing.assert_allclose(rates(time, *z), motion.field(sides)[0](time, *z), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(("case", "model"), WRITTEN)
def test_label(case, model):
    truth = NUMBERS[case.name]
    said = label(answer(case.name, model), 0)
    assert said == f"{truth['n']}T" or allowed_to_stick(truth, said)


@pytest.mark.parametrize(("case", "model"), WRITTEN)
def test_extremes_and_a_state(case, model):
    truth, ds = NUMBERS[case.name], answer(case.name, model)
    if allowed_to_stick(truth, label(ds, 0)):
        return
    assert extreme_error(ds, ds["state"].values, truth["low"], truth["high"]) < EXTREME
    size = np.subtract(truth["high"], truth["low"])
    assert np.min(np.max(np.abs(ds["section"].values[0] - truth["z"]) / size, axis=1)) < STATE


@pytest.mark.parametrize(("case", "model"), ONCE)
def test_multipliers(case, model):
    """With the default steps as good as the orbit closes, with 512 to 1e-7 of the largest."""
    truth = NUMBERS[case.name]
    exact = np.array(truth["real"]) + 1j * np.array(truth["imaginary"])
    for options in ({}, {"steps": 512}):
        system = load(model, case.values, case.start)
        found = asked(whirlmap.floquet_multipliers, system, truth["z"], truth["n"] * case.period, **options)
        if isinstance(found, Refused):
            assert case.jumps and found.names_the_jump, found.sentence
            return
        value, closure = found["real"].values + 1j * found["imaginary"].values, float(found["closure"])
        assert closure < (1e-7 if options else 1e-3) and bool(found["stable"])
        for one in exact:  # in any order
            assert np.abs(value - one).min() < 1e-7 * np.abs(exact).max() + 10 * closure


@pytest.mark.parametrize("name", ["gear-2T-Omega=1", "gear-4T-Omega=1", "gear-8T-Omega=1"])
def test_multipliers_of_the_dead_zone(name):
    """To 1e-9, from an orbit that Newton's method has found on the exact solution."""
    case, v = kinked_cases.BY_NAME[name], kinked_cases.BY_NAME[name].values
    exact = DeadZone(v["zeta"], v["F_m"], v["F_ah"] * v["Omega"] ** 2, v["Omega"])
    orbit, multipliers = exact.orbit(np.array(NUMBERS[name]["z"]), NUMBERS[name]["n"])
    found = whirlmap.floquet_multipliers(load(case.models[0], v, orbit), orbit, NUMBERS[name]["n"] * case.period)
    value = found["real"].values + 1j * found["imaginary"].values
    for one in multipliers:
        assert np.abs(value - one).min() < 1e-9


#: Points whose diagnosis is asked in the quick tests.
QUICK = ["dry-w=0.7", "dry-stops-F=0.8-d=0-w=0.5", "bilinear-k=4-w=4", "stop-w=0.8", "relay-w=1", "gear-4T-Omega=1"]


@pytest.mark.parametrize("name", some([case.name for case in PERIODIC], QUICK))
def test_diagnosis(name):
    """The label is the same, and every exponent is as near to the truth as its error says."""
    case, truth = kinked_cases.BY_NAME[name], NUMBERS[name]
    ds = asked(whirlmap.diagnose, load(case.models[0], case.values, case.start))
    if isinstance(ds, Refused):
        assert case.jumps and ds.names_the_jump, ds.sentence
        return
    said = label(ds)
    if allowed_to_stick(truth, said):
        return
    assert said == f"{truth['n']}T" and float(ds["confidence"]) > 0.5
    with np.errstate(divide="ignore"):
        exact = np.log(moduli(truth)) / (truth["n"] * case.period)
    if "lyapunov" in ds:
        value, error = ds["lyapunov"].values, ds["lyapunov_error"].values
        exact = exact[: value.size]  # a slide leaves no more directions
        seen = exact > -30 / case.period  # not a direction that a slide ends, or nearly so
        assert np.all(np.abs(value - exact)[seen] < 3 * error[seen] + 1e-6 / case.period)


@pytest.mark.parametrize("case", kinked_cases.CHAOS, ids=lambda c: c.name)
def test_chaos(case):
    """A positive exponent of twenty errors and more, by saltation: chaotic, or open where it cannot be measured."""
    truth = NUMBERS[case.name]
    assert truth["exponents"][0] > 15 * truth["errors"][0]
    for model in case.models:
        said = label(diagram(load(model, case.values, case.start)), 0)
        assert said in ("undecided", "sticks")
        ds = asked(diagram, load(model, case.values, case.start), lyapunov=1024)
        if isinstance(ds, Refused):
            assert case.jumps and ds.names_the_jump
        else:
            assert label(ds, 0) in (("chaotic", "undecided", "sticks") if case.jumps else ("chaotic",))


@pytest.mark.parametrize("case", kinked_cases.COEXISTING, ids=lambda c: c.name)
def test_coexisting_attractors(case):
    """The orbits that 16 starts of the truth come to, and no other; the smaller share of two, if a tenth, is not missed."""
    truth = NUMBERS[case.name]
    box = dict(zip((s.name for s in case.models[0].states), case.known["box"], strict=True))
    ds = whirlmap.attractors(load(case.models[0], case.values, case.start), starts=48, box=box, lyapunov=256)
    orbits = [(o["n"], np.array(o["low"]), np.array(o["high"])) for o in truth["orbits"]]
    seen = set()
    for k in range(ds.sizes["attractor"]):
        said = label(ds, k)
        low, high = ds["minimum"].values[k, : len(case.start)], ds["maximum"].values[k, : len(case.start)]
        same = [i for i, (n, a, b) in enumerate(orbits) if said == f"{n}T"
                and np.abs(np.array([low - a, high - b])).max() < 1e-4 * (b - a).max()]  # fmt: skip
        assert same, (said, low, high)
        seen.add(same[0])
    common = {i for i, o in enumerate(truth["orbits"]) if o["share"] >= 0.1}
    assert common <= seen


@pytest.mark.parametrize("case", kinked_cases.TEETH, ids=lambda c: c.name)
def test_two_solutions_of_the_dead_zone_agree(case):
    """The pieces by SciPy, and by the closed forms between the corners."""
    truth, v = NUMBERS[case.name], case.values
    orbit, multipliers = DeadZone(v["zeta"], v["F_m"], v["F_ah"] * v["Omega"] ** 2, v["Omega"]).orbit(
        np.array(truth["z"]), truth["n"]
    )
    np.testing.assert_allclose(orbit, truth["z"], atol=1e-10)
    np.testing.assert_allclose(np.sort(np.abs(multipliers)), np.sort(moduli(truth)), atol=1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("case", PERIODIC, ids=lambda c: c.name)
def test_the_truth_comes_out_again(case):
    again, truth = compute(case), NUMBERS[case.name]
    assert (again["n"], again["slides"]) == (truth["n"], truth["slides"])
    np.testing.assert_allclose(moduli(again), moduli(truth), atol=1e-8)
    np.testing.assert_allclose([again["low"], again["high"]], [truth["low"], truth["high"]], rtol=0, atol=1e-8)
