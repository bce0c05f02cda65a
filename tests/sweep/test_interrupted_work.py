"""Speeds, attractors and basins that Ctrl-C ends keep what is finished, say so, and can be written and drawn."""

import json

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

from whirlmap.cli.main import app
from whirlmap.integrate.loading import load
from whirlmap.options.computed import Settling
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status
from whirlmap.sweep.attractors import attractor_search
from whirlmap.sweep.attractors import attractors as found
from whirlmap.sweep.attractors.attractors import attractors
from whirlmap.sweep.attractors.basins import basins
from whirlmap.sweep.diagrams.diagram import bifurcation_diagram
from whirlmap.sweep.diagrams.in_batches import diagram_in_batches
from whirlmap.sweep.interruptible import batches
from whirlmap.sweep.speeds import safe_speeds as judged
from whirlmap.sweep.speeds.safe_speeds import safe_speeds

GRID = {"x": np.linspace(-2, 2, 10), "v": np.linspace(-2, 2, 12)}
SPEEDS = np.linspace(0.5, 2.0, 40)


def interrupt(monkeypatch, home, name, after=0):
    """Have a function raise at its call number ``after``."""
    real, calls = getattr(home, name), []

    def interrupted(*args, **options):
        calls.append(name)
        if len(calls) > after:
            raise KeyboardInterrupt
        return real(*args, **options)

    monkeypatch.setattr(home, name, interrupted)


def test_batches_grow_while_they_take_little_time(monkeypatch):
    now = [0.0]
    monkeypatch.setattr("whirlmap.sweep.interruptible.time.monotonic", lambda: now[0])
    sizes = []
    for part in batches(2000, first=10, most=500, seconds=5.0):
        sizes.append(part.stop - part.start)
        now[0] += 0.05 * sizes[-1]  # seconds for each point
    assert sizes == [10, 80, *([100] * 19), 10]


def test_whoever_iterates_may_stop_and_go_on():
    duffing, gamma = load("duffing"), np.linspace(0.2, 0.3, 10)
    options = {"settling": Settling(transient=20, most=4, keep=8), "lyapunov": 0}
    work = diagram_in_batches(duffing, "gamma", gamma, batch=4, **options)
    assert work.dataset is None and not work.complete
    assert next(iter(work)) == 4 and (work.done, work.total) == (4, 10)
    assert work.dataset.attrs["incomplete"] == "interrupted after 4 of 10 points"
    assert list(work) == [8, 10] and work.complete and "incomplete" not in work.dataset.attrs
    whole = bifurcation_diagram(duffing, "gamma", gamma, **options)
    np.testing.assert_array_equal(work.dataset["section"], whole["section"])


@pytest.mark.parametrize(
    ("stage", "left"), [("rounds_met", "before run-up and run-down"), ("refined_edges", "before the edges of the windows")]
)
def test_interrupted_speeds_keep_the_cold_starts(stage, left, monkeypatch):
    system = load("machines/jeffcott-rig")
    whole = safe_speeds(system, SPEEDS, 0.5, follow=False)
    real = judged.refined_edges

    def edges(*args, rounds=3, **options):
        if rounds and stage == "refined_edges":
            raise KeyboardInterrupt
        return real(*args, rounds=rounds, **options)

    monkeypatch.setattr(judged, "refined_edges", edges)
    if stage == "rounds_met":
        interrupt(monkeypatch, judged, stage)
    work = safe_speeds.parts(system, SPEEDS, 0.5, follow=stage == "rounds_met").run()
    ds = work.dataset
    assert not work.complete and ds.attrs["incomplete"].startswith(f"interrupted {left}") and not ds.attrs["followed"]
    np.testing.assert_array_equal(ds["verdict"], whole["verdict"])
    assert ds.sizes["window"] == whole.sizes["window"]
    assert (ds["window_start"].values >= whole["window_start"].values).all()  # no speed is called safe that was not judged
    assert np.isin(ds["window_end"], SPEEDS).all()


def test_speeds_interrupted_among_the_cold_starts_keep_those_that_are_finished(monkeypatch):
    monkeypatch.setattr(judged, "FIRST", 1)
    interrupt(monkeypatch, judged, "cold_motions", after=1)
    work = safe_speeds.parts(load("machines/jeffcott-rig"), SPEEDS, 1.9, workers=1).run()
    assert work.done == 8 and work.dataset.attrs["incomplete"] == "interrupted after 8 of 40 speeds"
    np.testing.assert_array_equal(work.dataset["s"], SPEEDS[:8])
    (window,) = json.loads(work.dataset.attrs["windows"])  # nobody knows what comes behind its last speed
    assert (window["below"], window["above"], window["end"]) == ("end of the range", "not judged", SPEEDS[7])


def test_basins_interrupted_while_starts_settle_keep_those_that_have(monkeypatch):
    monkeypatch.setattr(attractor_search, "FIRST", 4)
    interrupt(monkeypatch, attractor_search, "settle_and_record", after=1)
    work = basins.parts(load("duffing", gamma=0.2), GRID, workers=1).run()
    ds = work.dataset
    assert work.done == 32 and ds.attrs["incomplete"] == "interrupted after 32 of 120 starts"
    status = ds["start_status"].values.ravel()
    assert (status[:32] == Status.ok).all() and (status[32:] == Status.failed).all()
    assert int(ds["starts"].sum()) == 32 and int(ds["outcome_starts"].sum()) == 0  # none of them is undecided
    assert (ds["regime"] == Regime.periodic).all()


def test_starts_of_a_strange_attractor_that_nobody_has_labelled_yet_are_not_called_undecided(monkeypatch):
    interrupt(monkeypatch, attractor_search.Search, "_label")
    assert attractors.parts(load("duffing", gamma=0.5), starts=16, workers=1).run().dataset is None


def test_basins_interrupted_before_the_measurement_keep_attractors_and_shares(monkeypatch):
    system = load("duffing", gamma=0.2)
    whole = found.attractors(system, starts=64)
    interrupt(monkeypatch, found, "_evidence")
    work = attractors.parts(system, starts=64).run()
    ds = work.dataset
    assert ds.attrs["incomplete"] == "interrupted before the attractors were measured"
    np.testing.assert_array_equal(ds["attractor_of"], whole["attractor_of"])
    for name in ("regime", "period_T", "period_common", "starts", "share", "start_regime"):
        np.testing.assert_array_equal(ds[name], whole[name], err_msg=name)
    assert np.isnan(ds["lyapunov"]).all()


@pytest.mark.parametrize("command", ["attractors", "basins", "speeds"])
def test_commands_write_and_draw_what_was_kept(command, monkeypatch, tmp_path):
    words = {
        "attractors": ["duffing", "--set", "gamma=0.2", "--starts", "40"],
        "basins": ["duffing", "--set", "gamma=0.2", "--grid", "x=-2:2:8", "--grid", "v=-2:2:8"],
        "speeds": ["machines/jeffcott-rig", "--limit", "25 um", "--points", "20"],
    }[command]
    interrupt(monkeypatch, *((judged, "rounds_met") if command == "speeds" else (found, "_evidence")))
    place = tmp_path / "part"
    done = CliRunner().invoke(app, [command, *words, "--quiet", "--out", str(place)])
    assert done.exit_code == 130, done.output
    said = " ".join(done.stderr.split())
    assert "were kept in" in said and "the same command" in said and "incomplete: interrupted" in done.stdout
    assert "incomplete" in xr.load_dataset(place / f"{command}.nc").attrs
    assert (place / f"{command}.png").stat().st_size > 1000
