"""The audit's algebra, derived again with SymPy, and its numbers by other quadrature."""

import numpy as np
import pytest
import sympy as sp
from tests.independent.newton import printed_integrals

eps, phi, th, r, Gam = sp.symbols("epsilon varphi theta r Gamma", positive=True)
B = sp.symbols("B", real=True)
G, D, A, cK, w = sp.symbols("G D A cK omega", positive=True)
X, Y = sp.symbols("X Y", real=True)
s_r, s_t = X * sp.cos(phi) + Y * sp.sin(phi), Y * sp.cos(phi) - X * sp.sin(phi)
m = Y * sp.cos(phi) + X * sp.sin(phi)
Delta = G * D - B**2
a1 = -A


def zero(expression):
    assert sp.simplify(sp.expand(sp.together(expression))) == 0


def exact():
    """Solve the massless journal's balance: f_r = A(u B - v G), f_t = A(u D - v B), shaft cK (s_r, s_t)/2.

    u = (omega - 2 dphi/dt) eps and v = 2 deps/dt; the results are rates over omega.
    """
    rate, turn = sp.symbols("rate turn")  # eps', phi' over omega
    u, v = (1 - 2 * turn) * eps * w, 2 * rate * w
    balance = [A * (u * B - v * G) + cK * s_r / 2, A * (u * D - v * B) + cK * s_t / 2]
    solved = sp.solve(balance, [rate, turn], dict=True)[0]
    return solved[rate], solved[turn]


def test_pressure_gives_the_audits_film_forces():
    """(8), (9) of the pressure (7) with h^3: radial and tangential force on the journal from B, G, D."""
    z, L, R, mu, c, W, om, ed, pd = sp.symbols("z L R mu c W omega ed pd", real=True)
    bracket = (om - 2 * pd) * eps * sp.sin(th) - 2 * ed * sp.cos(th)
    p = -3 * mu * c * W / c**3 * bracket * (z**2 - L**2 / 4)  # W = 1/((1+eps cos)^3 + psi)
    line = sp.integrate(p, (z, -L / 2, L / 2)) * R
    zero(line - mu * R * L**3 / (2 * c**2) * W * bracket)


def test_gap_as_printed_needs_the_line_of_centres_behind_the_journal():
    """h = c(1 - u.n): with theta = gamma - phi - pi it is c(1 + eps cos theta)."""
    gamma = th + phi + sp.pi
    zero(1 - eps * (sp.cos(phi) * sp.cos(gamma) + sp.sin(phi) * sp.sin(gamma)) - (1 + eps * sp.cos(th)))


def test_equation_30_is_right_and_31_33_differ_as_the_audit_says():
    rate, turn = exact()
    printed_30 = cK * B * s_t / (4 * a1 * Delta * w) - D * cK * s_r / (4 * a1 * Delta * w)
    zero(rate - printed_30)
    compact = sp.Rational(1, 2) + cK * (G * s_t - B * s_r) / (4 * A * eps * Delta * w)
    zero(turn - compact)
    k = cK / (4 * a1 * eps * w)
    printed_31 = sp.Rational(1, 2) - k * s_t / D - B**2 * k * s_t / (D * Delta) + B**2 * k * m / (D * Delta)
    zero(printed_31 - turn - B * (B * m - D * s_r) * k / (D * Delta))
    printed_33 = sp.Rational(1, 2) - k * s_t / D + B**2 * k * m / (D * Delta) - B * D * k * s_r / (D * Delta)
    zero(printed_33 - turn - 2 * B * (B * Y * sp.cos(phi) - D * s_r) * k / (D * Delta))


def test_tangential_sign_of_the_print_would_drive_the_journal():
    """With f_phi = -f_t as stated, the slip against the load's tangential part changes sign (audit 2.B)."""
    turn = sp.Symbol("turn")
    stated = sp.solve(-A * ((1 - 2 * turn) * eps * w * D) + cK * s_t / 2, turn)[0]
    zero(stated - (sp.Rational(1, 2) - cK * s_t / (4 * A * eps * D * w)))


def test_mesh_signs_of_36_make_a_double_defective_root():
    Lam = sp.Symbol("Lambda", positive=True)
    printed = sp.Matrix([[1 + Lam, -Lam], [Lam, 1 - Lam]])
    assert printed.eigenvals() == {sp.Integer(1): 2}
    assert not printed.is_diagonalizable()
    of_22_24 = sp.Matrix([[1 - Lam, Lam], [Lam, 1 - Lam]])
    assert set(of_22_24.eigenvals()) == {sp.Integer(1), 1 - 2 * Lam}
    right = sp.Matrix([[1 + Lam, -Lam], [-Lam, 1 + Lam]])
    assert set(right.eigenvals()) == {sp.Integer(1), 1 + 2 * Lam}


def test_plain_film_integrals_and_mobilities():
    """Booker's integrals against quadrature, and P, q of audit section 3.2 against them."""
    e = sp.Rational(7, 10)
    S = sp.sqrt(1 - e**2)
    closed = [-2 * e / (1 - e**2) ** 2, sp.pi * (1 + 2 * e**2) / (2 * S**5), sp.pi / (2 * S**3)]
    np.testing.assert_allclose(
        [float(x) for x in closed], printed_integrals(0.7, 0.0, cubed=True), rtol=1e-13
    )
    b, g, d = closed
    q, P = 1 - e**2, sp.pi**2 + (2 * sp.pi**2 - 16) * e**2
    zero(d / (g * d - b**2) - 2 * sp.pi * q ** sp.Rational(5, 2) / P)
    zero(g / (g * d - b**2) - 2 * sp.pi * (1 + 2 * e**2) * q ** sp.Rational(3, 2) / P)
    zero(b / (g * d - b**2) + 8 * e * q**2 / P)


@pytest.mark.parametrize(
    ("e", "psi", "g", "b", "d"),
    [
        (0.3, 0.0, 2.346380299154621, -0.7245501750996257, 1.809496671381953),
        (0.6, 1e-3, 8.149960485827236, -2.902792074702361, 3.053213143359470),
        (0.9, 0.1, 6.768859931516499, -3.020323882463139, 3.294141701739501),
        (0.99, 1e-4, 2724.166276126705, -445.1914659961784, 116.8311539877546),
    ],
)
def test_unit_values_of_the_film_integrals(e, psi, g, b, d):
    np.testing.assert_allclose(printed_integrals(e, psi, cubed=True), [b, g, d], rtol=1e-12)


@pytest.mark.parametrize(("psi", "capacity"), [(1e-4, 554.8), (1e-3, 117.9), (0.1, 4.986)])
def test_static_capacity_at_the_wall(psi, capacity):
    b, _, d = printed_integrals(1.0 - 1e-12, psi, cubed=True)
    assert np.hypot(b, d) == pytest.approx(capacity, rel=5e-4)


def test_common_period_of_the_forcing_is_eight_mesh_periods():
    """phi, phi/4, phi/8: the smallest P for which all three are whole turns."""
    turns = next(n for n in range(1, 100) if all((n * sp.Rational(1, k)).is_integer for k in (1, 4, 8)))
    assert turns == 8
