"""Bearings by coefficients: constants and tables against speed, on ground and on supports, with cross-coupling."""

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from tests.independent.test_ross_coefficients import response

import whirlmap
from whirlmap.analysis.linear.truncation import truncation
from whirlmap.errors import CaseError, RangeError

RPM = np.pi / 30
HEAD = """model = "machine"
[operation]
speed = "5000 rpm"
g = "0 m/s^2"
[[shaft]]
name = "rotor"
material = "steel"
modes = 0
elements = [ { L = "200 mm", d = "90 mm", n = 4 } ]
[[disk]]
name = "wheel"
shaft = "rotor"
at = 2
m = "20 kg"
I_d = "0.1 kg*m^2"
I_p = "0.2 kg*m^2"
[[unbalance]]
name = "u"
shaft = "rotor"
at = 2
U = "200 g*mm"
"""
TABLE = """table = [
 { speed = "1000 rpm", k_xx = "8e6 N/m", k_yy = "1.2e7 N/m", k_xy = "1e6 N/m", k_yx = "-3e6 N/m", c_xx = "1e4 N*s/m", c_yy = "9e3 N*s/m" },
 { speed = "4000 rpm", k_xx = "9e6 N/m", k_yy = "1.4e7 N/m", k_xy = "2e6 N/m", k_yx = "-2e6 N/m", c_xx = "5e3 N*s/m", c_yy = "6e3 N*s/m" },
 { speed = "9000 rpm", k_xx = "12e6 N/m", k_yy = "1.5e7 N/m", k_xy = "2e6 N/m", k_yx = "-2e6 N/m", c_xx = "4e3 N*s/m", c_yy = "5e3 N*s/m" },
]
"""  # noqa: E501
CONSTANT = """k_xx = "9e6 N/m"
k_yy = "1.4e7 N/m"
k_xy = "2e6 N/m"
k_yx = "-2e6 N/m"
c_xx = "5e3 N*s/m"
c_yy = "6e3 N*s/m"
"""
PEDESTAL = '[[support]]\nname = "{0}"\nm = "8 kg"\nk = "4e7 N/m"\nc = "3e3 N*s/m"\n'


def bearing(name, at, law, support=""):
    on = f'support = "{support}"\n' if support else ""
    return f'[[bearing]]\nname = "{name}"\nshaft = "rotor"\nkind = "coefficients"\nat = {at}\n{on}{law}'


def loaded(folder, text, **changes):
    file = folder / "rotor.toml"
    file.write_text(text, encoding="utf-8")
    return whirlmap.load(file, **changes)


def test_between_speeds_coefficients_follow_a_monotone_cubic(tmp_path):
    text = HEAD + bearing("a", 0, TABLE) + bearing("b", 4, CONSTANT)
    knots, k_xx, c_xx = np.array([1000.0, 4000.0, 9000.0]), [8e6, 9e6, 12e6], [1e4, 5e3, 4e3]
    for rpm in (1000, 1700, 4000, 5000, 8600, 9000):
        system = loaded(tmp_path, text, speed=f"{rpm} rpm")
        (part, _), numbers = system.machine.case.parts.machine.coefficients, system.values
        K_0, m_0 = (system.machine.given[f"shaft.rotor.{key}"] for key in ("K", "m"))

        def of(e, numbers=numbers):
            return np.array([float(e.subs({q: float(numbers[q.name]) for q in e.free_symbols}))])

        K, C = part.stiffness(of)[0] * K_0, part.damping(of)[0] * 2 * m_0 * np.sqrt(K_0 / m_0)
        assert K[0, 0] == pytest.approx(float(PchipInterpolator(knots, k_xx)(rpm)), rel=1e-9)
        assert C[0, 0] == pytest.approx(float(PchipInterpolator(knots, c_xx)(rpm)), rel=1e-9)


@pytest.mark.parametrize("supported", [False, True])
def test_eigenvalues_are_those_of_all_matrices(tmp_path, supported):
    """`truncation` writes K and C into the unreduced matrices of the shaft and its supports."""
    on = "p" if supported else ""
    text = HEAD.replace("modes = 0", "modes = 4") + bearing("a", 0, TABLE, on) + bearing("b", 4, CONSTANT)
    system = loaded(tmp_path, text + (PEDESTAL.format("p") if supported else ""))
    found = truncation(system)
    assert found.error.size >= 3 and found.error.max() < 1e-4


