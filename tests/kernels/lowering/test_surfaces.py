"""Surfaces at which rates kink or jump are found, however they are written."""

import pytest
from sympy import Abs, Heaviside, Max, Min, Or, Piecewise, exp

from whirlmap.equations import Model, Parameter, State, cos, magnitude, sign, sqrt, t, when
from whirlmap.kernels.lowering.surfaces import sided
from whirlmap.models import family

x, v = State("x", "1", "displacement"), State("v", "1", "velocity")
F, w = Parameter("F", "1", "force"), Parameter("w", "1", "frequency", above=0)


def found(force):
    return sided(Model("found", (x, v), (F, w), {x: v, v: force + F * cos(w * t)}, harmonics=(w,)))


@pytest.mark.parametrize(
    "friction",
    [
        F * sign(v), when(v > 0, F, -F), when(v < 0, -F, F), F * v / Abs(v), F * Abs(v) / v, F * (2 * Heaviside(v) - 1),
        F * sign(2 * v), when(-v >= 0, -F, F), F * sign(v) ** 3, F * (Max(sign(v), 0) + Min(0, sign(v))),
    ],
)  # fmt: skip
def test_dry_friction_is_one_jump_in_any_spelling(friction):
    got = found(-friction - x)
    assert len([s for s, jumps in zip(got.surfaces, got.jumps, strict=True) if jumps]) == 1
    assert got.flat[got.jumps.index(True)]


@pytest.mark.parametrize(
    "stop",
    [
        when(x > 1, x - 1), Max(x - 1, 0), (Abs(x - 1) + x - 1) / 2, when(x <= 1, 0, F * (x - 1)),
        (x - 1) * Heaviside(x - 1),
        when(x > F, (x - F) ** 1.5), when(sqrt(x**2 + v**2) > F, sqrt(x**2 + v**2) - F), Max(0, 1 - exp(-x), 1 - exp(x)),
    ],
)  # fmt: skip
def test_stops_are_kinks(stop):
    got = found(-stop - x)
    assert got.surfaces and not any(got.jumps)


def test_a_preloaded_stop_jumps_and_opposite_surfaces_are_one():
    assert found(-when(x > 1, F)).jumps == [True]
    got = found(-F * sign(x - v) - sign(v - x) + when(x > v, 1))
    assert len(got.surfaces) == 1
    assert {s.name for e in got.rates for s in e.free_symbols} >= {"m0"}


def test_conditions_of_several_relations_have_a_surface_each():
    got = found(Piecewise((F, Or(x > 1, v < -1)), (0, True)))
    assert len(got.surfaces) == 2 and all(got.jumps)


def test_time_alone_is_a_surface_and_parameters_alone_are_none():
    assert len(found(-x * (1 + F * sign(cos(w * t)))).surfaces) == 1
    assert not found(-x * sign(F) * Abs(w)).surfaces
    assert not found(-x * magnitude(v) * v).surfaces


def test_inner_surfaces_come_first():
    got = found(-Abs(Abs(x) - 1))
    assert len(got.surfaces) == 2 and got.surfaces[0] == x and got.surfaces[1].has(got.sides[0])


def test_machines_of_the_project():
    """The dead zone and the wall are kinks; no film has a surface, whatever its arc."""
    assert not sided(family("gear_pair").model(edition="physical", arc="positive")).surfaces
    pair = sided(family("gear_pair").model(edition="physical", mesh="line", backlash="dead_zone", contact="rub"))
    assert len(pair.surfaces) == 4 and not any(pair.jumps)
    assert sided(family("gear_backlash").model()).jumps == [False, False]
