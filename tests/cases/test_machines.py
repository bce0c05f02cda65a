"""Dimensional cases: tables, shared names, other ways to give a number, and machines that cannot be."""

from math import pi

import pytest

from whirlmap.cases import read, resolve
from whirlmap.errors import CaseError, WhirlmapError
from whirlmap.integrate.loading import load
from whirlmap.models.lubricant import by_grade

TURBO, RIG, AERO = "machines/turbo-gearbox", "machines/jeffcott-rig", "machines/aero-damper"


def written(tmp_path, text, base="gear-psfd/machine"):
    file = tmp_path / "machine.toml"
    file.write_text(f'extends = "{base}"\n{text}')
    return resolve(read(file))


def entry(name, value, unit=None):
    """A line of a case file."""
    beside = f', unit = "{unit}"' if unit else ""
    return f'{name} = {{ value = {value}{beside}, assumed = "test" }}\n'


# --- how they are written ----------------------------------------------------------------------------------


def test_tables_and_shared_names_say_the_same_as_symbols(tmp_path):
    """Values that repeat at each bearing are written once."""
    short = "[bearings]\n" + entry("R", 28, "mm") + "[shafts]\n" + entry("K", 5e6, "N/m")
    long = entry("R_1", 28, "mm") + entry("R_2", 28, "mm") + entry("K_p", 5e6, "N/m") + entry("K_g", 5e6, "N/m")
    one, other = written(tmp_path, short), written(tmp_path, long)
    assert one.values == other.values
    assert one.inputs["R_1"].value == one.inputs["R_2"].value == 0.028


def test_switches_in_a_table_leave_their_names_to_tables(tmp_path):
    made = written(tmp_path, '[switches]\nsuspension = "linear"\n[suspension]\n' + entry("m_h", 7, "kg"))
    assert made.switches["suspension"] == "linear"
    assert made.inputs["m_1"].value == made.inputs["m_2"].value == 7.0


def test_shared_names_can_be_set_by_hand():
    made = resolve(read(TURBO), {"L": "20 mm"})
    assert made.inputs["L_1"].value == made.inputs["L_2"].value == 0.02


# --- other ways to give a number ---------------------------------------------------------------------------


def test_the_oil_follows_from_its_grade():
    made = resolve(read(TURBO))
    assert made.inputs["mu"].value == pytest.approx(by_grade(32, 100, 65, 845), rel=1e-15)
    assert "VG = 32" in made.inputs["mu"].note
    assert "ASTM D341" in made.inputs["mu"].note
    hot = resolve(read(TURBO), {"T_oil": "90 degC"})
    thinner = by_grade(32, 100, 90, 845) / by_grade(32, 100, 65, 845)
    assert hot.values["Gamma_1"] / made.values["Gamma_1"] == pytest.approx(thinner)
    plain = resolve(read(TURBO), {"mu": "0.02 Pa*s"})
    assert plain.inputs["mu"].value == 0.02
    assert "VG" not in plain.inputs
    assert "T_oil" not in plain.inputs
    assert resolve(read("gear-psfd/machine"), {"VG": 46, "VI": 100, "T_oil": "60 degC", "rho": "860 kg/m^3"}).inputs["VG"]


def test_unbalance_is_a_grade_or_grams_by_millimetres():
    """ISO 21940-11: e omega = 2.5 mm/s at the shaft's own speed for speed_max."""
    made = resolve(read(TURBO))
    omega = 9000 * pi / 30
    assert made.inputs["e_up"].value == pytest.approx(2.5e-3 / omega, rel=1e-14)
    assert made.inputs["e_ug"].value == pytest.approx(2.5e-3 / (omega / 3), rel=1e-14)
    assert resolve(read(RIG)).inputs["e_u"].value == pytest.approx(1e-5, rel=1e-14)
    grams = resolve(read(TURBO), {"U_p": "50 g*mm"})
    assert grams.inputs["e_up"].value == pytest.approx(50e-6 / 25, rel=1e-14)
    assert "G_p" not in grams.inputs


def test_torque_follows_from_power():
    made = resolve(read(TURBO))
    torque = 60e3 / (9000 * pi / 30)
    assert made.inputs["T_p"].value == pytest.approx(-torque, rel=1e-14)
    assert made.quantities["transmitted_power"][0] == pytest.approx(-60e3, rel=1e-12)
    base = 3e-3 * 31 * 0.9396926207859084 / 2
    assert made.values["F_0"] == pytest.approx(torque / base / (2e8 * 60e-6), rel=1e-12)
    assert made.values["phi_m"] == pytest.approx(-(pi / 2 - pi / 9), rel=1e-12)  # the gear pushes: the other flank
    assert resolve(read(TURBO), {"T_p": "30 N*m"}).values["phi_m"] == pytest.approx(pi / 2 - pi / 9, rel=1e-12)


