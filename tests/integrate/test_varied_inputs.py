"""Parameters at values of dimensional inputs are those of the case that is loaded with them, to the bit."""

import time

import numpy as np
import pytest

from whirlmap.cases import names
from whirlmap.errors import CaseError, RangeError
from whirlmap.integrate.loading import changed, load
from whirlmap.integrate.varied_inputs import VariedInputs

RIG = "machines/jeffcott-rig"


def varied(system, values, units, fixed=()):
    follows = VariedInputs(system, units, {name: (v[0], v[-1]) for name, v in values.items()}, fixed)
    follows.check()
    return follows


@pytest.mark.parametrize(
    ("case", "changes", "name", "unit", "values"),
    [
        (RIG, {}, "c", "um", [80.0, 93.1, 120.0]),
        (RIG, {"K": "2.1e6 N/m"}, "M", "kg", [1.5, 2.2, 3.1]),  # what was changed before stays
        ("machines/turbo-gearbox", {}, "T_oil", "degC", [45.0, 51.3, 60.0]),  # the viscosity follows by Walther's equation
        ("machines/turbo-gearbox", {}, "R", "mm", [20.0, 22.7, 25.0]),  # both bearings
        ("gear-psfd/machine", {}, "mu", "mPa*s", [15.0, 17.77, 25.0]),
    ],
)
def test_parameters_are_those_of_the_loaded_case(case, changes, name, unit, values):
    system = load(case, **changes)
    follows = varied(system, {name: values}, {name: unit})
    found = follows({name: np.array(values)})
    assert found
    for k, value in enumerate(values):
        whole = load(case, **changes, **{name: f"{value} {unit}"})
        now = {p: float(whole.values[p]) for p in system.parameters}
        assert {p: found[p][k] if p in found else float(system.values[p]) for p in system.parameters} == now


def test_two_inputs_feed_one_group_together():
    system = load(RIG)
    follows = varied(system, {"c": [80.0, 120.0], "mu": [0.01, 0.03]}, {"c": "um", "mu": "Pa*s"})
    found = follows({"c": np.array([90.0, 90.0, 100.0]), "mu": np.array([0.01, 0.02, 0.02])})
    whole = load(RIG, c="90 um", mu="0.02 Pa*s")
    assert found["Gamma"][1] == float(whole.values["Gamma"])
    assert found["Gamma"][1] == pytest.approx(2 * found["Gamma"][0], rel=1e-14)


def test_symbols_that_are_given_do_not_follow():
    system = load(RIG).replace(Gamma=0.2)
    assert "Gamma" not in varied(system, {"c": [80.0, 120.0]}, {"c": "um"}).followers
    assert "s" not in varied(load(RIG), {"c": [80.0, 120.0]}, {"c": "um"}, fixed=["s"]).followers
    again = changed(system, c="90 um")
    assert again.values["Gamma"] == 0.2 and again.values["k"] == load(RIG, c="90 um").values["k"]


def test_what_is_sent_to_other_processes_says_the_same():
    cloudpickle = pytest.importorskip("cloudpickle")
    follows = varied(load(RIG), {"c": [80.0, 120.0]}, {"c": "um"})
    at = {"c": np.array([85.0, 91.0])}
    here = follows(at)
    there = cloudpickle.loads(cloudpickle.dumps(follows))(at)
    assert {n: v.tolist() for n, v in here.items()} == {n: v.tolist() for n, v in there.items()}


@pytest.mark.parametrize(
    ("case", "name", "unit", "values", "said"),
    [
        ("machines/turbo-gearbox", "z_p", "", [20.0, 21.0], "z_p is a whole number"),
        ("machines/turbo-gearbox", "limit", "um", [5.0, 9.0], "changes nothing"),
        (RIG, "c", "", [80.0, 120.0], "c has a dimension .* expected values with their unit"),
        (RIG, "clearance", "um", [80.0, 120.0], "no parameter 'clearance'"),
    ],
)
def test_what_cannot_be_varied_is_refused(case, name, unit, values, said):
    with pytest.raises(RangeError, match=said):
        varied(load(case), {name: values}, {name: unit})


def test_a_value_that_cannot_be_is_refused_by_the_case():
    with pytest.raises(CaseError, match="above 0"):
        varied(load(RIG), {"c": [-1.0, 120.0]}, {"c": "um"})


DIMENSIONAL = [name for name in names() if (machine := load(name).machine) and machine.inputs]


@pytest.mark.parametrize(
    "case", [pytest.param(c, marks=[pytest.mark.slow] if "compressor" in c else []) for c in DIMENSIONAL]
)
def test_every_input_of_every_stock_case_gives_the_bits_of_the_loaded_case(case, monkeypatch):
    """And none of them asks SymPy for each value, or settles the case again."""
    system = load(case)
    for name, given in system.machine.inputs.items():
        unit = "" if given.parameter.unit == "1" else given.parameter.unit
        ends = (0.9 * given.value, 1.1 * given.value)
        value = given.value * 1.0123456789
        try:
            follows = varied(system, {name: ends}, {name: unit})
            whole = load(case, **{name: f"{value!r} {unit}".strip()})
        except (CaseError, RangeError):  # a count, a grade, or what changes nothing here
            continue
        assert follows._exact is not None, name
        with monkeypatch.context() as patch:
            patch.setattr("whirlmap.equations.exact_values.value_of", None)
            found = follows({name: np.array([value])})
        assert {p: v[0] for p, v in found.items()} == {p: float(whole.values[p]) for p in follows.followers}, name


def test_the_clearances_of_a_long_axis_take_no_time_worth_mentioning():
    follows = varied(load(RIG), {"c": [80.0, 120.0]}, {"c": "um"})
    begun = time.process_time()
    follows({"c": np.linspace(80.0, 120.0, 1000)})
    assert time.process_time() - begun < 1.0  # 0.1; with SymPy at each value 6
