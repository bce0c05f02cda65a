"""A mesh that transmits nothing: its flanks are those of a small positive torque, and its machine rests by its weight."""

from math import pi

import pytest
from sympy import Integer
from tests.machines.wrong_machines import GOOD

import whirlmap
from whirlmap.errors import CaseError
from whirlmap.integrate.equilibrium import start_states
from whirlmap.machines.train import driving

#: The gear's coupling holds the rotation of both shafts: at rest the teeth carry the transmitted load and nothing else.
TURNING = GOOD.replace('reference = "pinion"', 'reference = "pinion"\ntorsion = "free"').replace(
    'support = "pedestal"\n', ""
).replace(GOOD[GOOD.index("[[support]]") : GOOD.index("[[mesh]]")], "") + (
    '[[coupling]]\nname = "motor"\nshaft = "gear"\nat = 0\nk_t = "2e4 N*m/rad"\n'
)


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    made = tmp_path_factory.mktemp("idle") / "machine.toml"
    made.write_text(TURNING, encoding="utf-8")
    return made


@pytest.mark.parametrize(
    ("torque", "tau"), [("20 N*m", 1), ("1e-9 N*m", 1), ("0 N*m", 1), ("-1e-9 N*m", -1), ("-20 N*m", -1)]
)
def test_the_flanks_are_those_that_drive(file, torque, tau):
    """phi_m = beta_c + S tau (pi/2 - alpha); an idle mesh has the flanks of a positive torque."""
    system = whirlmap.load(file, **{"mesh.teeth.T": torque, "mesh.teeth.beta_c": "30 deg"})
    assert float(system.values["tau_teeth"]) == tau
    assert float(system.values["phi_m_teeth"]) == pytest.approx(pi / 6 + tau * (pi / 2 - pi / 9), rel=1e-14)


def test_phases_follow_the_same_rule():
    assert [driving(Integer(torque)) for torque in (-3, -1, 0, 1, 3)] == [-1, -1, 1, 1, 1]


@pytest.mark.parametrize("power", ["0 kW", "1 W"])
def test_an_idle_machine_rests_by_its_weight_alone(file, power, validate):
    """Reactions of each shaft by the lever rule: at rest the teeth carry nothing, for nothing else turns the pinion."""
    system = whirlmap.load(file, **{"mesh.teeth.P": power, "mesh.teeth.speed_P": "9000 rpm"})
    x, found = start_states(system.model, system.vector[:, None])
    assert found[0]
    numbers = dict(zip(system.model.states, x[:, 0], strict=True))
    numbers |= {p: float(system.values[p.name]) for p in system.model.parameters}
    force, loads, known = system.machine.quantities["force_unit"][0], [], []
    for rotor in system.machine.case.parts.machine.rotors:
        left, right = (float(system.model.outputs[f"load_{b}"].expression.subs(numbers)) for b in rotor.bearings)
        loads += [force * left, force * right]
        weight, shaft = 9.81 * rotor.shaft.mass, rotor.shaft
        known += [weight * (1 - shaft.centre / 0.2), weight * shaft.centre / 0.2]
    if power == "0 kW":
        validate("idle geared rotors on four films: loads at rest in N", loads, known, tier="exact",
                 source="lever rule", rel=1e-6)  # fmt: skip
    else:
        assert loads == pytest.approx(known, rel=1e-3)  # 1 W is 0.04 N at the teeth


def test_idle_teeth_with_backlash_are_refused_in_words_of_the_file(file):
    """Nothing holds them on one side, so that there is no place of rest."""
    with pytest.raises(CaseError, match=r"F_0_teeth = 0 with backlash = dead_zone.*give mesh\.teeth\.T"):
        whirlmap.load(file, **{"mesh.teeth.T": "0 N*m", "mesh.teeth.backlash": "dead_zone", "mesh.teeth.j_n": "100 um"})
