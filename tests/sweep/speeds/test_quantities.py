"""Which displacements are judged: both axes of a station by its name, and the report names what is left."""

import json
import re
import shlex

import numpy as np
import pytest
from tests.machines.wrong_machines import GOOD
from typer.testing import CliRunner

import whirlmap
from whirlmap.cli.main import app
from whirlmap.errors import RangeError
from whirlmap.sweep.speeds.safe_speeds import safe_speeds
from whirlmap.sweep.speeds.verdicts import Judge

RIG = "machines/jeffcott-rig"
#: One rotor with an overhung disk.
HEADS = ('[[shaft]]\nname = "gear"', "[[disk]]", '[[bearing]]\nname = "gear_end"', "[[unbalance]]")
AT = [GOOD.index(text) for text in HEADS]
OVERHUNG = (GOOD[: AT[0]] + GOOD[AT[1] : AT[2]] + GOOD[AT[3] :]).replace('support = "pedestal"\n', "").replace(
    'at = 2\nR =', 'at = 1\nR ='
).replace('at = 1\nm = "3 kg"', 'at = 2\nm = "3 kg"').replace('at = 1\nU =', "at = 2\nU =")  # fmt: skip


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    made = tmp_path_factory.mktemp("overhung") / "machine.toml"
    made.write_text(OVERHUNG, encoding="utf-8")
    return made


def test_a_station_is_judged_along_both_axes(file):
    system = whirlmap.load(file)
    assert Judge(system, "impeller").rows == ["x_impeller", "y_impeller"]
    assert Judge(system, "drive_end").rows == ["ux_drive_end", "uy_drive_end"]
    assert Judge(system, "x_impeller").rows == ["x_impeller"]
    assert Judge(system).rows == ["uy_drive_end", "uy_free_end"]
    assert Judge(system).not_judged == ["impeller", "ux_drive_end", "ux_free_end"]
    assert Judge(system, "impeller").not_judged == ["drive_end", "free_end"]
    with pytest.raises(RangeError, match=r"no station, state or output 'impeler'. Did you mean 'impeller'\?"):
        _ = Judge(system, "impeler").rows


def test_the_larger_axis_counts():
    system, speeds = whirlmap.load(RIG), np.array([0.5, 0.7])
    each = {name: safe_speeds(system, speeds, 0.5, quantity=name, follow=False)["amplitude"].values
            for name in ("rotor", "x", "y")}  # fmt: skip
    np.testing.assert_array_equal(each["rotor"], np.maximum(each["x"], each["y"]))
    assert (each["rotor"] > 0).all() and (each["x"] != each["y"]).all()


def test_the_report_names_what_was_judged_and_what_not():
    line = f"speeds {RIG} --range 0.5:0.7 --points 2 --no-follow --quiet"
    said = CliRunner(env={"COLUMNS": "160"}).invoke(app, shlex.split(line)).stdout
    assert "peak to peak of y, uy at most" in said
    assert "not judged: x, ux (--quantity NAME judges another station; linear --response shows all of them)" in said
    facts = json.loads(CliRunner().invoke(app, shlex.split(f"{line} --json --quantity journals")).stdout)
    assert facts["quantities"] == ["ux", "uy"] and facts["not_judged"] == ["rotor"]


def test_show_lists_the_stations():
    shown = CliRunner(env={"COLUMNS": "160"}).invoke(app, ["show", RIG]).stdout
    assert "stations, for speeds --quantity and linear --response: rotor (x, y), journals (ux, uy)\n" in shown


def test_all_stations_count_where_a_machine_has_no_journal(tmp_path):
    made, stiff = tmp_path / "machine.toml", "\n".join(f'k_{i}{i} = "1e8 N/m"\nc_{i}{i} = "1e4 N*s/m"' for i in "xy")
    text = re.sub(r'R = .*\nL = .*\nc = .*\n', f'kind = "coefficients"\n{stiff}\n', OVERHUNG)
    text = text.replace('[lubricant]\nmu = "0.015 Pa*s"\n', "").replace("at = 0\n", 'at = "2 mm"\n')
    made.write_text(text, encoding="utf-8")
    assert Judge(whirlmap.load(made)).rows == ["x_impeller", "y_impeller"]
