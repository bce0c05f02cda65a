"""What a file leaves out and counts as zero is said, and a radius that is a diameter is noticed."""

import re

import pytest
from tests.machines.wrong_machines import GOOD

import whirlmap
from whirlmap.cases import read
from whirlmap.cli.common import machine_parts
from whirlmap.cli.common.machine_parts import describe_parts, print_parts, warnings_of

ALWAYS = {("shaft", shaft, key) for shaft in ("pinion", "gear") for key in ("C", "zeta")}
IMPELLER = {("disk", "impeller", "I_d"), ("disk", "impeller", "I_p")}
TEETH = {("mesh", "teeth", "C_m"), ("mesh", "teeth", "e_TE")}


@pytest.fixture(autouse=True)
def no_truncation(monkeypatch):
    """Eigenvalues of the whole machine take longer than all of these tests."""
    monkeypatch.setattr(machine_parts, "_truncation", lambda _: {"why_not": "not asked for"})


def left_out(tmp_path, text):
    file = tmp_path / "machine.toml"
    file.write_text(text, encoding="utf-8")
    return set(read(file).parts.left_out)


def test_numbers_that_every_such_part_has_are_named(tmp_path):
    assert left_out(tmp_path, GOOD) == ALWAYS | IMPELLER | TEETH
    said = GOOD.replace('m = "3 kg"', 'm = "3 kg"\nI_d = "0.01 kg*m^2"\nI_p = "0 kg*m^2"')
    assert left_out(tmp_path, said) == ALWAYS | TEETH  # a zero that is written is no omission
    assert left_out(tmp_path, GOOD.replace('c = "1e4 N*s/m"\n', "")) - ALWAYS - IMPELLER - TEETH == {
        ("support", "pedestal", "c_x"), ("support", "pedestal", "c_y")
    }  # fmt: skip


def test_a_coupling_without_a_spring_lacks_no_damper(tmp_path):
    text = GOOD + '[[coupling]]\nname = "load"\nshaft = "gear"\nat = 1\nk_r = "1e6 N/m"\n'
    assert left_out(tmp_path, text) - ALWAYS - IMPELLER - TEETH == {("coupling", "load", "c_r")}


def test_rows_of_a_table_give_a_coefficient(tmp_path):
    rows = ", ".join(f'{{ speed = "{n} rpm", k_xx = "1e8 N/m", c_xx = "1e4 N*s/m", k_yy = "1e8 N/m" }}' for n in (9, 9900))
    text = GOOD.replace('R = "25 mm"\nL = "12 mm"\nc = "40 um"\n', f'kind = "coefficients"\ntable = [{rows}]\n', 1)
    assert left_out(tmp_path, text) - ALWAYS - IMPELLER - TEETH == {("bearing", "drive_end", "c_yy")}


def test_show_says_it_in_one_line_and_in_json(tmp_path, capsys):
    file = tmp_path / "machine.toml"
    file.write_text(GOOD, encoding="utf-8")
    system = whirlmap.load(file, **{"mesh.teeth.C_m": "3 N*s/m"})
    parts = describe_parts(system, system.machine.case.parts.machine, None)
    assert set(parts["left_out"]) == {".".join(one) for one in (ALWAYS | IMPELLER | TEETH) - {("mesh", "teeth", "C_m")}}
    print_parts(parts)
    assert "left out, and zero: C, zeta of shaft pinion, gear; I_d, I_p of disk impeller; e_TE of mesh teeth\n" in (
        capsys.readouterr().out
    )


@pytest.mark.parametrize(("R", "noticed"), [("25 mm", False), ("30 mm", False), ("50 mm", True), ("12.5 mm", True)])
def test_a_journal_unlike_its_shaft_is_noticed(tmp_path, R, noticed):
    """The first bearing stands on 50 mm; a sleeve makes a journal a little thicker."""
    file = tmp_path / "machine.toml"
    file.write_text(GOOD, encoding="utf-8")
    system = whirlmap.load(file, **{"bearing.drive_end.R": R})
    said = [text for text in warnings_of(describe_parts(system, system.machine.case.parts.machine, None))
            if text.startswith("journal_diameter")]  # fmt: skip
    assert len(said) == noticed
    if noticed:
        assert "bearing drive_end" in said[0] and "50 mm thick" in said[0] and "R is half of the diameter" in said[0]


def test_the_stock_machine_lacks_no_more_than_damping_of_its_shafts():
    assert {key for _, _, key in read("machines/two-shaft-gearbox").parts.left_out} == {"C", "zeta"}


def test_what_truncation_advises_can_be_set(tmp_path):
    """The options that the warning names, taken as they are."""
    file = tmp_path / "machine.toml"
    file.write_text(GOOD.replace('mm" },', 'mm", n = 4 },'), encoding="utf-8")
    system = whirlmap.load(file)
    parts = describe_parts(system, system.machine.case.parts.machine, None)
    parts["truncation"] = {"why_not": "", "holds": True, "fastest": 900.0}
    (said,) = warnings_of(parts)
    options = dict(re.findall(r"--set (\S+)=N \(now (\d)\)", said))
    assert set(options) <= {"shaft.pinion.modes", "shaft.gear.modes"} and options
    fewer = whirlmap.load(file, **dict.fromkeys(options, "0"))
    assert len(fewer.states) == len(system.states) - 4 * sum(map(int, options.values()))
    parts = describe_parts(fewer, fewer.machine.case.parts.machine, None)
    parts["truncation"] = {"why_not": "", "holds": True, "fastest": 900.0}
    assert "modes" not in warnings_of(parts)[0]  # there are none left to leave out
    parts["truncation"] |= {"holds": False, "frequency": 2.0, "largest_error": 0.5, "allowed": 0.01, "fastest": 1.0}
    assert "--set shaft.pinion.modes=N (now 0), --set shaft.gear.modes=N (now 0)" in warnings_of(parts)[0]
