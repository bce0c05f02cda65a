"""Energy of every Jeffcott rotor over a turn: power of the unbalance less losses is the change of what is stored."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from whirlmap.films.porous_short import film_force
from whirlmap.integrate.system import System
from whirlmap.models import family

VALUES = {"s": 1.4, "Gamma": 0.6, "b": 0.2, "k": 8.0, "xi": 0.03, "k_c": 3.0}


@pytest.mark.parametrize(
    "switches",
    [
        {"rotor": "rigid"},
        {"rotor": "flexible", "arc": "fixed"},
        {"rotor": "flexible", "arc": "positive"},
        {"bearing": "damper"},
    ],
    ids=lambda s: " ".join(s.values()),
)
def test_energy_balance_closes(switches, validate):
    """In W c: mass 1/g per bearing, so that kinetic energy is s^2 v^2/2; the film force from the velocity, by quadrature."""
    model = family("jeffcott").model(**switches)
    system = System(model, {p.name: VALUES[p.name] for p in model.parameters})
    v, names, n = VALUES, [q.name for q in model.states], model.dimension
    rigid, damper = "x" not in names, "k_c" in system.values
    spin, arc = (0, "positive") if damper else (1, model.switches["arc"])

    def parts(y):
        q = dict(zip(names, y, strict=False))
        u, w = np.array([q["ux"], q["uy"]]), np.array([q["vx"], q["vy"]])
        return u, u if rigid else np.array([q["x"], q["y"]]), w

    def stored(y):
        u, x, w = parts(y)
        bent = 0.0 if rigid else v["k"] / 2 * (x - u) @ (x - u)
        return v["s"] ** 2 / 2 * w @ w + x[1] + bent + (v["k_c"] / 2 * u @ u if damper else 0.0)

    def rates(time, y):
        out = np.empty(n + 1)
        out[:n] = system.reference_rhs(time, y[:n])
        u, _, w = parts(y)
        u_rate = out[:2]
        film = v["Gamma"] * v["s"] * np.array(film_force(*u, *(u_rate - spin / 2 * np.array([-u[1], u[0]])), 0.0, arc=arc))
        unbalance = v["s"] ** 2 * v["b"] * np.array([np.cos(time), np.sin(time)])
        out[n] = unbalance @ w + film @ u_rate - (0.0 if rigid else 2 * v["xi"] * v["s"] * w @ w)
        return out

    begin = np.zeros(n + 1)
    begin[:n] = np.array([0.4, -0.3, 0.5, -0.6, 0.2, 0.1])[:n]
    whole = solve_ivp(rates, (0.3, 0.3 + system.period), begin, method="DOP853", rtol=1e-12, atol=1e-12)
    change = stored(whole.y[:n, -1]) - stored(begin[:n])
    assert abs(whole.y[n, -1]) > 1e-2  # something happens
    shown = ", ".join(f"{key} {value}" for key, value in switches.items())
    validate(f"Jeffcott rotor ({shown}): work done over a turn", whole.y[n, -1], change, tier="invariant",
             source="change of the stored energy", within=1e-8 * max(1.0, abs(change)))  # fmt: skip
