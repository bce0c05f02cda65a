"""Branches over a diagram and curves of bifurcations over a map: of files, and of the page's own."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import whirlmap
from whirlmap.errors import InputError
from whirlmap.explorer.branch_lines import lines
from whirlmap.explorer.encoding import decoded
from whirlmap.explorer.exploration import Exploration, of_result
from whirlmap.explorer.follow_branches import follow_branches
from whirlmap.explorer.jobs import Job
from whirlmap.explorer.page_data import page_data
from whirlmap.explorer.with_branches import lay_over, with_branches

VARY = {"gamma": (0.2, 0.3), "omega": (1.18, 1.22)}


@pytest.fixture(scope="module")
def regimes() -> Exploration:
    """A map over the first doubling of the cascade: left of the curve the motion returns after 1T, right of it after 2T."""
    axes = {"gamma": np.linspace(0.2, 0.3, 4), "omega": np.linspace(1.18, 1.22, 3)}
    return of_result(whirlmap.regime_map(whirlmap.load("duffing"), axes, lyapunov=0).load(), "map")


@pytest.fixture(scope="module")
def curve() -> xr.Dataset:
    return whirlmap.event_curve(whirlmap.load("duffing"), VARY, "period-doubling", longest=0.2)


def _sides(found: dict) -> Iterator[tuple[float, float]]:
    yield from zip(decoded(found["values"]["gamma"]), decoded(found["values"]["omega"]), strict=True)


def test_a_curve_parts_motions_of_one_period_from_those_of_two(curve: xr.Dataset, regimes: Exploration) -> None:
    (found,) = page_data(lay_over(regimes, {"curve": curve}))["branches"]
    assert found["kind"] == "period-doubling"
    gamma, omega = min(_sides(found), key=lambda at: abs(at[1] - 1.2))
    system = whirlmap.load("duffing", omega=omega)
    near = whirlmap.label_points(system, {"gamma": [0.98 * gamma, 1.02 * gamma]}, lyapunov=0)
    assert near["period_T"].values.tolist() == [1, 2]


def test_a_page_of_a_notebook_holds_the_curve(curve: xr.Dataset, regimes: Exploration) -> None:
    page = whirlmap.explore(regimes.overview, branches=[curve])
    assert len(page.html) > len(whirlmap.explore(regimes.overview).html)
    with pytest.raises(InputError, match=r"^branches\[1\]: found no branches"):
        whirlmap.explore(regimes.overview, branches=[curve, regimes.overview])


def test_the_page_follows_the_same_curve(curve: xr.Dataset, regimes: Exploration) -> None:
    job = Job(1)
    follow_branches(job, regimes, {"gamma": 0.2, "omega": 1.2}, None)
    (found,) = job.result
    want = lines(regimes, curve)
    for name in VARY:
        assert decoded(found["values"][name]).min() == pytest.approx(decoded(want["values"][name]).min(), rel=1e-6)
        assert decoded(found["values"][name]).max() == pytest.approx(decoded(want["values"][name]).max(), rel=1e-6)


def test_a_branch_that_meets_nothing_says_so(regimes: Exploration) -> None:
    with pytest.raises(whirlmap.errors.RangeError, match=r"along gamma and along omega, meet no fold, .* no curve begins"):
        follow_branches(Job(1), regimes, {"gamma": 0.2, "omega": 1.2, "delta": 1.5}, None)


@pytest.mark.slow
def test_folds_that_the_first_axis_does_not_meet_are_found_along_the_second() -> None:
    """A hardening oscillator folds with its frequency, and its two folds meet in a cusp."""
    system = whirlmap.load("duffing", alpha=1.0, beta=0.04, delta=0.1, start={"x": 0.0, "v": 0.0})
    axes = {"gamma": np.linspace(0.1, 2, 2), "omega": np.linspace(0.9, 1.8, 2)}
    e, job = of_result(whirlmap.regime_map(system, axes, lyapunov=0).load(), "map"), Job(1)
    follow_branches(job, e, {"gamma": 1.5, "omega": 1.0}, None)
    (found,) = job.result
    assert found["kind"] == "fold"
    (cusp,) = found["events"]
    assert cusp["kind"] == "cusp"
    omega = 1 + 3**0.5 / 2 * 0.1  # where the averaged response, of first order in the damping, begins to fold
    assert cusp["values"]["omega"] == pytest.approx(omega, rel=0.01)
    assert cusp["values"]["gamma"] == pytest.approx((8 / 3**1.5 * (0.1 * omega) ** 3 / (0.75 * 0.04)) ** 0.5, rel=0.02)


def test_units_of_a_branch_become_those_of_the_diagram() -> None:
    system = whirlmap.load("machines/jeffcott-rig")
    ds = whirlmap.bifurcation_diagram(system, "c", ["80 um", "100 um"], lyapunov=0)
    branch = whirlmap.continue_orbit(system, "c", ["0.08 mm", "0.1 mm"], longest=1.0)
    found = lines(of_result(ds, "rig.nc"), branch)
    values = decoded(found["values"]["c"])
    assert (values.min(), values.max()) == (pytest.approx(80), pytest.approx(100))


def test_what_is_not_of_this_map_is_refused(curve: xr.Dataset, regimes: Exploration, tmp_path: Path) -> None:
    curve.to_netcdf(tmp_path / "curve.nc")
    assert len(with_branches(regimes, [tmp_path / "curve.nc"]).branches) == 1
    diagram = of_result(whirlmap.bifurcation_diagram(regimes.system, "gamma", [0.2, 0.3], lyapunov=0), "diagram")
    with pytest.raises(InputError, match=r"curve: found branches in gamma and omega, expected branches along gamma$"):
        lay_over(diagram, {"curve": curve})
    with pytest.raises(InputError, match=r"expected curves of bifurcations \(--event\) in gamma and omega"):
        lay_over(regimes, {"branch": whirlmap.continue_orbit(regimes.system, "gamma", (0.2, 0.22), longest=1.0)})
    with pytest.raises(InputError, match=r"found no branches"):
        lay_over(regimes, {"map": regimes.overview})
    other = curve.assign_attrs(
        parameters=curve.attrs["parameters"].replace('"delta": {"value": 0.3', '"delta": {"value": 0.31')
    )
    assert other.attrs["parameters"] != curve.attrs["parameters"]
    with pytest.raises(InputError, match=r"delta differ from the values of duffing"):
        lay_over(regimes, {"curve": other})
