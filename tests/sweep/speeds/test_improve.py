"""Designs compared: each as it would be judged on its own, the refinement about the best, and what is refused."""

from functools import partial

import numpy as np
import pytest

import whirlmap
from whirlmap.errors import RangeError
from whirlmap.sweep.speeds.improve import _front
from whirlmap.sweep.speeds.safe_speeds import safe_speeds
from whirlmap.sweep.speeds.verdicts import Verdict, clearance, shaft_speed
from whirlmap.sweep.speeds.windows import PARTS, ROUNDS, crossing, widest_window

RIG = "machines/jeffcott-rig"
MAKE = partial(whirlmap.load, RIG)
AT = np.linspace(0.5, 2.0, 13)


@pytest.fixture(scope="module")
def compared():
    return whirlmap.improve(MAKE, {"c": [80, 100, 120]}, AT, 0.6, units={"c": "um"})


def test_a_design_is_judged_as_it_would_be_on_its_own(compared):
    """The same rpm and the same limit in micrometres; amplitudes in the clearance of the machine as it is."""
    rig, wide = MAKE(), MAKE(c="120 um")
    assert clearance(wide) / clearance(rig) == pytest.approx(1.2)
    own = safe_speeds(wide, AT * shaft_speed(rig) / shaft_speed(wide), 0.6 / 1.2)
    there = compared.isel(design=2)
    np.testing.assert_array_equal(there["verdict"].values, own["verdict"].values)
    assert 0 < int((own["verdict"] == Verdict.safe).sum()) < AT.size
    np.testing.assert_allclose(there["amplitude"].values, own["amplitude"].values * 1.2, rtol=1e-5)
    assert float(there["worst_amplitude"]) == pytest.approx(float(own["amplitude"].max()) * 1.2, rel=1e-5)


def test_the_window_agrees_with_refined_edges():
    """Interpolated edges lie within a spacing of those of `safe_speeds`, and nearer where the speeds are closer."""
    rig, errors = MAKE(), []
    for count in (13, 49):
        at = np.linspace(0.5, 2.0, count)
        ds = whirlmap.improve(MAKE, {"Gamma": [float(rig.values["Gamma"]), 1e3]}, at, 0.6, refine=False)
        own = safe_speeds(rig, at, 0.6)
        k = int((own["window_end"] - own["window_start"]).values.argmax())
        ends = [abs(float(ds[n][0] - own[n][k])) for n in ("window_start", "window_end")]
        assert max(ends) < (at[1] - at[0]) + (at[1] - at[0]) / (PARTS + 1) ** ROUNDS
        errors.append(max(ends))
    assert errors[1] < errors[0]


def test_the_refinement_lies_between_the_neighbours_of_the_best(compared):
    coarse = compared["refined"].values == 0
    assert compared["c"].values[coarse].tolist() == [80, 100, 120]
    finer = compared["c"].values[~coarse]
    assert finer.size >= 3 and finer.min() > 80 and finer.max() < 120 and len(set(finer)) == finer.size
    best = compared.isel(design=compared.attrs["widest"])
    assert float(best["window_width"]) == compared["window_width"].max()
    calm = compared.isel(design=compared.attrs["calmest"])
    assert float(calm["worst_amplitude"]) == compared["worst_amplitude"].min()


def test_two_parameters_make_a_grid():
    ds = whirlmap.improve(MAKE, {"c": [80, 120], "Gamma": [1.0, 2.0, 4.0]}, AT[::3], 0.6, units={"c": "um"}, refine=False)
    assert ds.sizes["design"] == 6 and ds["c"].attrs["units"] == "um"
    assert sorted(zip(ds["c"].values, ds["Gamma"].values, strict=True)) == [(c, g) for c in (80, 120) for g in (1, 2, 4)]


def test_windows_by_hand():
    at, swing = np.array([1.0, 2.0, 3.0, 4.0, 5.0]), np.array([0.1, 0.2, 0.6, 0.3, np.nan])
    verdict = np.array([Verdict.safe, Verdict.safe, Verdict.amplitude, Verdict.safe, Verdict.contact], dtype=np.int8)
    assert widest_window(at, swing, verdict, 0.4) == pytest.approx((1.0, 2.5))
    assert crossing(at, swing, verdict, 0.4, 3, 1) == 4.0  # contact is no crossing of the limit
    assert np.isnan(widest_window(at, swing, np.full(5, Verdict.contact, dtype=np.int8), 0.4)).all()


def test_the_front_is_what_nothing_betters():
    xr = pytest.importorskip("xarray")
    ds = xr.Dataset({
        "window_width": ("design", [1.0, 2.0, 3.0, 3.0, 0.5]), "worst_amplitude": ("design", [0.1, 0.3, 0.2, np.nan, 0.1]),
    })  # fmt: skip
    assert _front(ds).tolist() == [1, 0, 1, 0, 0]


def test_a_design_that_reaches_contact_has_no_worst_amplitude():
    make = partial(whirlmap.load, "gear-psfd/machine")
    ds = whirlmap.improve(make, {"psi": [1e-3, 1.0]}, [0.5, 1.0], 0.8, refine=False)
    assert ds["ended"].values.tolist() == [0, 2] and (ds["verdict"][1] == Verdict.contact).all()
    assert np.isnan(ds["worst_amplitude"].values[1]) and ds["window_width"].values[1] == 0
    assert ds.attrs["widest"] == ds.attrs["calmest"] == 0


@pytest.mark.parametrize(
    ("vary", "speeds", "limit", "word"),
    [
        ({}, [1, 2], 0.5, "one or two"), ({"s": [1, 2]}, [1, 2], 0.5, "is the speed"),
        ({"b": [2, 1]}, [1, 2], 0.5, "ascend"),
        ({"b": [0.1, 0.2]}, [2, 1], 0.5, "ascend"), ({"b": [0.1, 0.2]}, [-1, 1], 0.5, "positive"),
        ({"b": [0.1, 0.2]}, [1, 2], -1, "limit"),
    ],
)  # fmt: skip
def test_bad_questions_are_refused(vary, speeds, limit, word):
    with pytest.raises(RangeError, match=word):
        whirlmap.improve(MAKE, vary, speeds, limit)
