"""Values that Python functions are given: numbers, texts with units and ranges; what is neither is refused by a sentence."""

from functools import partial

import numpy as np
import pytest

import whirlmap
from whirlmap.errors import CaseError, InputError, RangeError

RIG = "machines/jeffcott-rig"
SPEEDS = ["1000 rpm", "1200 rpm"]
SHORT = {"settling": whirlmap.Settling(transient=10, most=2, keep=4), "lyapunov": 0, "steps": 16}
make = partial(whirlmap.load, RIG)


@pytest.fixture(scope="module")
def rig():
    return make()


@pytest.fixture(scope="module")
def numbers():
    return [float(make(speed=text).values["s"]) for text in SPEEDS]


def speeds(rig, s):
    return whirlmap.safe_speeds(rig, s, 0.5, follow=False, **SHORT)


def improve(rig, s):
    return whirlmap.improve(make, {"c": ["90 um", "110 um"]}, s, 0.5, refine=False, follow=False, **SHORT)


OVER_SPEEDS = {
    "label_points": lambda rig, name, s: whirlmap.label_points(rig, {name: s}, **SHORT),
    "bifurcation_diagram": lambda rig, name, s: whirlmap.bifurcation_diagram(rig, name, s, **SHORT),
    "regime_map": lambda rig, name, s: whirlmap.regime_map(rig, {name: s}, **SHORT),
    "campbell": whirlmap.campbell,
    "waterfall": lambda rig, name, s: whirlmap.waterfall(rig, name, s, "ux", transient=4, periods=8, steps=20),
    "safe_speeds": lambda rig, _, s: speeds(rig, s),
    "improve": lambda rig, _, s: improve(rig, s),
}


@pytest.mark.parametrize("function", OVER_SPEEDS.values(), ids=OVER_SPEEDS)
def test_speeds_are_taken_with_their_unit(rig, numbers, function):
    plain = function(rig, "s", numbers)
    for name, values in (("speed", SPEEDS), ("s", SPEEDS), ("speed", "1000rpm:1200rpm:2")):
        given = function(rig, name, values)
        np.testing.assert_allclose(given["s"], plain["s"], rtol=1e-14)
        assert set(given.variables) == set(plain.variables)


@pytest.mark.parametrize("values", [["fast", "faster"], ["3 kg", "4 kg"], [["1 rpm"], ["2 rpm", "3 rpm"]]])
@pytest.mark.parametrize("function", OVER_SPEEDS.values(), ids=OVER_SPEEDS)
def test_what_is_no_speed_is_named(rig, function, values):
    with pytest.raises(InputError, match="found") as raised:
        function(rig, "s", values)
    assert str(values[0]).strip("[]'").split()[-1] in str(raised.value)


def test_a_speed_without_its_unit_is_no_value_of_s(rig):
    with pytest.raises(InputError, match="found speed without a unit, expected speeds with their unit"):
        whirlmap.label_points(rig, {"speed": [1000.0, 1200.0]}, **SHORT)


def test_a_dimensional_input_names_what_it_feeds(rig):
    for function in (whirlmap.campbell, OVER_SPEEDS["label_points"], OVER_SPEEDS["waterfall"]):
        with pytest.raises(RangeError, match=r"found the dimensional input 'c'.*it feeds s, Gamma"):
            function(rig, "c", ["80 um", "90 um"])


def test_one_parameter_by_two_names_is_refused(rig):
    with pytest.raises(RangeError, match="s is given twice"):
        whirlmap.label_points(rig, {"s": [0.3, 0.4], "speed": SPEEDS}, **SHORT)


def test_a_bracket_has_units(rig):
    low, high = (float(make(speed=text).values["s"]) for text in ("1000 rpm", "60000 rpm"))
    found = whirlmap.stability_threshold(rig, "speed", ("1000 rpm", "60000 rpm"))
    assert low < found < high
    assert found == pytest.approx(whirlmap.stability_threshold(rig, "s", (low, high)), rel=1e-8)
    with pytest.raises(RangeError, match="bracket: found 3 values, expected two"):
        whirlmap.stability_threshold(rig, "s", (0.1, 0.2, 0.3))


