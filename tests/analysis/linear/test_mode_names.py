"""Names and shapes of modes, and Campbell diagrams in rpm and Hz."""

import json

import numpy as np
import pytest
from tests.analysis.linear.test_campbell import on_springs
from typer.testing import CliRunner

import whirlmap
from whirlmap.analysis.linear.campbell import campbell
from whirlmap.cli.main import app

RIG = "campbell machines/jeffcott-rig --vary s=0.3:2:20"


def run(line):
    result = CliRunner(env={"COLUMNS": "200"}).invoke(app, line.split())
    assert result.exit_code == 0, (result.stderr, result.exception)
    return result.stdout


@pytest.fixture(scope="module")
def rig():
    return json.loads(run(f"{RIG} --json"))


def test_modes_of_a_gearbox_are_those_of_its_rotors_and_of_torsion():
    ds = campbell(whirlmap.load("machines/turbo-gearbox"), "s", [0.2, 0.3332, 0.5])
    names = ds["mode_name"].values.tolist()
    assert {"pinion forward", "gear backward", "pinion torsion", "gear torsion"} <= set(names)
    shape = ds["shape"].isel(mode=names.index("gear torsion"), s=1)
    assert float(shape.sel(body="gear torsion")) == 1 and float(shape.sel(body="gear housings")) < 0.1
    assert (ds["shape"].max("body") == 1).all()


def test_modes_are_named_by_the_bodies_that_the_model_declares():
    ds = campbell(on_springs(0.3), "s", np.linspace(0.5, 2.0, 5))
    assert sorted(ds["mode_name"].values.tolist()) == ["disc backward", "disc forward"]
    assert set(campbell(on_springs(0.0, ratio=1.5), "s", [0.5, 1.0])["mode_name"].values.tolist()) == {"disc in a line"}


def test_modes_of_a_model_without_bodies_have_no_name_and_no_whirl_and_it_says_so():
    system = on_springs(0.3, bodies={})
    ds = campbell(system, "s", np.linspace(0.5, 2.0, 5))
    assert set(ds["mode_name"].values.tolist()) == {""} and not ds["whirl"].values.any()
    assert system.model.not_declared()["bodies"] == "no names and no sense of whirl of modes"
    assert "not declared: bodies (no names" in str(system.model)


def test_the_critical_speed_of_the_rig_in_rpm_and_hz(rig):
    """At a critical speed of its own shaft a rotor turns as often as it swings: rpm are 60 times Hz."""
    found, units = rig["dimensional"], rig["dimensional"]["units"]
    assert (units["values"], units["frequency"], units["critical"]) == ("rpm", "Hz", {"value": "rpm", "frequency": "Hz"})
    for row in found["critical"]:
        assert row["value"] == pytest.approx(60 * row["frequency"], rel=1e-12)
    assert any(2800 < row["value"] < 2990 for row in found["critical"])  # 2970 rpm on rigid bearings
    np.testing.assert_allclose(np.array(found["values"]), np.array(rig["values"]) * 2990.927498917685, rtol=1e-12)


def test_the_numbers_in_groups_stay(rig):
    assert rig["values"][0] == 0.3 and rig["line"][0] == rig["values"]
    assert [row["name"] for row in rig["critical"]] == ["journals forward", "rotor forward", "rotor backward"]
    assert rig["critical"][1]["shape"]["rotor"] == 1
    assert "dimensional" not in json.loads(run(f"{RIG} --json --dimensionless"))


def test_the_table_is_in_rpm_and_hz():
    said = run(RIG)
    assert "speed [rpm]" in said and "frequency [Hz]" in said and "rotor forward" in said
    said = run(f"{RIG} --dimensionless")
    assert "rpm" not in said and "Hz" not in said


def test_the_picture_is_in_rpm_and_hz():
    from whirlmap.cli.common import pictures

    system = whirlmap.load("machines/jeffcott-rig")
    ds = whirlmap.in_units(system, campbell(system, "s", np.linspace(0.3, 2, 9)))
    upper, lower = pictures.campbell(system, ds).axes
    assert "[Hz]" in upper.get_ylabel() and "[rpm]" in lower.get_xlabel()
