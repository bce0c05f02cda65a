"""Rubs at a station: force and friction, a shaft that rests on its casing, and the full annular rub in closed form."""

import numpy as np
import pytest
from scipy.optimize import brentq
from tests.machines.test_coefficients import loaded
from tests.machines.wrong_machines import GOOD

SPEED = 400.0
#: A stub of a shaft that only translates: a Jeffcott rotor on two equal springs and dampers.
STUB = f"""model = "machine"
[operation]
speed = "{SPEED} rad/s"
g = "0 m/s^2"
[[shaft]]
name = "rotor"
material = "steel"
modes = 0
elements = [ {{ L = "40 mm", d = "160 mm", n = 2 }} ]
[[unbalance]]
name = "u"
shaft = "rotor"
at = 1
U = "600 g*mm"
"""
for name, at in (("a", 0), ("b", 2)):
    STUB += f'[[bearing]]\nname = "{name}"\nshaft = "rotor"\nat = {at}\nkind = "coefficients"\n'
    STUB += 'k_xx = "4e5 N/m"\nk_yy = "4e5 N/m"\nc_xx = "150 N*s/m"\nc_yy = "150 N*s/m"\n'
RUB = '[[rub]]\nname = "seal"\nshaft = "rotor"\nat = 1\nclearance = "80 um"\nK_r = "6e5 N/m"\nmu_r = 0.05\n'


@pytest.mark.slow
def test_friction_pushes_against_the_rotation_of_each_shaft(tmp_path):
    """Rates with and without the rub, at a place where the shaft touches; the gear turns clockwise."""
    for shaft, sense in (("pinion", 1), ("gear", -1)):
        rub = f'[[rub]]\nname = "seal"\nshaft = "{shaft}"\nat = 1\nclearance = "30 um"\nK_r = "2e8 N/m"\nmu_r = 0.1\n'
        # The plain machine has an attachment mode there as well: its mesh acts at the same station.
        plain, rubbing = loaded(tmp_path, GOOD), loaded(tmp_path, GOOD + rub)
        assert plain.states == rubbing.states
        x = np.zeros(len(plain.states))
        x[plain.states.index(f"y_{shaft}")] = 2.0  # of c_0 = 40 um
        pushed = rubbing.rhs(0.3, x) - plain.rhs(0.3, x)
        s, K_0 = float(plain.values["s"]), plain.machine.given["shaft.pinion.K"]
        rotor = next(r for r in plain.machine.case.parts.machine.rotors if r.name == shaft)
        N = 2e8 * (2.0 * 40e-6 - 30e-6) / (K_0 * 40e-6)
        size = N / (s**2 * float(plain.values[f"nu_{shaft}"]) * rotor.numbers.mass[0])
        assert pushed[plain.states.index(f"vy_{shaft}")] == pytest.approx(-size, rel=1e-9)
        assert pushed[plain.states.index(f"vx_{shaft}")] == pytest.approx(0.1 * sense * size, rel=1e-9)


def test_a_shaft_rests_on_its_casing(tmp_path):
    """Weight on springs and casing in parallel beyond the clearance; without friction straight below."""
    text = (STUB + RUB).replace('g = "0 m/s^2"', 'g = "9.81 m/s^2"').replace('"4e5 N/m"', '"2e5 N/m"')
    system = loaded(tmp_path, text.replace("80 um", "20 um").replace("mu_r = 0.05\n", ""))
    from whirlmap import linear_analysis

    m, rest = system.machine.given["shaft.rotor.m"], linear_analysis(system).equilibrium
    (rotor,) = system.machine.case.parts.machine.rotors
    y = [1e-4 * rest[system.states.index(q.name)] for q in rotor.coordinates("y")]
    sunk = (m * 9.81 + 6e5 * 20e-6) / (4e5 + 6e5)
    assert sunk > 20e-6
    assert -rotor.numbers.shapes[1] @ y == pytest.approx(sunk, rel=1e-3)  # the stub is not quite rigid


def test_full_annular_rub_is_the_closed_form(tmp_path):
    """A circular orbit that touches all the time: |k - m w^2 + i c w + K_r (1 - d/r)(1 + i mu)| r = m e w^2."""
    from whirlmap import simulate

    system = loaded(tmp_path, STUB + RUB)
    ds = simulate(system, transient=200, periods=2)
    m, w = system.machine.given["shaft.rotor.m"], SPEED

    def left(r):
        return abs(8e5 - m * w**2 + 300j * w + 6e5 * (1 - 80e-6 / r) * (1 + 0.05j)) * r - 600e-6 * w**2

    r = brentq(left, 81e-6, 5e-3)
    gap = 80e-6 - 1e-4 * 0 - r
    ours = 1e-4 * ds["outputs"].sel(output="gap_seal").values
    assert ours == pytest.approx(np.full(ours.shape, gap), rel=2e-3)
    force = ds["outputs"].sel(output="force_seal").values * system.machine.given["shaft.rotor.K"] * 1e-4
    assert force == pytest.approx(np.full(ours.shape, 6e5 * (r - 80e-6) * np.hypot(1, 0.05)), rel=2e-3)
