"""Time series, phase portraits, orbits and sections."""

from fractions import Fraction

import numpy as np
import pytest

from whirlmap.errors import RangeError
from whirlmap.plot import draw_orbit, draw_phase_portrait, draw_section, draw_time_series


def by_gid(ax, gid):
    (found,) = [a for a in ax.get_children() if a.get_gid() == gid]
    return found


def cut(ds, sample):
    """The same run, ended in contact at a sample."""
    out = ds.copy(deep=True)
    out["x"][sample + 1 :] = np.nan
    out["outputs"][sample + 1 :] = np.nan
    out["status"] = out["status"].copy(data=np.int8(1))
    out["end_time"] = out["end_time"].copy(data=float(ds["time"][sample]))
    return out.assign_attrs(stop="contact_1")


def test_section_points_are_those_of_the_dataset(chaos):
    line = by_gid(draw_section(chaos["section"], "x"), "section")
    np.testing.assert_array_equal(line.get_xydata(), chaos["section"]["section"].values[0])


def test_a_period_1_section_is_one_point(periodic):
    """Its points differ by 1e-11; the axes still span a share of the orbit, so that they are one dot."""
    points = periodic["section"]["section"].values.reshape(-1, 2)
    assert np.ptp(points, axis=0).max() < 1e-9
    orbit = np.ptp(periodic["series"]["x"].values, axis=0)
    ax = draw_section(periodic["section"], "x", orbit=periodic["series"])
    assert np.diff(ax.get_xlim())[0] >= 0.05 * orbit[0]
    assert np.diff(ax.get_ylim())[0] >= 0.05 * orbit[1]
    alone = draw_section(periodic["section"], "x")
    assert np.diff(alone.get_xlim())[0] > 1e6 * np.ptp(points[:, 0])


def test_a_chaotic_section_keeps_its_own_size(chaos):
    points = chaos["section"]["section"].values[0]
    ax = draw_section(chaos["section"], "x", orbit=chaos["series"])
    assert np.diff(ax.get_xlim())[0] < 1.3 * np.ptp(points[:, 0])


def test_an_angle_is_shown_within_its_period(chaos):
    """Displacements in place of angles: a run that turns over and over again."""
    period = 1.5
    section, series = (chaos[p].assign_attrs(cyclic=f'{{"x": {period}}}') for p in ("section", "series"))
    points = by_gid(draw_section(section, "x"), "section").get_xydata()
    turned = (points - chaos["section"]["section"].values[0]) / [period, 1]
    np.testing.assert_allclose(turned, np.rint(turned), atol=1e-9)
    assert np.abs(points[:, 0]).max() <= period / 2 and np.any(turned)
    path = by_gid(draw_phase_portrait(series, "x"), "orbit").get_xdata()
    whole = np.isfinite(path)
    assert np.nanmax(np.abs(np.diff(path))) < period / 2 and 0 < (~whole).sum() < whole.sum() / 10


def test_an_empty_section_says_why(chaos):
    gone = chaos["section"].copy(deep=True)
    gone["section"][:] = np.nan
    gone["status"][:] = 2
    assert "grew beyond" in draw_section(gone, "x").texts[0].get_text()


def test_phase_portrait_marks_the_samples_at_whole_periods(chaos):
    series = chaos["series"]
    marks = by_gid(draw_phase_portrait(series, "x"), "section").get_xydata()
    assert len(marks) == 129
    np.testing.assert_array_equal(marks, series["x"].values[:: (series.sizes["time"] - 1) // 128])


def test_only_the_last_turns_are_shown_on_request(chaos):
    marks = by_gid(draw_phase_portrait(chaos["series"], "x", turns=10), "section").get_xydata()
    assert len(marks) == 11


def test_a_run_that_ended_is_marked_where_it_ended(chaos):
    ended = cut(chaos["series"], 900)
    ax = draw_phase_portrait(ended, "x")
    np.testing.assert_array_equal(by_gid(ax, "ended").get_xydata()[0], chaos["series"]["x"].values[900])
    assert ax.get_title(loc="left").startswith("contact 1 at time")


def test_the_time_after_the_end_is_hatched(chaos):
    ended = cut(chaos["series"], 900)
    ax = draw_time_series(ended, "x")
    band = by_gid(ax, "ended")
    assert band.get_hatch()
    left = band.get_extents().transformed(ax.transData.inverted()).x0
    assert left == pytest.approx(float(chaos["series"]["turn"][900]))
    assert ax.get_xlim()[1] > left


def test_a_run_that_ended_before_the_record_says_so(chaos):
    ended = cut(chaos["series"], 0)
    for ax in (draw_time_series(ended, "x"), draw_phase_portrait(ended, "x")):
        assert "contact 1 at time" in ax.texts[0].get_text()


def test_time_series_are_those_of_the_dataset(rotor):
    series = rotor["series"]
    ax = draw_time_series(series, ["ux", "eps"])
    np.testing.assert_array_equal(ax.lines[0].get_ydata(), series["x"].sel(state="ux"))
    np.testing.assert_array_equal(ax.lines[1].get_ydata(), series["outputs"].sel(output="eps"))
    np.testing.assert_array_equal(ax.lines[0].get_xdata(), series["turn"])


def test_an_unknown_series_lists_the_known(rotor):
    with pytest.raises(RangeError, match="they hold: ux uy"):
        draw_time_series(rotor["series"], "uz")


@pytest.mark.parametrize(("order", "marks"), [(1, 41), (Fraction(1, 4), 11), (Fraction(2), 81)])
def test_an_orbit_has_a_mark_at_every_turn(rotor, order, marks):
    ax = draw_orbit(rotor["series"], "ux", "uy", clearance=1.0, order=order)
    assert len(by_gid(ax, "marks").get_xydata()) == marks


def test_a_journal_is_seen_in_its_whole_clearance_to_one_scale(rotor):
    ax = draw_orbit(rotor["series"], "ux", "uy", clearance=1.0)
    assert by_gid(ax, "clearance").get_radius() == 1.0
    assert ax.get_xlim() == ax.get_ylim() and ax.get_xlim()[0] < -1 and ax.get_xlim()[1] > 1
    assert ax.get_aspect() == 1.0
    (inset,) = ax.child_axes
    assert np.diff(inset.get_xlim())[0] == pytest.approx(np.diff(inset.get_ylim())[0])


def test_an_orbit_without_clearance_fills_equal_axes(rotor):
    ax = draw_orbit(rotor["series"], "ux", "uy")
    assert np.diff(ax.get_xlim())[0] == pytest.approx(np.diff(ax.get_ylim())[0])
    assert np.diff(ax.get_xlim())[0] < 0.5
