"""Speeds, senses and mesh phases of gear trains."""

from math import cos, pi, sin

import pytest
from sympy import Integer, Rational, sympify

from whirlmap.equations.quantities import Parameter
from whirlmap.errors import CaseError
from whirlmap.machines.train import Link, train


def link(name, driver, driven, z, beta=0, torque=1):
    zs = (Parameter(f"z_{name}_{i}", "1", "", order=True) for i in (1, 2))
    return Link(name, driver, driven, *zs, sympify(beta), Integer(torque)), dict(zip((1, 2), z, strict=True))


def numbers(links):
    return {q: z for one, values in links for q, z in zip((one.z_driver, one.z_driven), values.values(), strict=True)}


def test_speeds_and_senses_of_three_shafts_in_a_row():
    links = [link("a", "one", "two", (37, 113)), link("b", "two", "three", (29, 71))]
    found = train("two", ["one", "two", "three"], [one for one, _ in links])
    speeds = {name: e.xreplace(numbers(links)) for name, e in found.speeds.items()}
    assert speeds == {"two": 1, "one": Rational(-113, 37), "three": Rational(-29, 71)}
    assert found.senses == {"two": 1, "one": -1, "three": -1}


def flank_phase(z, sense, angle, direction, front):
    """Teeth counted at the pitch point: a wheel has flanks a quarter of a pitch ahead and behind of each tooth's middle."""
    return z * sense * (angle - direction) + (pi / 2 if front else -pi / 2)


@pytest.mark.parametrize("torque", [1, -1])
@pytest.mark.parametrize("reference", ["bull", "first"])
def test_phases_are_those_of_the_flanks_of_the_middle_wheel(reference, torque):
    """A wheel between two others, as idler: driven in the first mesh, drives in the second; both directions of power."""
    b_1, b_2 = 0.4, 2.3
    links = [link("a", "first", "bull", (20, 41), b_1, torque), link("b", "bull", "second", (41, 30), b_2, torque)]
    found = train(reference, ["first", "bull", "second"], [one for one, _ in links])
    theta = {n: float(e.xreplace(numbers(links))) for n, e in found.phases.items()}
    sense = found.senses["bull"]
    drives = torque > 0  # with its front flanks in the second mesh; driven by its back flanks in the first
    first = flank_phase(41, sense, 0.0, b_1 + pi, front=not drives)
    second = flank_phase(41, sense, 0.0, b_2, front=drives)
    expected = second - first
    for function in (cos, sin):
        assert function(theta["b"] - theta["a"]) == pytest.approx(function(expected), abs=1e-9)


def test_two_pinions_of_one_wheel_differ_by_its_teeth_between_them():
    links = [link("a", "bull", "p1", (40, 20), 0), link("b", "bull", "p2", (40, 20), pi / 3)]
    found = train("bull", ["bull", "p1", "p2"], [one for one, _ in links])
    assert float(found.phases["b"].xreplace(numbers(links))) == pytest.approx(-40 * pi / 3)
    assert found.phases["a"] == 0


def test_loops_and_lonely_shafts_are_refused():
    loop = [link("a", "x", "y", (2, 3))[0], link("b", "y", "z", (3, 4))[0], link("c", "z", "x", (4, 2))[0]]
    with pytest.raises(CaseError, match=r"mesh .: found a loop"):
        train("x", ["x", "y", "z"], loop)
    with pytest.raises(CaseError, match="shaft z: found no mesh"):
        train("x", ["x", "y", "z"], loop[:1])
