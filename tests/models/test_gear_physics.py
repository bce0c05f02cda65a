"""Every physics switch of the gear pair: energy, momentum, frames, limits, refusals."""

from itertools import product

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from sympy import lambdify, symbols

from whirlmap.equations import t
from whirlmap.errors import CaseError, ModelError
from whirlmap.films import porous_short
from whirlmap.films.law import plain_fixed_force
from whirlmap.integrate.system import System
from whirlmap.models import family, mesh
from whirlmap.models.gear_pair import BEYOND

VALUES = {
    "s": 1.7, "psi": 0.0, "f": 0.49, "Lambda": 25.0, "xi_p": 0.02, "xi_g": 0.014, "xi_m": 0.22, "xi_1": 0.05,
    "xi_2": 0.05, "nu_g": 4.0, "kappa_g": 2.0, "nu_1": 0.5, "nu_2": 1.0, "S_1": 0.32, "S_2": 0.32, "a_1": 1.25,
    "a_2": 1.25, "b_p": 0.1, "b_g": 0.2, "E": 0.3, "Gamma_1": 1.1, "Gamma_2": 2.3, "r_p": 1.0, "r_g": -0.5, "r_m": 20.0,
    "j_p": 1.0, "j_g": -0.5, "chi_p": 0.3, "chi_g": -1.0,
    "F_0": 0.8, "phi_m": 1.3, "v_1": 0.3, "v_2": -0.2, "v_3": 0.1, "chi_1": 0.4, "chi_2": 1.0, "chi_3": -2.0,
    "CR": 1.6, "v_m": 0.6, "chi_m": 0.5, "B_m": 0.05,
    "iota_p": 0.6, "iota_g": 2.5, "kappa_tp": 8.0, "kappa_tg": 5.0, "xi_tp": 0.1, "xi_tg": 0.2,
    "eps_r": 0.6, "kappa_r": 30.0, "mu_r": 0.2, "kappa_c1": 0.3, "kappa_c2": 0.6,
}  # fmt: skip


def pair(changes=None, **switches):
    model = family("gear_pair").model(**{"edition": "physical", **switches})
    values = {**VALUES, **(changes or {})}
    return System(model, {p.name: values[p.name] for p in model.parameters})


# --- energy ------------------------------------------------------------------------------------------------

#: One of each switch on its own, and all of them at once.
SWITCHED = [
    {},
    {"suspension": "linear"},
    {"centring": "spring"},
    {"contact": "rub"},
    {"mesh": "line"},
    {"mesh": "line", "stiffness": "fourier"},
    {"mesh": "line", "stiffness": "rectangular"},
    {"mesh": "line", "backlash": "dead_zone"},
    {"mesh": "line", "torsion": "rigid_rotors"},
    {
        "mesh": "line", "stiffness": "rectangular", "backlash": "dead_zone", "torsion": "rigid_rotors", "contact": "rub",
        "centring": "spring", "suspension": "linear",
    },
]  # fmt: skip

#: Every film: switches, and changes of values.
FILMS = [
    ({"arc": "fixed"}, {"psi": 0.1}),
    ({"arc": "positive"}, {}),
    ({"arc": "positive"}, {"psi": 0.1}),
    ({"arc": "positive", "centring": "spring"}, {"j_p": 0.0, "j_g": 0.0}),  # dampers that do not turn
]

ux, uy, wx, wy = symbols("ux uy wx wy", real=True)
_FILM = lambdify((ux, uy, wx, wy), plain_fixed_force(ux, uy, wx, wy), "math")


def film_force(u, slip, sense, psi, arc):
    """Force of a film from the velocity, the other way round than the model uses it."""
    if arc == "positive" or psi > 0.0:
        return np.array(porous_short.film_force(*u, *slip, psi, arc=arc, sigma=sense))
    force = np.array(_FILM(u[0], sense * u[1], slip[0], sense * slip[1]))  # mirrored where the journal turns clockwise
    return force * (1, sense)


