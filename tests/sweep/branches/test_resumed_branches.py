"""Branches that were interrupted go on to what they would have been."""

import numpy as np
import pytest

import whirlmap
from whirlmap.errors import RangeError
from whirlmap.sweep.branches.branch_dataset import word

CASES = {
    "orbits": ("duffing", {"delta": 0.05, "alpha": 1, "beta": 0.1, "gamma": 0.18}, ("omega", (0.8, 1.6)), {}),
    "both ways": ("gear_backlash", {"F_ah": 0.05, "zeta": 0.05}, ("Omega", (0.5, 1.6)), {"begin": 0.6}),
    "doublings": ("duffing", {"delta": 0.3, "omega": 1.2}, ("gamma", (0.24, 0.3)), {"doublings": 1}),
    "cycles": ("roessler", {}, ("c", (2.6, 3.2)), {}),
    "equilibria": ("lorenz", {}, ("rho", (10.0, 30.0)), {"begin": 14.0, "orbit": (6, 6, 13)}),
}


@pytest.mark.parametrize("name", CASES)
def test_an_interrupted_branch_goes_on(name):
    case, values, vary, options = CASES[name]
    system = whirlmap.load(case, **values)
    whole = whirlmap.continue_orbit(system, *vary, **options)
    work = whirlmap.continue_orbit.parts(system, *vary, **options)
    for done in work:
        if done > 0.6 * whole.sizes["point"]:
            break
    assert "incomplete" in work.dataset.attrs and work.dataset.sizes["point"] < whole.sizes["point"]
    open_ends = "interrupted" in [word(whole, "end", e) for e in work.dataset["end"].values.ravel()]
    assert open_ends or work.dataset.sizes["branch"] < whole.sizes["branch"]
    resumed = whirlmap.continue_orbit(system, *vary, **options, resume=work.dataset)
    assert "incomplete" not in resumed.attrs and resumed.sizes["branch"] == whole.sizes["branch"]
    assert sorted(map(sorted, resumed["end"].values.tolist())) == sorted(map(sorted, whole["end"].values.tolist()))
    assert sorted(resumed["event_kind"].values) == sorted(whole["event_kind"].values)
    parameter = f"event_{vary[0]}"
    np.testing.assert_allclose(np.sort(resumed[parameter].values), np.sort(whole[parameter].values), rtol=1e-9)


def test_branches_of_something_else_are_refused():
    system = whirlmap.load("duffing", delta=0.05, alpha=1, beta=0.1, gamma=0.18)
    work = whirlmap.continue_orbit.parts(system, "omega", (0.8, 1.6))
    next(iter(work))
    with pytest.raises(RangeError, match="range"):
        whirlmap.continue_orbit(system, "omega", (0.8, 1.7), resume=work.dataset)
