"""The gear pair's dimensionless groups: known values, other units, symbols against inputs."""

from fractions import Fraction

import pytest

from whirlmap.cases import read, resolve
from whirlmap.errors import CaseError
from whirlmap.models.gear_pair_machine import GEAR_PAIR_MACHINE, INPUTS

MACHINE = "gear-psfd/machine"

#: Section 6.2 of the audit, to the four digits printed there.
KNOWN = {
    "f": 0.4905,
    "Lambda": 25,
    "xi_m": 0.2214,
    "xi_p": 0.01976,
    "xi_g": 0.01383,
    "nu_g": 4,
    "kappa_g": 2,
    "nu_1": 0.5,
    "nu_2": 1,
    "S_1": 0.3162,
    "S_2": 0.3162,
    "xi_1": 0.05,
    "xi_2": 0.05,
    "a_1": 1.25,
    "a_2": 1.25,
    "b_p": 0.1,
    "b_g": 0.2,
    "E": 0.1,
    "Gamma_1": 1.0929,
    "Gamma_2": 2.2662,
    "psi": 1e-3,
}
#: Groups that come out exactly, with no rounding on the way.
EXACT = (
    "f",
    "Lambda",
    "nu_g",
    "kappa_g",
    "nu_1",
    "nu_2",
    "xi_1",
    "xi_2",
    "a_1",
    "a_2",
    "b_p",
    "b_g",
    "E",
    "psi",
)


def test_the_reference_machine_has_the_audits_groups():
    values = resolve(read(MACHINE)).values
    for name, value in KNOWN.items():
        assert float(values[name]) == pytest.approx(value, rel=4e-4), name
    for name in EXACT:
        assert float(values[name]) == KNOWN[name], name


#: The same machine, as a British workshop and a careless student would write it.
OTHER_UNITS = {
    "m_p": "10000 g",
    "m_g": "0.04 t",
    "m_1": "5000 g",
    "m_2": "10e6 mg",
    "K_p": "4 N/um",
    "K_g": "8 MN/m",
    "C_p": "0.25 kN*s/m",
    "C_g": "0.7 N*s/mm",
    "k_11": "20 kN/mm",
    "k_21": "40 kN/mm",
    "k_12": "1e-3 N/um^3",
    "k_22": "2e-3 N/um^3",
    "c_1": "1 kN*s/m",
    "c_2": "2 N*s/mm",
    "K_m": "100 N/um",
    "C_m": "2.8 N*s/mm",
    "e_TE": "5e-3 mm",
    "e_up": "5000 nm",
    "e_ug": "1e-2 mm",
    "mu": "20 cP",
    "c": "0.05 mm",
    "R_1": "2.5 cm",
    "L_1": "1.2 cm",
    "R_2": "0.03 m",
    "L_2": "14400 um",
    "H": "2000 um",
    "Phi": "5.2083333333333333e-9 mm^2",
    "g": "981 cm/s^2",
}


def test_the_same_machine_in_other_units_has_the_same_groups():
    case = read(MACHINE)
    before, after = resolve(case).values, resolve(case, OTHER_UNITS).values
    assert set(OTHER_UNITS) == set(resolve(case).inputs) - {"z_p", "z_g"}  # nothing is left out
    for name, value in before.items():
        assert float(after[name]) == pytest.approx(float(value), rel=1e-13), name


def test_groups_do_not_depend_on_the_system_of_units():
    """Scaling mass, length and time leaves every group alone: they are dimensionless as expressions."""
    mass, length, time = Fraction(7, 3), Fraction(11, 5), Fraction(13, 2)
    powers = {
        "kg": (1, 0, 0),
        "m": (0, 1, 0),
        "m^2": (0, 2, 0),
        "N/m": (1, 0, -2),
        "N*s/m": (1, 0, -1),
        "rad/s": (0, 0, -1),
        "N/m^3": (1, -2, -2),
        "Pa*s": (1, -1, -1),
        "m/s^2": (0, 1, -2),
        "1": (0, 0, 0),
    }
    case = read(MACHINE)
    settled = resolve(case, {"speed": "1500 rpm"})
    groups = GEAR_PAIR_MACHINE.groups
    plain = {name: Fraction(given.value) for name, given in settled.inputs.items()}
    scaled = {}
    for q in (q for q in INPUTS if q.name in plain):
        m, l, t = powers[q.unit]
        scaled[q.name] = plain[q.name] * mass**m * length**l * time**t
    for edition in ("literal", "intended", "physical"):
        switches = {"mesh": "isotropic", "backlash": "none", "torsion": "none", "contact": "stop", "centring": "none"}
        switches["edition"] = edition
        for name in groups.expressions(switches):
            one, _ = groups.evaluate(name, switches, plain)
            other, _ = groups.evaluate(name, switches, scaled)
            assert float(other) == pytest.approx(float(one), rel=1e-13), (edition, name)


