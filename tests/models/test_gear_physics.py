"""Every physics switch of the gear pair: momentum, frames, limits, refusals; energy is in test_gear_energy."""

from itertools import product

import numpy as np
import pytest
from scipy.integrate import quad
from sympy import lambdify
from tests.models.gear_mechanics import SWITCHED, VALUES, Energy, pair

from whirlmap.equations import t
from whirlmap.errors import CaseError, ModelError
from whirlmap.integrate.system import System
from whirlmap.kernels.lowering.surfaces import sided
from whirlmap.models import family, mesh
from whirlmap.models.gear_pair import BEYOND

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
    energy, sides = Energy(system), set()
    names = [s.name for s in system.model.states]
    rng = np.random.default_rng(2)
    for _ in range(20):
        x = 0.3 * rng.uniform(-1, 1, len(names))
        with_mesh, without = system.reference_rhs(0.3, x), still.reference_rhs(0.3, x[:20])
        force = {a: with_mesh[names.index(f"v{a}")] - without[names.index(f"v{a}")] for a in ("xp", "yp", "xg", "yg")}
        np.testing.assert_allclose([force["xp"], force["yp"]], [-4 * force["xg"], -4 * force["yg"]], rtol=0, atol=1e-12)
        assert np.hypot(force["xp"], force["yp"]) > 1e-6  # in the gap the oil between the teeth is left
        if "mesh" in switches:  # along the line of action, and with the torques that belong to it
            W = -(force["xp"] * np.cos(1.3) + force["yp"] * np.sin(1.3))
            q = energy.at(0.3, x)
            deflection, damping = q["delta"] - q["te"], 2 * VALUES["xi_m"] / VALUES["s"] * (q["approach"] - q["te_rate"])
            loose = "dead_zone" in switches.values() and -VALUES["B_m"] < deflection < 0
            sides.add("gap" if loose else "drive" if deflection > 0 else "back")
            assert W - damping == pytest.approx(0.0, abs=1e-12) if loose else (W - damping) * deflection > 0
            np.testing.assert_allclose(force["xp"] * np.sin(1.3), force["yp"] * np.cos(1.3), rtol=0, atol=1e-12)
        if switches.get("torsion") == "rigid_rotors":
            q, v, s = dict(zip(names, x, strict=True)), VALUES, VALUES["s"]
            p = v["F_0"] / s**2 - 2 * v["xi_tp"] / s * q["vqp"] - v["kappa_tp"] / s**2 * q["qp"] - W
            g = -v["F_0"] / s**2 - 2 * v["xi_tg"] / s * q["vqg"] - v["kappa_tg"] / s**2 * q["qg"] + W
            np.testing.assert_allclose(with_mesh[-2:], [p / v["iota_p"], g / v["iota_g"]], rtol=0, atol=1e-12)
    if switches:
        assert sides == {"drive", "back", "gap"} - ({"gap"} if switches["backlash"] == "none" else set())


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
    from whirlmap.kernels.running.reference import reference_rates

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
        assert not any(sided(model).jumps)


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
