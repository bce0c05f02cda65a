"""Diagrams: what is drawn is what the Dataset holds, and what ended is shown."""

import numpy as np
import pytest

from whirlmap.errors import RangeError
from whirlmap.plot import draw_diagram, draw_exponents, draw_regime_strip
from whirlmap.plot.common.style import DIRECTIONS, REGIMES
from whirlmap.plot.figures.diagnosis_figure import diagram_figure, paper_diagram_figure
from whirlmap.results.regime import Regime


def cloud(ax):
    """Every section point of a panel."""
    points = [line.get_xydata() for line in ax.lines if line.get_marker() == "o"]
    both = np.concatenate(points)
    return both[np.isfinite(both).all(axis=1)]


def tagged(ax, start):
    return [a for a in ax.get_children() if str(a.get_gid() or "").startswith(start)]


def test_the_points_are_those_of_the_dataset(diagram):
    ax = draw_diagram(diagram, "x")
    values = diagram["section"].sel(state="x").transpose("gamma", "period").values
    expected = np.stack([np.repeat(diagram["gamma"].values, values.shape[1]), values.ravel()], axis=1)
    np.testing.assert_array_equal(cloud(ax), expected)
    assert ax.get_ylabel() == "$x$ [–]"
    assert ax.get_xlabel() == r"forcing amplitude, $\gamma$ [–]"


def test_all_points_are_inside_the_axes(diagram):
    ax = draw_diagram(diagram, "v")
    points = cloud(ax)
    for values, (low, high) in zip(points.T, (ax.get_xlim(), ax.get_ylim()), strict=True):
        assert low < values.min() and values.max() < high


def test_colours_by_regime_are_the_fixed_ones(diagram):
    ax = draw_diagram(diagram, "x", colour_by_regime=True)
    assert {line.get_color() for line in ax.lines} == {
        REGIMES[Regime.periodic].colour,
        REGIMES[Regime.undecided].colour,
    }
    assert len(cloud(ax)) == diagram["section"].sel(state="x").size


def test_what_ended_is_hatched_over_its_own_cells_and_nowhere_else(ended):
    ax = draw_diagram(ended, "x")
    bands = {a.get_gid(): a for a in tagged(ax, "ended-")}
    assert set(bands) == {"ended-contact", "ended-unresolved"}
    gamma = ended["gamma"].values
    contact = bands["ended-contact"].get_extents().transformed(ax.transData.inverted())
    assert contact.x0 == pytest.approx(gamma[0] - (gamma[1] - gamma[0]) / 2)
    assert contact.x1 == pytest.approx((gamma[2] + gamma[3]) / 2)
    assert all(band.get_hatch() for band in bands.values())
    assert len(cloud(ax)) == 5 * ended.sizes["period"]
    assert "contact" in {t.get_text() for t in ax.texts}


def test_a_diagram_without_ended_points_has_no_hatch(diagram):
    assert not tagged(draw_diagram(diagram, "x"), "ended-")


def test_a_settled_orbit_is_a_point_and_not_a_line(diagram):
    """Section points of period 1 differ by rounding; alone, they must not fill the axis."""
    one = diagram.isel(gamma=slice(0, 1))
    spread = float(np.ptp(one["section"].sel(state="x").values))
    assert int(one["period_T"][0]) == 1 and spread < 1e-6
    low, high = draw_diagram(one, "x").get_ylim()
    swing = float((one["maximum"] - one["minimum"]).sel(quantity="x")[0])
    assert high - low >= 0.05 * swing


def test_two_sweeps_have_two_colours_and_both_are_seen(both):
    ax = draw_diagram(both, "x")
    assert [line.get_color() for line in ax.lines] == [DIRECTIONS["up"].colour, DIRECTIONS["down"].colour]
    assert ax.lines[0].get_markersize() > ax.lines[1].get_markersize()
    middle = both["section"].sel(state="x", omega=1.8).isel(period=-1).values
    assert abs(middle[0] - middle[1]) > 0.5, "the test needs a speed with two branches"


def test_the_strip_has_a_bar_for_every_run_of_one_regime(ended):
    ax = draw_regime_strip(ended)
    bars = [a.get_gid() for a in tagged(ax, "regime-")]
    assert bars == ["regime-contact", "regime-periodic", "regime-undecided", "regime-unresolved"]
    assert "2T" in {t.get_text() for t in ax.texts}


def test_the_strip_has_a_row_for_each_direction(both):
    labels = [t.get_text() for t in draw_regime_strip(both).get_yticklabels()]
    assert labels == ["down", "up"]


def test_exponents_are_drawn_where_they_were_measured(diagram):
    ax = draw_exponents(diagram)
    measured = np.isfinite(diagram["lyapunov"].values)
    assert 0 < measured.sum() < measured.size
    drawn = np.concatenate([c[0].get_xydata() for c in ax.containers])
    np.testing.assert_array_equal(drawn[:, 0], diagram["gamma"].values[measured])
    np.testing.assert_array_equal(drawn[:, 1], diagram["lyapunov"].values[measured])


def test_no_exponents_are_said_to_be_absent(both):
    assert "no exponent measured" in {t.get_text() for t in draw_exponents(both).texts}


def test_values_spaced_by_a_factor_get_a_logarithmic_axis(diagram):
    spaced = diagram.assign_coords(gamma=("gamma", np.geomspace(1e-4, 1, 9), diagram["gamma"].attrs))
    assert draw_diagram(spaced, "x").get_xscale() == "log"
    assert draw_regime_strip(spaced).get_xscale() == "log"
    assert draw_diagram(diagram, "x").get_xscale() == "linear"


def test_an_unknown_state_names_the_nearest(diagram):
    with pytest.raises(RangeError, match=r"no state 'xx'. Did you mean 'x'"):
        draw_diagram(diagram, "xx")


@pytest.mark.parametrize("exponents", [None, True, False])
def test_a_figure_has_its_panels(ended, exponents):
    fig = diagram_figure(ended, ["x", "v"], exponents=exponents, title="a title", names={"x": "mass"})
    assert len(fig.axes) == 3 + (exponents is not False)
    assert fig.axes[0].get_title(loc="left") == "mass"
    (legend,) = fig.legends
    assert {t.get_text() for t in legend.get_texts()} == {"contact", "periodic", "undecided", "unresolved"}


def test_a_figure_without_states_has_all_whose_section_is_there(diagram):
    assert len(diagram_figure(diagram, exponents=False).axes) == diagram.sizes["state"] + 1


def test_the_papers_figure_has_two_columns_with_a_strip_each(diagram):
    fig = paper_diagram_figure(diagram, ("x", "v", "x", "v"))
    assert len(fig.axes) == 6
    fig.draw_without_rendering()
    left = {round(ax.get_position().x0, 3) for ax in fig.axes}
    assert len(left) == 2
