"""Random draws: the same whatever draws are made with them, distributed as asked, and kept in a store like any sweep."""

import numpy as np
import pytest
import xarray as xr

import whirlmap
from whirlmap.analysis.steady.settling import Settling
from whirlmap.errors import OutputError, RangeError
from whirlmap.sweep.maps.regime_map import tolerance_sweep
from whirlmap.sweep.parameters.random_draws import Tolerance, draws
from whirlmap.sweep.points.label_points import label_points
from whirlmap.sweep.store.zarr_store import differences

SHORT = Settling(transient=40, most=8, keep=8)
BOTH = {"gamma": Tolerance("normal", 0.3, 0.01), "omega": Tolerance("uniform", 1.1, 1.3)}


def test_a_draw_follows_from_seed_name_and_number_alone():
    whole = draws(BOTH, 7, 0, 1000)
    for first, count in ((0, 1), (17, 5), (999, 1), (256, 700)):
        part = draws(dict(reversed(BOTH.items())), 7, first, count)
        for name in BOTH:
            np.testing.assert_array_equal(part[name], whole[name][first : first + count])
    np.testing.assert_array_equal(draws({"omega": BOTH["omega"]}, 7, 0, 1000)["omega"], whole["omega"])
    assert (draws(BOTH, 8, 0, 1000)["omega"] != whole["omega"]).all()
    assert abs(np.corrcoef(whole["gamma"], whole["omega"])[0, 1]) < 0.1


def test_draws_are_distributed_as_asked():
    found = draws(BOTH, 1, 0, 100_000)
    assert found["gamma"].mean() == pytest.approx(0.3, abs=4 * 0.01 / np.sqrt(1e5))
    assert found["gamma"].std() == pytest.approx(0.01, rel=0.01)
    low, high = found["omega"].min(), found["omega"].max()
    assert 1.1 < low < 1.1001 and 1.2999 < high < 1.3
    assert np.histogram(found["omega"], 10, (1.1, 1.3))[0].min() > 9500


@pytest.mark.parametrize(
    ("text", "kind", "first", "second"),
    [("uniform:1:2", "uniform", 1, 2), ("normal:1:0.5", "normal", 1, 0.5), ("uniform:10%", "uniform", 1.8, 2.2),
     ("normal:3%", "normal", 2, 0.06)],
)  # fmt: skip
def test_tolerances_are_read(text, kind, first, second):
    found = Tolerance.parse(text, 2.0)
    assert found.kind == kind and (found.first, found.second) == pytest.approx((first, second))


@pytest.mark.parametrize(
    "text", ["uniform", "uniform:2:1", "normal:1:0", "normal:x", "cauchy:0:1", "normal:1:2:3", "uniform:nan:1"]
)
def test_bad_tolerances_are_refused(text):
    with pytest.raises(RangeError):
        Tolerance.parse(text, 2.0)


def test_draws_in_a_store(tmp_path):
    system = whirlmap.load("duffing")
    ds = tolerance_sweep(system, BOTH, 40, seed=3, store=tmp_path / "a", settling=SHORT, chunk=7)
    assert ds["regime"].dims == ("draw",) and {"gamma", "omega", "draw"} <= set(ds.coords)
    points = label_points(system, {n: ds[n].values for n in BOTH}, settling=SHORT)
    for name, values in points.data_vars.items():
        np.testing.assert_array_equal(ds[name].values, values.values, err_msg=name)
    tolerance_sweep(system, BOTH, 40, seed=3, store=tmp_path / "b", settling=SHORT, chunk=7, workers=1)
    assert differences(tmp_path / "a", tmp_path / "b") == []
    with pytest.raises(OutputError, match="draws: the store has 40 with seed 3, this run 40 with seed 4"):
        tolerance_sweep(system, BOTH, 40, seed=4, store=tmp_path / "a", settling=SHORT, resume=True)


def test_draws_at_every_point_of_a_grid(tmp_path):
    system = whirlmap.load("duffing")
    grid = {"gamma": [0.2, 0.3]}
    ds = tolerance_sweep(system, {"omega": "normal:1%"}, 6, vary=grid, store=tmp_path / "m", settling=SHORT, chunk=4)
    assert ds["regime"].dims == ("gamma", "draw") and ds["omega"].dims == ("draw",)
    one = label_points(system, {"gamma": np.full(6, 0.3), "omega": ds["omega"].values}, settling=SHORT)
    np.testing.assert_array_equal(ds["rms"].values[1], one["rms"].values)
    assert isinstance(xr.open_zarr(tmp_path / "m"), xr.Dataset)


def test_draws_beyond_a_parameters_limits_are_refused(tmp_path):
    with pytest.raises(RangeError, match=r"omega = -.* must be above 0"):
        tolerance_sweep(whirlmap.load("duffing"), {"omega": "normal:60%"}, 1000, store=tmp_path / "m")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("given", [0.1, 10, None, ("uniform", 0.9, 1.1)])
def test_a_tolerance_that_is_no_text_says_how_one_is_written(given):
    with pytest.raises(RangeError, match=r"found the tolerance .*, expected a text: uniform:LOW:HIGH"):
        whirlmap.tolerance_sweep(whirlmap.load("duffing"), {"gamma": given}, 4)


def test_dimensional_inputs_name_what_they_feed():
    rig = whirlmap.load("machines/jeffcott-rig")
    with pytest.raises(RangeError, match=r"found the dimensional input 'c'.*it feeds s, Gamma"):
        whirlmap.tolerance_sweep(rig, {"c": "uniform:5%"}, 4)
    with pytest.raises(RangeError, match="has no parameter 'gama'"):
        whirlmap.tolerance_sweep(whirlmap.load("duffing"), {"gama": "uniform:5%"}, 4)
