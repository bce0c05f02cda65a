"""Power spectra, full spectra and waterfalls."""

from fractions import Fraction

import numpy as np
import pytest

from whirlmap.analysis.spectra.spectral_lines import spectral_lines
from whirlmap.analysis.spectra.spectrum import full_spectrum, power_spectrum
from whirlmap.errors import RangeError
from whirlmap.plot import draw_full_spectrum, draw_power_spectrum, draw_waterfall
from whirlmap.plot.panels.spectrum import _apart

ORDERS = {"mesh": 1, "pinion": Fraction(1, 4), "gear": Fraction(-1, 8)}
TURN = np.arange(64 * 32) / 32


def by_gid(ax, start):
    return [a for a in ax.get_children() if str(a.get_gid() or "").startswith(start)]


def test_the_curve_is_the_power_in_decibels(chaos):
    x = chaos["series"]["x"].sel(state="x").values[:-1]
    ds = power_spectrum(x, rate=25)
    ax = draw_power_spectrum(ds, highest=2.0)
    (curve,) = by_gid(ax, "power")
    chosen = (ds["frequency"].values > 0) & (ds["frequency"].values <= 2)
    np.testing.assert_allclose(curve.get_ydata(), 10 * np.log10(ds["power"].values[chosen]))
    np.testing.assert_array_equal(curve.get_xdata(), ds["frequency"].values[chosen])


def test_found_lines_stand_where_they_were_found():
    ds = power_spectrum(np.sin(2 * np.pi * TURN) + 0.1 * np.sin(2 * np.pi * 0.25 * TURN), rate=32)
    lines = spectral_lines(ds)
    ax = draw_power_spectrum(ds, lines=lines)
    (marks,) = by_gid(ax, "lines")
    np.testing.assert_allclose(sorted(marks.get_xdata()), [0.25, 1.0], atol=1e-3)
    assert max(marks.get_ydata()) == pytest.approx(10 * np.log10(0.5), abs=0.05)
    assert ax.get_title(loc="left") == "2 lines hold 100 % of the power"


def test_every_named_order_in_range_has_a_line_and_a_name():
    ds = power_spectrum(np.sin(2 * np.pi * TURN), rate=32)
    ax = draw_power_spectrum(ds, orders={"mesh": 1, "pinion": 0.25, "third": 3, "tenth": 10})
    assert {a.get_gid() for a in by_gid(ax, "order-")} == {"order-mesh", "order-pinion", "order-third"}
    assert {t.get_text() for t in ax.texts} == {"mesh", "pinion", "third"}


def test_the_names_of_close_orders_are_moved_apart():
    placed = _apart([0.125, 0.25, 0.26, 1.0], 0.1)
    assert np.diff(placed).min() >= 0.1 * (1 - 1e-6)
    assert placed[3] == 1.0


def test_silence_can_be_drawn():
    ds = power_spectrum(np.ones(256), rate=32)
    ax = draw_power_spectrum(ds, lines=spectral_lines(ds))
    ax.figure.draw_without_rendering()
    (curve,), (marks,) = by_gid(ax, "power"), by_gid(ax, "lines")
    assert np.ptp(curve.get_ydata()) == 0 and curve.get_ydata()[0] < -2000  # a flat line far below any power
    assert np.isfinite(ax.get_ylim()).all() and len(marks.get_xdata()) == 0
    assert ax.get_title(loc="left") == "0 lines hold 0 % of the power"


def test_forward_whirl_stands_on_the_right_and_backward_on_the_left():
    """A circle of radius 0.5 forwards at 1/T and one of 0.2 backwards at 1/8T."""
    z = 0.5 * np.exp(2j * np.pi * TURN) + 0.2 * np.exp(-2j * np.pi * TURN / 8)
    ax = draw_full_spectrum(full_spectrum(z.real, z.imag, rate=32), orders=ORDERS)
    (forward,), (backward,) = by_gid(ax, "forward"), by_gid(ax, "backward")
    assert forward.get_xdata().min() > 0 > backward.get_xdata().max()
    for curve, at, radius in ((forward, 1.0, 0.5), (backward, -0.125, 0.2)):
        highest = int(np.argmax(curve.get_ydata()))
        assert curve.get_xdata()[highest] == pytest.approx(at)
        assert curve.get_ydata()[highest] == pytest.approx(radius)
    assert len(by_gid(ax, "order-")) == 3


@pytest.fixture(scope="module")
def speeds():
    at = np.linspace(1.0, 3.0, 9)
    x = np.sin(2 * np.pi * TURN)[:, None] * at + 0.3 * np.sin(2 * np.pi * TURN / 4)[:, None]
    ds = power_spectrum(x, rate=32).rename(lane="s")
    return ds.assign_coords(s=("s", at, {"units": "1", "long_name": "speed ratio"}))


def test_a_waterfall_has_a_line_for_each_speed_and_one_for_each_order(speeds):
    ax = draw_waterfall(speeds, "s", orders=ORDERS)
    rows = by_gid(ax, "spectrum")
    assert len(rows) == 9 and len(by_gid(ax, "order-")) == 3
    for row, s in zip(rows, speeds["s"].values, strict=True):
        highest = row.get_xdata()[np.argmax(row.get_ydata())]
        assert highest == pytest.approx(s, rel=1e-6)  # the mesh line lies on the mesh order
        assert row.get_ydata().min() == pytest.approx(s, abs=1e-3)


def test_order_lines_go_through_the_origin(speeds):
    for line in by_gid(draw_waterfall(speeds, "s", orders=ORDERS, clock=20.0), "order-"):
        x, y = line.get_data()
        name = str(line.get_gid()).removeprefix("order-")
        np.testing.assert_allclose(np.asarray(x) / np.asarray(y), 20 * abs(float(ORDERS[name])))


def test_ended_runs_are_left_out_and_said(speeds):
    part = speeds.copy(deep=True)
    part["power"][:, 3] = np.nan
    for kind in ("lines", "map"):
        ax = draw_waterfall(part, "s", kind=kind)
        assert "1 ended run left out" in ax.get_title(loc="left")
    assert len(by_gid(draw_waterfall(part, "s"), "spectrum")) == 8


def test_the_map_shows_the_mesh_line_at_every_speed(speeds):
    ax = draw_waterfall(speeds, "s", kind="map")
    (mesh,) = by_gid(ax, "map")
    level = np.asarray(mesh.get_array())
    edges = np.asarray(mesh.get_coordinates())[0, :, 0]
    at = (edges[1:] + edges[:-1])[np.argmax(level, axis=1)] / 2
    np.testing.assert_allclose(at, speeds["s"].values, atol=2 * np.diff(edges).max())
    assert -1 < level.max() <= 1e-9


def test_an_unknown_kind_is_refused(speeds):
    with pytest.raises(RangeError, match="lines"):
        draw_waterfall(speeds, "s", kind="3d")
