"""Labels of operating points: known answers, and the same bits in any company."""

import numpy as np
import pytest
import xarray as xr

import whirlmap
from whirlmap.analysis.labels.labelling import measure
from whirlmap.analysis.steady.settling import Settling
from whirlmap.errors import RangeError
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status
from whirlmap.sweep.diagrams.diagram import bifurcation_diagram
from whirlmap.sweep.points import label_points as of_points
from whirlmap.sweep.points.label_points import label_points

SHORT = Settling(transient=60, most=16, keep=16)


def plane(n: int) -> dict[str, np.ndarray]:
    """Points of Duffing's plane where periods, chaos and slow contraction stand side by side."""
    rng = np.random.default_rng(5)
    return {"gamma": rng.uniform(0.2, 0.65, n), "omega": rng.uniform(1.0, 1.4, n)}


@pytest.fixture(scope="module")
def duffing():
    return whirlmap.load("duffing")


@pytest.fixture(scope="module")
def whole(duffing):
    ds = label_points(duffing, plane(97), settling=SHORT)
    regimes = ds["regime"].values
    assert {Regime.periodic, Regime.chaotic} <= set(regimes), np.bincount(regimes)
    assert np.unique(ds["steps"]).size > 1 and (ds["settled_after"] > 60 + 2 * 16).any()
    return ds


def same(a: xr.Dataset, b: xr.Dataset, what: str) -> None:
    assert set(a.variables) == set(b.variables)
    for name in a.variables:
        np.testing.assert_array_equal(a[name].values, b[name].values, err_msg=f"{what}: {name}")


def test_the_ladder_of_duffing_as_points(duffing):
    gamma = np.array([0.20, 0.28, 0.29, 0.37, 0.50, 0.65])
    ds = label_points(duffing, {"gamma": gamma, "omega": np.full(6, 1.2)}, settling=Settling(transient=200), lyapunov=400)
    assert ds["period_T"].values.tolist() == [1, 2, 4, 5, 0, 2]
    assert ds["regime"].values.tolist() == [Regime.periodic] * 4 + [Regime.chaotic, Regime.periodic]
    diagram = bifurcation_diagram(duffing, "gamma", gamma, settling=Settling(transient=200), lyapunov=400)
    for name in ("regime", "lyapunov", "maximum", "rms", "steps", "confidence"):
        np.testing.assert_array_equal(ds[name].values, diagram[name].values, err_msg=name)


@pytest.mark.parametrize("chunk", [1, 7, 64])
def test_the_same_bits_in_chunks_of_any_size(duffing, whole, chunk):
    rng = np.random.default_rng(chunk)
    order = rng.permutation(97)[: 3 * chunk] if chunk < 64 else rng.permutation(97)
    columns = plane(97)
    for first in range(0, order.size, chunk):
        these = order[first : first + chunk]
        part = label_points(duffing, {n: c[these] for n, c in columns.items()}, settling=SHORT, workers=1 + first % 2)
        same(part, whole.isel(point=these), f"points {these}")


def test_many_points_are_worked_through_in_batches(duffing, whole, monkeypatch):
    sizes = []

    def watched(system, columns, *rest, **more):
        sizes.append(columns["gamma"].size)
        return measure(system, columns, *rest, **more)

    monkeypatch.setattr(of_points, "measure", watched)
    monkeypatch.setattr(of_points, "POOL", 2)
    ds = label_points(duffing, plane(97), settling=SHORT, workers=1)
    assert sizes == [32, 32, 32, 1]
    same(ds, whole, "batches of 32 points")
    assert ds["regime"].attrs.keys() == whole["regime"].attrs.keys()
    changing = {"date", "command"}
    assert {k: v for k, v in ds.attrs.items() if k not in changing} == {
        k: v for k, v in whole.attrs.items() if k not in changing
    }


def test_the_slowly_contracting_in_any_company(duffing, whole):
    """The time given to a point that contracts must not follow from its neighbours."""
    late = np.flatnonzero(whole["settled_after"] > 60 + 2 * 16)[:6]
    for k in late:
        alone = label_points(duffing, {n: c[k : k + 1] for n, c in plane(97).items()}, settling=SHORT)
        same(alone, whole.isel(point=[k]), f"point {k}")


def test_unforced_points_in_any_company():
    """Roessler's turns differ in number from point to point."""
    system = whirlmap.load("roessler")
    c = np.array([2.5, 3.3, 4.0, 5.7, 9.0])
    options = {"settling": Settling(transient=100, most=8), "lyapunov": 300}
    ds = label_points(system, {"c": c}, **options)
    assert {Regime.periodic, Regime.chaotic} <= set(ds["regime"].values)
    for k in range(c.size):
        same(label_points(system, {"c": c[k : k + 1]}, **options), ds.isel(point=[k]), f"c = {c[k]}")


def test_starts_are_taken(duffing):
    """Two wells: the start decides in which the oscillator stays."""
    starts = np.array([[1.0, -1.0], [0.0, 0.0]])
    ds = label_points(duffing, {"gamma": np.full(2, 0.1)}, starts=starts, settling=SHORT)
    assert np.sign(ds["mean"].sel(quantity="x").values).tolist() == [1, -1]
    assert (ds["regime"] == Regime.periodic).all()


def test_bearings_and_their_films():
    system = whirlmap.load("gear-psfd/reference")
    ds = label_points(system, {"s": np.array([0.5, 2.0])}, settling=Settling(transient=20, most=4, keep=8), lyapunov=0)
    assert ds["bearing"].values.tolist() == ["1", "2"]
    ran = ds["status"].values == Status.ok
    assert ran.any()
    np.testing.assert_array_equal(ds["max_eccentricity"].values, ds["maximum"].sel(quantity=["eps_1", "eps_2"]).values)
    np.testing.assert_array_equal(ds["min_film"].values[ran], 1 - ds["max_eccentricity"].values[ran])
    assert "section" not in ds
    for name, values in ds.data_vars.items():
        assert values.attrs["units"] and values.attrs["long_name"], name


@pytest.mark.parametrize(
    ("values", "options", "says"),
    [({}, {}, "found no parameter"), ({"gama": [0.2]}, {}, "gamma"), ({"gamma": [0.2, np.nan]}, {}, "finite"),
     ({"gamma": [0.2], "omega": [1.0, 1.1]}, {}, "different numbers"), ({"gamma": []}, {}, "one or more"),
     ({"gamma": [0.2]}, {"lyapunov": 5}, "lyapunov must be 0"), ({"gamma": [0.2]}, {"starts": np.zeros((2, 3))}, "shape")],
)  # fmt: skip
def test_bad_points_are_refused(duffing, values, options, says):
    with pytest.raises(RangeError, match=says):
        label_points(duffing, values, **options)


def test_unforced_motion_that_contracts_comes_to_rest():
    """Lorenz' equations spiral into a fixed point, the slower the nearer rho is to 24.74; at 28 they are chaotic."""
    brief = Settling(transient=20, most=8, keep=8)
    ds = label_points(whirlmap.load("lorenz"), {"rho": [15.0, 20.0, 23.0, 28.0]}, settling=brief)
    assert (ds["lyapunov"].values[1:3] < 0).all() and ds["lyapunov"].values[3] > 0  # the first rests at once
    waited = ds["settled_after"].values
    assert [Regime(r).label for r in ds["regime"].values[:3]] == ["at-rest"] * 3
    assert (ds["step_verdict"].values == 0).all()
    assert waited[3] < 60  # the plain time: 20, windows of 8 and 16, and some turns that are timed
