"""Couplings of two shafts, drivers and loads: speeds, lateral and torsional modes, against matrices written out here."""

import numpy as np
import pytest
from tests.machines.test_coefficients import bearing, loaded
from tests.machines.wrong_machines import GOOD

import whirlmap
from whirlmap.analysis.linear.truncation import truncation
from whirlmap.equations.run_up import ACCELERATION, running_up
from whirlmap.integrate.evaluation import Evaluator

SPRING = 'k_xx = "4e6 N/m"\nk_yy = "4e6 N/m"\nc_xx = "2e3 N*s/m"\nc_yy = "2e3 N*s/m"\n'


def stub(name, d, n=2):
    elements = f'elements = [ {{ L = "40 mm", d = "{d} mm", n = {n} }} ]'
    return f'[[shaft]]\nname = "{name}"\nmaterial = "steel"\nmodes = 0\n{elements}\n'


def on(shaft, name, at, law=SPRING):
    return bearing(name, at, law).replace('shaft = "rotor"', f'shaft = "{shaft}"')


TWO = (
    'model = "machine"\n[operation]\nreference = "a"\nspeed = "2000 rpm"\ng = "0 m/s^2"\n' + stub("a", 160) + stub("b", 120)
    + on("a", "a1", 0) + on("a", "a2", 2) + on("b", "b1", 0) + on("b", "b2", 2)
    + '[[unbalance]]\nname = "u"\nshaft = "b"\nat = 1\nU = "50 g*mm"\n'
)  # fmt: skip
JOINED = '[[coupling]]\nname = "flex"\nshaft = "a"\nat = 1\nto = "b"\nat_to = 1\nk_r = "6e6 N/m"\nc_r = "800 N*s/m"\n'


def test_two_stubs_and_their_spring_are_two_masses(tmp_path):
    """Translations of two short thick shafts at their middles: m_a, m_b on 2 k each, joined by k_r, c_r."""
    system = loaded(tmp_path, TWO + JOINED)
    assert float(system.values["r_b"]) == float(system.values["r_a"]) == 1
    m = np.diag([system.machine.given[f"shaft.{name}.m"] for name in "ab"])
    joint = np.array([[1.0, -1.0], [-1.0, 1.0]])
    K, C = 8e6 * np.eye(2) + 6e6 * joint, 4e3 * np.eye(2) + 800 * joint
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(m, K), -np.linalg.solve(m, C)]])
    ours = whirlmap.linear_analysis(system).eigenvalues * 2000 * np.pi / 30
    for z in np.linalg.eigvals(A):
        assert np.abs(ours - z).min() < 3e-3 * abs(z)  # the stubs are not quite rigid


def test_a_driver_holds_a_shaft_across_its_axis(tmp_path):
    """Without ``to`` the other end stands still: one more spring to the ground."""
    held = '[[coupling]]\nname = "drive"\nshaft = "a"\nat = 1\nk_r = "3e6 N/m"\n'
    system = loaded(tmp_path, TWO + JOINED.replace('"6e6 N/m"', '"0 N/m"').replace('"800 N*s/m"', '"0 N*s/m"') + held)
    m = system.machine.given["shaft.a.m"]
    roots = np.roots([m, 4e3, 8e6 + 3e6])
    ours = whirlmap.linear_analysis(system).eigenvalues * 2000 * np.pi / 30
    assert all(np.abs(ours - z).min() < 3e-3 * abs(z) for z in roots)


@pytest.mark.parametrize("free", [pytest.param(False, marks=pytest.mark.slow), True])
def test_a_motor_in_a_train_agrees_with_all_matrices(tmp_path, free):
    """Motor, coupling, pinion, gear: lateral, and with torsion, where the driver turns the motor."""
    motor = stub("motor", 90, 4).replace("modes = 0\n", "").replace('"40 mm"', '"400 mm"')
    text = GOOD.replace("[[disk]]", motor + "[[disk]]", 1)
    text += on("motor", "m1", 0, SPRING.replace("4e6", "4e7")) + on("motor", "m2", 4, SPRING.replace("4e6", "4e7"))
    text += '[[disk]]\nname = "armature"\nshaft = "motor"\nat = 2\nm = "30 kg"\nI_d = "0.2 kg*m^2"\nI_p = "0.3 kg*m^2"\n'
    text += '[[coupling]]\nname = "flex"\nshaft = "motor"\nat = 4\nto = "pinion"\nat_to = "50 mm"\nk_r = "5e6 N/m"\n'
    if free:
        text = text.replace('reference = "pinion"', 'reference = "pinion"\ntorsion = "free"') + 'k_t = "2e4 N*m/rad"\n'
        text += '[[coupling]]\nname = "drive"\nshaft = "motor"\nat = 0\nk_t = "4e4 N*m/rad"\nc_t = "3 N*m*s/rad"\n'
    system = loaded(tmp_path, text)
    assert float(system.values["r_motor"]) == 1 and len(system.machine.case.parts.machine.rotors) == 3
    found = truncation(system)
    assert found.error.size >= 5 and found.holds


