"""Pictures in a notebook: they show themselves, the user's settings stay, and a page says what there is."""

import doctest
import re
import sys
from pathlib import Path

import matplotlib as mpl
import pytest
from matplotlib.figure import Figure

import whirlmap
from whirlmap.plot import diagnosis_figure, draw_phase_portrait, draw_section, encode
from whirlmap.plot.common.style import HOUSE

PAGE = Path(__file__).parents[2] / "docs" / "figures.md"
PNG = b"\x89PNG"


def test_a_picture_shows_itself_without_pyplot(periodic):
    pyplot = "matplotlib.pyplot" in sys.modules
    axes = draw_phase_portrait(periodic["series"], "x")
    assert axes._repr_png_().startswith(PNG) and axes.figure._repr_png_().startswith(PNG)
    figure = diagnosis_figure(periodic["series"], "x")
    assert isinstance(figure, Figure) and figure._repr_png_().startswith(PNG)
    assert ("matplotlib.pyplot" in sys.modules) == pyplot


def test_axes_of_the_user_stay_theirs(periodic):
    axes = Figure().add_subplot()
    assert draw_phase_portrait(periodic["series"], "x", ax=axes) is axes and not hasattr(axes, "_repr_png_")


def test_settings_of_the_user_stay(periodic):
    house = draw_section(periodic["section"], "x")
    assert house.xaxis.label.get_size() == HOUSE["axes.labelsize"] and not house.spines["top"].get_visible()
    with mpl.rc_context({"font.size": 16, "axes.linewidth": 2.0, "axes.labelsize": 20, "figure.figsize": (3, 2)}):
        own = draw_section(periodic["section"], "x")
    assert own.spines["left"].get_linewidth() == 2.0 and not own.spines["top"].get_visible()
    assert own.xaxis.label.get_size() == 20 and tuple(own.figure.get_size_inches()) == (3, 2)
    assert own._left_title.get_size() == pytest.approx(2 * HOUSE["axes.titlesize"])  # follows the font
    assert mpl.rcParams["font.size"] == mpl.rcParamsDefault["font.size"]


def test_dots_per_inch_of_the_user_count(periodic):
    figure = draw_section(periodic["section"], "x").figure
    with mpl.rc_context({"savefig.dpi": 50}):
        small = encode(figure, "png")
    assert width(encode(figure, "png")) == 4 * width(small) == 2 * width(encode(figure, "png", dpi=100))


def width(png):
    return int.from_bytes(png[16:20], "big")


def test_the_page_has_every_public_function():
    public = {name for name, value in vars(whirlmap.plot).items() if callable(value) and not name.startswith("_")}
    assert len(public) > 25
    text = PAGE.read_text(encoding="utf-8")
    named = set(re.findall(r"`(\w+)[`(]", text))
    assert public <= named
    for row in (line.split("|") for line in text.splitlines() if line.startswith("| `")):
        for source in re.findall(r"`(\w+)`", row[3]):
            assert source in whirlmap.__all__, source


def test_examples_of_the_page_and_the_package_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (session,) = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    exec(session, {})
    assert (tmp_path / "portrait.png").read_bytes().startswith(PNG)
    tried = doctest.testmod(whirlmap.plot)
    assert tried.attempted >= 4 and not tried.failed
