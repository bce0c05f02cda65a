"""What the commands print and write."""

import json
import shlex

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import whirlmap.cli.common.progress as progress_module
from whirlmap.cli.common.progress import Progress, clock
from whirlmap.cli.common.report import jsonable
from whirlmap.cli.main import app


@pytest.fixture(autouse=True)
def empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def done(line):
    result = CliRunner().invoke(app, shlex.split(line))
    assert result.exit_code == 0, (result.stderr, result.exception)
    return result


WORK = {
    "simulate": "simulate duffing --periods 3",
    "bifurcation": "bifurcation duffing --vary gamma=0.2:0.4:5 --transient 40",
    "diagnose": "diagnose duffing --set gamma=0.2 --transient 60 --max-periods 64",
}


@pytest.mark.parametrize("name", WORK)
def test_out_writes_what_its_name_asks_for(name, tmp_path):
    """The suffix chooses data or picture, a folder's name both; --force replaces."""
    for place, files in (
        ("a.nc", ["a.nc"]),
        ("a.svg", ["a.svg"]),
        ("both", [f"both/{name}.nc", f"both/{name}.png"]),
    ):
        content = json.loads(done(f"{WORK[name]} --json --out {place}").stdout)
        assert content["files"] == files
        assert all((tmp_path / f).stat().st_size > 500 for f in files)
    ds = xr.load_dataset("a.nc")
    assert ds.attrs["case"] == "duffing" and ds.attrs["method"] == "dop853"
    assert all("units" in v.attrs and "long_name" in v.attrs for v in ds.data_vars.values())
    assert done(f"{WORK[name]} --out a.nc --force").stdout.endswith("written: a.nc\n")
    assert not [p for p in tmp_path.rglob("*") if "part" in p.name]


def test_bifurcation_finds_the_period_doublings_of_duffing():
    """The ladder of known_values.md: 1T at gamma 0.20, 2T at 0.28, 5T at 0.37, 2T at 0.65."""
    line = "bifurcation duffing --vary gamma={0}:{1}:2 --transient 200 --json"
    for first, second, periods in ((0.20, 0.28, [1, 2]), (0.37, 0.65, [5, 2])):
        content = json.loads(done(line.format(first, second)).stdout)
        assert content["sweeps"][0]["period"] == periods
        assert content["sweeps"][0]["regime"] == ["periodic", "periodic"]


def test_follow_both_gives_two_sweeps():
    line = "bifurcation duffing --vary gamma=0.2:0.3:3 --transient 10 --follow both --out a.nc --json"
    content = json.loads(done(line).stdout)
    assert [s["direction"] for s in content["sweeps"]] == ["up", "down"]
    assert dict(xr.load_dataset("a.nc").sizes)["direction"] == 2


def test_diagnose_speaks_of_turns_and_counts():
    content = json.loads(done(f"{WORK['diagnose']} --json").stdout)
    assert (content["regime"], content["period"], content["period_turns"]) == (
        "periodic",
        1,
        {"forcing": 1.0},
    )
    assert "periodic, 1T" in done(WORK["diagnose"]).stdout


@pytest.mark.parametrize(
    ("option", "key", "value"),
    [("--set gamma=0.21", "gamma", 0.21), ("--set omega=1.3", "omega", 1.3)],
)
def test_set_reaches_the_system(option, key, value):
    assert json.loads(done(f"simulate duffing --periods 1 {option} --json").stdout)["parameters"][key] == value


def test_start_steps_periods_transient_and_every_matter():
    base = "simulate duffing --periods 1 --json"
    plain = json.loads(done(base).stdout)
    assert plain["samples"] == 101 and plain["time"][0] == 0
    assert json.loads(done(f"{base} --steps 50").stdout)["samples"] == 51
    assert json.loads(done(f"{base} --every 10").stdout)["samples"] == 11
    assert json.loads(done(f"{base} --transient 2").stdout)["time"][0] == pytest.approx(2 * plain["period"])
    moved = json.loads(done(f"{base} --start x=0.5").stdout)["motion"]["x"]
    assert moved != plain["motion"]["x"]


def test_workers_change_nothing():
    line = "bifurcation duffing --vary gamma=0.2:0.5:40 --transient 10 --json --workers {}"
    assert done(line.format(1)).stdout == done(line.format(2)).stdout