def motor_on_its_coupling():
    """A train whose teeth hold nothing, so that motor and pinion turn on two springs."""
    motor = stub("motor", 60, 2)
    text = GOOD.replace("[[disk]]", motor + "[[disk]]", 1).replace('K_m = "1e8 N/m"', 'K_m = "1 N/m"')
    text = text.replace('reference = "pinion"', 'reference = "pinion"\ntorsion = "free"')
    text += on("motor", "m1", 0) + on("motor", "m2", 2)
    text += '[[disk]]\nname = "armature"\nshaft = "motor"\nat = 1\nm = "30 kg"\nI_d = "0.2 kg*m^2"\nI_p = "0.3 kg*m^2"\n'
    text += '[[coupling]]\nname = "flex"\nshaft = "motor"\nat = 1\nto = "pinion"\nat_to = 1\n'
    text += 'k_r = "1e3 N/m"\nk_t = "300 N*m/rad"\n'
    text += '[[coupling]]\nname = "drive"\nshaft = "motor"\nat = 1\nk_t = "500 N*m/rad"\n'
    text += '[[coupling]]\nname = "load"\nshaft = "gear"\nat = 1\nk_t = "100 N*m/rad"\n'
    return text.replace('T = "20 N*m"', 'T = "1e-9 N*m"')


def test_the_inertia_of_a_run_up_twists_the_couplings(tmp_path):
    """Under an acceleration the drive carries (J_motor + J_pinion) domega/dt, the other coupling J_pinion domega/dt."""
    system = loaded(tmp_path, motor_on_its_coupling())
    given, machine, s = system.machine.given, system.machine.case.parts.machine, float(system.values["s"])
    a, omega_0 = 1e-3, system.machine.quantities["omega_0"][0]
    moving = whirlmap.System(
        running_up(system.model, "s"), {**{k: v for k, v in system.values.items() if k != "s"}, ACCELERATION: a}
    )
    still = whirlmap.System(moving.model, {**moving.values, ACCELERATION: 0.0})
    turning = [i for i, name in enumerate(system.states) if name.startswith(("q", "vq"))]
    x = np.append(np.full(len(system.states), 1e-3), s)
    pushed, slopes = (moving.rhs(0.0, x) - still.rhs(0.0, x))[turning], still.jacobian(0.0, x)[np.ix_(turning, turning)]
    # without the term of the clock, -lambda v
    pushed -= np.array([-a / s**2 * 1e-3 if system.states[i].startswith("v") else 0.0 for i in turning])
    bent = dict(zip([system.states[i] for i in turning], np.linalg.solve(slopes, -pushed), strict=True))
    R_b, c_0 = 3e-3 * 20 * np.cos(np.radians(20)) / 2, 40e-6
    twist = {}
    for name in ("motor", "pinion"):
        rotor = next(r for r in machine.rotors if r.name == name)
        shape = rotor.shaft.twisting.shapes[1]
        twist[name] = shape @ [bent[q.name] for q in rotor.arcs] * c_0 / R_b
    J, torque = {n: given[f"shaft.{n}.J"] for n in twist}, a * omega_0**2
    assert twist["motor"] == pytest.approx(-(J["motor"] + J["pinion"]) * torque / 500, rel=1e-3)
    assert twist["pinion"] - twist["motor"] == pytest.approx(-J["pinion"] * torque / 300, rel=1e-3)


def test_torsion_of_a_motor_on_its_coupling(tmp_path):
    """The rotation of motor and pinion is two inertias on two springs."""
    system = loaded(tmp_path, motor_on_its_coupling())
    J = [system.machine.given[f"shaft.{name}.J"] for name in ("motor", "pinion")]
    K = np.array([[800.0, -300.0], [-300.0, 300.0]])
    expected = np.sqrt(np.linalg.eigvals(K / np.array(J)[:, None]))
    turning = [i for i, name in enumerate(system.states) if name.startswith(("q", "vq"))]
    n = len(system.states)
    evaluate = Evaluator.of(system.model, system.vector[:, None], jacobian=True)
    _, slopes = evaluate(0.0, np.full((n, 1), 1e-3), np.zeros(1, dtype=int), forced=False)
    rates = np.linalg.eigvals(slopes[:, :, 0][np.ix_(turning, turning)]).imag * 9000 * np.pi / 30
    for w in expected:
        assert np.abs(rates - w).min() < 2e-3 * w
