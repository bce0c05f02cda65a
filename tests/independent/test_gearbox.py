"""Right-hand sides of the switched physics against Newton's equations in SI."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from tests.independent import newton_gearbox
from tests.independent.newton import Machine
from tests.independent.newton_gearbox import Gearbox

from whirlmap.integrate.system import System
from whirlmap.models import family

RATIOS = {"r_p": 1.0, "r_g": -0.5, "r_m": 20.0, "j_p": 1.0, "j_g": -0.5}
STEP = {"CR": 1.6, "v_m": 0.5, "chi_m": 0.7}
HARMONICS = {
    "constant": (),
    "fourier": ((0.3, 0.4), (-0.2, 1.1), (0.1, -2.0)),
    "rectangular": tuple(
        (0.5 * np.sinc(n / 7) * 2 * np.sin(n * np.pi * 0.6) / (n * np.pi), -0.7 * n) for n in range(1, 7)
    ),
}  # fmt: skip


def random_state(rng, n):
    x = rng.uniform(-0.6, 0.6, n)
    for i in (0, 2):
        size, angle = 1 - 10 ** rng.uniform(-2, 0), rng.uniform(-np.pi, np.pi)
        x[i : i + 2] = size * np.cos(angle), size * np.sin(angle)
    return x


def system(box, s, **switches):
    model = family("gear_pair").model(edition="physical", **switches)
    groups = {**box.machine.groups(s, **RATIOS), **box.groups(), **STEP}
    return System(model, {p.name: groups[p.name] for p in model.parameters})


@pytest.mark.parametrize("arc", ["fixed", "positive"])
@pytest.mark.parametrize(
    ("stiffness", "backlash", "torsion"),
    list(product(HARMONICS, ["none", "dead_zone"], ["none", "rigid_rotors"])),
)
def test_right_hand_side_is_newtons_law(stiffness, backlash, torsion, arc):
    rng = np.random.default_rng([21, len(stiffness), len(backlash), len(torsion), len(arc)])
    sides, rubbed = set(), 0
    for n in range(16):
        turning = torsion == "rigid_rotors"
        box = Gearbox(
            T_p=(30.0, -30.0)[n % 2], turning=turning, K_r=2e8, mu_r=0.2, touch=10e-6, k_c1=3e6, k_c2=5e6,
            play=8e-6 if backlash == "dead_zone" else None, harmonics=HARMONICS[stiffness],
        ).scattered(rng)  # fmt: skip
        s, tau = rng.uniform(0.6, 4.0), rng.uniform(0, 50)
        x = random_state(rng, 24 if turning else 20)
        here = system(
            box, s, arc=arc, mesh="line", stiffness=stiffness, backlash=backlash, torsion=torsion, contact="rub",
            centring="spring", suspension="linear",
        )  # fmt: skip
        expected, delta = newton_gearbox.rates(box, s, tau, x, **RATIOS, arc=arc, cubic=False)
        got = here.reference_rhs(tau, x)
        assert np.max(np.abs(got - expected) / np.maximum(1.0, np.abs(expected))) < 2e-12
        sides.add("drive" if delta > 0 else "back" if box.play and delta < -box.play else "gap")
        rubbed += np.hypot(x[0], x[1]) > float(here.values["eps_r"])
    assert {"drive", "back"} <= sides or backlash == "none"
    assert rubbed > 0


def test_without_any_of_it_the_gearbox_is_the_machine():
    """Isotropic in the one, without torque, torsion and walls in the other: all but the mesh agrees."""
    from tests.independent import newton

    rng = np.random.default_rng(3)
    box = Gearbox(machine=replace(Machine(), K_m=1e-9, C_m=0.0), T_p=1e-30)
    x = random_state(rng, 20)
    plain = newton.rates(box.machine, 1.3, 2.0, x, **RATIOS, arc="fixed")
    np.testing.assert_allclose(newton_gearbox.rates(box, 1.3, 2.0, x, **RATIOS, arc="fixed")[0], plain, rtol=1e-10)
