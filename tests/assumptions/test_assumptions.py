"""Each assumption of the gear pair's model, tripped by a value and left alone by another."""

import json
from functools import lru_cache
from math import isnan, pi, sqrt, tanh

import numpy as np
import pytest
import xarray as xr

import whirlmap
from whirlmap.assumptions.violation import Violation
from whirlmap.assumptions.violations import repeated, violations
from whirlmap.errors import CaseError
from whirlmap.integrate.system import System

MACHINE, REFERENCE, LITERAL = "gear-psfd/machine", "gear-psfd/reference", "gear-psfd/literal"


@lru_cache
def system(case, **changes):
    return whirlmap.load(case, **changes)


def found(here, diagrams=None) -> dict[str, Violation]:
    those = violations(here, diagrams)
    assert len({s.name for s in those}) == len(those)
    assert all(s.sentence.endswith(".") for s in those)
    return {s.name: s for s in those}


def diagram(eps_1, eps_2=None, *, s=None, start_found=None, **attributes):
    """What `bifurcation_diagram` returns, as far as it is read."""
    eps_1 = np.asarray(eps_1, dtype=float)
    s = np.linspace(0.3, 0.6, eps_1.size) if s is None else np.asarray(s, dtype=float)
    both = np.stack([eps_1, eps_1 * 0 + 0.5 if eps_2 is None else np.asarray(eps_2, dtype=float)], axis=1)
    flags = np.ones(eps_1.size, dtype=np.int8) if start_found is None else np.asarray(start_found, dtype=np.int8)
    return xr.Dataset(
        {"maximum": (("s", "quantity"), both), "start_found": ("s", flags)},
        coords={"s": s, "quantity": ["eps_1", "eps_2"]},
        attrs=attributes,
    )


CALM = diagram([0.4, 0.5, 0.6])


def test_a_machine_within_its_assumptions_strains_the_mesh_load_alone():
    assert set(found(system(MACHINE, s=0.5), CALM)) == {"mesh_load"}


def test_no_torque_holds_the_teeth_together():
    violation = found(system(MACHINE), CALM)["mesh_load"]
    assert (violation.value, violation.limit) == (0.0, pytest.approx(1e8 * 5e-6))
    assert "500 N" in violation.sentence


@pytest.mark.parametrize(("length", "trips"), [("12.4 mm", False), ("12.6 mm", True), ("30 mm", True)])
def test_short_bearing(length, trips):
    violations = found(system(MACHINE, s=0.5, L_1=length), CALM)
    assert ("slenderness_1" in violations) == trips
    assert "slenderness_2" not in violations
    if trips:
        assert violations["slenderness_1"].value == pytest.approx(float(length.split()[0]) / 50)


@pytest.mark.parametrize(("deepest", "trips"), [(0.89, False), (0.91, True), (0.999, True)])
def test_eccentricity(deepest, trips):
    violations = found(system(MACHINE, s=0.5), diagram([0.4, np.nan, deepest, 0.5], s=[0.3, 0.4, 0.45, 0.5]))
    assert ("eccentricity_1" in violations) == trips
    assert "eccentricity_2" not in violations
    if trips:
        assert violations["eccentricity_1"].value == deepest
        assert "at s = 0.45" in violations["eccentricity_1"].sentence


def test_eccentricity_is_sought_in_all_results():
    parameters = json.dumps({"psi": {"value": 0.1}})
    runs = {1e-3: CALM, 0.1: diagram([0.3, 0.4], [0.5, 0.95], parameters=parameters)}
    for given in (runs, list(runs.values())):
        violation = found(system(MACHINE, s=0.5), given)["eccentricity_2"]
        assert violation.value == 0.95
        assert "s = 0.6, psi = 0.1" in violation.sentence
    both_ways = xr.concat([diagram([0.4, 0.93]).assign_coords(direction="up"), diagram([0.4, 0.92])
                           .assign_coords(direction="down")], dim="direction")  # fmt: skip
    assert "up, s = 0.6" in found(system(MACHINE, s=0.5), both_ways)["eccentricity_1"].sentence


def test_results_without_eccentricities_say_nothing_about_them():
    bare = CALM.sel(quantity=["eps_1"])
    assert "eccentricity" in found(system(MACHINE, s=0.5), bare)["not_evaluated"].sentence


def test_film_reynolds_number():
    here = system(MACHINE, s=0.5, mu="0.0004 Pa*s")
    violation = found(here, CALM)["film_reynolds_1"]
    omega = sqrt(4e6 / 10) * 0.6  # the diagram goes further than the system
    assert violation.value == pytest.approx(870 * omega * 25e-3 * 50e-6 / 0.0004)
    assert violation.limit == pytest.approx(41.2 * sqrt(500))
    assert "870 kg/m3 assumed" in violation.sentence
    assert "film_reynolds_1" not in found(system(MACHINE, s=0.5), CALM)


