"""Reasons beside numbers: those that name a number which has been changed are marked, whoever changed it."""

import json
import shlex

import pytest
from typer.testing import CliRunner

from whirlmap.cases import read, resolve
from whirlmap.cli.main import app

RIG, TURBO = "machines/jeffcott-rig", "machines/turbo-gearbox"


def marks(case, **changes):
    """What the reason of each number was written for, and what each changed number was."""
    found = resolve(read(case), changes).marks
    return {n: dict(m.written_for) for n, m in found.items() if m.written_for}, {
        n: m.instead_of for n, m in found.items() if m.instead_of
    }


def test_nothing_is_marked_where_nothing_was_changed():
    for case in (RIG, TURBO, "gear-psfd/machine", "gear-psfd/reference"):
        assert marks(case) == ({}, {})
    assert marks(RIG, R="0.0125 m") == ({}, {})  # the same radius in another unit


@pytest.mark.parametrize(
    ("case", "changes", "written_for", "instead_of"),
    [
        (RIG, {"R": "20 mm"}, {"L": {"R": "12.5 mm"}}, {"R": "12.5 mm"}),  # L/D = 0.24
        ("jeffcott", {"s": 3}, {"Gamma": {"s": "2.6"}}, {"s": "2.6"}),
        ("gear-psfd/machine", {"m_p": "12 kg"}, {"K_p": {"m_p": "10 kg"}}, {"m_p": "10 kg"}),
        (TURBO, {"R_1": "40 mm"}, {"c": {"R_1": "35 mm"}, "L_1": {"R_1": "35 mm"}}, {"R_1": "35 mm"}),
        (TURBO, {"alpha": "25 deg"}, {}, {"alpha": "20 deg"}),
        (TURBO, {"speed": "4500 rpm"}, {}, {"speed": "9000 rpm"}),  # "rated speed" is no symbol
    ],
)
def test_a_change_by_hand_marks_the_reasons_that_name_it(case, changes, written_for, instead_of):
    assert marks(case, **changes) == (written_for, instead_of)


def test_a_file_that_extends_another_marks_its_reasons_and_not_its_own(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text(
        f'extends = "{RIG}"\n[bearings]\nR = {{ value = 20, unit = "mm", source = "drawing 7" }}\n'
        'c = { value = 50, unit = "um", assumed = "c/R = 0.0025" }\n'
    )
    assert marks(str(file)) == ({"L": {"R": "12.5 mm"}}, {})
    text = CliRunner().invoke(app, ["show", str(file)], env={"COLUMNS": "200"}).stdout
    assert "L/D = 0.24 [written for R = 12.5 mm]" in text and "c/R = 0.0025 [" not in text
    assert f"extends {RIG}: A laboratory rig" in text


def test_show_says_what_a_number_was_and_that_words_are_older():
    line = f"show {RIG} --set 'R=20 mm'"
    text = CliRunner().invoke(app, shlex.split(line), env={"COLUMNS": "200"}).stdout
    assert "set by the user; the case has 12.5 mm" in text and "changed: R;" in text
    found = json.loads(CliRunner().invoke(app, [*shlex.split(line), "--json"]).stdout)
    assert found["changed"] == ["R"]
    assert found["inputs"]["R"]["instead_of"] == "12.5 mm" and found["inputs"]["L"]["written_for"] == {"R": "12.5 mm"}
    assert found["inputs"]["R"]["source"] == "set by the user"