class Energy:
    """Stored energy and power of one system, in m_p c^2 (clock speed)^2, written from mechanics alone."""

    def __init__(self, system):
        self.v = {name: float(value) for name, value in system.values.items()}
        self.on = {name for name, value in system.model.switches.items() if value != BEYOND.get(name)}
        self.switches, self.names = system.model.switches, [s.name for s in system.model.states]

    def at(self, time, x):
        """Unpack a state into vectors, and the mesh's deflection."""
        v, q = self.v, dict(zip(self.names, x, strict=True))
        for a, b in (("u1", "u1{}"), ("u2", "u2{}"), ("P", "{}p"), ("G", "{}g"), ("H1", "{}1"), ("H2", "{}2")):
            q[a] = np.array([q[b.format(axis)] for axis in "xy"])
        for a, b in (("vP", "p"), ("vG", "g"), ("v1", "1"), ("v2", "2")):
            q[a] = np.array([q[f"vx{b}"], q[f"vy{b}"]])
        phase = v["r_m"] * time
        if "mesh" not in self.on:
            turn = np.array([np.cos(phase), np.sin(phase)])
            slew = v["r_m"] * np.array([-turn[1], turn[0]])
            q["delta"], q["approach"] = q["P"] - q["G"], q["vP"] - q["vG"]
            q["te"], q["te_rate"], q["n"] = v["E"] * turn, v["E"] * slew, np.eye(2)
            return q
        q["n"] = np.array([np.cos(v["phi_m"]), np.sin(v["phi_m"])])
        q["delta"] = v["F_0"] / v["Lambda"] + q["n"] @ (q["P"] - q["G"])
        q["approach"] = q["n"] @ (q["vP"] - q["vG"])
        if "torsion" in self.on:
            q["delta"], q["approach"] = q["delta"] + q["qp"] - q["qg"], q["approach"] + q["vqp"] - q["vqg"]
        q["te"], q["te_rate"] = v["E"] * np.cos(phase), -v["E"] * v["r_m"] * np.sin(phase)
        return q

    def stiffness(self):
        """Mesh stiffness over its mean, and its rate; from the declaration, checked by a test of its own."""
        k = mesh.stiffness_over_mean(self.switches["stiffness"], self.v["r_m"] * t)
        numbers = {q: self.v[q.name] for q in k.free_symbols - {t}}
        return lambdify(t, k.subs(numbers)), lambdify(t, k.diff(t).subs(numbers))

    def pressed(self, deflection):
        if "backlash" not in self.on:
            return deflection
        return max(deflection, 0.0) + min(deflection + self.v["B_m"], 0.0)

    def stored(self, time, x, k):
        v, q = self.v, self.at(time, x)
        s2 = v["s"] ** 2
        d1, d2 = q["P"] - q["H1"] - q["u1"], q["G"] - q["H2"] - q["u2"]
        move = (q["vP"] @ q["vP"] + v["nu_g"] * q["vG"] @ q["vG"]) / 2
        move += v["nu_1"] * q["v1"] @ q["v1"] + v["nu_2"] * q["v2"] @ q["v2"]  # two housings of each
        high = v["f"] / s2 * (q["yp"] + v["nu_g"] * q["yg"] + 2 * v["nu_1"] * q["y1"] + 2 * v["nu_2"] * q["y2"])
        bent = (d1 @ d1 + v["kappa_g"] * d2 @ d2) / (2 * s2)
        for H, nu, S, a in ((q["H1"], "nu_1", "S_1", "a_1"), (q["H2"], "nu_2", "S_2", "a_2")):
            bent += v[nu] * H @ H / (v[S] ** 2 * s2)
            if self.switches["suspension"] == "cubic":
                bent += v[nu] * v[a] / s2 * np.sum(H**4) / 2
        loaded = self.pressed(q["delta"] - q["te"]) if "mesh" in self.on else q["delta"] - q["te"]
        bent += v["Lambda"] / (2 * s2) * k * np.sum(np.square(loaded))
        if "torsion" in self.on:
            move += (v["iota_p"] * q["vqp"] ** 2 + v["iota_g"] * q["vqg"] ** 2) / 2
            bent += (v["kappa_tp"] * q["qp"] ** 2 + v["kappa_tg"] * q["qg"] ** 2) / (2 * s2)
        for u, spring in ((q["u1"], "kappa_c1"), (q["u2"], "kappa_c2")):
            if "centring" in self.on:
                bent += v[spring] * u @ u / s2
            if "contact" in self.on:
                bent += v["kappa_r"] * max(np.hypot(*u) - v["eps_r"], 0.0) ** 2 / s2
        return move + high + bent

    def power(self, time, x, u_rates, k, k_rate):
        """What comes in through unbalance, transmission error, torque and varying teeth, less what is lost."""
        v, q = self.v, self.at(time, x)
        s2 = v["s"] ** 2
        lost = 2 / v["s"] * (v["xi_p"] * q["vP"] @ q["vP"] + v["xi_g"] * v["nu_g"] * q["vG"] @ q["vG"])
        for w, nu, xi, S in ((q["v1"], "nu_1", "xi_1", "S_1"), (q["v2"], "nu_2", "xi_2", "S_2")):
            lost += 4 * v[nu] * v[xi] / (v[S] * v["s"]) * w @ w
        come = 0.0
        turning = ((q["vP"], 1.0, "b_p", "r_p", "chi_p"), (q["vG"], v["nu_g"], "b_g", "r_g", "chi_g"))
        for velocity, mass, b, r, chi in turning:
            angle = v[r] * time + v[chi]
            come += mass * v[b] * v[r] ** 2 * velocity @ np.array([np.cos(angle), np.sin(angle)])
        deflection, rate = q["delta"] - q["te"], q["approach"] - q["te_rate"]
        pressed = self.pressed(deflection) if "mesh" in self.on else deflection
        tooth = 2 * v["xi_m"] / v["s"] * rate + v["Lambda"] / s2 * k * pressed
        lost += 2 * v["xi_m"] / v["s"] * np.sum(np.square(rate))
        come -= np.sum(tooth * q["te_rate"])
        come += v["Lambda"] / (2 * s2) * k_rate * np.sum(np.square(pressed))
        if "torsion" in self.on:
            come += v["F_0"] / s2 * (q["vqp"] - q["vqg"])
            lost += 2 / v["s"] * (v["xi_tp"] * q["vqp"] ** 2 + v["xi_tg"] * q["vqg"] ** 2)
        for u, w, Gamma, spin in ((q["u1"], u_rates[:2], "Gamma_1", v["j_p"]), (q["u2"], u_rates[2:], "Gamma_2", v["j_g"])):
            slip = w - spin / 2 * np.array([-u[1], u[0]])
            film = v[Gamma] * v["s"] * film_force(u, slip, np.sign(spin), v["psi"], self.switches["arc"])
            assert film @ slip <= 0, "a film takes energy from the half-speed frame, it never gives any"
            lost -= film @ w / s2
            eps = np.hypot(*u)
            if "contact" in self.on and eps > v["eps_r"]:
                N = 2 * v["kappa_r"] * (eps - v["eps_r"])
                come -= v["mu_r"] * N * np.sign(spin) * np.array([-u[1], u[0]]) @ w / eps / s2
        return come - lost, q


