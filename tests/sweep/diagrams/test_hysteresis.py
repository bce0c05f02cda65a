"""Up and down on one diagram: where the branches differ, between the folds of a hardening spring."""

import numpy as np
import pytest
import xarray as xr

import whirlmap
from whirlmap.errors import RangeError
from whirlmap.plot.figures.diagnosis_figure import diagram_figure
from whirlmap.sweep.diagrams.diagram import bifurcation_diagram
from whirlmap.sweep.diagrams.hysteresis import intervals
from whirlmap.sweep.diagrams.in_batches import diagram_in_batches

SETTLING = whirlmap.Settling(transient=120, most=8)
OMEGA = np.linspace(0.8, 2.2, 29)


@pytest.fixture(scope="module")
def spring():
    return whirlmap.load("duffing", alpha=1, beta=0.5, delta=0.1, gamma=0.5)


@pytest.fixture(scope="module")
def loop(spring):
    return bifurcation_diagram(spring, "omega", OMEGA, follow="both", settling=SETTLING)


def folds():
    """Frequencies of the two folds by harmonic balance, A^2 ((1 + 3/4 beta A^2 - w^2)^2 + delta^2 w^2) = gamma^2."""
    amplitude = np.linspace(0.2, 3, 40001)
    spring, rest = 1 + 0.75 * 0.5 * amplitude**2, (0.5 / amplitude) ** 2
    both = []
    for sign in (-1, 1):  # w^2 from spring^2 - 2 spring w^2 + w^4 + delta^2 w^2 = rest
        half = spring - 0.1**2 / 2
        inside = half**2 - spring**2 + rest
        both.append(np.where(inside >= 0, half + sign * np.sqrt(np.maximum(inside, 0)), np.nan))
    left, right = both  # of the resonance: the fold down is the least of the right, the fold up the largest at all
    return np.sqrt(np.nanmin(right[amplitude > 0.4])), np.sqrt(np.nanmax(left))


def test_branches_differ_between_the_folds(loop):
    low, high = folds()
    ((first, last),) = intervals(loop, "omega")
    step = OMEGA[1] - OMEGA[0]
    assert abs(first - low) < 2 * step and abs(last - high) < 2 * step, (first, last, low, high)
    outside = (loop["omega"] < first) | (loop["omega"] > last)
    assert (loop["hysteresis"].where(outside, 0) == 0).all()
    up, down = (loop["peak_to_peak"].sel(direction=d, quantity="x") for d in ("up", "down"))
    np.testing.assert_array_equal(np.abs(up - down) > 0.05, loop["hysteresis"] == 1)


def test_batches_and_fewer_states_say_the_same(spring, loop):
    work = diagram_in_batches(spring, "omega", OMEGA, follow="both", settling=SETTLING, batch=7, states=["v"]).run()
    assert work.dataset["state"].values.tolist() == ["v"]
    xr.testing.assert_identical(work.dataset["hysteresis"], loop["hysteresis"])


def test_where_the_branches_agree_nothing_is_marked(spring):
    ds = bifurcation_diagram(spring, "omega", [0.8, 0.9, 1.0], follow="both", settling=SETTLING)
    assert (ds["hysteresis"] == 0).all() and intervals(ds, "omega") == []


def test_the_picture_marks_the_stretch(loop):
    fig = diagram_figure(loop, ["x"])
    spans = [p for ax in fig.axes for p in ax.patches if p.get_gid() == "hysteresis"]
    assert len(spans) >= 1
    assert "up and down differ" in [t.get_text() for t in fig.legends[0].get_texts()]


def test_a_section_keeps_the_states_asked_for(spring):
    whole = bifurcation_diagram(spring, "omega", [0.9, 1.0], settling=SETTLING, states=["x", "v"])
    own = bifurcation_diagram(spring, "omega", [0.9, 1.0], settling=SETTLING)
    assert own["state"].values.tolist() == ["x"]
    xr.testing.assert_equal(own["section"], whole["section"].sel(state=["x"]))
    assert len(own["section"].attrs["unit_of_each"].split()) == 1
    with pytest.raises(RangeError, match="no state 'y'"):
        bifurcation_diagram(spring, "omega", [0.9, 1.0], states=["y"])
