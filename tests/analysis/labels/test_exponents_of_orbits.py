"""Exponents of points that come to their orbit late, past one that repels slowly, against SciPy's multipliers."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

import whirlmap
from whirlmap.equations import Model, Parameter, State, cos, t, when
from whirlmap.integrate.system import System

x, v = State("x", "1", "transmission error over half the backlash", start=1.1), State("v", "1", "its rate")
Omega = Parameter("Omega", "1", "mesh frequency", above=0)
teeth = when(x > 1, x - 1, when(x < -1, x + 1, 0))
rates = {x: v, v: 0.1 + 0.05 * Omega**2 * cos(Omega * t) - 0.1 * v - (1 + 0.2 * cos(Omega * t)) * teeth}
#: Kahraman and Singh's pair where its stiffness pumps the teeth at half the mesh frequency, barely beyond the damping.
PAIR = Model(name="pair", states=(x, v), parameters=(Omega,), harmonics=(Omega,), equations=rates, swing=(x,))


def two_periods(state, speed):
    def right_side(time, y):
        force = np.sign(y[0]) * max(abs(y[0]) - 1, 0)
        wave = np.cos(speed * time)
        return [y[1], 0.1 + 0.05 * speed**2 * wave - 0.1 * y[1] - (1 + 0.2 * wave) * force]

    end = 4 * np.pi / speed
    return solve_ivp(right_side, (0, end), state, method="DOP853", rtol=1e-11, atol=1e-13, max_step=end / 200).y[:, -1]


def test_an_orbit_that_is_come_to_late_has_its_own_exponent():
    speed = 1.996
    found = whirlmap.bifurcation_diagram(System(PAIR, {"Omega": speed}), "Omega", [speed], states=["x", "v"]).isel(Omega=0)
    assert whirlmap.labels(found).item() == "periodic" and found.period_T.item() == 2
    assert found.settled_after.item() > 200, "the point returns early: the test is not about late ones"
    orbit = fsolve(lambda y: two_periods(y, speed) - y, found.section.values[-1], xtol=1e-11, factor=0.1)
    small = 1e-6 * np.eye(2)
    matrix = np.stack([(two_periods(orbit + d, speed) - two_periods(orbit - d, speed)) / 2e-6 for d in small], axis=1)
    exponent = np.log(np.abs(np.linalg.eigvals(matrix)).max()) / (4 * np.pi / speed)
    assert found.lyapunov.item() == pytest.approx(exponent, rel=1e-3)