@pytest.mark.parametrize(
    ("switches", "changes"), [*(({"arc": "fixed", **s}, {}) for s in SWITCHED), *FILMS],
    ids=lambda s: " ".join(f"{k}={v}" for k, v in s.items()) or "as derived",
)  # fmt: skip
def test_energy_balance_closes(switches, changes):
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
    assert abs(y[n] - change) < 1e-8 * max(1.0, abs(y[n]))
    if "backlash" in energy.on:
        assert seen["loose"] < 0.0
    if "contact" in energy.on:
        assert seen["rubbing"] > VALUES["eps_r"]


# --- momentum ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "switches", [{}, *(dict(zip(("stiffness", "backlash", "torsion"), c, strict=True), mesh="line") for c in product(
        ("constant", "fourier", "rectangular"), ("none", "dead_zone"), ("none", "rigid_rotors")))],
    ids=lambda s: " ".join(s.values()) or "isotropic",
)  # fmt: skip
def test_action_is_reaction_in_the_mesh(switches):
    """What the mesh does to the pinion it does to the gear with the other sign, also as a torque."""
    system = pair(arc="fixed", **switches)
    still = pair({"Lambda": 1e-300, "xi_m": 0.0, "F_0": 0.0}, arc="fixed", mesh="line")
    names = [s.name for s in system.model.states]
    rng = np.random.default_rng(2)
    for _ in range(20):
        x = 0.3 * rng.uniform(-1, 1, len(names))
        with_mesh, without = system.reference_rhs(0.3, x), still.reference_rhs(0.3, x[:20])
        force = {a: with_mesh[names.index(f"v{a}")] - without[names.index(f"v{a}")] for a in ("xp", "yp", "xg", "yg")}
        np.testing.assert_allclose([force["xp"], force["yp"]], [-4 * force["xg"], -4 * force["yg"]], rtol=0, atol=1e-12)
        assert np.hypot(force["xp"], force["yp"]) > 1e-6 or "dead_zone" in switches.values()
        if "mesh" in switches:  # along the line of action, and with the torques that belong to it
            W = -(force["xp"] * np.cos(1.3) + force["yp"] * np.sin(1.3))
            np.testing.assert_allclose(force["xp"] * np.sin(1.3), force["yp"] * np.cos(1.3), rtol=0, atol=1e-12)
        if switches.get("torsion") == "rigid_rotors":
            q, v, s = dict(zip(names, x, strict=True)), VALUES, VALUES["s"]
            p = v["F_0"] / s**2 - 2 * v["xi_tp"] / s * q["vqp"] - v["kappa_tp"] / s**2 * q["qp"] - W
            g = -v["F_0"] / s**2 - 2 * v["xi_tg"] / s * q["vqg"] - v["kappa_tg"] / s**2 * q["qg"] + W
            np.testing.assert_allclose(with_mesh[-2:], [p / v["iota_p"], g / v["iota_g"]], rtol=0, atol=1e-12)


