"""Pictures of regime maps: every kind of point has its look, and the axes are those of the parameters."""

import numpy as np
import pytest
import xarray as xr

from whirlmap.errors import RangeError
from whirlmap.plot import draw_regime_map, draw_shares, encode, regime_map_figure
from whirlmap.plot.figures.regime_map import LOOKS, codes, regime_line_figure
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status


@pytest.fixture
def made() -> xr.Dataset:
    """A map with every kind of point: the regime by column, amplitudes that rise along psi."""
    s, psi = np.linspace(0.5, 2.0, 11), np.geomspace(1e-4, 1.0, 9)
    regime = np.repeat([1, 1, 1, 1, 1, 2, 3, 4, 5, 0, 0], 9).reshape(11, 9)
    status = np.repeat([0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 0], 9).reshape(11, 9)
    period = np.repeat([1, 2, 4, 8, 16, 0, 0, 0, 0, 0, 0], 9).reshape(11, 9)
    evaluation = np.ones((11, 9), dtype=int)
    evaluation[10, 0] = 0
    height = np.where(status == 0, np.log10(psi)[None, :] + 5.0 + 0 * s[:, None], np.nan)[:, :, None]
    dims = ("s", "psi")
    return xr.Dataset(
        {"regime": (dims, regime), "status": (dims, status), "period_common": (dims, period),
         "evaluation": (dims, evaluation),
         "peak_to_peak": ((*dims, "quantity"), height)},
        {"s": ("s", s, {"units": "1", "long_name": "speed ratio"}), "psi": ("psi", psi, {"units": "1"}), "quantity": ["yp"]},
    )  # fmt: skip


def test_every_kind_of_point_has_its_look(made):
    names = [LOOKS[k].label for k in codes(made)[:, 0]]
    assert names == [
        "periodic, 1", "periodic, 2", "periodic, 3 to 4", "periodic, 5 to 8", "periodic, longer", "quasi-periodic",
        "chaotic", "contact", "diverged", "unresolved", "not reached",
    ]  # fmt: skip
    assert Status.failed and len({look.label for look in LOOKS}) == len(LOOKS)
    # periodic in five, two ends, what was not reached; `not_steady` is of signals
    assert len(LOOKS) == len(Regime) - 2 + 5 + 2 + 1


def test_axes_and_cells_are_the_parameters(made):
    ax = draw_regime_map(made, "yp")
    assert ax.get_xscale() == "linear" and ax.get_yscale() == "log"
    assert "speed ratio" in ax.get_xlabel() and r"\psi" in ax.get_ylabel()
    (mesh,) = [c for c in ax.collections if c.get_gid() == "regimes"]
    np.testing.assert_array_equal(mesh.get_array().reshape(9, 11), codes(made).T)


def test_shares_add_up(made):
    ax = draw_shares(made, "s")
    bands = [c for c in ax.collections if c.get_gid()]
    assert {b.get_gid() for b in bands} == {LOOKS[k].label for k in np.unique(codes(made))}
    assert ax.get_ylim() == (0, 1)
    sideways = draw_shares(made, "psi", vertical=True)
    assert sideways.get_yscale() == "log" and sideways.get_xlim() == (0, 1)


def test_contours_are_of_the_amplitude_and_short_ones_are_left_out(made):
    smooth = made.isel(s=slice(0, 7)).interp(s=np.linspace(0.5, 1.3, 60), psi=np.geomspace(1e-4, 1, 50))
    for name in ("regime", "status", "period_common", "evaluation"):
        smooth[name] = smooth[name].fillna(0).astype(int)
    smooth["peak_to_peak"] = (np.log10(smooth["psi"]) + 5 + 0 * smooth["peak_to_peak"]).fillna(0)
    smooth["peak_to_peak"] = smooth["peak_to_peak"].transpose("s", "psi", "quantity")
    fig = regime_map_figure(smooth, "yp")
    lines = [c for c in fig.axes[0].collections if type(c).__name__ == "QuadContourSet" and not c.filled]
    heights = np.log10(np.concatenate([p.vertices for p in lines[0].get_paths()])[:, 1]) + 5
    for height in heights[::25]:
        assert np.abs(lines[0].levels - height).min() < 0.01


@pytest.mark.parametrize("form", ["png", "svg"])
def test_the_figure_is_drawn_the_same_each_time(made, form):
    assert encode(regime_map_figure(made, "yp", title="x"), form) == encode(regime_map_figure(made, "yp", title="x"), form)


def test_gaps_of_a_refined_map_are_bridged_by_the_contours(made):
    refined = made.isel(s=slice(0, 7)).copy(deep=True)
    refined["evaluation"][1::2] = 2
    refined["peak_to_peak"][1::2] = np.nan
    assert [c for c in draw_regime_map(refined, "yp").collections if type(c).__name__ == "QuadContourSet"]


def test_a_line_has_a_picture_of_its_own_and_more_dimensions_are_refused(made):
    assert len(regime_line_figure(made.isel(psi=0).drop_vars("psi"), "yp").axes) == 2
    with pytest.raises(RangeError, match="two dimensions"):
        draw_regime_map(made.isel(psi=0))
