"""Machines from parts as cases: names of inputs, changes that need another model, files that extend others, the page."""

import re
from pathlib import Path

import numpy as np
import pytest
from tests.machines.wrong_machines import GOOD

import whirlmap
from whirlmap.cases import read
from whirlmap.cases.machine_keys import KINDS, OPERATING
from whirlmap.machines.beams import MATERIALS
from whirlmap.machines.fields import Choice
from whirlmap.sweep.parameters.axis import Axis

PAGE = (Path(__file__).parents[2] / "docs" / "parts.md").read_text(encoding="utf-8")


@pytest.fixture
def file(tmp_path):
    made = tmp_path / "machine.toml"
    made.write_text(GOOD, encoding="utf-8")
    return made


def test_dotted_names_reach_inputs_in_one_model(file):
    changes = {"bearing.free_end.c": "60 um", "support.pedestal.k": "2e8 N/m"}
    stock, changed = whirlmap.load(file), whirlmap.load(file, **changes)
    assert changed.model is stock.model
    assert float(changed.values["gamma_free_end"]) == pytest.approx(1.5)
    assert float(changed.values["kappa_x_pedestal"]) == pytest.approx(2 * float(stock.values["kappa_x_pedestal"]))
    assert changed.values["kappa_x_pedestal"] == changed.values["kappa_y_pedestal"]
    every = whirlmap.load(file, **{"bearing.c": "45 um"})
    assert {float(every.values[f"gamma_{b}"]) for b in ("drive_end", "free_end", "gear_end", "gear_other")} == {1.0}


def test_an_axis_over_a_clearance_is_each_value_loaded(file):
    system, name = whirlmap.load(file), "bearing.free_end.c"
    axis = Axis.of(system, name, ["35 um", "40 um", "55 um"])
    for i, text in enumerate(("35 um", "40 um", "55 um")):
        loaded = whirlmap.load(file, **{name: text})
        for parameter, column in axis.columns.items():
            assert column[i] == float(loaded.values[parameter])
    assert set(axis.columns) == {"gamma_free_end", "Gamma_free_end"}


def test_a_change_of_shape_is_another_model_with_its_own_groups(file):
    stock, thicker = whirlmap.load(file), whirlmap.load(file, **{"shaft.pinion.elements.2.d": "80 mm"})
    assert thicker.model is not stock.model and thicker.states == stock.states
    mass = thicker.machine.given["shaft.pinion.m"] - stock.machine.given["shaft.pinion.m"]
    assert mass == pytest.approx(7810 * np.pi / 4 * 0.1 * (0.08**2 - 0.06**2), rel=1e-9)
    assert whirlmap.load(file, **{"shaft.pinion.elements.2.d": "80 mm"}).model is thicker.model
    fixed = whirlmap.load(file, **{"bearing.drive_end.arc": "fixed", "torsion": "none"})
    assert fixed.model is not stock.model
    again = whirlmap.load(fixed.machine.case, **fixed.machine.changes)
    assert again.model is fixed.model


def test_a_new_key_of_a_part_changes_the_equations(file):
    spring = whirlmap.load(file, **{"bearing.free_end.k_c": "1e6 N/m"})
    assert float(spring.values["kappa_c_free_end"]) > 0 and "kappa_c_free_end" not in whirlmap.load(file).parameters


def test_unbalances_by_eccentricity_and_grade_say_the_same(file):
    stock = whirlmap.load(file)
    m, U = stock.machine.given["shaft.pinion.m"], 30e-6
    by_e = whirlmap.load(file, **{"unbalance.u.e": f"{U / m!r} m"})
    by_G = whirlmap.load(file, **{"unbalance.u.G": f"{U / m * 900!r} m/s", "speed_max": "900 rad/s"})
    for one in (by_e, by_G):
        assert float(one.values["b_u"]) == pytest.approx(float(stock.values["b_u"]), rel=1e-12)


def test_power_counts_at_the_speed_of_the_driver(file):
    """The driver is the reference here; from the gear's side the same power is 41/20 of the torque."""
    stock = whirlmap.load(file)
    by_power = whirlmap.load(file, **{"mesh.teeth.P": f"{20 * 900!r} W", "mesh.teeth.speed_P": "900 rad/s"})
    assert float(by_power.values["F_0_teeth"]) == pytest.approx(float(stock.values["F_0_teeth"]), rel=1e-12)


def test_a_file_extends_another_part_by_part(file, tmp_path):
    mine = tmp_path / "mine.toml"
    own = '[[bearing]]\nname = "free_end"\nc = "50 um"\n[operation]\nspeed = "6000 rpm"\n'
    mine.write_text('extends = "machine.toml"\n' + own)
    system, stock = whirlmap.load(mine), whirlmap.load(file)
    assert system.model is stock.model
    changed = {n for n in system.parameters if system.values[n] != stock.values[n]}
    assert changed == {"s", "gamma_free_end", "Gamma_free_end"}
    wrong = tmp_path / "wrong.toml"
    wrong.write_text('extends = "machine.toml"\n[[bearing]]\nname = "free_end"\nR = 25\n')
    with pytest.raises(whirlmap.errors.CaseError, match=r"wrong.toml, line 4: \[\[bearing\]\] free_end: R"):
        read(wrong)


