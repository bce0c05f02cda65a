"""Convergence of exponents, correlation sums, and the sheets composed of all parts."""

import numpy as np
import pytest

from whirlmap.analysis.indicators.correlation_dimension import correlation_dimension
from whirlmap.analysis.spectra.spectral_lines import spectral_lines
from whirlmap.analysis.spectra.spectrum import power_spectrum
from whirlmap.plot import draw_convergence, draw_correlation_sum, draw_local_slope
from whirlmap.plot.common.diagnosis_parts import clock_name, marked_shaft, parts_of
from whirlmap.plot.figures.diagnosis_figure import diagnosis_figure, paper_orbit_figure
from whirlmap.plot.panels.convergence import with_error


def by_gid(ax, gid):
    return [a for a in ax.get_children() if a.get_gid() == gid]


def words(ax):
    return " ".join(t.get_text() for t in ax.texts)


def test_the_band_is_two_standard_errors_about_the_final_value(chaos):
    ds = chaos["lyapunov"]
    ax = draw_convergence(ds)
    (curve,), (band,) = by_gid(ax, "running"), by_gid(ax, "band")
    np.testing.assert_array_equal(curve.get_ydata(), ds["running"].values[:, 0])
    box = band.get_extents().transformed(ax.transData.inverted())
    value, error = float(ds["lyapunov"][0]), float(ds["lyapunov_error"][0])
    assert (box.y0, box.y1) == (pytest.approx(value - 2 * error), pytest.approx(value + 2 * error))
    low, high = ax.get_ylim()
    assert low < 0 < value < high


def test_several_exponents_have_a_curve_each(chaos):
    assert len(by_gid(draw_convergence(chaos["lyapunov"], count=2), "running")) == 2


def test_no_exponent_is_said(chaos):
    ds = chaos["lyapunov"].copy(deep=True)
    ds["running"][:] = np.nan
    ds["status"] = ds["status"].copy(data=np.int8(1))
    assert "a stop that the model declares was" in words(draw_convergence(ds))


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.1234, 0.0021, "0.1234 ± 0.0021"),
        (-12.3, 0.9, "−12.30 ± 0.90"),
        (0.5, 0.0, "0.5"),
        (-0.01535769, 4e-8, "−0.0153577 ± 4e−08"),
        (1.0, np.nan, "1"),
    ],
)
def test_a_number_is_cut_to_two_digits_of_its_error(value, error, text):
    assert with_error(value, error) == text


def test_the_fitted_line_and_range_are_those_of_the_dataset(chaos):
    ds = chaos["dimension"]
    assert int(ds["status"]) == 0, "the test needs a scaling range"
    for draw in (draw_correlation_sum, draw_local_slope):
        ax = draw(ds)
        (fit,) = by_gid(ax, "fit")
        np.testing.assert_allclose(fit.get_xdata(), [float(ds["radius_low"]), float(ds["radius_high"])])
        assert len(by_gid(ax, "range")) == 1
    x, y = by_gid(draw_correlation_sum(ds), "fit")[0].get_data()
    assert np.diff(np.log(y))[0] / np.diff(np.log(x))[0] == pytest.approx(float(ds["D2"]))


def test_without_a_dimension_the_panel_says_why(periodic):
    ds = correlation_dimension(periodic["section"]["section"].values[0], theiler=2)
    for draw in (draw_correlation_sum, draw_local_slope):
        ax = draw(ds)
        assert "finite set of points" in words(ax) + ax.get_title(loc="left")
        assert not by_gid(ax, "fit")


def test_the_papers_sheet_has_six_panels(chaos):
    x = chaos["series"]["x"].sel(state="x").values[:-1]
    spectrum = power_spectrum(x, rate=25)
    fig = paper_orbit_figure("x", **chaos, spectrum=spectrum, lines=spectral_lines(spectrum), orders={"forcing": 1})
    assert len(fig.axes) == 6
    for ax, gid in zip(fig.axes, ("orbit", "power", "section", "running", "sum", "slope"), strict=True):
        assert by_gid(ax, gid), gid


def test_absent_parts_give_their_reasons(periodic):
    fig = paper_orbit_figure("x", **periodic, reasons={"dimension": "periodic: a finite set of points"})
    assert "periodic: a finite set" in words(fig.axes[4]) and "periodic: a finite set" in words(fig.axes[5])
    assert "not computed" in words(fig.axes[3])


def test_the_dataset_of_a_diagnosis_fills_its_sheet(diagnosed):
    fig = diagnosis_figure(diagnosed, "x", title="duffing")
    gids = {a.get_gid() for ax in fig.axes for a in ax.get_children()}
    assert {"orbit", "section", "power", "running", "sum", "order-forcing"} <= gids
    assert "not computed" not in " ".join(words(ax) for ax in fig.axes)


def test_parts_are_those_of_the_dataset(diagnosed):
    parts = parts_of(diagnosed, "x")
    assert parts.dimension is not None and float(parts.dimension["D2"]) == float(diagnosed["dimension_D2"])
    assert parts.dimension["correlation_sum"].dims == ("radius",)
    assert parts.orders == {"forcing": 1.0}
    draw_correlation_sum(parts.dimension)


def test_a_simulation_alone_gives_a_sheet_with_a_journal_orbit(rotor):
    fig = diagnosis_figure(rotor["series"], "uy", section=rotor["section"], orders={"shaft": 1})
    assert by_gid(fig.axes[0], "clearance")
    assert "not computed" in words(fig.axes[4])
    assert fig.axes[3].get_xlabel() == "frequency / shaft frequency [–]"


def test_clocks_name_the_frequency_and_the_marked_shaft():
    clocks = {"mesh": 1.0, "pinion": 0.25, "gear": -0.125}
    assert clock_name(clocks) == "mesh"
    assert marked_shaft(clocks) == ("pinion", 0.25)
    assert marked_shaft({"shaft": 1.0}) == ("shaft", 1)
    assert marked_shaft({}) == ("", 1)
