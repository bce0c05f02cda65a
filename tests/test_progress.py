"""Progress: its estimate of the time left, where it is shown, and what public functions take."""

import re
import sys

import numpy as np
import pytest

import whirlmap
from whirlmap import progress as shown
from whirlmap.forecast import Forecast
from whirlmap.kernels import cache
from whirlmap.progress import Progress

#: T and seconds of a T of points that return, and of those that do not.
SETTLES, RUNS, COST, COSTLY = 120.0, 9000.0, 1e-4, 3e-4


def work(opened, points=600, batch=60, runs=RUNS):
    """Seconds spent and said to be left, of work in batches; a batch says which of its points do not return."""
    forecast, spent, seen = Forecast(points, 108.0), 0.0, []

    def spend(periods, cost):
        nonlocal spent
        forecast.spend(periods, periods * cost)
        spent += periods * cost
        seen.append((spent, forecast.seconds_left()))

    for first in range(0, points, batch):
        here = int(opened[first : first + batch].sum())
        forecast.come(batch)
        for _ in range(4):
            spend(batch * SETTLES / 4, COST)
        forecast.settle(batch, here, 16384.0)
        ran, stretch = 0.0, 256.0
        while here and ran < runs:
            stretch = min(stretch, runs - ran)
            spend(here * stretch, COSTLY)
            ran += stretch
            forecast.run(here, ran)
            stretch = ran
        if here:
            forecast.close(here)
    return np.array(seen)


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 1.0])
@pytest.mark.parametrize("runs", [4000.0, RUNS, 16384.0])
def test_the_time_left_is_within_a_factor_of_three_after_a_tenth_of_the_work(share, runs):
    opened = np.random.default_rng(5).uniform(size=600) < share
    seen = work(opened, runs=runs)
    spent, left = seen.T
    true = spent[-1] - spent
    later = (spent > 0.1 * spent[-1]) & (spent < 0.95 * spent[-1])
    ratio = left[later] / true[later]
    assert ratio.min() > 1 / 3 and ratio.max() < 3


def test_points_that_do_not_return_far_behind_are_foreseen_once_one_is_met():
    opened = np.zeros(600, dtype=bool)
    opened[60::2] = True
    before, after = (left[1] for left in (work(opened)[3], work(opened)[9]))
    assert after > 30 * before


def test_a_first_batch_that_takes_longer_than_expected_says_so_of_those_behind_it():
    """Nine batches of 20 points; each point takes thirteen times the T that it takes at least."""
    forecast, shares = Forecast(180, 108.0), []
    for batch in range(9):
        forecast.come(20)
        for step in range(1, 14):
            forecast.spend(20 * 108.0, 20 * 108.0 * COST)
            spent = (13 * batch + step) / (13 * 9)
            total = 20 * 108.0 * COST * (13 * batch + step)
            shares.append((spent, total / (total + forecast.seconds_left())))
        forecast.settle(20, 0, 16384.0)
    true, said = np.array(shares).T
    assert np.all(said[true < 0.15] < 0.25) and np.all(np.abs(said - true)[13:] < 0.1)


