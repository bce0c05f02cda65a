"""A simulation as CSV, read back by the diagnosis of recorded signals."""

import shlex

import numpy as np
import pytest
from typer.testing import CliRunner

import whirlmap
from whirlmap.cli.main import app
from whirlmap.errors import InputError
from whirlmap.results.signals import rate_of, read_column


def run(line):
    return CliRunner(env={"COLUMNS": "80"}).invoke(app, shlex.split(line))


def test_csv_comes_back_bit_for_bit_and_is_diagnosed_by_its_times(tmp_path):
    file = tmp_path / "x.csv"
    line = f"simulate duffing --set gamma=0.2 --transient 50 --periods 100 --steps 40 --out {file} --quiet"
    assert run(line).exit_code == 0
    ds = whirlmap.simulate(whirlmap.load("duffing", gamma=0.2), periods=100, transient=50, steps=40)
    np.testing.assert_array_equal(read_column(file, "x"), ds["x"].sel(state="x"))
    np.testing.assert_array_equal(read_column(file, "time"), ds["time"])
    assert file.read_text().startswith("# units: ")
    assert run(line).exit_code == 2  # it exists
    found = run(f"diagnose --series {file} --column x --json")
    assert found.exit_code == 0, found.stderr
    assert '"periodic"' in found.stdout


def test_uneven_times_are_refused(tmp_path):
    file = tmp_path / "x.csv"
    file.write_text("time,x\n0,1\n1,2\n3,4\n")
    with pytest.raises(InputError, match="equal steps"):
        rate_of(file)