def test_show_lists_inputs_groups_switches_clocks_and_sources():
    content = json.loads(done("show gear-psfd/machine --set 'speed=1500 rpm' --equations --json").stdout)
    assert content["inputs"]["m_p"]["written"] == "10 kg"
    assert content["inputs"]["m_p"]["source"].startswith("assumed: ")
    assert content["parameters"]["psi"]["value"] == 1e-3
    assert content["parameters"]["r_g"] | {"exact": "-1/2", "value": -0.5} == content["parameters"]["r_g"]
    assert content["quantities"]["pinion_speed"]["rpm"] == pytest.approx(1500)
    assert content["common_multiple"] == 40
    s = content["parameters"]["s"]["value"]
    assert {n: c["s"] / s for n, c in content["clocks"].items()} == pytest.approx({"mesh": 20, "pinion": 1, "gear": 0.5})
    assert set(content["equations"]) == set(content["states"])
    assert content["switches"]["edition"]["value"] == "physical"
    assert [w.split(":")[0] for w in content["warnings"]] == ["mesh_load"]
    text = done("show gear-psfd/machine").stdout
    for words in ("Dimensional inputs", "Dimensionless groups", "Switches", "Start state", "common period"):
        assert words in text


def test_show_warns_where_a_rotor_strains_its_model():
    changes = "--set 'L=8 mm' --set 'mu=0.004 Pa*s' --set 'speed=6000 rpm'"
    content = json.loads(done(f"show machines/jeffcott-rig {changes} --json").stdout)
    assert [w.split(":")[0] for w in content["warnings"]] == ["slenderness", "clearance", "film_inertia"]
    plain = json.loads(done("show machines/jeffcott-rig --json").stdout)["warnings"]
    assert [w.split(":")[0] for w in plain] == ["clearance"]


def test_show_warns_of_a_damper_that_carries_nothing():
    line = "show gear-psfd/reference --set arc=positive --set j_p=0 --set j_g=0 --json"
    assert any("gravity" in w for w in json.loads(done(line).stdout)["warnings"])


def test_json_has_no_nan():
    assert jsonable({"a": np.array([1.0, np.nan]), "b": float("inf"), "c": np.int8(3)}) == {
        "a": [1.0, None],
        "b": None,
        "c": 3,
    }


def test_progress_off_a_terminal_is_a_line_now_and_then(capsys, monkeypatch):
    monkeypatch.setattr(progress_module, "EVERY", 0.0)
    with Progress("work", 200) as progress:
        progress(50)
        progress.expect(100, "1 of 2 points")
        progress(25)
    first, second = capsys.readouterr().err.splitlines()
    assert "work: 25 % in 0:00" in first and "left" in first
    assert "work: 75 % in" in second and "1 of 2 points" in second
    with Progress("work", 200, quiet=True) as progress:
        progress(50)
    assert capsys.readouterr().err == ""


def test_clock_reads_like_a_clock():
    assert [clock(s) for s in (4, 65, 3727)] == ["0:04", "1:05", "1:02:07"]


@pytest.fixture
def reproduction(monkeypatch, tmp_path):
    """A study that takes no time, and says what it was asked for."""
    asked = []

    def study(out, *, quality, cases, workers, progress):
        asked.append((str(out), quality, cases, workers))
        progress(10)
        verdicts = {"machine": {"fig2": {"verdict": "reproduced", "found": "1T"}}}
        return {"report": tmp_path / "report.html", "figures": [], "verdicts": verdicts}

    monkeypatch.setattr("whirlmap.cli.commands.reproduce.run", study)
    return asked


def test_reproduce_prints_the_verdict_on_every_claim(reproduction):
    assert "fig2    reproduced" in done("reproduce").stdout
    content = json.loads(done("reproduce --quality full --out there --workers 1 --json").stdout)
    assert content["verdicts"]["machine"]["fig2"]["verdict"] == "reproduced"
    assert done("reproduce --case gear-psfd/machine").stdout
    assert reproduction == [
        ("reproduction", "quick", None, None), ("there", "full", None, 1),
        ("reproduction", "quick", ["gear-psfd/machine"], None),
    ]  # fmt: skip


def test_an_interrupted_reproduction_says_where_its_parts_are(reproduction, monkeypatch):
    def study(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("whirlmap.cli.commands.reproduce.run", study)
    result = CliRunner().invoke(app, ["reproduce"])
    assert result.exit_code == 130 and "reproduction" in result.stderr and result.stdout == ""