def test_rigid_rotor_on_a_pedestal_is_the_textbook_system(tmp_path):
    """A short thick rotor bounces on bearing and pedestal in series: m x'' + k(x - z) = 0, M z'' + K z - k(x - z) = 0."""
    short = HEAD.replace('"200 mm"', '"40 mm"').replace('"90 mm"', '"160 mm"')
    law = 'k_xx = "9e5 N/m"\nk_yy = "9e5 N/m"\n'
    both = bearing("a", 0, law, "p") + bearing("b", 4, law, "q")
    soft = PEDESTAL.replace('k = "4e7 N/m"\nc = "3e3 N*s/m"', 'k = "5e5 N/m"')
    system = loaded(tmp_path, short + both + soft.format("p") + soft.format("q"))
    m = system.machine.given["shaft.rotor.m"]
    M, K = np.diag([m / 2, 8.0]), np.array([[9e5, -9e5], [-9e5, 14e5]])
    bounce = np.sqrt(np.linalg.eigvals(np.linalg.solve(M, K)))
    ours = whirlmap.linear_analysis(system).eigenvalues.imag * 5000 * RPM
    for w in bounce:
        assert np.abs(ours - w).min() < 2e-3 * w


def test_static_load_sinks_by_the_stiffness(tmp_path):
    """Weight on two bearings alike and their pedestals; direct and cross stiffness together."""
    law = 'k_xx = "9e7 N/m"\nk_yy = "6e7 N/m"\nk_xy = "2e7 N/m"\nk_yx = "-1e7 N/m"\nc_xx = "1e4 N*s/m"\nc_yy = "1e4 N*s/m"\n'
    short = HEAD.replace('"200 mm"', '"40 mm"').replace('"90 mm"', '"160 mm"').replace('g = "0 m/s^2"', 'g = "9.81 m/s^2"')
    system = loaded(tmp_path, short + bearing("a", 0, law, "p") + bearing("b", 4, law) + PEDESTAL.format("p"))
    m, rest = system.machine.given["shaft.rotor.m"], whirlmap.linear_analysis(system).equilibrium
    x = dict(zip(system.states, 1e-4 * rest, strict=True))
    assert x["y_p"] == pytest.approx(-(m / 2 + 8) * 9.81 / 4e7, rel=1e-6)
    sunk = np.linalg.solve([[9e7, 2e7], [-1e7, 6e7]], [0, -m / 2 * 9.81])
    (rotor,) = system.machine.case.parts.machine.rotors
    at_b = [rotor.numbers.shapes[4] @ [x[q.name] for q in rotor.coordinates(axis)] for axis in "xy"]
    assert at_b == pytest.approx(sunk, rel=1e-6)


def test_two_alike_are_two(tmp_path):
    one = loaded(tmp_path, HEAD + bearing("b", 4, CONSTANT)
                 + bearing("a", 0, 'two_alike = 2\nk_xx = "9e6 N/m"\nk_yy = "9e6 N/m"\n', "p")
                 + PEDESTAL.format("p"))  # fmt: skip
    two = loaded(tmp_path, HEAD + bearing("b", 4, CONSTANT)
                 + bearing("a", 0, 'k_xx = "18e6 N/m"\nk_yy = "18e6 N/m"\n', "p")
                 + '[[support]]\nname = "p"\nm = "16 kg"\nk = "8e7 N/m"\nc = "6e3 N*s/m"\n')  # fmt: skip
    ours, theirs = (np.sort_complex(whirlmap.linear_analysis(s).eigenvalues) for s in (one, two))
    assert np.abs(ours - theirs).max() < 1e-9 * np.abs(theirs).max()


def test_a_speed_that_is_not_in_the_table_is_refused(tmp_path):
    text = HEAD + bearing("a", 0, TABLE) + bearing("b", 4, CONSTANT)
    with pytest.raises(CaseError, match=r"bearing a: table: found the speed 9500 rpm of shaft rotor, .* 1000 to 9000"):
        loaded(tmp_path, text, speed="9500 rpm")
    system = loaded(tmp_path, text)
    with pytest.raises((CaseError, RangeError), match="bearing a: table"):
        whirlmap.campbell(system, "speed", [f"{n} rpm" for n in (500, 2000, 8000)])
    with pytest.raises((CaseError, RangeError), match="bearing a: table"):
        whirlmap.bifurcation_diagram(system, "speed", [f"{n} rpm" for n in (2000, 8000, 9100)])


def test_coefficients_are_inputs_with_dotted_names(tmp_path):
    text = HEAD + bearing("a", 0, CONSTANT) + bearing("b", 4, CONSTANT)
    stock, changed = loaded(tmp_path, text), loaded(tmp_path, text, **{"bearing.a.k_xx": "1.8e7 N/m"})
    assert stock.model is changed.model
    assert float(changed.values["kappa_xx_a"]) == pytest.approx(2 * float(stock.values["kappa_xx_a"]), rel=1e-12)


def test_a_run_ends_on_the_response_to_the_unbalance(tmp_path):
    system = loaded(tmp_path, HEAD + bearing("a", 0, TABLE) + bearing("b", 4, CONSTANT))
    ds = whirlmap.simulate(system, transient=120, periods=1)
    X, turn = response(system), ds["turn"].values - ds["turn"].values[0]
    for i, name in enumerate(system.states):
        expected = np.real(X[i] * np.exp(2j * np.pi * turn))
        assert np.abs(ds["x"].values[:, i] - expected).max() < 1e-5 * np.abs(X).max(), name
