"""Ctrl-C: what was done is kept, readable, and the exit code is 130."""

import json
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import whirlmap
from whirlmap.cli.main import app
from whirlmap.integrate.ranges import Range

#: The program with progress lines that come often, and Ctrl-C as a terminal gives it.
PROGRAM = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
import whirlmap.cli.common.progress as progress
progress.EVERY = 0.0
from whirlmap.cli.main import run
run()
"""


def start(*words):
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def interrupt_at(process, words, number=signal.SIGINT):
    """Send a signal once a progress line contains some words; returns stdout and stderr."""
    seen = []
    for line in process.stderr:
        seen.append(line)
        if words in line:
            process.send_signal(number)
            break
    rest = process.communicate(timeout=120)
    return rest[0], "".join(seen) + rest[1]


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT between processes")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_diagram_keeps_the_points_that_were_finished(number, tmp_path):
    place = tmp_path / "part.nc"
    process = start(
        "bifurcation", "duffing", "--vary", "gamma=0.2:0.5:100000", "--workers", "1", "--json", "--out", place
    )  # fmt: skip
    stdout, stderr = interrupt_at(process, " points", number)
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
    assert ds.attrs["incomplete"] == f"interrupted in the values given, after {ds.sizes['design']} of 4000 designs"
    assert json.loads(stdout)["incomplete"] == ds.attrs["incomplete"]
    assert {f.suffix for f in place.iterdir()} == {".nc", ".png"}


#: What a command does that keeps something at the first Ctrl-C, and takes its time for it.
TWICE = """
import sys, time
from whirlmap.cli.common import interrupts
interrupts.begin()
if "early" in sys.argv:
    print("ready", flush=True)
    time.sleep(60)
interrupts.keep()
from whirlmap.results.files import replace_file
from pathlib import Path

def slowly(trial):
    trial.write_text("half of it")
    print("writing", flush=True)
    time.sleep(60)

try:
    print("ready", flush=True)
    time.sleep(60)
except KeyboardInterrupt:
    replace_file(Path(sys.argv[1]), slowly)
