"""Work in parts gives the numbers of work in one piece, and an interrupt keeps the parts that were done."""

from functools import partial

import numpy as np
import pytest
import xarray as xr

from whirlmap.analysis.simulation.ramp import ramp_of
from whirlmap.analysis.simulation.run_up import Running, run_up
from whirlmap.analysis.simulation.time_series import Series, simulate
from whirlmap.analysis.steady.settling import Settling
from whirlmap.errors import RangeError
from whirlmap.integrate.loading import load
from whirlmap.options.computed import INTEGRATION
from whirlmap.options.execution import EXECUTION
from whirlmap.sweep.diagrams import in_batches as run
from whirlmap.sweep.diagrams.diagram import bifurcation_diagram
from whirlmap.sweep.diagrams.in_batches import diagram_in_batches
from whirlmap.sweep.diagrams.runs_in_parts import run_up_in_windows, simulation_in_stretches

SETTLING = Settling(transient=30, most=8)
GAMMA = np.linspace(0.2, 0.4, 11)


def same(a, b):
    xr.testing.assert_identical(a.drop_attrs(), b.drop_attrs())
    for name in a.variables:
        assert {k: str(v) for k, v in a[name].attrs.items()} == {k: str(v) for k, v in b[name].attrs.items()}
    passing = ("date", "command")
    assert {k: v for k, v in a.attrs.items() if k not in passing} == {k: v for k, v in b.attrs.items() if k not in passing}


@pytest.mark.parametrize("follow", [None, "up", "down", "both"])
@pytest.mark.parametrize("batch", [3, 4, 100])
def test_batches_change_nothing(follow, batch):
    duffing = load("duffing")
    work = diagram_in_batches(duffing, "gamma", GAMMA, follow=follow, settling=SETTLING, batch=batch).run()
    assert work.complete
    same(work.dataset, bifurcation_diagram(duffing, "gamma", GAMMA, follow=follow, settling=SETTLING))


@pytest.mark.parametrize("follow", [None, "up"])
def test_batches_of_an_unforced_system_differ_in_length_and_change_nothing(follow):
    lorenz = load("lorenz")
    rho = np.linspace(24.0, 28.0, 7)
    work = diagram_in_batches(lorenz, "rho", rho, follow=follow, settling=SETTLING, batch=3).run()
    same(work.dataset, bifurcation_diagram(lorenz, "rho", rho, follow=follow, settling=SETTLING))


def interrupted_after(monkeypatch, name, count):
    """Have the part with this number raise KeyboardInterrupt."""
    whole, calls = getattr(run, name), []

    def part(*args, **more):
        calls.append(1)
        if len(calls) > count:
            raise KeyboardInterrupt
        return whole(*args, **more)

    monkeypatch.setattr(run, name, part)


@pytest.mark.parametrize(("follow", "kept"), [(None, slice(0, 6)), ("up", slice(0, 6)), ("down", slice(5, 11))])
def test_an_interrupt_keeps_the_batches_that_were_done(monkeypatch, follow, kept):
    duffing = load("duffing")
    whole = bifurcation_diagram(duffing, "gamma", GAMMA, follow=follow, settling=SETTLING)
    interrupted_after(monkeypatch, "bifurcation_diagram", 2)
    work = diagram_in_batches(duffing, "gamma", GAMMA, follow=follow, settling=SETTLING, batch=3).run()
    assert (work.done, work.total, work.complete) == (6, 11, False)
    assert work.dataset.attrs["incomplete"] == "interrupted after 6 of 11 points"
    xr.testing.assert_identical(work.dataset.drop_attrs(), whole.isel(gamma=kept).drop_attrs())


def test_an_interrupt_on_the_way_down_keeps_the_way_up(monkeypatch):
    duffing = load("duffing")
    interrupted_after(monkeypatch, "bifurcation_diagram", 5)
    work = diagram_in_batches(duffing, "gamma", GAMMA, follow="both", settling=SETTLING, batch=3).run()
    ds = work.dataset
    assert (work.done, work.total) == (14, 22) and ds.sizes["gamma"] == 11
    assert (ds["status"].sel(direction="up") == 0).all()
    assert ds["status"].sel(direction="down").values.tolist() == [4] * 8 + [0] * 3
    assert ds["status"].dtype == np.int8 and "flag_meanings" in ds["status"].attrs
    assert np.isnan(ds["section"].sel(direction="down")[:8]).all()


