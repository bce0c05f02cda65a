"""Energy of the gear pair with every film and physics switch: what comes in is lost or stored."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.models.gear_mechanics import SWITCHED, VALUES, Energy, pair

FILMS = [
    ({"arc": "fixed"}, {"psi": 0.1}),
    ({"arc": "positive"}, {}),
    ({"arc": "positive"}, {"psi": 0.1}),
    ({"arc": "positive", "centring": "spring"}, {"j_p": 0.0, "j_g": 0.0}),  # dampers that do not turn
]


@pytest.mark.parametrize(
    ("switches", "changes"), [*(({"arc": "fixed", **s}, {}) for s in SWITCHED), *FILMS],
    ids=lambda s: " ".join(f"{k}={v}" for k, v in s.items()) or "as derived",
)  # fmt: skip
def test_energy_balance_closes(switches, changes, validate):
    """Power in less losses less the change of what is stored, over one mesh period, after the motion has begun."""
    system = pair(changes, **switches)
    n, energy = system.model.dimension, Energy(system)
    k, k_rate = energy.stiffness()
    seen = {"loose": 0.0, "rubbing": 0.0}

    def rates(time, y):
        out = np.empty(n + 1)
        out[:n] = system.reference_rhs(time, y[:n])
        out[n], q = energy.power(time, y[:n], out[:4], k(time), k_rate(time))
        if "mesh" in energy.on:
            seen["loose"] = min(seen["loose"], float(q["delta"] - q["te"]))
        seen["rubbing"] = max(seen["rubbing"], np.hypot(*q["u1"]), np.hypot(*q["u2"]))
        return out

    rng = np.random.default_rng(1)
    begin = np.concatenate([0.2 * rng.uniform(-1, 1, n), [0.0]])
    begin[2:4] = 0.4, -0.55
    whole = solve_ivp(rates, (0.7, 0.7 + system.period), begin, method="DOP853", rtol=1e-12, atol=1e-12)
    y = whole.y[:, -1]
    first, last = whole.t[0], whole.t[-1]
    change = energy.stored(last, y[:n], k(last)) - energy.stored(first, begin[:n], k(first))
    assert abs(y[n]) > 1e-3  # something happens
    shown = ", ".join(f"{key} {value}" for key, value in switches.items())
    validate(f"gear pair ({shown}): work done over a mesh period", y[n], change, tier="invariant",
             source="change of the stored energy", within=1e-8 * max(1.0, abs(y[n])))  # fmt: skip
    if "backlash" in energy.on:
        assert seen["loose"] < 0.0
    if "contact" in energy.on:
        assert seen["rubbing"] > VALUES["eps_r"]
