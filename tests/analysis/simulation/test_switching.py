"""Where models change form: crossings of declared surfaces in a time series."""

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp

import whirlmap
from whirlmap.analysis.simulation.surface_crossings import surface_crossings
from whirlmap.equations import Model, Parameter, State, Switching, cos, t
from whirlmap.errors import RangeError
from whirlmap.integrate.system import System
from whirlmap.models import family


def series(system, start, time):
    made = solve_ivp(system.reference_rhs, (time[0], time[-1]), start, t_eval=time, method="DOP853", rtol=1e-12, atol=1e-13)
    names = [s.name for s in system.model.states]
    return xr.Dataset({"x": (("time", "state"), made.y.T)}, coords={"time": time, "state": names})


def backlash(**values):
    return System(family("gear_backlash").model(), {"zeta": 0.0, "F_m": 0.1, "F_ah": 0.0, "Omega": 1.0, **values})


def test_free_flight_across_the_gap_is_timed():
    """From the driving flank with speed -1: x = 1 - v t + F_m t^2/2 hits the back flank at the root of a quadratic."""
    start, v = 1.0 + 1e-9, 1.0
    time = np.linspace(0, 6, 1201)
    found = surface_crossings(backlash(), series(backlash(), [start, -v], time))
    hit = (v - np.sqrt(v**2 - 4 * 0.1)) / 0.1
    leaves, back = found["event_time"].values[:2]
    assert leaves == pytest.approx(0.0, abs=1e-8)
    assert back == pytest.approx(hit, abs=1e-7)
    assert [str(found["surface"].values[i]) for i in found["event_surface"].values[:2]] == ["drive_side", "back_side"]
    assert list(found["event_rising"].values[:2]) == [0, 1]


def test_contacts_are_timed_to_the_third_order():
    """The acceleration has a kink at the very crossing: the error stays below a constant times the cube of the distance."""
    system = backlash(F_ah=0.2, Omega=0.9, zeta=0.05)
    fine = surface_crossings(system, series(system, [0.3, -0.4], np.linspace(0, 20, 64001)))["event_time"].values
    assert fine.size == 3
    for n in (250, 500, 1000, 2000):
        coarse = surface_crossings(system, series(system, [0.3, -0.4], np.linspace(0, 20, n + 1)))["event_time"].values
        np.testing.assert_allclose(coarse, fine, rtol=0, atol=0.01 * (20 / n) ** 3 + 2e-10)


def test_shares_and_counts_add_up():
    system = backlash(F_ah=0.2, zeta=0.05)
    found = surface_crossings(system, series(system, [1.1, 0.0], np.linspace(0, 200, 20001)))
    height = found["height"].values
    np.testing.assert_allclose(found["share"].values, (height > 0).mean(axis=1), atol=2e-3)
    assert 0.05 < float(found["share"].sel(surface="drive_side")) < 0.95
    rising = found["event_rising"].values.astype(bool)
    assert found["count"].values.tolist() == [(rising & (found["event_surface"].values == k)).sum() for k in (0, 1)]
    assert np.all(np.diff(found["event_time"].values) >= 0)


def test_a_series_that_crosses_nothing():
    """A gear pair whose teeth stay together: film tables are not asked for anything."""
    system = whirlmap.load("machines/turbo-gearbox", backlash="dead_zone")
    x = np.zeros((5, system.model.dimension))
    data = xr.Dataset({"x": (("time", "state"), x)}, coords={"time": np.linspace(0, 0.01, 5), "state": list(system.states)})
    found = surface_crossings(system, data)
    assert found["event_time"].size == 0
    assert found["share"].values.tolist() == [1.0, 0.0]
    assert found["count"].values.tolist() == [0, 0]


def test_teeth_part_once_a_mesh_period_near_the_mesh_resonance():
    """The turbo gearbox at 3700 rpm, just above its mesh mode at 3450 rpm: the teeth part, and hit no back flank."""
    system = whirlmap.load("machines/turbo-gearbox", backlash="dead_zone", speed="3700 rpm")
    found = whirlmap.surface_crossings(system, whirlmap.simulate(system, periods=93, transient=30 * 93))
    assert 0.45 < float(found["share"].sel(surface="drive_side")) < 0.57
    assert found["count"].values.tolist() == [93, 0]  # once in each of the 93 mesh periods of a turn of the gear
    apart = np.diff(found["event_time"].values[found["event_rising"].values == 1])
    np.testing.assert_allclose(apart, system.period, rtol=0.05)


def test_a_surface_may_move_with_time():
    x, w = State("x", "1", "x"), Parameter("w", "1", "w")
    model = Model("m", (x,), (w,), {x: 0 * x + cos(w * t)}, harmonics=(w,),
                  switchings={"above": Switching(x - cos(w * t), "above")})  # fmt: skip
    time = np.linspace(0, 6, 601)
    data = xr.Dataset({"x": (("time", "state"), np.sin(time)[:, None])}, coords={"time": time, "state": ["x"]})
    found = surface_crossings(System(model, {"w": 1.0}), data)
    np.testing.assert_allclose(found["event_time"].values, [np.pi / 4, 5 * np.pi / 4], atol=1e-9)


def test_what_has_no_surface_says_so():
    duffing = whirlmap.load("duffing")
    with pytest.raises(RangeError, match="declares no discontinuity surface"):
        surface_crossings(duffing, xr.Dataset())
    other = xr.Dataset({"x": (("time", "state"), np.zeros((3, 1)))}, coords={"time": [0.0, 1, 2], "state": ["z"]})
    with pytest.raises(RangeError, match="other states"):
        surface_crossings(backlash(), other)
