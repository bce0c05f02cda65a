"""`simulate --vary`: what it prints and writes, and what it refuses."""

import json

import pytest
import xarray as xr
from typer.testing import CliRunner

from whirlmap.cli.main import app

RUN = ["simulate", "duffing", "--vary", "omega=1:1.4", "--time", "4000", "--quiet"]


def called(*words):
    return CliRunner().invoke(app, list(words))


def test_a_run_is_printed_and_written_over_its_diagram(tmp_path):
    diagram, out = tmp_path / "diagram.nc", tmp_path / "run"
    made = called("bifurcation", "duffing", "--vary", "omega=1:1.4:5", "--quiet", "--out", str(diagram))
    assert made.exit_code == 0, made.output
    found = called(*RUN, "--json", "--diagram", str(diagram), "--out", str(out))
    assert found.exit_code == 0, found.output
    facts = json.loads(found.stdout)
    assert facts["status"] == "ok" and facts["varied"] == "omega" and facts["largest"] > 0
    assert sorted(p.suffix for p in out.iterdir()) == [".nc", ".png"]
    ds = xr.load_dataset(next(p for p in out.iterdir() if p.suffix == ".nc"))
    assert ds["spectrum"].dims == ("omega", "phase_order", "quantity")
    assert "forcing, amplitude" in called(*RUN).output


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--vary", "omega=1", "--time", "9"], "name=begin:end"),
        (["--vary", "omega=1:2"], "--time"),
        (["--time", "20"], "--vary"),
        ([*RUN[2:], "--periods", "5"], "--periods"),
        ([*RUN[2:], "--diagram", "nothing.nc"], "nothing.nc"),
    ],
)
def test_wrong_words_are_refused(words, said):
    found = called("simulate", "duffing", *words)
    assert found.exit_code == 2 and said in found.output