def test_a_limit_has_a_unit(rig, numbers):
    clearance = float(rig.machine.inputs["c"].value)
    plain = whirlmap.safe_speeds(rig, numbers, 20e-6 / clearance, follow=False, **SHORT)
    given = whirlmap.safe_speeds(rig, numbers, "20 um", follow=False, **SHORT)
    assert given.attrs["limit"] == pytest.approx(plain.attrs["limit"], rel=1e-14)
    how = {"units": {"c": "um"}, "refine": False, "follow": False, **SHORT}
    designs = whirlmap.improve(make, {"c": [90, 110]}, numbers, "20 um", **how)
    assert designs.attrs["limit"] == given.attrs["limit"]
    for limit in (None, "wide", ["20 um"]):
        with pytest.raises(InputError, match="limit: found"):
            whirlmap.safe_speeds(rig, numbers, limit, follow=False, **SHORT)


def test_design_parameters_have_units(rig, numbers):
    given = improve(rig, numbers)
    plain = whirlmap.improve(make, {"c": [90, 110]}, numbers, 0.5, units={"c": "um"}, refine=False, follow=False, **SHORT)
    ranged = whirlmap.improve(make, {"c": "90um:110um:2"}, numbers, 0.5, refine=False, follow=False, **SHORT)
    assert given["c"].attrs["units"] == "um"
    assert given.drop_attrs().equals(plain.drop_attrs()) and ranged.drop_attrs().equals(plain.drop_attrs())
    with pytest.raises(RangeError, match="found the unit 'um' in its values and 'mm' in units"):
        whirlmap.improve(make, {"c": ["90 um", "110 um"]}, numbers, 0.5, units={"c": "mm"}, **SHORT)
    with pytest.raises(RangeError, match=r"units: found 'C', which is not varied\. Did you mean 'c'"):
        whirlmap.improve(make, {"c": [90, 110]}, numbers, 0.5, units={"C": "um"}, **SHORT)


def test_start_states_have_units(rig):
    clearance = float(rig.machine.inputs["c"].value) * 1e6
    ends = (f"{-0.1 * clearance} um", f"{0.1 * clearance} um")
    options = {"settling": SHORT["settling"], "lyapunov": 256, "steps": 16}
    given = whirlmap.attractors(rig, starts=4, box={"ux": ends}, **options)
    plain = whirlmap.attractors(rig, starts=4, box={"ux": (-0.1, 0.1)}, **options)
    np.testing.assert_allclose(given["start_state"], plain["start_state"], atol=1e-13)
    slices = [whirlmap.basins(rig, {"ux": x, "uy": [0.0, 0.1]}, **options) for x in (list(ends), [-0.1, 0.1])]
    np.testing.assert_allclose(slices[0]["ux"], slices[1]["ux"], atol=1e-13)
    with pytest.raises(InputError, match="box: x has no dimension in duffing, found the unit 'um'"):
        whirlmap.attractors(whirlmap.load("duffing"), starts=4, box={"x": ("1 um", "2 um")})
    with pytest.raises(RangeError, match="box of 'ux': found 1 value, expected two"):
        whirlmap.attractors(rig, starts=4, box={"ux": "1 um"})
    for starts in ([["left"]] * 4, [["1 um"]] * 4):
        with pytest.raises(RangeError, match="values of 'starts': found"):
            whirlmap.attractors(rig, starts=starts)
        with pytest.raises(RangeError, match="values of 'starts': found"):
            whirlmap.label_points(rig, {"s": [0.3]}, starts=starts, **SHORT)


@pytest.mark.parametrize("value", ["1000 rpm", "fast", None, [1.0, 2.0]])
def test_a_system_says_where_units_are_taken(rig, value):
    for given in (lambda: rig.replace(s=value), lambda: rig.at_speed(value)):
        with pytest.raises(CaseError, match=r"s: found .*, expected a number .*taken by whirlmap\.load"):
            given()
    with pytest.raises(CaseError, match=r"speed is a dimensional input of the case, which whirlmap\.load takes"):
        rig.replace(speed=value)
    with pytest.raises(RangeError, match="start value of 'ux' must be a finite number, not"):
        rig.replace(start={"ux": value})