def test_a_forecast_never_says_that_all_is_done_before_it_is(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(shown.time, "monotonic", lambda: now[0])
    with Progress("work", 1000, points=10, quiet=True) as bar:
        for _ in range(50):  # five times as long as expected
            now[0] += 1.0
            bar(100)
            assert "100 %" not in bar.line(now[0]) and not bar.line(now[0]).endswith(" 0:00 left")


def test_work_beyond_the_number_expected_has_no_known_end(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(shown.time, "monotonic", lambda: now[0])
    with Progress("work", 1000, most=True, quiet=True) as bar:
        for part in range(1, 20):
            now[0] += 1.0
            bar(100)
            said = bar.line(now[0])
            assert (f"{10 * part} % in" in said and "left" in said) if part < 10 else "%" not in said and "left" not in said


def test_compiling_is_said_and_counts_for_no_rate(monkeypatch, tmp_path):
    monkeypatch.setenv("WHIRLMAP_CACHE", str(tmp_path))
    now, seen = [0.0], []
    monkeypatch.setattr(shown.time, "monotonic", lambda: now[0])
    with Progress("work", 100, quiet=True) as bar:

        def make():
            seen.append(bar.compiling)
            now[0] += 50.0
            return b"machine code"

        cache.stored("kernel_test.o", make)
        now[0] += 1.0
        bar(50)
        assert seen == [1] and bar.compiling == 0
        assert bar.seconds_left(now[0]) == pytest.approx(1.0)


class Notebook:
    """What IPython does of a display with a name: it shows, and replaces what it has shown."""

    def __init__(self):
        self.shown = []

    def display(self, thing, *, display_id):
        assert display_id is True
        self.update(thing)
        return self

    def update(self, thing):
        self.shown.append(thing._repr_html_())


@pytest.fixture
def notebook(monkeypatch):
    made = Notebook()
    monkeypatch.setitem(sys.modules, "IPython", sys)
    monkeypatch.setitem(sys.modules, "IPython.display", made)
    monkeypatch.setattr("rich.console._is_jupyter", lambda: True)
    monkeypatch.setattr("whirlmap.notebook_bar.DRAWN", 0.0)
    monkeypatch.setattr(shown, "DRAWN", 0.0)
    return made


def test_a_notebook_gets_a_bar_that_needs_no_widgets(notebook, recwarn):
    with Progress("a <map>", 100) as bar:
        bar(25)
        bar(50)
    first, quarter, three_quarters, *rest = notebook.shown
    assert first.startswith("<div>a &lt;map&gt; <progress ")
    assert 'value="0.2500"' in quarter and "25 %" in quarter and "T/s" in quarter and "left " in quarter
    assert 'value="0.7500"' in three_quarters and "75 %" in three_quarters
    assert rest[-1] == ""  # it is gone
    assert not recwarn.list


def test_a_bar_whose_end_nobody_knows_has_no_value(notebook):
    with Progress("search", None) as bar:
        bar(25)
        assert " value=" not in notebook.shown[-1] and "%" not in notebook.shown[-1]


def test_a_bar_of_a_command_shows_in_a_notebook_too(notebook):
    whirlmap.bifurcation_diagram(whirlmap.load("duffing"), "gamma", [0.2, 0.25], lyapunov=0, progress=True)
    assert len(notebook.shown) > 2 and notebook.shown[-1] == ""
    assert any("<progress" in html for html in notebook.shown)


def test_no_notebook_and_no_terminal_gets_no_bar(monkeypatch):
    monkeypatch.setitem(sys.modules, "IPython", sys)
    monkeypatch.setattr("rich.console._is_jupyter", lambda: False)
    assert shown._bar(most=False) is None


def test_a_terminal_gets_a_bar_with_the_time_left(monkeypatch):
    import io

    class Terminal(io.StringIO):
        def isatty(self):
            return True

    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setattr(shown, "DRAWN", 0.0)
    monkeypatch.setenv("TERM", "xterm")
    with Progress("work", 100) as bar:
        bar(50)
        with shown.compiling():
            bar._bar.refresh()
    assert "work: compiling kernels" in screen.getvalue() and "left" in screen.getvalue()


S = np.linspace(0.5, 1.0, 4)
LONG = {
    "simulate": lambda p: whirlmap.simulate(whirlmap.load("duffing"), periods=40, transient=20, progress=p),
    "section": lambda p: whirlmap.section(whirlmap.load("duffing"), points=20, progress=p),
    "bifurcation": lambda p: whirlmap.bifurcation_diagram(whirlmap.load("duffing"), "gamma", [0.2, 0.3], progress=p),
    "map": lambda p: whirlmap.regime_map(whirlmap.load("duffing"), {"gamma": [0.2, 0.3]}, chunk=1, progress=p),
    "draws": lambda p: whirlmap.tolerance_sweep(whirlmap.load("duffing"), {"gamma": "normal:1%"}, 2, progress=p),
    "points": lambda p: whirlmap.label_points(whirlmap.load("duffing"), {"gamma": [0.2, 0.3]}, progress=p),
    "attractors": lambda p: whirlmap.attractors(whirlmap.load("duffing", gamma=0.2), starts=8, progress=p),
    "basins": lambda p: whirlmap.basins(whirlmap.load("duffing", gamma=0.2), {"x": [-1, 1], "v": [-1, 1]}, progress=p),
    "speeds": lambda p: whirlmap.safe_speeds(whirlmap.load("machines/jeffcott-rig"), S, 0.5, follow=False, progress=p),
    "exponents": lambda p: whirlmap.lyapunov_spectrum(
        whirlmap.load("duffing"), common_periods=320, transient=20, progress=p
    ),
    "diagnose": lambda p: whirlmap.diagnose(whirlmap.load("duffing", gamma=0.2), max_periods=64, progress=p),
    "waterfall": lambda p: whirlmap.waterfall(whirlmap.load("duffing"), "gamma", [0.2, 0.3], "x", progress=p),
}


@pytest.mark.parametrize("what", LONG)
def test_long_functions_take_true_or_a_callable(what, capsys, monkeypatch):
    monkeypatch.setattr(shown, "EVERY", 0.0)
    quiet = LONG[what](False)
    assert capsys.readouterr().err == ""
    drawn = LONG[what](True)
    assert re.match(rf"{what}: ", capsys.readouterr().err)
    counted = []
    LONG[what](counted.append)
    assert sum(counted) > 0 and capsys.readouterr().err == ""
    assert set(quiet.variables) == set(drawn.variables)
