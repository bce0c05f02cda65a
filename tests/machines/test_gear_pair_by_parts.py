"""The paper's gear pair by parts has the rates of `gear_pair`, in every switch that parts can say."""

from itertools import product

import numpy as np
import pytest
from tests.machines import pair_by_parts as by_parts

import whirlmap
from whirlmap.models import family

OFF = {
    "edition": "physical", "film": "porous", "arc": "fixed", "contact": "stop", "mesh": "isotropic", "stiffness": "constant",
    "backlash": "none", "torsion": "none", "suspension": "cubic", "centring": "none",
}  # fmt: skip
LINES = [
    {"mesh": "line", "stiffness": k, "backlash": b, "torsion": q}
    for k, b, q in product(("constant", "fourier", "rectangular"), ("none", "dead_zone"), ("none", "rigid_rotors"))
]
CHOICES = [
    *({"edition": e, "arc": a} for e, a in product(("intended", "physical"), ("fixed", "positive"))),
    {"edition": "intended", "film": "printed"}, {"film": "printed", "contact": "ignore"},
    {"suspension": "linear"}, {"centring": "spring"}, {"contact": "rub"}, {"contact": "rub", "arc": "positive"},
    *LINES, *({**one, "edition": "intended", "contact": "rub", "centring": "spring"} for one in LINES[4:8]),
]  # fmt: skip


def numbers(switches, rng, n, plain):
    q = by_parts.scattered(by_parts.INPUTS, rng) | ({"Phi": 0.0} if plain else {})
    q |= {"z_p": 4, "z_g": 8} if switches["edition"] == "intended" else {"z_p": 20, "z_g": 31}
    if switches["mesh"] == "line":
        q |= by_parts.scattered(by_parts.LINE, rng) | {"beta_c": rng.uniform(-3, 3)}
        q["T_p"] *= (1, -1)[n % 2]
        q |= {"constant": {}, "fourier": by_parts.FOURIER, "rectangular": by_parts.STEP}[switches["stiffness"]]
    if switches["torsion"] != "none":
        q |= by_parts.scattered(by_parts.TURNING, rng)
    if switches["backlash"] == "dead_zone":
        q["j_n"] = 0.3 * q["c"]
    if switches["contact"] == "rub":
        q |= by_parts.RUB | {"mu_r": 0.2}
    if switches["centring"] == "spring":
        q |= {"k_c1": 3e6, "k_c2": 5e6}
    return q


def both(folder, switches, rng, n, plain):
    """The same machine as a gear pair and by parts, at the same clock."""
    q, chi_g = numbers(switches, rng, n, plain), float(rng.uniform(-3, 3))
    file = folder / f"pair{n}.toml"
    file.write_text(by_parts.written(switches, q, chi_g), encoding="utf-8")
    clock = {"r_pinion": "1/4"} if switches["edition"] == "intended" else {}
    return whirlmap.load(family("gear_pair"), **by_parts.pair_inputs(switches, q, chi_g)), whirlmap.load(file, **clock)


def in_states(pair, parts, x):
    """States by parts of a state of the gear pair: arcs count along the rotation there, along the tooth force here."""
    found = dict(zip(pair.states, x, strict=True))
    sense = float(parts.values.get("tau_teeth", 1.0))
    return np.array([found[by_parts.STATES[n]] * (sense if "q" in n else 1.0) for n in parts.states])


@pytest.mark.parametrize("plain", [False, True], ids=["porous", "plain"])
@pytest.mark.parametrize("chosen", CHOICES, ids=lambda one: "-".join(one.values()))
def test_rates_are_those_of_the_gear_pair(tmp_path, chosen, plain):
    switches = OFF | chosen
    if plain and switches["film"] == "printed":
        pytest.skip("a printed film has a ring")
    rng = np.random.default_rng([5, *map(len, switches.values()), plain])
    sides = set()
    for n in range(2):
        pair, parts = both(tmp_path, switches, rng, n, plain)
        assert len(pair.states) == len(parts.states)
        for _ in range(6):
            tau, x = rng.uniform(0, 50), rng.uniform(-0.6, 0.6, len(pair.states))
            for i in (0, 2):
                size, angle = 1 - 10 ** rng.uniform(-2, 0), rng.uniform(-np.pi, np.pi)
                x[i : i + 2] = size * np.cos(angle), size * np.sin(angle)
            expected = in_states(pair, parts, pair.reference_rhs(tau, x))
            got = parts.reference_rhs(tau, in_states(pair, parts, x))
            assert np.max(np.abs(got - expected) / np.maximum(1.0, np.abs(expected))) < 1e-12
            sides.add(float(np.hypot(x[0], x[1])) > 0.8)
    assert sides == {True, False}  # near the wall, where it rubs, and away from it


def test_the_compiled_kernel_has_them_too(tmp_path):
    """Every switch at once: tables and all, to the accuracy of the tables."""
    switches = OFF | {**LINES[-1], "contact": "rub", "centring": "spring"}
    rng = np.random.default_rng(8)
    pair, parts = both(tmp_path, switches, rng, 0, False)
    x = rng.uniform(-0.5, 0.5, (len(pair.states), 8))
    expected = np.stack([in_states(pair, parts, column) for column in pair.rhs(1.7, x).T], axis=1)
    got = parts.rhs(1.7, np.stack([in_states(pair, parts, column) for column in x.T], axis=1))
    np.testing.assert_allclose(got, expected, rtol=1e-10, atol=1e-10)


def test_period_and_clocks_are_those_of_the_gear_pair(tmp_path):
    for edition in ("intended", "physical"):
        pair, parts = both(tmp_path, OFF | {"edition": edition}, np.random.default_rng(3), 0, False)
        assert (parts.period, parts.common_multiple) == (pair.period, pair.common_multiple)
        assert float(parts.values["s"]) == pytest.approx(float(pair.values["s"]), rel=1e-15)
        assert parts.machine.quantities["omega_0"][0] == pytest.approx(pair.machine.quantities["omega_0"][0], rel=1e-15)