def test_a_diagram_of_some_hundred_points_is_more_than_one_batch():
    """Else an interrupt loses it all."""
    done = []
    diagram_in_batches(
        load("duffing", gamma=0.2), "omega", np.linspace(1.3, 1.4, 300), settling=SETTLING, steps=16, workers=1,
    ).run(lambda now, total: done.append((now, total)))  # fmt: skip
    assert len(done) > 1 and done[-1] == (300, 300)


def test_an_interrupt_before_the_first_batch_leaves_nothing(monkeypatch):
    interrupted_after(monkeypatch, "bifurcation_diagram", 0)
    assert diagram_in_batches(load("duffing"), "gamma", GAMMA, settling=SETTLING).run().dataset is None


@pytest.mark.parametrize(("periods", "transient", "every"), [(37, 3, 5), (5, 0, 1), (1, 0, 100)])
def test_stretches_change_nothing(periods, transient, every):
    options = {"periods": periods, "transient": transient, "every": every}
    for name in ("duffing", "lorenz"):
        system = load(name)
        work = simulation_in_stretches(system, **options).run()
        assert work.complete
        same(work.dataset, simulate(system, **options))


def test_stretches_of_a_run_that_ends_early_are_filled_with_nan():
    """A hardening spring turned soft lets x escape."""
    system = load("duffing", beta=-1.0, alpha=1.0, start={"x": 0.9})
    whole = simulate(system, periods=40)
    work = simulation_in_stretches(system, periods=40).run()
    assert int(whole["status"]) == 2
    np.testing.assert_array_equal(work.dataset["x"], whole["x"])
    np.testing.assert_array_equal(work.dataset["time"], whole["time"])
    assert float(work.dataset["end_time"]) == pytest.approx(float(whole["end_time"]), rel=1e-12)
    assert int(work.dataset["status"]) == 2


def test_an_interrupted_simulation_keeps_its_stretches(monkeypatch):
    system = load("duffing")
    whole = simulate(system, periods=32)
    advance, calls = Series.advance, []

    def interrupted(series):
        calls.append(series)
        if len(calls) == 4:
            raise KeyboardInterrupt
        advance(series)

    monkeypatch.setattr(Series, "advance", interrupted)
    work = simulation_in_stretches(system, periods=32).run()
    assert work.done == 6 and work.dataset.attrs["incomplete"] == "interrupted after 6 of 32 T"
    np.testing.assert_array_equal(work.dataset["x"], whole["x"][: 6 * 100 + 1])


def test_an_interrupted_run_up_keeps_its_windows(monkeypatch):
    system = load("duffing", gamma=0.05)
    whole = run_up(system, "omega", 0.5, 0.7, time=3000.0, windows=12)
    new = partial(Running, system, ramp_of(system, "omega", 0.5, 0.7, 3000.0), 0, 12, INTEGRATION, EXECUTION)
    same(run_up_in_windows(new()).run().dataset, whole)
    summed, calls = Running._summed, []

    def interrupted(running, *arguments):
        calls.append(running)
        if len(calls) == 6:
            raise KeyboardInterrupt
        return summed(running, *arguments)

    monkeypatch.setattr(Running, "_summed", interrupted)
    work = run_up_in_windows(new()).run()
    assert work.done == 5 and work.dataset.attrs["incomplete"] == "interrupted after 5 of 12 windows"
    for name in ("minimum", "clock_amplitude", "spectrum"):
        np.testing.assert_array_equal(work.dataset[name][:5], whole[name][:5])
        assert np.isnan(work.dataset[name][5:]).all()
    np.testing.assert_array_equal(work.dataset["omega"], whole["omega"])


def test_what_cannot_fit_into_memory_is_refused(monkeypatch):
    monkeypatch.setattr("whirlmap.results.memory.memory", lambda: 2**30)
    with pytest.raises(RangeError, match=r"4\.\d+ GB, expected at most 0\.5 GB"):
        simulation_in_stretches(load("duffing"), periods=1_000_000).run()
    with pytest.raises(RangeError, match="memory"):
        diagram_in_batches(load("duffing"), "gamma", GAMMA, settling=Settling(keep=10_000_000)).run()
