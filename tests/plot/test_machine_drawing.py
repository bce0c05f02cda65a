"""The picture of a machine from parts: everything stands where it is, at its size."""

import numpy as np
import pytest

from whirlmap.plot import machine_figure

PARTS = {
    "shafts": [
        {
            "name": "pinion", "speed": 100.0, "mass": 3.5, "lumped": False,
            "disks": [{"name": "fan", "z": 0.4, "m": 4.0, "I_p": 0.02}],
            "elements": [{"z": 0.0, "L": 0.1, "d": 0.05, "d_i": 0.0}, {"z": 0.1, "L": 0.3, "d": 0.06, "d_i": 0.02}],
        },
        {"name": "gear", "speed": -50.0, "mass": 40.0, "lumped": True, "disks": [], "elements": []},
    ],
    "bearings": [
        {"name": "left", "shaft": "pinion", "z": 0.0, "R": 0.025, "L": 0.02, "support": "", "load": 120.0},
        {"name": "right", "shaft": "pinion", "z": 0.3, "R": 0.025, "L": 0.02, "support": "frame", "load": None},
    ],
    "meshes": [{"name": "teeth", "driver": "pinion", "driven": "gear", "z": [0.1, 0.0], "teeth": [20, 40], "module": 3e-3}],
    "unbalances": [{"name": "u", "shaft": "pinion", "z": 0.4}],
    "couplings": [{"name": "motor", "shaft": "gear", "z": 0.0}],
}  # fmt: skip


@pytest.fixture(scope="module")
def figure():
    return machine_figure(PARTS, title="a machine")


def test_each_shaft_has_its_axis_in_mm(figure):
    pinion, gear = figure.axes
    assert pinion.get_title(loc="left") == "pinion: 954.93 rpm, 3.5 kg"
    assert gear.get_title(loc="left").startswith("gear: -477")
    assert gear.get_xlabel() == "distance from the first end [mm]"
    boxes = {(round(p.get_x(), 6), round(p.get_width(), 6), round(p.get_height(), 6)) for p in pinion.patches}
    assert {(0.0, 100.0, 50.0), (100.0, 300.0, 60.0), (100.0, 300.0, 20.0)} <= boxes  # elements, and the hole
    disk = next(p for p in pinion.patches if np.isclose(p.get_height(), 2e3 * np.sqrt(2 * 0.02 / 4.0)))
    assert disk.get_x() + disk.get_width() / 2 == pytest.approx(400.0)
    wheel = next(p for p in pinion.patches if np.isclose(p.get_height(), 60.0) and np.isclose(p.get_width(), 24.0))
    assert wheel.get_x() + wheel.get_width() / 2 == pytest.approx(100.0)  # pitch diameter 20 x 3 mm
    bearings = [p for p in pinion.patches if np.isclose(p.get_width(), 20.0)]
    assert {round(p.get_x() + 10) for p in bearings} == {0, 300} and len(bearings) == 4


def test_words_name_the_parts_and_their_loads(figure):
    words = [t.get_text() for ax in figure.axes for t in ax.texts]
    assert {"left\n120 N", "right\non frame", "teeth, 20 teeth", "u", "fan"} <= set(words)


def test_two_meshes_at_one_wheel_are_named_in_one_line():
    """A bull gear between two pinions."""
    second = {"name": "other", "driver": "pinion", "driven": "gear", "z": [0.1, 0.0], "teeth": [20, 50], "module": 3e-3}
    axes, gear = machine_figure({**PARTS, "meshes": [*PARTS["meshes"], second]}, title="a machine").axes
    assert "teeth, other, 20 teeth" in {text.get_text() for text in axes.texts}
    words = {text.get_text() for text in gear.texts}
    assert {"teeth, 40 teeth", "other, 50 teeth"} <= words  # two wheels side by side in one place, of two sizes
