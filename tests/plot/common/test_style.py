"""The house style: limits, symbols, colours, saving, and no trace in matplotlib's settings."""

import sys

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import to_rgb

from whirlmap.errors import OutputError
from whirlmap.plot import draw_section, encode, save
from whirlmap.plot.common.labels import symbol
from whirlmap.plot.common.limits import cell_edges, is_log, limits, markersize, runs
from whirlmap.plot.common.style import REGIMES, UNFINISHED, look_of
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status


@pytest.mark.parametrize(
    ("name", "latex"),
    [
        ("yp", "$y_{p}$"), ("u1x", "$u_{1x}$"), ("vx1", "$v_{x1}$"), ("x", "$x$"), ("psi", r"$\psi$"),
        ("eps_1", r"$\varepsilon_{1}$"), ("Gamma_2", r"$\Gamma_{2}$"),
        ("speed", r"$\mathrm{speed}$"), ("F_ah", "$F_{ah}$"),
        ("mu", r"$\mu$"), ("xi_p", r"$\xi_{p}$"),
    ],
)  # fmt: skip
def test_names_become_symbols(name, latex):
    assert symbol(name) == latex


@pytest.mark.parametrize("values", [[0.5, 0.5 + 1e-11], [0.0], [1e-16, -1e-16], [], [np.nan], [3.0, np.inf]])
def test_limits_are_finite_and_never_shorter_than_rounding(values):
    low, high = limits(values, others=1.0)
    assert np.isfinite([low, high]).all() and high - low > 1e-7


def test_limits_know_how_far_the_motion_swings():
    low, high = limits([0.5, 0.5 + 1e-11], amplitude=2.0)
    assert high - low >= 0.1
    assert limits([0.0, 1.0], amplitude=2.0) == pytest.approx((-0.05, 1.05))


def test_cells_reach_half_way_to_their_neighbours():
    np.testing.assert_allclose(cell_edges([1, 2, 4]), [0.5, 1.5, 3, 5])
    np.testing.assert_allclose(cell_edges([1, 100], log=True), [0.1, 10, 1000])
    assert np.diff(cell_edges([3.0]))[0] > 0


def test_logarithmic_values_are_recognised():
    assert is_log(np.geomspace(0.1, 10, 7)) and not is_log(np.linspace(0.1, 10, 7)) and not is_log([1.0])


def test_runs_of_equal_neighbours():
    assert runs(["a", "a", "b", "a"]) == [(0, 1), (2, 2), (3, 3)]


def test_the_few_points_of_a_periodic_orbit_are_large():
    few = np.tile([0.0, 1.0], 500) + 1e-11 * np.arange(1000)
    many = np.linspace(0, 1, 1000)
    assert markersize(few, few, (1, 1)) > 4 > markersize(many, many, (1, 1))


def test_every_regime_has_its_own_look():
    assert set(REGIMES) == set(Regime)
    looks = [*REGIMES.values(), *UNFINISHED.values()]
    assert len({(look.colour, look.hatch) for look in looks}) == len(looks)
    assert len({look.marker for look in looks}) == len(looks)
    assert look_of(Regime.undecided, Status.unresolved).label == "unresolved"
    assert look_of(Regime.contact, Status.contact).label == "contact"


def test_regimes_are_told_apart_in_grey_or_by_hatch():
    solid = [look for look in REGIMES.values() if not look.hatch]
    grey = sorted(np.dot(to_rgb(look.colour), [0.299, 0.587, 0.114]) for look in solid)
    assert np.diff(grey).min() > 0.02


def test_drawing_leaves_no_trace(chaos, tmp_path):
    before = dict(mpl.rcParams)
    pyplot = "matplotlib.pyplot" in sys.modules
    save(draw_section(chaos["section"], "x").figure, tmp_path / "a.png")
    assert dict(mpl.rcParams) == before
    assert ("matplotlib.pyplot" in sys.modules) == pyplot


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_the_same_figure_gives_the_same_bytes(chaos, tmp_path, suffix):
    first, second = (draw_section(chaos["section"], "x").figure for _ in range(2))
    path = save(first, tmp_path / f"a.{suffix}")
    assert path.read_bytes() == encode(second, suffix)
    assert [p.name for p in tmp_path.iterdir()] == [f"a.{suffix}"]


@pytest.mark.parametrize(("name", "message"), [("a.jpg", "ends in"), ("a", "ends in"), ("no/a.png", "does not exist")])
def test_places_that_cannot_be_written_are_refused(chaos, tmp_path, name, message):
    with pytest.raises(OutputError, match=message):
        save(draw_section(chaos["section"], "x").figure, tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_a_folder_in_the_way_leaves_nothing_behind(chaos, tmp_path):
    (tmp_path / "a.png").mkdir()
    with pytest.raises(OutputError, match="found a folder"):
        save(draw_section(chaos["section"], "x").figure, tmp_path / "a.png")
    assert [p.name for p in tmp_path.iterdir()] == ["a.png"]