# --- frames ------------------------------------------------------------------------------------------------

#: All vectors of the state, as pairs of places.
VECTORS = [(i, i + 1) for i in range(0, 20, 2)]


def turned(x, angle):
    y = np.array(x)
    c, s = np.cos(angle), np.sin(angle)
    for i, j in VECTORS:
        y[i], y[j] = c * x[i] - s * x[j], s * x[i] + c * x[j]
    return y


@pytest.mark.parametrize("switches", SWITCHED, ids=lambda s: " ".join(s.values()) or "as derived")
@pytest.mark.parametrize("arc", ["fixed", "positive"])
def test_forces_turn_with_the_frame(switches, arc):
    """Without weight, with a linear suspension, and unbalance and line of action turned along, no direction is special."""
    switches = {"arc": arc, **switches, "suspension": "linear"}
    line = switches.get("mesh") == "line"
    still = {"f": 0.0, **({} if line else {"E": 0.0})}  # the isotropic mesh's error has a direction in space
    one = pair(still, **switches)
    rng = np.random.default_rng(4)
    pressed = 0
    for angle in rng.uniform(-3, 3, 5):
        along = {n: VALUES[n] + angle for n in ("chi_p", "chi_g", "phi_m") if n in one.values}
        other = one.replace(**along)
        x = 0.3 * rng.uniform(-1, 1, one.model.dimension)
        x[:2] = 0.85 * np.cos(angle**2), 0.85 * np.sin(angle**2)
        pressed += np.hypot(*x[:2]) > VALUES["eps_r"]
        np.testing.assert_allclose(
            other.reference_rhs(0.4, turned(x, angle)), turned(one.reference_rhs(0.4, x), angle), rtol=0, atol=2e-11
        )
    assert pressed == 5


# --- rub ---------------------------------------------------------------------------------------------------


def test_rub_is_nothing_at_the_centre_and_below_the_roughness():
    rubbing, free = pair(arc="fixed", contact="rub"), pair(arc="fixed")
    for size in (0.0, 1e-300, 1e-8, 0.3, 0.5999999):
        x = np.zeros(20)
        x[0] = x[3] = size
        got = rubbing.reference_rhs(0.2, x)
        assert np.isfinite(got).all()
        np.testing.assert_allclose(got, free.reference_rhs(0.2, x), rtol=1e-14, atol=0)


@pytest.mark.parametrize("spin", [1.0, -1.0])
def test_friction_acts_along_the_surface_against_the_slip(spin):
    """Normal force inwards, friction mu_r times it and tangential; the surface of the journal slides with its spin."""
    from sympy import Float

    from whirlmap.models import rub

    numbers = {q: Float(VALUES[q.name]) for q in rub.PARAMETERS}
    for angle in (0.0, 0.7, 2.4, -2.0):
        u = 0.9 * np.array([np.cos(angle), np.sin(angle)])
        force = np.array([float(e.subs(numbers)) for e in rub.wall_force(Float(u[0]), Float(u[1]), spin)])
        inwards, slip = -u / 0.9, spin * np.array([-u[1], u[0]]) / 0.9
        assert force @ inwards == pytest.approx(30 * 0.3, rel=1e-12)
        assert force @ slip == pytest.approx(-0.2 * 30 * 0.3, rel=1e-12)


