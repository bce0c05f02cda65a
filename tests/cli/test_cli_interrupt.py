"""Ctrl-C: what was done is kept, readable, and the exit code is 130."""

import json
import signal
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

from whirlmap.cli.main import app

#: The program with progress lines that come often, and Ctrl-C as a terminal gives it.
PROGRAM = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
import whirlmap.cli.progress as progress
progress.EVERY = 0.0
from whirlmap.cli.main import run
run()
"""


def start(*words):
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def interrupt_at(process, words):
    """Send SIGINT once a progress line contains some words; returns stdout and stderr."""
    seen = []
    for line in process.stderr:
        seen.append(line)
        if words in line:
            process.send_signal(signal.SIGINT)
            break
    rest = process.communicate(timeout=120)
    return rest[0], "".join(seen) + rest[1]


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT between processes")
def test_an_interrupted_diagram_keeps_the_points_that_were_finished(tmp_path):
    place = tmp_path / "part.nc"
    process = start(
        "bifurcation", "duffing", "--vary", "gamma=0.2:0.5:100000", "--workers", "1", "--json", "--out", place
    )  # fmt: skip
    stdout, stderr = interrupt_at(process, " points")
    assert process.returncode == 130, stderr
    assert "Traceback" not in stderr and "were kept" in stderr
    ds = xr.load_dataset(place)
    assert 32 <= ds.sizes["gamma"] < 100_000
    assert ds.attrs["incomplete"] == f"interrupted after {ds.sizes['gamma']} of 100000 points"
    np.testing.assert_array_equal(ds["gamma"], np.linspace(0.2, 0.5, 100_000)[: ds.sizes["gamma"]])
    content = json.loads(stdout)
    assert content["incomplete"] == ds.attrs["incomplete"] and content["files"] == [str(place)]
    assert [p.name for p in tmp_path.iterdir()] == ["part.nc"]


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT between processes")
def test_an_interrupted_diagnosis_writes_nothing(tmp_path):
    process = start("diagnose", "duffing", "--transient", "1000", "--out", str(tmp_path / "sheet"))
    stdout, stderr = interrupt_at(process, "diagnose: ")
    assert process.returncode == 130 and stdout == ""
    assert "Traceback" not in stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT between processes")
def test_an_interrupted_comparison_keeps_the_designs_that_were_finished(tmp_path):
    place = tmp_path / "part"
    process = start(
        "improve", "machines/jeffcott-rig", "--vary", "c=60um:140um:4000", "--points", "20", "--workers", "1", "--json",
        "--out", place,
    )  # fmt: skip
    stdout, stderr = interrupt_at(process, " designs")
    assert process.returncode == 130, stderr
    assert "Traceback" not in stderr and "were kept" in stderr
    ds = xr.load_dataset(place / "improve.nc")
    assert 1 <= ds.sizes["design"] < 4000 and (ds["followed"] == 0).all()
    assert ds.attrs["incomplete"] == f"interrupted in the values given, after {ds.sizes['design']} designs"
    assert json.loads(stdout)["incomplete"] == ds.attrs["incomplete"]
    assert {f.suffix for f in place.iterdir()} == {".nc", ".png"}


def test_what_was_written_before_an_interrupt_is_said(tmp_path, monkeypatch):
    def interrupted(_files):
        raise KeyboardInterrupt

    monkeypatch.setattr("whirlmap.cli.report.print_written", interrupted)
    place = tmp_path / "there.nc"
    done = CliRunner().invoke(app, ["simulate", "duffing", "--periods", "2", "--quiet", "--out", str(place)])
    assert done.exit_code == 130 and place.is_file()
    assert f"interrupted after writing {place}" in done.stderr.replace("\n", "")
    again = CliRunner().invoke(app, ["simulate", "duffing", "--periods", "2", "--quiet"])
    assert again.exit_code == 130 and "nothing was written" in again.stderr
