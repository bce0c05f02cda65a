"""Answers are no errors, and runs that could not be finished are no answers: exit codes say which."""

import json

import pytest
from typer.testing import CliRunner

from whirlmap.cli.main import app
from whirlmap.results.status import Status
from whirlmap.sweep import run as sweep_run

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


def test_a_bracket_that_cannot_be_is_still_refused():
    assert "must" in run("linear machines/jeffcott-rig --threshold s=-1:0.05", 2).stderr


@pytest.mark.parametrize(("status", "code"), [("ok", 0), ("contact", 0), ("diverged", 0), ("unresolved", 1), ("sticks", 1)])
def test_a_run_that_could_not_go_on_ends_with_one(status, code, monkeypatch):
    whole = sweep_run.simulation_in_stretches

    def ended(*args, **options):
        work = whole(*args, **options)
        work.dataset["status"] = work.dataset["status"].copy(data=Status[status])
        return work

    monkeypatch.setattr(sweep_run, "simulation_in_stretches", ended)
    result = run("simulate duffing --periods 2 --quiet", code)
    assert ("not finished" in result.stderr) == bool(code)