def test_friction_needs_a_spin_and_says_so():
    with pytest.raises(CaseError, match="j_p = 0 with mu_r"):
        pair({"j_p": 0.0}, arc="positive", contact="rub")
    pair({"j_p": 0.0, "mu_r": 0.0}, arc="positive", contact="rub")


# --- dampers -----------------------------------------------------------------------------------------------


def test_a_damper_that_does_not_turn_resists_motion_and_nothing_else():
    """j = 0: the film moves its journal along the load, at any eccentricity, and stands still without one."""
    system = pair({"j_p": 0.0, "j_g": 0.0, "f": 0.0}, arc="positive")
    x = np.zeros(20)
    x[:4] = 0.5, 0.1, -0.3, 0.4
    x[4:8] = x[0:4]  # shafts straight
    np.testing.assert_allclose(system.reference_rhs(0.0, x)[:4], 0.0, atol=1e-30)
    rng = np.random.default_rng(7)
    for _ in range(20):
        x[4:8] = x[:4] + rng.uniform(-1, 1, 4)
        v = system.reference_rhs(0.0, x)[:4]
        assert v[:2] @ (x[4:6] - x[:2]) > 0
        assert v[2:] @ (x[6:8] - x[2:4]) > 0


def test_centring_springs_carry_what_the_film_cannot():
    """A still journal hangs in its springs, f/(2 kappa_c) below the centre, and that is a state of rest."""
    from whirlmap.kernels.reference import reference_rates

    changes = {"j_p": 0.0, "j_g": 0.0, "Lambda": 0.0, "kappa_c1": 0.6, "kappa_c2": 2.0}
    system = pair(changes, arc="positive", centring="spring", suspension="linear")
    f, S2 = 0.49, 0.32**2
    x = np.zeros(20)
    x[1], x[3] = -f / (2 * 0.6), -4 * f / (2 * 2.0)
    x[9], x[11] = -S2 * (f + f / (2 * 0.5)), -S2 * (f + 4 * f / (2 * 1.0))  # housings, with half a shaft's weight each
    x[5], x[7] = x[9] + x[1] - f, x[11] + x[3] - 4 * f / 2
    rest = reference_rates(system.model, forced=False)(0.0, x, system.vector)
    np.testing.assert_allclose(rest, 0.0, atol=1e-14)
    without = pair({**changes, "kappa_c1": 0.0}, arc="positive", centring="spring", suspension="linear")
    assert np.abs(reference_rates(without.model, forced=False)(0.0, x, without.vector)).max() > 0.01


# --- teeth -------------------------------------------------------------------------------------------------


def test_the_torque_is_carried_at_rest():
    """Static equilibrium with torsion: the mesh carries F_0 and the shafts' twist is taken off."""
    from whirlmap.integrate.equilibrium import start_states

    system = pair({"f": 0.0}, arc="fixed", mesh="line", torsion="rigid_rotors")
    x, found = start_states(system.model, system.vector[:, None])
    assert found[0]
    q = dict(zip([s.name for s in system.model.states], x[:, 0], strict=True))
    n = np.cos(1.3), np.sin(1.3)
    W = 25 * (0.8 / 25 + n[0] * (q["xp"] - q["xg"]) + n[1] * (q["yp"] - q["yg"]) + q["qp"] - q["qg"])
    missing = 0.8 - W  # what the shafts to driver and load take instead
    assert missing == pytest.approx(8 * q["qp"], abs=1e-9)
    assert missing == pytest.approx(-5 * q["qg"], abs=1e-9)
    assert abs(missing) > 1e-3