def torque(case, **changes):
    made = resolve(read(case), changes)
    return made.inputs["T_p"].value, made.inputs["T_p"].note


def test_power_counts_at_the_speed_it_is_given_for(tmp_path):
    """60 kW at 9000 rpm are the same torque, whatever range of speeds is asked for; and the note says the speed."""
    rated = -60e3 / (9000 * pi / 30)
    assert torque(TURBO)[0] == pytest.approx(rated, rel=1e-14)
    for changes in ({"speed_max": "12000 rpm"}, {"speed": "4500 rpm"}):
        value, note = torque(TURBO, **changes)
        assert value == pytest.approx(rated, rel=1e-14)
        assert "speed_max = 9000 rpm" in note and ("where P_t is given" in note) == ("speed_max" in changes)
    wider = tmp_path / "wider.toml"
    wider.write_text(f'extends = "{TURBO}"\n[operation]\n' + entry("speed_max", 12000, "rpm"))
    assert torque(wider)[0] == pytest.approx(rated, rel=1e-14)
    assert torque(wider, P_t="-80 kW")[0] == pytest.approx(-80e3 / (12000 * pi / 30), rel=1e-14)
    value, note = torque(TURBO, speed_P="6000 rpm", speed_max="12000 rpm")
    assert value == pytest.approx(1.5 * rated, rel=1e-14) and "speed_P = 6000 rpm" in note


def test_how_a_machine_is_run_is_there_for_speeds():
    for name, low, high, limit in ((TURBO, 3000, 9000, 25e-6), (RIG, 600, 6000, 60e-6), (AERO, 2000, 15000, 100e-6)):
        inputs = load(name).machine.inputs
        assert inputs["speed_min"].value == pytest.approx(low * pi / 30, rel=1e-14)
        assert inputs["speed_max"].value == pytest.approx(high * pi / 30, rel=1e-14)
        assert inputs["limit"].value == pytest.approx(limit, rel=1e-14)
    assert load(TURBO, limit="30 um").machine.inputs["limit"].value == pytest.approx(30e-6)


@pytest.mark.parametrize("name", [TURBO, RIG, AERO])
def test_every_number_of_the_machines_says_where_it_comes_from(name):
    from whirlmap.references import references

    for given in read(name).given.values():
        kind, text = given.note.split(": ", 1)
        assert kind in ("source", "assumed")
        assert len(text) > 3
        if kind == "source":
            assert text.split(",")[0] in references(), given.name


# --- what the groups mean ----------------------------------------------------------------------------------


def test_the_rigs_groups_are_those_of_its_numbers():
    made = resolve(read(RIG), {"mu": "0.01 Pa*s"})
    W, c = 0.8 * 9.81 / 2, 1e-4
    A = 0.01 * 12.5e-3 * 6e-3**3 / (2 * c**2)
    expected = {"s": 60 * pi * (c / 9.81) ** 0.5, "Gamma": A * (9.81 / c) ** 0.5 / W, "b": 0.1, "k": 38.7e3 * c / W}
    for name, value in expected.items():
        assert float(made.values[name]) == pytest.approx(value, rel=1e-12), name
    assert made.quantities["omega_n"][0] == pytest.approx((2 * 38.7e3 / 0.8) ** 0.5, rel=1e-12)


def test_a_damper_is_the_film_of_newtons_law_with_a_cage():
    """Force balance of a ring that does not turn, in SI: film (C = pi mu R L^3/(2 c^3) at the centre), cage, shaft."""
    system = load(AERO)
    q = {n.rpartition(".")[2]: i.value for n, i in system.machine.inputs.items()}
    c, w, held = q["c"], q["speed"], q["K"] / 2  # stiffness of the shaft at each bearing
    assert system.states == ("x_rotor", "y_rotor", "ux_ring", "uy_ring", "vx_rotor", "vy_rotor")
    damping = system.machine.quantities["film_damping_ring"][0]
    assert damping == pytest.approx(pi * q["mu"] * 0.06 * 0.03**3 / (2 * c**3), rel=1e-12)
    assert system.machine.quantities["omega_cage_rotor"][0] == pytest.approx((2 * q["k_c"] / 40) ** 0.5, rel=1e-12)
    for u, x in (((1e-9, 0.0), (3e-6, 1e-6)), ((0.0, 2e-9), (-1e-6, 4e-6))):
        rates = system.reference_rhs(0.0, [x[0] / c, x[1] / c, u[0] / c, u[1] / c, 0.0, 0.0])
        for i in (0, 1):
            force = held * (x[i] - u[i]) - q["k_c"] * u[i]
            # At the centre the half film of positive pressure resists along the motion alone.
            assert rates[2 + i] * c * w == pytest.approx(force / damping, rel=2e-3)
    hang = -40 * 9.81 / 2 / q["k_c"] / c
    down = hang - 40 * 9.81 / 2 / held / c
    import numpy as np

    from whirlmap.kernels.running.reference import reference_rates

    rest = reference_rates(system.model, forced=False)(0.0, np.array([0, down, 0, hang, 0, 0]), system.vector)
    np.testing.assert_allclose(rest, 0.0, atol=1e-12)


