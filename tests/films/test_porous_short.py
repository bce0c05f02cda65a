"""The reference film against quadrature that shares nothing with its rule, and against the physics."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from whirlmap.errors import RangeError
from whirlmap.films.porous_short import (
    film_force,
    film_integrals,
    fixed_arc_velocity,
    positive_arc_velocity,
)

angle = st.floats(-np.pi, np.pi)
eccentricity = st.one_of(st.floats(0.0, 0.99), st.sampled_from([0.0, 5e-324, 1e-300, 1e-12, 0.9999]))
permeability = st.one_of(st.just(0.0), st.floats(-8.0, 1.0).map(lambda e: 10.0**e))


def turned(x, y, a):
    return x * np.cos(a) - y * np.sin(a), x * np.sin(a) + y * np.cos(a)


def random_states(seed, size=2000):
    rng = np.random.default_rng(seed)
    eps = np.where(rng.random(size) < 0.5, rng.random(size), 1.0 - 10.0 ** rng.uniform(-4, 0, size))
    psi = np.where(rng.random(size) < 0.3, 0.0, 10.0 ** rng.uniform(-10, 1, size))
    phi, load = rng.uniform(-np.pi, np.pi, (2, size))
    load[::3] = phi[::3] + 10.0 ** rng.uniform(-6, 0, load[::3].size)  # loads that push towards the wall
    magnitude = 10.0 ** rng.uniform(-3, 3, size)
    return eps * np.cos(phi), eps * np.sin(phi), magnitude * np.cos(load), magnitude * np.sin(load), psi


# --- integrals ---------------------------------------------------------------------------------------------


def brute_force(eps, psi, theta1):
    """30-digit tanh-sinh quadrature in theta itself, split around the thinnest film."""
    with mp.workdps(30):
        eps, psi, start = mp.mpf(eps), mp.mpf(psi), mp.mpf(theta1)
        scale = mp.sqrt(2 * abs(1 - eps) + 2 * mp.cbrt(psi))
        cuts = [sign * f * scale for f in (0.3, 1, 3, 10, 30) for sign in (-1, 1)]
        centres = [mp.pi, -mp.pi, 3 * mp.pi]
        inner = sorted(
            x for c in centres for x in [c, *(c + cut for cut in cuts)] if start < x < start + mp.pi
        )
        points = [start, *inner, start + mp.pi]

        def weight(t):
            return 1 / ((1 + eps * mp.cos(t)) ** 3 + psi)

        return [
            float(mp.quad(f, points, maxdegree=9))
            for f in (
                lambda t: mp.cos(t) ** 2 * weight(t),
                lambda t: mp.sin(t) * mp.cos(t) * weight(t),
                lambda t: mp.sin(t) ** 2 * weight(t),
            )
        ]


CASES = [
    (0.0, 0.0, 0.0), (0.0, 10.0, 2.0), (0.999, 0.0, 0.0), (0.999, 0.0, np.pi / 2), (0.999, 0.0, -np.pi / 2),
    (0.999, 1e-8, 0.0), (0.999, 1e-8, np.pi / 2), (0.999, 1e-10, 1.0), (0.999, 1e-4, np.pi),
    (0.999, 10.0, -3.0),
    (0.99, 1e-6, 3.0), (0.97, 1e-5, -2.0), (1.0, 1e-3, 0.0), (1.0, 1e-8, 0.0),
    (1.02, 1e-3, 0.0), (1.6, 10.0, 0.0),
]  # fmt: skip
_rng = np.random.default_rng(7)
CASES += [
    (float(e), float(10.0**p), float(t))
    for e, p, t in zip(
        _rng.uniform(0, 0.999, 12), _rng.uniform(-6, 1, 12), _rng.uniform(-3, 3, 12), strict=True
    )
]


@pytest.mark.parametrize(("eps", "psi", "theta1"), CASES)
def test_integrals_against_brute_force(eps, psi, theta1, validate):
    expected = np.array(brute_force(eps, psi, theta1))
    found = np.array(film_integrals(eps, psi, theta1))
    # measured: 2e-14; the requirement is 1e-10
    if (eps, psi, theta1) in CASES[:16]:  # the random ones are asserted below
        validate(f"film integrals, eccentricity {eps:g}, permeability {psi:g}, arc from {theta1:.3g}", found, expected,
                 tier="independent", source="quadrature", within=1e-12 * max(expected[0], expected[2]))  # fmt: skip
    assert np.abs(found - expected).max() <= 1e-12 * max(expected[0], expected[2])


@pytest.mark.parametrize(
    ("eps", "psi", "theta1", "values"),
    [
        (0.3, 0.0, 0.0, (2.346380299154621, -0.7245501750996257, 1.809496671381953)),
        (0.6, 1e-3, 0.0, (8.149960485827236, -2.902792074702361, 3.053213143359470)),
        (0.9, 0.1, 0.0, (6.768859931516499, -3.020323882463139, 3.294141701739501)),
        (0.99, 1e-4, 0.0, (2724.166276126705, -445.1914659961784, 116.8311539877546)),
        (0.6, 1e-3, 1.0, (15.71759154791492, -0.2356402902445133, 4.653639730695618)),
    ],
)
def test_unit_values_of_the_audit(eps, psi, theta1, values):
    np.testing.assert_allclose(film_integrals(eps, psi, theta1), values, rtol=2e-13)


def test_arc_start_is_periodic_and_shapes_broadcast():
    theta1 = np.linspace(-3.0, 3.0, 5)
    found = film_integrals(0.7, np.array([[0.0], [1e-3]]), theta1)
    assert found[0].shape == (2, 5)
    later = film_integrals(0.7, np.array([[0.0], [1e-3]]), theta1 + 4 * np.pi)
    np.testing.assert_allclose(found, later, rtol=1e-12)


@pytest.mark.parametrize(
    ("eps", "psi"), [(1.0, 0.0), (1.2, 1e-3), (-0.1, 0.0), (0.5, -1e-3), (np.nan, 0.0), (0.5, np.nan)]
)
def test_outside_the_film_is_an_error(eps, psi):
    with pytest.raises(RangeError, match="index 1"):
        film_integrals([0.5, eps], [0.0, psi])


# --- force -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("arc", ["fixed", "positive"])
@pytest.mark.parametrize("spin", [1.0, -0.5])
def test_force_against_the_dimensional_pressure(arc, spin):
    """Audit (7) with h^3, summed over a (theta, z) grid, against A omega_c times the dimensionless force."""
    mu, R, L, c, seep, clock = 0.02, 0.025, 0.012, 50e-6, 1.3e-16, 600.0  # seep = Phi H [m^3]
    eps, phi, eps_dot, phi_dot = 0.72, 0.8, 190.0, 0.2 * clock
    omega = spin * clock
    size = 400_000
    theta = (np.arange(size) + 0.5) * 2.0 * np.pi / size
    h = c * (1.0 + eps * np.cos(theta))
    z, z_weight = np.polynomial.legendre.leggauss(4)
    z, z_weight = 0.5 * L * z, 0.5 * L * z_weight
    speed = (omega - 2.0 * phi_dot) * eps * np.sin(theta) - 2.0 * eps_dot * np.cos(theta)
    p = -3.0 * mu * c / (h**3 + 12.0 * seep) * speed * (z[:, None] ** 2 - L**2 / 4.0)
    if arc == "positive":
        assert (p > 0).any() and (p < 0).any()
        p = np.maximum(p, 0.0)
    else:
        p = np.where((theta < np.pi) == (omega > 0), p, 0.0)
    line = z_weight @ p * R * 2.0 * np.pi / size
    f_r, f_t = (line * np.cos(theta)).sum(), (line * np.sin(theta)).sum()
    expected = turned(f_r, f_t, phi)
    A = mu * R * L**3 / (2.0 * c**2)
    w = turned(eps_dot / clock, eps * (phi_dot / clock - 0.5 * spin), phi)
    u = turned(eps, 0.0, phi)
    found = film_force(*u, *w, 12.0 * seep / c**3, arc=arc, sigma=np.sign(spin))
    # the midpoint sum meets a kink or an end of the arc: O(size^-2)
    np.testing.assert_allclose(np.array(found) * A * clock, expected, rtol=1e-8)


@pytest.mark.parametrize(
    ("eps", "radial", "tangential", "fixed", "positive"),
    [  # audit 4.4, psi = 0, spin 1: eps', eps phi' -> (F_r, F_t)
        (0.3, 0.0, 0.3, (0.217, -0.543), (-0.217, -0.543)),
        (0.6, 0.0, 0.6, (1.758, -1.841), (-1.758, -1.841)),
        (0.9, 0.0, 0.9, (44.88, -17.07), (-44.88, -17.07)),
        (0.3, 0.5, 0.15, (-2.35, 0.72), (-3.89, 0.0)),
        (0.9, 0.5, 0.45, (-261.5, 49.9), (-522.8, 0.0)),
        (0.6, -0.5, 0.3, (8.25, -2.93), (0.473, 0.0)),
        (0.9, -0.5, 0.45, (261.5, -49.9), (0.304, 0.0)),
        (0.6, -0.2, 0.0, (1.54, 0.67), (-0.075, 0.963)),
    ],
)
def test_audit_table_of_motions(eps, radial, tangential, fixed, positive):
    w = radial, tangential - 0.5 * eps
    for arc, expected, last_digit in (("fixed", fixed, 5.1e-3), ("positive", positive, 6e-4)):
        found = film_force(eps, 0.0, *w, 0.0, arc=arc)
        np.testing.assert_allclose(found, expected, rtol=2.5e-3, atol=last_digit)


def test_steady_rotation_has_the_same_film_on_both_arcs():
    args = 0.6, 0.1, *(-0.5 * np.array([-0.1, 0.6])), 1e-3
    np.testing.assert_allclose(film_force(*args, arc="fixed"), film_force(*args, arc="positive"), rtol=1e-12)


def test_porous_synchronous_whirl_of_the_audit():
    for arc, sign in (("fixed", 1.0), ("positive", -1.0)):
        found = film_force(0.6, 0.0, 0.0, 0.3, 0.1, arc=arc)
        np.testing.assert_allclose(found, (sign * 0.939, -1.314), rtol=5e-4)


@given(eps=eccentricity, psi=permeability, phi=angle, direction=angle)
@settings(max_examples=150, deadline=None)
@pytest.mark.parametrize("arc", ["fixed", "positive"])
def test_film_only_dissipates(arc, eps, psi, phi, direction):
    w = np.cos(direction), np.sin(direction)
    F = film_force(eps * np.cos(phi), eps * np.sin(phi), *w, psi, arc=arc, sigma=-1.0)
    assert F[0] * w[0] + F[1] * w[1] < 0.0


def test_unknown_arc_is_refused():
    with pytest.raises(RangeError, match="'fixed' or 'positive'"):
        film_force(0.1, 0.0, 0.0, 0.1, 0.0, arc="full")  # type: ignore[arg-type]


# --- velocity ----------------------------------------------------------------------------------------------


def test_fixed_velocity_balances_the_load():
    ux, uy, qx, qy, psi = random_states(1)
    for sigma in (1.0, -1.0):
        F = film_force(ux, uy, *fixed_arc_velocity(ux, uy, qx, qy, psi, sigma), psi, arc="fixed", sigma=sigma)
        residual = np.hypot(-0.5 * F[0] - qx, -0.5 * F[1] - qy) / np.hypot(qx, qy)
        # in x, y the small radial part keeps 16 digits of the tangential part only, 1/(1 - eps) times larger
        assert residual.max() < 1e-10  # measured 6e-12


def test_positive_velocity_balances_the_load():
    ux, uy, qx, qy, psi = random_states(2, 20_000)
    F = film_force(ux, uy, *positive_arc_velocity(ux, uy, qx, qy, psi), psi, arc="positive")
    residual = np.hypot(-0.5 * F[0] - qx, -0.5 * F[1] - qy) / np.hypot(qx, qy)
    assert residual.max() < 1e-12  # measured 2e-14


def test_cartesian_form_of_the_fixed_inverse():
    """The formula in the docstring, term by term; it is what the compiled kernels use."""
    ux, uy, qx, qy, psi = random_states(3)
    eps = np.hypot(ux, uy)
    G, B, D = film_integrals(eps, psi)
    Delta = G * D - B * B
    qu, qJu = qx * ux + qy * uy, -qx * uy + qy * ux
    for sigma in (1.0, -1.0):
        cross = sigma * B / (Delta * eps**2)
        wx = G / Delta * qx + (D - G) / (Delta * eps**2) * qu * ux - cross * (qJu * ux - qu * uy)
        wy = G / Delta * qy + (D - G) / (Delta * eps**2) * qu * uy - cross * (qJu * uy + qu * ux)
        found = fixed_arc_velocity(ux, uy, qx, qy, psi, sigma)
        # near the wall the formula's radial part is a difference of terms 1/(1 - eps) times larger
        np.testing.assert_allclose(found, (wx, wy), atol=1e-11 * (G / Delta * np.hypot(qx, qy)).max())


@given(eps=eccentricity, psi=permeability, phi=angle, load=angle, turn=angle)
@settings(max_examples=100, deadline=None)
@pytest.mark.parametrize("velocity", [fixed_arc_velocity, positive_arc_velocity])
def test_velocity_turns_with_the_machine(velocity, eps, psi, phi, load, turn):
    u, q = turned(eps, 0.0, phi), turned(1.0, 0.0, load)
    w = velocity(*u, *q, psi)
    found = velocity(*turned(*u, turn), *turned(*q, turn), psi)
    # psi = 0 at eps = 0.9999: rounding of u moves the gap by 1e-16/1e-4
    np.testing.assert_allclose(found, turned(*w, turn), rtol=1e-9, atol=1e-11)


@given(eps=eccentricity, psi=permeability, phi=angle, load=angle)
@settings(max_examples=100, deadline=None)
def test_positive_film_has_mirror_symmetry_and_no_spin(eps, psi, phi, load):
    """Seen in a mirror along x the machine spins backwards, and the fixed arc changes its side."""
    u, q = turned(eps, 0.0, phi), turned(1.0, 0.0, load)
    w = positive_arc_velocity(*u, *q, psi)
    mirrored = positive_arc_velocity(u[0], -u[1], q[0], -q[1], psi)
    np.testing.assert_allclose(mirrored, (w[0], -w[1]), rtol=1e-9, atol=1e-12)
    w = fixed_arc_velocity(*u, *q, psi, 1.0)
    mirrored = fixed_arc_velocity(u[0], -u[1], q[0], -q[1], psi, -1.0)
    np.testing.assert_allclose(mirrored, (w[0], -w[1]), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("velocity", [fixed_arc_velocity, positive_arc_velocity])
def test_velocity_is_homogeneous_and_zero_without_load(velocity):
    ux, uy, qx, qy, psi = random_states(4, 200)
    w = np.array(velocity(ux, uy, qx, qy, psi))
    np.testing.assert_allclose(velocity(ux, uy, 1e-150 * qx, 1e-150 * qy, psi), 1e-150 * w, rtol=1e-10)
    qx[::2] = qy[::2] = 0.0
    w = np.array(velocity(ux, uy, qx, qy, psi))
    assert (w[:, ::2] == 0.0).all() and (w[:, 1::2] != 0.0).all()


@pytest.mark.parametrize("psi", [0.0, 1e-3, 0.1])
@pytest.mark.parametrize("velocity", [fixed_arc_velocity, positive_arc_velocity])
def test_velocity_is_continuous_through_the_centre(velocity, psi):
    centre = velocity(0.0, 0.0, 0.3, -0.4, psi)
    # isotropic at the centre: on a half circle the integral of cos^2 is pi/2
    np.testing.assert_allclose(centre, (2.0 * (1.0 + psi) / np.pi) * np.array([0.3, -0.4]), rtol=1e-14)
    for phi in np.linspace(0.0, 6.0, 7):
        found = velocity(1e-9 * np.cos(phi), 1e-9 * np.sin(phi), 0.3, -0.4, psi)
        np.testing.assert_allclose(found, centre, atol=1e-8)


def test_unloaded_journal_whirls_at_half_its_speed(validate):
    """u' = w + (j/2) J u with w = 0: |u| is kept and the whirl is j/2, whatever the film."""
    for velocity in (fixed_arc_velocity, positive_arc_velocity):
        w = velocity(0.5, 0.2, 0.0, 0.0, 1e-3)
        u_dot = np.array(w) + 0.5 * 0.8 * np.array([-0.2, 0.5])
        assert abs(u_dot @ [0.5, 0.2]) < 1e-16
        validate("journal without load, spin 0.8: whirl speed", (0.5 * u_dot[1] - 0.2 * u_dot[0]) / 0.29, 0.4,
                 tier="invariant", source="half the spin, whatever the film law", rel=1e-6)  # fmt: skip