@pytest.mark.parametrize("contact_ratio", [1.2, 1.6, 1.95])
def test_the_rectangle_is_that_of_one_pair_and_two(contact_ratio):
    """Fourier coefficients against quadrature of the rectangle, its mean, and its plateaus to the stated overshoot."""
    k = mesh.stiffness_over_mean("rectangular", t).subs({mesh.CR: contact_ratio, mesh.v_m: 1 / contact_ratio, mesh.chi_m: 0})
    value = lambdify(t, k, "numpy")
    d = contact_ratio - 1
    for n in range(1, mesh.TERMS + 1):
        exact = 2 / contact_ratio * np.sin(np.pi * n * d) / (np.pi * n)  # of the sharp rectangle
        sigma = np.sinc(n / (mesh.TERMS + 1))
        found = quad(lambda a, n=n: value(a) * np.cos(n * a), -np.pi, np.pi, epsabs=1e-12)[0] / np.pi
        assert found == pytest.approx(sigma * exact, abs=1e-10)
    assert quad(value, -np.pi, np.pi, epsabs=1e-12)[0] / (2 * np.pi) == pytest.approx(1.0, abs=1e-12)
    angle = np.linspace(-np.pi, np.pi, 4001)
    high, low = 2 / contact_ratio, 1 / contact_ratio  # k_mean = CR k_one
    assert value(angle).max() < high + 0.02 * (high - low)
    assert value(angle).min() > low - 0.02 * (high - low)


def test_multiples_of_the_mesh_phase_keep_its_period():
    system = pair(arc="fixed", mesh="line", stiffness="fourier")
    assert (system.period, system.common_multiple) == (pytest.approx(2 * np.pi / 20), 40)
    for n, (c, s) in enumerate(mesh.multiples(t, 6), start=1):
        for a in (0.3, 1.7, -2.0):
            assert float(c.subs(t, a)) == pytest.approx(np.cos(n * a), abs=1e-13)
            assert float(s.subs(t, a)) == pytest.approx(np.sin(n * a), abs=1e-13)


# --- refusals ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("switch", "off"), BEYOND.items())
def test_the_literal_edition_has_none_of_it(switch, off):
    for choice in set(family("gear_pair").switches[switch]) - {off, "ignore"}:  # the print has no wall
        with pytest.raises(ModelError, match=f"edition = literal has no .*{switch} = {choice}"):
            family("gear_pair").model(edition="literal", **{"mesh": "isotropic", switch: choice})


@pytest.mark.parametrize("switch", [{"stiffness": "fourier"}, {"backlash": "dead_zone"}, {"torsion": "rigid_rotors"}])
def test_what_needs_a_line_of_action_says_so(switch):
    with pytest.raises(ModelError, match="needs mesh = line"):
        family("gear_pair").model(**switch)


@pytest.mark.parametrize(
    ("changes", "switches", "words"),
    [
        ({"F_0": 0.0}, {"backlash": "dead_zone"}, "without a transmitted torque"),
        ({"Lambda": 0.0}, {}, "Lambda = 0 with mesh = line"),
        ({"v_1": 0.9}, {"stiffness": "fourier"}, "expected a sum below 1"),
        ({"v_m": 1.7}, {"stiffness": "rectangular"}, r"v_m \(CR - 1\)"),
        ({"CR": 2.1}, {"stiffness": "rectangular"}, "CR"),
        ({"B_m": 0.0}, {"backlash": "dead_zone"}, "B_m"),
        ({"kappa_tp": 0.0, "kappa_tg": 0.0}, {"torsion": "rigid_rotors"}, "nothing holds the common angle"),
    ],
)
def test_teeth_that_mean_nothing_are_refused(changes, switches, words):
    with pytest.raises(CaseError, match=words):
        pair(changes, arc="fixed", mesh="line", **switches)


def test_parameters_of_a_switch_that_is_off_do_not_exist():
    plain = {p.name for p in family("gear_pair").model().parameters}
    extra = family("gear_pair").symbols() - plain - {"xi_5"}
    assert {"F_0", "phi_m", "B_m", "CR", "iota_p", "kappa_r", "kappa_c1", "v_1"} <= extra
    for switches in SWITCHED:
        model = family("gear_pair").model(edition="physical", arc="fixed", **switches)
        assert model.read() == set(model.parameters)
        assert {p.name for p in model.parameters} <= plain | extra
        assert not model.jumps


# --- tangents ----------------------------------------------------------------------------------------------


