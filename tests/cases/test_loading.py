"""Loading systems: golden vectors through the case, stock cases at their start, changes that are refused."""

import re
from fractions import Fraction

import numpy as np
import pytest

from whirlmap.cases import names
from whirlmap.errors import CaseError, RangeError
from whirlmap.integrate.loading import load, pieces
from whirlmap.models import FAMILIES

#: Section 3.5 of the audit: s = 1.7, tau = 3, the reference machine on the pinion's clock.
X = [.31, -.42, -.25, -.5, -.182, -.397, .024, .536, -.197, -.248, .196, .143,
     .042, -.372, -.012, .278, -.538, -.183, -.76, -.516]  # fmt: skip
ACCELERATIONS = [1.10491702469, 7.23973882557, -0.285466816339, -2.24873901866, 0.682968384446,
                 0.822818234605, -0.513095379345, -0.260816699792]  # fmt: skip
GOLDEN = {
    ("fixed", "0"): [0.164713902875, 0.161025209982, -0.114026594315, 0.0926641139051],
    ("fixed", "1e-3"): [0.164529285957, 0.161115224498, -0.113843613449, 0.0929171916142],
    ("fixed", "0.1"): [0.149233733775, 0.169555661549, -0.0993094579191, 0.116624095337],
    ("positive", "0"): [0.0753662728993, 0.300380978166, -0.0158275191991, 0.487163375379],
    ("positive", "1e-3"): [0.0753123589518, 0.300429546684, -0.0158169933037, 0.487321687017],
}


@pytest.mark.parametrize(("arc", "psi"), GOLDEN)
def test_the_machine_gives_the_audits_golden_vector(arc, psi):
    system = load("gear-psfd/machine", arc=arc, psi=psi, s=1.7)
    rates = system.reference_rhs(3.0, X)
    np.testing.assert_allclose(rates[:4], GOLDEN[arc, psi], rtol=1e-11)  # the vector is printed to 12 digits
    np.testing.assert_array_equal(rates[4:12], X[12:])
    np.testing.assert_allclose(rates[12:], ACCELERATIONS, rtol=1e-11)


@pytest.mark.parametrize("name", names())
def test_every_stock_case_has_finite_rates_at_its_start(name):
    system = load(name)
    start = [
        system.start.get(s.name, s.start + system.model.start_where_none.get(s, 0))
        for s in system.model.states
    ]
    assert np.all(np.isfinite(system.reference_rhs(0.0, start)))
    assert system.case == name
    assert set(system.notes) == set(system.parameters)


def test_common_periods_are_exact():
    assert load("gear-psfd/reference").common_multiple == 8
    assert load("gear-psfd/machine").common_multiple == 40
    assert load("gear-psfd/machine", z_p=23, z_g=41).common_multiple == 943
    assert load("gear-psfd/reference", r_g=-0.125).values["r_g"] == Fraction(-1, 8)
    assert load("gear-psfd/reference", r_g="-0.3333333333333333").values["r_g"] == Fraction(-1, 3)


def test_jeffcott_rests_at_the_eccentricity_that_its_case_states():
    from scipy.optimize import fsolve

    system = load("jeffcott", b=0)
    rest = fsolve(lambda u: system.reference_rhs(0.0, [*u, 0, 0])[2:], [0.2, -0.2], xtol=1e-13)
    assert np.hypot(*rest) == pytest.approx(0.3, abs=1e-9)


def test_a_model_in_hand_is_loaded_with_its_values():
    system = load(FAMILIES["lorenz"], sigma=10, rho=28, beta="8/3", start={"x": "0.5"})
    assert system.values["beta"] == 8 / 3
    assert system.start == {"x": 0.5}
    assert load(system.model, sigma=10, rho=28, beta=1).values["beta"] == 1


def test_the_literal_editions_xi_5_is_a_symbol_of_its_own():
    default = load("gear-psfd/literal")
    assert default.values["xi_5"] == pytest.approx(default.values["xi_m"] / 4, rel=1e-15)
    assert default.notes["xi_5"] == "default: xi_m/nu_g"
    assert load("gear-psfd/literal", xi_5=0.1).values["xi_5"] == 0.1


