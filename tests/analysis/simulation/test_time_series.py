"""Time series and sections."""

import numpy as np
import pytest

import whirlmap
from whirlmap.errors import RangeError


def test_a_series_starts_at_the_start_and_keeps_time():
    system = whirlmap.load("duffing", start={"x": 0.5})
    ds = whirlmap.simulate(system, periods=3)
    assert float(ds["x"].sel(state="x")[0]) == 0.5
    np.testing.assert_allclose(ds["time"][-1], 3 * system.period, rtol=1e-14)
    assert ds.sizes["time"] == 301


def test_a_transient_is_a_shift():
    system = whirlmap.load("duffing")
    whole = whirlmap.simulate(system, periods=5)["x"].values
    rest = whirlmap.simulate(system, periods=2, transient=3)["x"].values
    np.testing.assert_array_equal(rest, whole[300:])


def test_roessler_cycle_of_the_chaosbook():
    """The one-loop cycle at c = 5.7 is unstable; at c = 2.5 it is stable and its crossings are one period apart."""
    ds = whirlmap.section(whirlmap.load("roessler", c=2.5), points=30, transient=400)
    times = ds["crossing_time"].values[0]
    gaps = np.diff(times[np.isfinite(times)])
    np.testing.assert_allclose(gaps, gaps[0], rtol=1e-7)  # fourth-order crossings of a settled cycle
    points = ds["section"].values[0]
    assert np.abs(points[np.isfinite(points[:, 0]), 0]).max() < 1e-12  # on the surface x = 0


def test_a_series_that_ends_is_nan_behind_its_end():
    ds = whirlmap.simulate(whirlmap.load("duffing", delta=-2.0, alpha=1.0, beta=0.0), periods=20)
    x = ds["x"].sel(state="x").values
    end = int(np.flatnonzero(np.isfinite(x))[-1])
    assert np.isnan(x[end + 1 :]).all()
    assert float(ds["time"][end]) <= float(ds["end_time"]) <= float(ds["time"][end + 1]) + 1e-9


@pytest.mark.parametrize(
    ("options", "says"),
    [({"periods": 0}, "periods"), ({"every": 7, "periods": 20}, "does not divide"), ({"steps": 0}, "steps per T")],
)
def test_impossible_counts_are_refused(options, says):
    with pytest.raises(RangeError, match=says):
        whirlmap.simulate(whirlmap.load("duffing"), **options)


def test_a_series_says_where_the_accuracy_is_not_met():
    """An oscillator too fast for the ladder of steps, alone and in stretches; one that is not says nothing."""
    from whirlmap.sweep.diagrams.runs_in_parts import simulation_in_stretches

    fast = whirlmap.load("duffing", alpha=1e9)
    assert "stiff" in whirlmap.simulate(fast, periods=1).attrs["accuracy_not_met"]
    assert "stiff" in simulation_in_stretches(fast, periods=2).run().dataset.attrs["accuracy_not_met"]
    assert "accuracy_not_met" not in whirlmap.simulate(whirlmap.load("duffing"), periods=1).attrs
