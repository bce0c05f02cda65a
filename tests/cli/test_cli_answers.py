"""Answers are no errors, and runs that could not be finished are no answers: exit codes say which."""

import json

import pytest
from typer.testing import CliRunner

from whirlmap.cli.main import app
from whirlmap.results.status import Status
from whirlmap.sweep.diagrams import runs_in_parts as sweep_run

STABLE = "linear machines/jeffcott-rig --threshold s=0.05:0.06"


def run(line, code):
    result = CliRunner().invoke(app, line.split())
    assert result.exit_code == code, (result.stderr, result.exception)
    return result


def test_that_stability_is_kept_is_an_answer():
    said = run(STABLE, 0).stdout
    assert "no loss of stability for s from 0.05 to 0.06: the equilibrium is stable" in said
    found = json.loads(run(f"{STABLE} --json", 0).stdout)["threshold"]
    assert found["value"] is None and "stable" in found["note"]


DAMPER = "machines/aero-damper"


@pytest.mark.parametrize("line", ["linear CASE", "linear CASE --threshold s=1:5", "campbell CASE --vary s=1:5:4"])
def test_that_a_damper_has_no_eigenvalues_is_an_answer(line):
    line = line.replace("CASE", DAMPER)
    said = " ".join(run(line, 0).stdout.split())
    for words in ("no eigenvalues: the film of a damper", "whirlmap diagnose machines/aero-damper", "whirlmap show"):
        assert words in said
    found = json.loads(run(f"{line} --json", 0).stdout)
    assert "no eigenvalues" in found["note"]
    if line.startswith("linear"):  # the sag in the cages, W/K_c and W/K, over c = 120 um
        load = 40 * 9.81 / 2
        assert found["equilibrium"]["uy_ring"] == pytest.approx(-load / 4e6 / 120e-6)
        assert found["equilibrium"]["y_rotor"] == pytest.approx(-(load / 4e6 + load / 2e7) / 120e-6)
        assert found["stable"] is None and found["eigenvalues"] == []
    else:
        assert found["frequency"] == [] and len(found["values"]) == 4


def test_who_asks_for_a_picture_that_cannot_be_drawn_gets_an_error(tmp_path):
    assert "no eigenvalues" in run(f"campbell {DAMPER} --vary s=1:5:4 --out {tmp_path / 'c.png'}", 2).stderr


def test_an_oscillator_is_sent_to_the_commands_that_answer():
    said = run("linear duffing", 2).stderr
    assert "diagnose" in said and "bifurcation" in said and "film" not in said


def test_a_damper_without_a_closed_equilibrium_says_why_none_is_found():
    line = "linear gear-psfd/machine --set j_p=0 --set j_g=0 --set centring=spring --set k_c=1e6N/m"
    assert "carries nothing at rest" in run(line, 2).stderr


def test_a_bracket_that_cannot_be_is_still_refused():
    assert "must" in run("linear machines/jeffcott-rig --threshold s=-1:0.05", 2).stderr


@pytest.mark.parametrize(("status", "code"), [("ok", 0), ("contact", 0), ("diverged", 0), ("unresolved", 1), ("sticks", 1)])
def test_a_run_that_could_not_go_on_ends_with_one(status, code, monkeypatch):
    whole = sweep_run.simulation_in_stretches

    def ended(*args, **options):
        work = whole(*args, **options).run()
        work.dataset["status"] = work.dataset["status"].copy(data=Status[status])
        work.run = lambda: work
        return work

    monkeypatch.setattr("whirlmap.cli.commands.simulate.simulation_in_stretches", ended)
    result = run("simulate duffing --periods 2 --quiet", code)
    assert ("not finished" in result.stderr) == bool(code)