def test_inertia_of_the_oil_at_the_mesh_frequency():
    violation = found(system(MACHINE), CALM)["film_inertia"]  # s = 0.8175
    assert violation.value == pytest.approx(870 * 0.8175 * sqrt(4e5) * 20 * 50e-6**2 / 0.02)
    assert violation.value > violation.limit == 1.0
    assert "film_inertia" not in found(system(MACHINE, s=0.72), CALM)
    assert "film_inertia" in found(system(MACHINE, s=0.5), diagram([0.5, 0.5], s=[0.5, 0.74]))


@pytest.mark.parametrize(("wall", "trips"), [("2.4 mm", False), ("2.45 mm", True), ("6 mm", True)])
def test_thickness_of_the_ring(wall, trips):
    violations = found(system(MACHINE, s=0.5, H=wall), CALM)
    assert ("ring_1" in violations) == trips
    if trips:
        x = pi * float(wall.split()[0]) / 12
        assert violations["ring_1"].value == pytest.approx(x)
        assert f"{tanh(x) / x:.3g}" in violations["ring_1"].sentence


def test_a_ring_that_lets_nothing_through_may_be_thick():
    assert "ring_1" not in found(system(MACHINE, s=0.5, H="6 mm", Phi="0 m^2"), CALM)


def test_fixed_arc_in_forward_whirl():
    derived = found(system(REFERENCE), CALM)
    assert derived["fixed_arc_1"].value == 8.0  # the mesh, over half of a spin of 1/4
    assert derived["fixed_arc_2"].value == 2.0  # its own unbalance; the mesh turns against it
    assert "outwards" in derived["fixed_arc_1"].sentence
    still = found(system(REFERENCE, E=0, b_p=0, b_g=0), CALM)
    assert not {"fixed_arc_1", "fixed_arc_2"} & set(still)
    assert "fixed_arc_1" not in found(system(REFERENCE, arc="positive"), CALM)


def test_fixed_arc_of_the_print():
    """Journals that spin with the mesh whirl more slowly than half of it under their unbalances."""
    violations = found(system(LITERAL), CALM)
    assert violations["fixed_arc_1"].value == violations["fixed_arc_2"].value == 2.0
    assert "outwards" not in violations["fixed_arc_1"].sentence  # without h^3 there is no such force
    assert "fixed_arc_1" not in found(system(LITERAL, E=0), CALM)


def test_clocks_of_the_paper_are_those_of_four_and_eight_teeth():
    for case in (REFERENCE, LITERAL):
        violations = found(system(case), CALM)
        assert (violations["teeth_1"].value, violations["teeth_1"].limit) == (4.0, 20.0)
        assert (violations["teeth_2"].value, violations["teeth_2"].limit) == (8.0, 40.0)


def test_journals_and_gear_of_the_print_turn_on_clocks_of_their_own():
    violations = found(system(LITERAL), CALM)
    assert (violations["spin_1"].value, violations["spin_2"].value) == (4.0, 8.0)
    assert violations["gear_sense"].value == 0.5
    assert not {"spin_1", "spin_2", "gear_sense"} & set(found(system(REFERENCE), CALM))
    assert found(system(MACHINE, r_g="1/2"), CALM)["gear_sense"].value == 0.5


def test_few_teeth():
    assert "few_teeth_1" not in found(system(MACHINE, z_p=12), CALM)
    assert found(system(MACHINE, z_p=11), CALM)["few_teeth_1"].value == 11
    assert "spin_1" in found(system(MACHINE, s=0.5, j_p=0.5), CALM)


def test_a_damper_that_does_not_turn_is_no_contradiction_but_carries_no_weight():
    violations = found(system(MACHINE, s=0.5, j_p=0, j_g=0))
    assert "spin_1" not in violations
    assert (violations["static_equilibrium"].value, violations["static_equilibrium"].limit) == (0.0, 1.0)


def test_static_equilibria_of_a_diagram():
    violation = found(system(MACHINE, s=0.5), diagram([0.5] * 4, start_found=[0, 1, 1, 1]))["static_equilibrium"]
    assert violation.value == 0.75
    assert "1 of 4" in violation.sentence


def dimensionless(**changes):
    """A system of symbols alone."""
    here = system(REFERENCE)
    return System(here.model, {**here.values, **changes})


def test_symbols_alone_are_judged_as_far_as_they_go():
    violations = found(dimensionless())
    assert set(violations) == {"mesh_load", "fixed_arc_1", "fixed_arc_2", "teeth_1", "teeth_2", "not_evaluated"}
    assert violations["mesh_load"].limit == pytest.approx(25 * 0.1)
    assert "K_p c" in violations["mesh_load"].sentence
    assert violations["teeth_1"].limit == 12
    unknown = violations["not_evaluated"]
    assert isnan(unknown.value)
    assert isnan(unknown.limit)
    for words in ("length over diameter", "Reynolds", "porous ring", "largest eccentricity"):
        assert words in unknown.sentence
    plain = found(dimensionless(psi=0.0), CALM)["not_evaluated"].sentence
    assert "porous ring" not in plain
    assert "eccentricity" not in plain


