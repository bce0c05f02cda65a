"""Units of what a system's numbers stand for, against the inputs of the machines themselves."""

import numpy as np
import pytest

import whirlmap
from whirlmap.errors import RangeError
from whirlmap.integrate.dimensions import PURE, Dimensions


@pytest.fixture(scope="module")
def gearbox():
    return whirlmap.load("machines/turbo-gearbox")


def test_lengths_velocities_and_forces_of_a_gearbox(gearbox):
    units, clock = Dimensions(gearbox), 9000 * np.pi / 30  # c = 60 um, K_p = 2e8 N/m
    assert (units.quantity("yp").size, units.quantity("yp").unit) == (pytest.approx(60), "um")
    assert (units.quantity("vyp").size, units.quantity("vyp").unit) == (pytest.approx(60e-3 * clock), "mm/s")
    assert (units.quantity("load_1").size, units.quantity("load_1").unit) == (pytest.approx(2e8 * 60e-6), "N")
    assert (units.quantity("qp").unit, units.quantity("eps_1")) == ("um", PURE)
    assert units.of("time").size == pytest.approx(1 / clock)


def test_the_speed_ratio_is_a_speed_of_the_first_shaft(gearbox):
    found = Dimensions(gearbox).quantity("s")
    assert (found.size * float(gearbox.values["s"]), found.unit) == (pytest.approx(9000), "rpm")
    assert found.size * 2.0 == pytest.approx(Dimensions(gearbox.replace(s=2.0)).quantity("s").size * 2.0)


def test_velocities_follow_a_varied_speed(gearbox):
    s = np.array([0.1, 0.2])
    many = Dimensions(gearbox).quantity("vyp", s=s).size
    one = [Dimensions(gearbox.replace(s=value)).quantity("vyp").size for value in s]
    np.testing.assert_allclose(many, one, rtol=1e-14)


def test_a_result_is_converted_once_and_by_its_own_case(gearbox):
    ds = whirlmap.simulate(gearbox, periods=2)
    shown = whirlmap.in_units(gearbox, ds)
    with pytest.raises(RangeError, match="already"):
        whirlmap.in_units(gearbox, shown)
    with pytest.raises(RangeError, match="found a result of machines/turbo-gearbox"):
        whirlmap.in_units(whirlmap.load("machines/jeffcott-rig"), ds)


@pytest.mark.parametrize("case", ["duffing", "jeffcott", "gear-psfd/intended"])
def test_a_case_without_dimensions_stays_in_its_own_units(case):
    units = Dimensions(system := whirlmap.load(case))
    assert not units.known
    assert all(units.quantity(name) == PURE for name in (*system.states, *system.model.outputs))
