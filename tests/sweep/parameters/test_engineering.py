"""Limits, ranges and draws of machines as engineers write them."""

import numpy as np
import pytest

import whirlmap
from whirlmap.errors import InputError, RangeError
from whirlmap.integrate.ranges import Range
from whirlmap.sweep.parameters.engineering import drawn_machines, limit_of, speeds_of

RIG = "machines/jeffcott-rig"


def test_limits_and_speeds_are_in_the_models_numbers():
    rig = whirlmap.load(RIG, c="100 um", limit="25 um")
    assert limit_of(rig, "20 um") == pytest.approx(0.2, rel=1e-14) and limit_of(rig, None) == pytest.approx(0.25, rel=1e-14)
    low, high = speeds_of(rig, "900 rpm:3600 rpm")
    assert high == pytest.approx(4 * low, rel=1e-14)
    assert low == pytest.approx(float(rig.values["s"]) / 2, rel=1e-12)  # it runs at 1800 rpm
    assert speeds_of(rig, "0.5:2") == (0.5, 2.0) and limit_of(whirlmap.load("duffing"), "0.6") == 0.6


@pytest.mark.parametrize(
    ("ask", "error", "said"),
    [
        (lambda rig: limit_of(rig, "20"), InputError, "limit: found 20 without a unit"),
        (lambda rig: speeds_of(rig, "500:6000"), InputError, "range: found '500:6000' without units"),
        (lambda rig: speeds_of(rig, "900 rpm:500 rpm"), RangeError, "the lower one first"),
        (lambda _: limit_of(whirlmap.load("duffing"), "20 um"), InputError, "has no dimensions"),
        (lambda rig: drawn_machines(rig, {"clearance": 0.1}, 2, 0.2), InputError, "is not given 'clearance'"),
    ],
)
def test_what_says_nothing_is_refused(ask, error, said):
    with pytest.raises(error, match=said):
        ask(whirlmap.load(RIG))


def test_drawn_machines_have_the_same_limit_in_metres():
    rig = whirlmap.load(RIG, c="100 um", K="2.1e6 N/m")
    machines, limits = drawn_machines(rig, {"c": 0.1, "Gamma": 0.05}, 12, 0.2, seed=3)
    c = np.array([m.machine.inputs["c"].value for m in machines])
    assert len(set(c)) == 12 and (np.abs(c - 100e-6) <= 10e-6).all() and np.abs(c - 100e-6).max() > 5e-6
    np.testing.assert_allclose(limits * c, 0.2 * 100e-6, rtol=1e-12)
    gamma = np.array([float(m.values["Gamma"]) for m in machines]) / float(rig.values["Gamma"])
    assert (np.abs(gamma - 1) <= 0.05).all() and len(set(gamma)) == 12  # drawn itself, it does not follow the clearance
    assert {m.machine.inputs["K"].value for m in machines} == {2.1e6}  # what was changed before stays
    again, _ = drawn_machines(rig, {"c": 0.1, "Gamma": 0.05}, 12, 0.2, seed=3)
    assert [m.values for m in again] == [m.values for m in machines]


def test_a_range_knows_its_unit_and_what_is_left_of_it():
    swept = Range.parse("c=40um:80 um:5")
    assert (swept.start, swept.stop, swept.unit) == (40.0, 80.0, "um")
    assert Range.parse(swept.rest(3)) == Range("c", 70.0, 80.0, 2, unit="um")
    with pytest.raises(RangeError, match="the same unit on both ends"):
        Range.parse("c=40um:80mm:5")