def test_only_the_gear_pair_is_judged():
    with pytest.raises(CaseError, match="duffing"):
        violations(whirlmap.load("duffing"))


def test_a_computed_diagram_is_read():
    quick = whirlmap.Settling(transient=2, most=1, keep=2)
    here = system(REFERENCE, psi=0.1)
    ds = whirlmap.bifurcation_diagram(here, "s", [2.0, 3.27], settling=quick)
    deepest = float(ds["maximum"].sel(quantity="eps_2").max())
    violations = found(here, ds)
    assert ("eccentricity_2" in violations) == (deepest > 0.9)
    assert "not_evaluated" not in violations


# --- the mesh along its line of action ---------------------------------------------------------------------

TURBO = "machines/turbo-gearbox"


def test_a_torque_that_holds_the_teeth_together_is_no_strain():
    """At rest the teeth carry nearly T_p/R_bp, 1457 N; the transmission error alone pulls with K_m e, 1200 N."""
    assert "mesh_load" not in found(system(TURBO), CALM)
    light = found(system(TURBO, P_t="-45 kW"), CALM)["mesh_load"]
    assert light.value < light.limit == pytest.approx(1200)
    assert light.value == pytest.approx(45e3 / (9000 * pi / 30) / 0.0436957, rel=0.05)
    assert "torsion = rigid_rotors" not in light.sentence


def test_without_torsion_films_that_give_way_unload_the_teeth():
    violation = found(system(TURBO, torsion="none"), CALM)["mesh_load"]
    assert violation.value < violation.limit
    assert "torsion = rigid_rotors" in violation.sentence


def test_a_journal_that_rests_near_its_wall():
    assert not [n for n in found(system(TURBO), CALM) if n.startswith("rest_")]
    deep = found(system(MACHINE, psi=0.1, mu="0.008 Pa*s"), CALM)
    assert deep["rest_eccentricity_2"].value > 0.9


def test_a_density_that_is_given_is_used():
    sentences = [s.sentence for s in found(system(TURBO), CALM).values() if "kg/m3" in s.sentence]
    assert sentences
    assert all("845 kg/m3)" in text for text in sentences)


# --- rotors of other models, and how a machine is run ------------------------------------------------------

RIG = "machines/jeffcott-rig"


@pytest.mark.parametrize(
    ("changes", "names"),
    [
        ({"c": "20 um"}, set()),
        ({"c": "20 um", "L": "17 mm"}, {"slenderness"}),
        ({"c": "5 um", "U": "1 g*mm"}, {"clearance"}),
        ({"c": "40 um"}, {"clearance"}),
        ({"c": "20 um", "U": "16 g*mm"}, {"unbalance_b"}),
        ({"c": "20 um", "speed": "500 rpm"}, {"speed_min"}),
        ({"c": "20 um", "speed": "6001 rpm"}, {"speed_max"}),
        ({"c": "20 um", "speed": "6000 rpm"}, set()),
    ],
)
def test_a_rotor_strains_what_its_numbers_say(changes, names):
    violations = found(system(RIG, VG=22, **changes))
    assert set(violations) - {"not_evaluated", "oil_temperature", "rest_eccentricity"} == names


@pytest.mark.parametrize("case", [MACHINE, RIG])
def test_the_density_of_the_oil_counts_beside_a_viscosity(case):
    violations = found(system(case, mu="0.0005 Pa*s", rho="1000 kg/m^3"))
    assert "(oil of 1000 kg/m3)" in violations["film_inertia"].sentence


def test_vortices_in_the_film_of_a_fast_rotor():
    violations = found(system(RIG, mu="0.001 Pa*s", speed="30000 rpm"))
    w = 30000 * pi / 30
    assert violations["film_reynolds"].value == pytest.approx(850 * w * 0.0125 * 1e-4 / 0.001)
    assert violations["film_reynolds"].limit == pytest.approx(41.2 * sqrt(125))
    assert violations["film_inertia"].value == pytest.approx(850 * w * 1e-8 / 0.001)


def test_the_end_of_a_sweep_that_strains_most_is_said_once():
    here = system(RIG)
    texts = repeated([here.replace(s=s) for s in (0.05, 0.1, 4.0, 8.0)])
    assert [t.split(":")[0] for t in texts if t.startswith("speed")] == ["speed_min", "speed_max"]
    assert any("23927 rpm" in t for t in texts) and any("149.55 rpm" in t for t in texts)
    assert not any("not_evaluated" in t for t in texts)
    assert repeated([whirlmap.load("duffing")]) == []