def test_golden_velocities_of_the_audit():
    """Journal rows of the golden vector, audit sec. 3.5 (machine of sec. 6, s = 1.7, clock A)."""
    u = np.array([[0.31, -0.42], [-0.25, -0.5]])
    centre = np.array([[-0.182, -0.397], [0.024, 0.536]])
    housing = np.array([[-0.197, -0.248], [0.196, 0.143]])
    A1, A2 = (0.02 * R * L**3 / (2 * (50e-6) ** 2) for R, L in ((0.025, 0.012), (0.030, 0.0144)))
    Gamma = 2 * np.array([A1, A2]) * 1.7 * np.sqrt(4e6 / 10) / (4e6 * 50e-6)
    r, kappa = np.array([1.0, -0.5]), np.array([1.0, 2.0])
    q = (kappa / (2 * Gamma))[:, None] * (centre - housing - u)
    drift = 0.5 * r[:, None] * np.stack([-u[:, 1], u[:, 0]], axis=1)
    golden = {
        ("fixed", 0.0): (0.164713902875, 0.161025209982, -0.114026594315, 0.0926641139051),
        ("fixed", 1e-3): (0.164529285957, 0.161115224498, -0.113843613449, 0.0929171916142),
        ("fixed", 0.1): (0.149233733775, 0.169555661549, -0.0993094579191, 0.116624095337),
        ("positive", 0.0): (0.0753662728993, 0.300380978166, -0.0158275191991, 0.487163375379),
        ("positive", 1e-3): (0.0753123589518, 0.300429546684, -0.0158169933037, 0.487321687017),
    }
    for (arc, psi), expected in golden.items():
        if arc == "fixed":
            w = fixed_arc_velocity(*u.T, *q.T, psi, np.sign(r))
        else:
            w = positive_arc_velocity(*u.T, *q.T, psi)
        np.testing.assert_allclose((np.stack(w, axis=1) + drift).ravel(), expected, rtol=5e-12)