def test_the_symbolic_jacobian_is_that_of_differences():
    """Everything on at once: teeth pressed, loose and on their back flanks; journals free and rubbing."""
    system = pair({"B_m": 0.1}, arc="fixed", **SWITCHED[-1])
    rng = np.random.default_rng(8)
    x = 0.3 * rng.uniform(-1, 1, (24, 40))
    x[:2] += 0.45
    mine, h = system.jacobian(0.4, x), 1e-6
    np.testing.assert_allclose(system.rhs(0.4, x), system.reference_rhs(0.4, x), rtol=0, atol=1e-11)
    energy = Energy(system)
    deflections = [(q := energy.at(0.4, column))["delta"] - q["te"] for column in x.T]
    sides = {"drive" if d > 0 else "back" if d < -0.1 else "gap" for d in deflections}
    assert sides == {"drive", "back", "gap"}
    assert 0 < (np.hypot(x[0], x[1]) > 0.6).sum() < 40
    for j in range(24):
        step = np.zeros((24, 1))
        step[j] = h
        slope = (system.reference_rhs(0.4, x + step) - system.reference_rhs(0.4, x - step)) / (2 * h)
        np.testing.assert_allclose(mine[:, j], slope, rtol=0, atol=2e-7)


# --- the limit of one degree of freedom --------------------------------------------------------------------


def held_teeth(zeta, F_m, F_ah, Omega):
    """Gear pair on rigid bearings, whose teeth alone move: the values at which it is `gear_backlash` exactly.

    Half the backlash b = B_m/2 is the unit of length, 1/sqrt(Lambda/iota)/s that of time, iota the two rotors' together.
    """
    B, Lambda, s, iota_p, iota_g = 0.4, 25.0, 1.7, 0.5, 2.0
    iota = iota_p * iota_g / (iota_p + iota_g)
    rate = np.sqrt(Lambda / iota) / s  # natural frequency per clock radian
    return pair(
        {
            "f": 0.0, "Lambda": Lambda, "s": s, "iota_p": iota_p, "iota_g": iota_g, "kappa_tp": 0.0, "kappa_tg": 1e-300,
            "xi_tp": 0.0, "xi_tg": 0.0, "B_m": B, "F_0": Lambda * F_m * B / 2, "xi_m": zeta * rate * iota * s,
            "r_m": Omega * rate, "E": F_ah * B / 2, "phi_m": 0.0,
        },
        arc="fixed", mesh="line", backlash="dead_zone", torsion="rigid_rotors",
    ), B / 2, rate  # fmt: skip


def held_rates(system, time, q, v):
    """Acceleration of qp - qg with both centres held, from the gear pair's own equations."""
    x = np.zeros(24)
    x[20], x[22] = q, v
    got = system.reference_rhs(time, x)
    return got[22] - got[23]


@pytest.mark.parametrize("Omega", [0.8, 1.1])
def test_with_held_centres_the_teeth_are_the_backlash_oscillator(Omega):
    """The same right-hand side as `gear_backlash`, on both flanks and between them: its known values hold."""
    zeta, F_m, F_ah = 0.05, 0.1, 0.2
    one = System(family("gear_backlash").model(), {"zeta": zeta, "F_m": F_m, "F_ah": F_ah, "Omega": Omega})
    system, half, rate = held_teeth(zeta, F_m, F_ah, Omega)
    E, r_m, F_0 = (float(system.values[n]) for n in ("E", "r_m", "F_0"))
    rng = np.random.default_rng(9)
    sides = set()
    for x, v, time in rng.uniform([-3, -2, 0], [3, 2, 20], (200, 3)):
        # deflection delta = half (x - 1) counts from the driving flank; the clock's time is the oscillator's over rate
        delta, delta_rate = half * (x - 1), half * rate * v
        q = delta - F_0 / 25.0 + E * np.cos(r_m * time / rate)
        q_rate = delta_rate - E * r_m * np.sin(r_m * time / rate)
        acceleration = held_rates(system, time / rate, q, q_rate) + E * r_m**2 * np.cos(r_m * time / rate)
        expected = one.reference_rhs(time, np.array([x, v]))[1]
        assert acceleration / (half * rate**2) == pytest.approx(expected, rel=0, abs=1e-12)
        sides.add("drive" if x > 1 else "back" if x < -1 else "gap")
    assert sides == {"drive", "back", "gap"}