# --- machines that cannot be -------------------------------------------------------------------------------

BAD = [
    ("[bearings]\n" + entry("c", -50, "um"), "must be above 0"),
    ("[pinion]\n" + entry("z_p", 0), "must be above 0"),
    ("[pinion]\n" + entry("z_p", 20.5), "must be a whole number"),
    (entry("psi", -1e-3), "psi.*must be at least 0"),
    ("[bearings]\n" + entry("R", 25), "without a unit"),
    ("[bearings]\n" + entry("R", 25, "kg"), "expected a unit such as m"),
    ("[operation]\n" + entry("speed_min", -500, "rpm") + entry("speed_max", 500, "rpm"),
     "speed_min: found -500 rpm, which must be above 0"),
    ("[operation]\n" + entry("speed_min", 900, "rpm") + entry("speed_max", 500, "rpm"),
     "speed_min = 900 rpm and speed_max = 500 rpm"),
    ("[unbalance]\n" + entry("G_p", 2.5, "mm/s") + entry("U_p", 5, "g*mm"), "U_p and G_p given together"),
    ("[lubricant]\n" + entry("mu", 0.02, "Pa*s") + entry("VG", 46), "mu and VG given together"),
    ("[lubricant]\n" + entry("VG", 46), "also needs VI, T_oil, rho"),
    ("[lubricant]\n" + entry("VG", 40) + entry("VI", 95) + entry("T_oil", 60, "degC") + entry("rho", 860, "kg/m^3"),
     "nearest is 46"),
    ("[unbalance]\n" + entry("G_p", 2.5, "mm/s"), "also needs speed_max"),
    ("[mesh]\n" + entry("P_t", 20, "kW"), "also needs speed_P or speed_max"),
    ("[lubricant]\n" + entry("VG", 46) + entry("VI", 95) + entry("T_oil", 500, "degC") + entry("rho", 860, "kg/m^3"),
     "VG: found an oil at 500 degC, expected -70 to 340"),
    ("[bearings]\nc = 50\n", r"line 3: c: found 50, expected an entry such as c = \{"),
    ("[mesh]\n" + entry("T_p", 0, "N*m"), "found T_p = 0, expected a torque with a sign"),
    (entry("P_t", 0, "kW") + entry("speed_max", 900, "rpm"), "found T_p = 0, expected a torque with a sign"),
    (entry("psi", "1e300"), "psi: found 1E[+]300, which must be at most 1e[+]30 in size"),
    (entry("K_p", "1e-300", "N/m"), r"found .*K_p.* = (inf|[0-9.e+]+), which must be (a finite number|at most 1e[+]30)"),
    (entry("r_p", 0) + entry("speed", 900, "rpm"), r"found s = speed/\(r_p.*\) = nan, which must be a finite number"),
    ("[bearings]\n" + entry("R", 25, "mm") + entry("R_2", 26, "mm"), "R_2 given twice"),
    ("[bearings]\n" + entry("m_p", 25, "kg"), r"found m_p in \[bearings\], expected it in \[pinion\]"),
    ("[bearing]\n" + entry("R", 25, "mm"), r"unknown table \[bearing\].*bearings"),
    ('suspension = "linear"\n[suspension]\n' + entry("m_h", 7, "kg"), r"write the switch in a table \[switches\]"),
    ('[switches]\nmesh = "lin"', "expected one of isotropic"),
    ('mesh = "line"', "F_0.*missing T_p"),
    ('backlash = "dead_zone"', "backlash = dead_zone needs mesh = line"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "words"), BAD)
def test_machines_that_cannot_be_get_one_message(tmp_path, text, words):
    with pytest.raises(WhirlmapError, match=words) as caught:
        written(tmp_path, text)
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"T_p": "20 N*m"}, "T_p has no effect on gear_pair.*mesh = line reads it"),
        ({"F_0": 1}, "does not read 'F_0'; mesh = line does"),
        ({"T_oil": "60 degC"}, "T_oil has no effect: mu is not given by VG here"),
        ({"G_p": "2.5 mm/s", "e_up": "5 um"}, "e_up and G_p given together"),
        ({"R": "25 mm", "R_1": "26 mm"}, "R_1 given twice"),
    ],
)
def test_changes_that_cannot_be_get_one_message(changes, words):
    with pytest.raises(CaseError, match=words):
        resolve(read("gear-psfd/machine"), changes)