#: Case, changes, and what the one message must say.
BAD_CHANGES = [
    (
        "gear-psfd/literal",
        {"kappa_g": 2},
        "edition = literal, film = printed does not read 'kappa_g'; edition = intended does",
    ),
    ("gear-psfd/literal", {"Gamma_2": 2}, "does not read 'Gamma_2'"),
    ("gear-psfd/literal", {"R_2": "30 mm"}, "R_2 has no effect on gear_pair with edition = literal"),
    ("gear-psfd/reference", {"z_p": 23}, "z_p has no effect on gear_pair with edition = intended"),
    ("gear-psfd/reference", {"xi_5": 0.1}, "does not read 'xi_5'"),
    ("gear-psfd/machine", {"edition": "litteral"}, "Did you mean 'literal'?"),
    ("gear-psfd/machine", {"edition": 3}, "cannot be 3; it is one of intended | literal | physical"),
    (
        "gear-psfd/machine",
        {"edition": "literal", "arc": "positive"},
        "edition = literal has no arc = positive",
    ),
    ("gear-psfd/machine", {"j_p": 0, "arc": "fixed"}, "a non-rotating damper needs arc = positive"),
    ("gear-psfd/machine", {"speed": "1500 rpm", "s": 2}, "found speed and s given together"),
    (
        "gear-psfd/machine",
        {"speed": "25 Hz"},
        "whether turns or radians are meant (speed of the pinion's shaft)",
    ),
    ("gear-psfd/machine", {"speed": 1500}, "speed: found 1500 without a unit, expected a unit such as rpm"),
    ("gear-psfd/machine", {"muu": "1 Pa*s"}, "has no symbol 'muu'. Did you mean 'mu'?"),
    (
        "gear-psfd/machine",
        {"mu": "0.03 Pa"},
        "mu: found the unit 'Pa', expected a unit such as Pa*s (viscosity",
    ),
    ("gear-psfd/machine", {"m_p": "-3 kg"}, "m_p: found -3 kg, which must be above 0 (mass of the pinion)"),
    ("gear-psfd/machine", {"z_g": 0}, "z_g: found 0, which must be above 0 (teeth of the gear)"),
    ("gear-psfd/machine", {"psi": float("nan")}, "psi: found nan, expected a finite number (permeability"),
    ("gear-psfd/machine", {"psi": -1}, "psi: found -1, which must be at least 0"),
    ("duffing", {"gama": 1}, "gama: duffing has no symbol 'gama'. Did you mean 'gamma'?"),
    ("duffing", {"gamma": "3 m"}, "gamma: found the unit 'm', expected no unit (forcing amplitude)"),
    ("duffing", {"gamma": [1]}, "gamma: found [1], expected a number"),
    ("jeffcott", {"k": 3}, "jeffcott with rotor = rigid does not read 'k'; rotor = flexible does"),
]


@pytest.mark.parametrize(("case", "changes", "message"), BAD_CHANGES)
def test_changes_that_cannot_be_meant_are_refused(case, changes, message):
    with pytest.raises(CaseError, match=re.escape(message)):
        load(case, **changes)


def test_unknown_and_unfinished_start_values():
    with pytest.raises(RangeError, match="no state 'y'"):
        load("duffing", start={"y": 1})
    with pytest.raises(CaseError, match="start: x: found 'nan', expected a finite number"):
        load("duffing", start={"x": "nan"})


def test_a_start_outside_the_bearing_is_refused():
    with pytest.raises(RangeError, match=r"start u1x = 0.8, u1y = 0.8: journal 1: .* there already"):
        load("gear-psfd/machine", start={"u1x": 0.8, "u1y": 0.8})
    assert load("gear-psfd/machine", start={"u1x": 0.8}).start == {"u1x": 0.8}


def test_start_states_of_a_file_are_checked(tmp_path):
    file = tmp_path / "case.toml"
    file.write_text('extends = "duffing"\nstart = { y = 1 }\n')
    with pytest.raises(CaseError, match=r"case\.toml.*found the state 'y', expected one of x v"):
        load(file)


def test_pieces_hold_every_parameter_with_unit_and_source():
    system = load("gear-psfd/literal", mu="0.03 Pa*s")
    made = pieces(system)
    assert set(system.parameters) <= set(made.parameters)
    assert made.parameters["mu"] == {"value": 0.03, "unit": "Pa*s", "source": "set by the user"}
    assert made.parameters["r_g"]["value"] == "1/8"
    assert made.citations == ("changjian-psfd", "capone1991", "morgan1957")
    assert made.switches["edition"] == "literal"
    assert made.model_hash != pieces(load("gear-psfd/reference")).model_hash
    assert made.model_hash == pieces(load("gear-psfd/literal")).model_hash
    assert made.case_hash == pieces(load("gear-psfd/literal")).case_hash