@pytest.mark.parametrize(
    ("edition", "clocks"),
    [
        ("physical", {"r_p": 1, "r_g": Fraction(-1, 2), "r_m": 20, "j_p": 1, "j_g": -0.5}),
        ("intended", {"r_p": Fraction(1, 4), "r_g": Fraction(-1, 8), "r_m": 1, "j_p": 0.25, "j_g": -0.125}),
        ("literal", {"r_p": Fraction(1, 4), "r_g": Fraction(1, 8), "r_m": 1, "j_p": 1, "j_g": 1}),
    ],
)
def test_each_edition_has_its_clock_and_its_exact_orders(edition, clocks):
    values = resolve(read(MACHINE), {"edition": edition}).values
    assert {name: values[name] for name in clocks} == clocks
    assert all(isinstance(values[name], Fraction) for name in ("r_p", "r_g", "r_m"))


def test_prime_teeth_give_exact_orders():
    assert resolve(read(MACHINE), {"z_p": 23, "z_g": 41}).values["r_g"] == Fraction(-23, 41)


def test_speed_is_the_pinions_in_every_edition():
    case = read(MACHINE)
    omega_0 = (4e6 / 10) ** 0.5
    for edition in ("physical", "intended", "literal"):
        settled = resolve(case, {"edition": edition, "speed": "1500 rpm"})
        s, r_p = float(settled.values["s"]), float(settled.values["r_p"])
        assert s * r_p * omega_0 == pytest.approx(157.07963267948966, rel=1e-14)
        assert settled.quantities["pinion_speed"][0] == pytest.approx(157.07963267948966, rel=1e-14)


def test_a_changed_input_recomputes_its_groups_and_no_others():
    case = read(MACHINE)
    before, after = resolve(case).values, resolve(case, {"mu": "0.04 Pa*s"}).values
    changed = {name for name in before if before[name] != after[name]}
    assert changed == {"Gamma_1", "Gamma_2"}
    assert after["Gamma_1"] == pytest.approx(2 * before["Gamma_1"], rel=1e-15)


def test_a_symbol_that_is_given_wins_over_its_group():
    settled = resolve(read(MACHINE), {"Gamma_1": 3, "mu": "0.04 Pa*s"})
    assert settled.values["Gamma_1"] == 3
    assert settled.notes["Gamma_1"] == "set by the user"
    assert settled.notes["Gamma_2"].startswith("group: ")


def test_an_input_takes_precedence_over_the_symbol_of_a_lower_layer_that_it_alone_sets():
    settled = resolve(read("gear-psfd/reference"), {"Phi": "5.2083333333333333e-13 m^2"})
    assert settled.values["psi"] == pytest.approx(0.1, rel=1e-14)
    assert resolve(read("gear-psfd/reference")).values["psi"] == 1e-3
    assert (
        "Phi" not in resolve(read("gear-psfd/reference")).inputs
    )  # replaced by psi, so not shown as if it counted


def test_orders_of_one_journal_follow_the_orders_of_its_shaft():
    values = resolve(read("gear-psfd/reference"), {"r_g": "1/8"}).values
    assert values["r_g"] == Fraction(1, 8)
    assert values["j_g"] == 0.125


def test_missing_inputs_are_named(tmp_path):
    file = tmp_path / "half.toml"
    file.write_text('model = "gear_pair"\ns = { value = 1, assumed = "test" }\n')
    with pytest.raises(CaseError, match=r"no value for 'psi'.*missing H, Phi, c"):
        resolve(read(file))