"""


def said_and_ended(words, numbers):
    """Send one signal at each line that a process prints; returns stderr and seconds to the end."""
    process = subprocess.Popen(
        [sys.executable, "-c", TWICE, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
    for number in numbers:
        process.stdout.readline()
        process.send_signal(number)
        begun = time.monotonic()
    stderr = process.communicate(timeout=30)[1]
    assert process.returncode == 130
    return stderr, time.monotonic() - begun


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT between processes")
@pytest.mark.parametrize(
    ("words", "numbers"),
    [([], "INT INT"), (["early"], "INT"), ([], "TERM INT"), ([], "INT TERM"), (["early"], "TERM")],
)
def test_a_second_ctrl_c_and_one_before_the_work_end_at_once(words, numbers, tmp_path):
    signals = [signal.Signals[f"SIG{name}"] for name in numbers.split()]
    stderr, seconds = said_and_ended([str(tmp_path / "there.txt"), *words], signals)
    assert seconds < 10 and "Traceback" not in stderr
    assert "interrupted, and ended at once: nothing was written" in stderr
    assert list(tmp_path.iterdir()) == []  # not even half of it


@pytest.mark.parametrize("stage", ["pass_by", "advance"])
def test_an_interrupted_simulation_says_what_is_missing(stage, tmp_path, monkeypatch):
    from whirlmap.analysis.simulation.time_series import Series

    real, calls = getattr(Series, stage), []

    def interrupted(series, *periods):
        calls.append(stage)
        if len(calls) > 1:
            raise KeyboardInterrupt
        real(series, *periods)

    monkeypatch.setattr(Series, stage, interrupted)
    words = ["simulate", "duffing", "--transient", "40", "--periods", "64", "--quiet", "--out", str(tmp_path / "run")]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 130, done.output
    said = " ".join(done.stderr.split())
    ds = xr.load_dataset(tmp_path / "run" / "simulate.nc")
    passed, recorded = (16, 0) if stage == "pass_by" else (40, 4)
    assert ds["turn"][-1] == passed + recorded and ds.attrs["incomplete"] in said
    assert f"--transient {40 + recorded} --periods {64 - recorded}" in said
    monkeypatch.undo()
    whole = whirlmap.simulate(whirlmap.load("duffing"), periods=20, transient=passed)
    np.testing.assert_array_equal(ds["x"], whole["x"][: ds.sizes["time"]])


def test_an_interrupted_diagram_says_how_to_get_the_rest(tmp_path, monkeypatch):
    from whirlmap.sweep.diagrams import in_batches as run

    real, calls = run.bifurcation_diagram, []

    def interrupted(*args, **options):
        calls.append(args)
        if len(calls) > 1:
            raise KeyboardInterrupt
        return real(*args, **options)

    monkeypatch.setattr(run, "bifurcation_diagram", interrupted)
    words = ["bifurcation", "duffing", "--vary", "gamma=0.2:0.3:40", "--workers", "1", "--quiet"]
    done = CliRunner().invoke(app, [*words, "--out", str(tmp_path / "a.nc")])
    assert done.exit_code == 130 and f"were kept in {tmp_path / 'a.nc'}" in " ".join(done.stderr.split())
    rest = Range.parse(re.search(r"--vary (\S+),", done.stderr)[1])
    np.testing.assert_allclose(rest.values, np.linspace(0.2, 0.3, 40)[32:], rtol=1e-15)


def test_an_interrupted_map_without_a_store_keeps_its_chunks_in_out(tmp_path, monkeypatch):
    from whirlmap.sweep.maps import run_sweep as stored

    real, calls = stored._take, []

    def interrupted(*args):
        real(*args)
        calls.append(args)
        if len(calls) == 2:
            raise KeyboardInterrupt

    monkeypatch.setattr(stored, "_take", interrupted)
    words = ["map", "duffing", "--vary", "gamma=0.2:0.5:4", "--vary", "omega=1:1.3:3", "--chunk", "3", "--workers", "1"]
    done = CliRunner().invoke(app, [*words, "--quiet", "--out", str(tmp_path / "part")])
    assert done.exit_code == 130, done.output
    ds = xr.load_dataset(tmp_path / "part" / "map.nc")
    points = int((ds["evaluation"] > 0).sum())
    assert 0 < points < 12 and ds.attrs["incomplete"] == f"interrupted after {points} of 12 points"
    assert "were kept in" in done.stderr and (tmp_path / "part" / "map.png").is_file()


def test_an_interrupted_reproduction_keeps_the_data_that_are_finished(tmp_path, monkeypatch):
    from whirlmap.studies.gear_psfd.reproduction import edition_data

    def diagnosed(*_args, **_options):
        raise KeyboardInterrupt

    made = whirlmap.bifurcation_diagram(whirlmap.load("gear-psfd/machine"), "s", [0.2, 0.3])
    monkeypatch.setattr(edition_data, "bifurcation_diagram", lambda *_a, **_o: made)
    monkeypatch.setattr(edition_data, "diagnose", diagnosed)
    monkeypatch.setattr(edition_data, "speeds", lambda _quality: np.array([0.8, 1.2]))
    words = ["reproduce", "--case", "gear-psfd/machine", "--workers", "1", "--quiet", "--out", str(tmp_path / "r")]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 130, (done.output, done.exception)
    assert "diagram-machine-psi0.001.nc" in done.stderr and len(list((tmp_path / "r").glob("diagram-*.nc"))) == 4


def test_what_was_written_before_an_interrupt_is_said(tmp_path, monkeypatch):
    def interrupted(_files):
        raise KeyboardInterrupt

    monkeypatch.setattr("whirlmap.cli.common.report.print_written", interrupted)
    place = tmp_path / "there.nc"
    done = CliRunner().invoke(app, ["simulate", "duffing", "--periods", "2", "--quiet", "--out", str(place)])
    assert done.exit_code == 130 and place.is_file()
    assert f"interrupted after writing {place}" in done.stderr.replace("\n", "")
    again = CliRunner().invoke(app, ["simulate", "duffing", "--periods", "2", "--quiet"])
    assert again.exit_code == 130 and "nothing was written" in again.stderr
