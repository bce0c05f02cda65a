"""The waterfall: forced lines stand at their orders at every speed."""

import json

import numpy as np
import pytest

import whirlmap
from whirlmap.errors import RangeError
from whirlmap.sweep.diagrams.waterfall import waterfall


def test_forced_lines_follow_the_forcing():
    """A linear oscillator answers at the forcing alone, with the amplitude of its frequency response."""
    system = whirlmap.load("duffing", alpha=1.0, beta=0.0, delta=0.3, gamma=0.5)
    omega = np.linspace(0.6, 2.0, 8)
    ds = waterfall(system, "omega", omega, "x")
    strongest = ds["frequency"].values[np.argmax(ds["power"].values, axis=0)]
    np.testing.assert_allclose(strongest, 1.0)
    amplitude = 0.5 / np.hypot(1 - omega**2, 0.3 * omega)
    np.testing.assert_allclose(np.sqrt(2 * ds["power"].max("frequency")), amplitude, rtol=1e-4)  # RK4 at 100 steps
    assert json.loads(ds.attrs["clocks"]) == {"forcing": 1.0}


def test_points_that_end_have_no_spectrum():
    ds = waterfall(whirlmap.load("duffing", alpha=1.0, beta=0.0), "delta", [-2.0, 0.3], "x", transient=20)
    assert np.isnan(ds["power"].values[:, 0]).all()
    assert np.isfinite(ds["power"].values[:, 1]).all()


def test_an_unknown_state_names_the_nearest():
    with pytest.raises(RangeError, match=r"no state 'xx'\. Did you mean 'x'"):
        waterfall(whirlmap.load("duffing"), "omega", [1.0, 2.0], "xx")