BY_COEFFICIENTS = "".join(f'{key} = "{value}"\n' for key, value in (
    ("kind", "coefficients"), ("k_xx", "1e8 N/m"), ("k_yy", "1e8 N/m"), ("c_xx", "1e5 N*s/m"), ("c_yy", "1e5 N*s/m"),
))  # fmt: skip


def test_a_bearing_of_another_kind_replaces_what_that_kind_does_not_have(file, tmp_path):
    """Its shaft, station and support stay; its radius, length and clearance go, in a file and by hand."""
    mine = tmp_path / "mine.toml"
    mine.write_text(f'extends = "machine.toml"\n[[bearing]]\nname = "free_end"\n{BY_COEFFICIENTS}', encoding="utf-8")
    (one,) = read(mine).parts.machine.coefficients
    assert (one.name, one.shaft, one.station, one.support) == ("free_end", "pinion", 2, "pedestal")
    assert "bearing.free_end.R" not in read(mine).parts.layer
    keys = {f"bearing.free_end.{line.split(' = ')[0]}": line.split('"')[1] for line in BY_COEFFICIENTS.splitlines()}
    by_hand = whirlmap.load(file, **keys).machine.case.parts
    assert by_hand.machine.coefficients == (one,)
    again = tmp_path / "again.toml"  # and back
    film = 'kind = "journal"\nR = "25 mm"\nL = "12 mm"\nc = "40 um"\n'
    again.write_text(f'extends = "mine.toml"\n[[bearing]]\nname = "free_end"\n{film}', encoding="utf-8")
    assert whirlmap.load(again).model is whirlmap.load(file).model


def test_a_message_names_the_file_that_has_the_key(file, tmp_path):
    """Both files have a table of the part; E is in the one that is extended, R in the nearer one."""
    mine, extends = tmp_path / "mine.toml", 'extends = "machine.toml"\n'
    mine.write_text(f'{extends}[[shaft]]\nname = "gear"\nmaterial = "steel"\n', encoding="utf-8")
    line = GOOD.splitlines().index('E = "210 GPa"') + 1
    with pytest.raises(whirlmap.errors.CaseError, match=rf"machine.toml, line {line}: \[\[shaft\]\] gear: E: found E"):
        read(mine)
    mine.write_text(f'{extends}[[bearing]]\nname = "drive_end"\nR = "3 mm"\n{BY_COEFFICIENTS}', encoding="utf-8")
    with pytest.raises(whirlmap.errors.CaseError, match=r"mine.toml, line 4: \[\[bearing\]\] drive_end: R: found"):
        read(mine)


def test_a_distance_divides_the_element_there(file, tmp_path):
    text = GOOD.replace('at = 1\nm = "3 kg"', 'at = "40 mm"\nm = "3 kg"')
    made = tmp_path / "divided.toml"
    made.write_text(text, encoding="utf-8")
    rotors = read(made).parts.machine.rotors
    lengths = [e.L for e in rotors[0].shaft.elements]
    assert lengths == pytest.approx([0.04, 0.06, 0.1]) and rotors[0].shaft.disks[0].station == 1
    assert rotors[0].shaft.bearings == (0, 3)  # stations of the file are those of its own elements


def test_the_page_lists_every_key_and_every_choice():
    rows = {m[1]: m[2] for m in re.finditer(r"^\| `\[+(\w+)\]+`(?! with)[^|]*\| (.*) \|$", PAGE, re.MULTILINE)}
    assert set(rows) == {*KINDS, "operation"}
    for kind, fields in {**KINDS, "operation": OPERATING}.items():
        for one in fields:
            key = one.key
            if key in ("z_driver", "z_driven", "v_2", "v_3", "chi_1", "chi_2") or re.search(r"_[xy]$", key):
                continue
            assert f"`{key}`" in rows[kind], (kind, key)
            for choice in one.choices if isinstance(one, Choice) else ():
                assert f"`{choice}`" in rows[kind], (kind, choice)


def test_the_page_says_which_keys_are_required():
    rows = {m[1]: m[2] for m in re.finditer(r"^\| `\[+(\w+)\]+`(?! with)[^|]*\| (.*) \|$", PAGE, re.MULTILINE)}
    for kind, fields in KINDS.items():
        required = {re.sub(r"_[xy]$", "", one.key) for one in fields if getattr(one, "required", False)}
        assert set(re.findall(r"\*\*`(\w+)`\*\*", rows[kind])) == required, kind
    assert re.findall(r"\*\*`(\w+)`\*\*", rows["operation"]) == ["speed"]
    steel = MATERIALS["steel"]
    assert f"E = {steel.E / 1e9:.0f} GPa, G = {steel.G / 1e9:.1f} GPa, ρ = {steel.rho:.0f} kg/m³" in PAGE


def test_the_file_on_the_page_loads(tmp_path):
    text, *_ = re.findall(r"^```toml\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
    made = tmp_path / "page.toml"
    made.write_text(text, encoding="utf-8")
    system = whirlmap.load(made)
    assert float(system.values["r_pinion"]) == 1.0 and system.common_multiple == 1
