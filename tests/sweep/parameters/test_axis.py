"""Dimensional inputs on the axes of diagrams and maps: in their unit, with every group that follows."""

import numpy as np
import pytest

import whirlmap
from whirlmap.errors import InputError, RangeError
from whirlmap.integrate.ranges import Range
from whirlmap.plot.figures.diagnosis_figure import diagram_figure
from whirlmap.plot.figures.regime_map import regime_map_figure
from whirlmap.sweep.diagrams.in_batches import diagram_in_batches
from whirlmap.sweep.parameters.axis import Axis, read_axis

SHORT = {"settling": whirlmap.Settling(transient=20, most=4, keep=8), "lyapunov": 0, "steps": 32}


@pytest.fixture(scope="module")
def rig():
    return whirlmap.load("machines/jeffcott-rig")


@pytest.fixture(scope="module")
def diagram(rig):
    return whirlmap.bifurcation_diagram(rig, "c", "80um:120um:5", **SHORT)


def test_a_diagram_over_the_clearance_is_in_its_unit(rig, diagram):
    np.testing.assert_array_equal(diagram["c"], [80, 90, 100, 110, 120])
    assert diagram["c"].attrs["units"] == "um" and "clearance" in diagram["c"].attrs["long_name"]
    assert {"s", "Gamma", "k"} <= set(diagram.coords) and diagram["Gamma"].dims == ("c",)


def test_its_points_are_those_of_the_machine_with_that_clearance(diagram):
    machine = whirlmap.load("machines/jeffcott-rig", c="90 um")
    alone = whirlmap.label_points(machine, {"s": [float(machine.values["s"])]}, **SHORT)
    for name in ("regime", "maximum", "rms", "settled_after"):
        np.testing.assert_array_equal(diagram[name].values[1], alone[name].values[0], err_msg=name)


def test_lengths_are_those_of_each_clearance(rig, diagram):
    shown, swing = whirlmap.in_units(rig, diagram), diagram["peak_to_peak"].sel(quantity="y").values
    np.testing.assert_allclose(shown["peak_to_peak"].sel(quantity="y"), swing * diagram["c"].values, rtol=1e-12)
    np.testing.assert_array_equal(shown["c"], diagram["c"])
    np.testing.assert_allclose(shown["s"], 1800.0, rtol=1e-12)  # the speed stays: s counts another one
    figure = diagram_figure(shown, ["y"], columns=1, title="")
    assert "clearance" in figure.axes[-1].get_xlabel() and "um" in figure.axes[-1].get_xlabel().replace("μ", "u")


@pytest.mark.parametrize("follow", [None, "up", "both"])
def test_batches_give_the_same_diagram(rig, follow):
    values = ["80 um", "90 um", "100 um", "110 um"]
    whole = whirlmap.bifurcation_diagram(rig, "c", values, follow=follow, **SHORT)
    parts = diagram_in_batches(rig, "c", values, follow=follow, batch=3, **SHORT).run().dataset
    assert set(parts.coords) == set(whole.coords)
    for name in (*whole.data_vars, *whole.coords):
        np.testing.assert_array_equal(parts[name], whole[name], err_msg=name)


def test_a_map_over_clearance_and_viscosity_has_the_points_of_the_machines(rig, tmp_path):
    vary = {"c": Range("c", 80, 120, 3, unit="um"), "mu": ["10 mPa*s", "20 mPa*s"]}
    ds = whirlmap.regime_map(rig, vary, store=tmp_path / "m", chunk=4, **SHORT)
    assert ds["regime"].dims == ("c", "mu") and ds["mu"].attrs["units"] == "mPa*s"
    machine = whirlmap.load("machines/jeffcott-rig", c="100 um", mu="20 mPa*s")
    alone = whirlmap.label_points(machine, {"s": [float(machine.values["s"])]}, **SHORT)
    np.testing.assert_array_equal(ds["maximum"].values[1, 1], alone["maximum"].values[0])
    shown = whirlmap.in_units(rig, ds.load())
    swing = ds["peak_to_peak"].sel(quantity="y").values
    np.testing.assert_allclose(shown["peak_to_peak"].sel(quantity="y"), swing * ds["c"].values[:, None], rtol=1e-12)
    assert regime_map_figure(shown, "y", title="").axes[0].get_xlabel()
    with pytest.raises(whirlmap.errors.OutputError, match="values of c"):
        other = vary | {"c": Range("c", 80, 120, 3, unit="mil")}
        whirlmap.regime_map(rig, other, store=tmp_path / "m", resume=True, **SHORT)


def test_a_parameter_beside_an_input_does_not_follow_it(rig):
    ds = whirlmap.regime_map(rig, {"c": ["80 um", "120 um"], "s": [0.5, 0.6]}, **SHORT)
    machine = whirlmap.load("machines/jeffcott-rig", c="120 um").replace(s=0.6)
    alone = whirlmap.label_points(machine, {"s": [0.6]}, **SHORT)
    np.testing.assert_array_equal(ds["maximum"].values[1, 1], alone["maximum"].values[0])
    assert whirlmap.in_units(rig, ds)["s"].attrs["units"] == "1"  # another speed at each clearance


def test_a_speed_beside_an_input_is_the_same_speed_for_all_its_values(rig):
    """What s = 1 is follows from the clearance."""
    ds = whirlmap.regime_map(rig, {"c": ["80 um", "120 um"], "speed": "1500rpm:1800rpm:2"}, **SHORT)
    assert ds["regime"].dims == ("c", "speed") and ds["speed"].attrs["units"] == "rpm"
    machine = whirlmap.load("machines/jeffcott-rig", c="120 um", speed="1500 rpm")
    alone = whirlmap.label_points(machine, {"s": [float(machine.values["s"])]}, **SHORT)
    np.testing.assert_array_equal(ds["maximum"].values[1, 0], alone["maximum"].values[0])
    mine, whole = whirlmap.in_units(rig, ds), whirlmap.in_units(machine, alone)  # velocities too are those of each machine
    assert mine["peak_to_peak"].attrs["unit_of_each"] == whole["peak_to_peak"].attrs["unit_of_each"]
    np.testing.assert_allclose(mine["peak_to_peak"].values[1, 0], whole["peak_to_peak"].values[0], rtol=1e-12)
    assert ds["s"].dims == ("c", "speed") and ds["s"].values[1, 0] == float(machine.values["s"])


def test_speeds_become_values_of_s(rig):
    name, values, unit = read_axis(rig, "speed", ["900 rpm", "1800 rpm"])
    assert (name, unit) == ("s", "") and values[1] == pytest.approx(float(rig.values["s"]), rel=1e-12)
    assert read_axis(rig, "speed", "900rpm:1800rpm:2")[1] == pytest.approx(values)


@pytest.mark.parametrize(
    ("name", "values", "error", "said"),
    [
        ("c", [80.0, 90.0], RangeError, "expected values with their unit, such as"),
        ("c", ["80 um", "90 mm"], RangeError, "found the units mm, um, expected one"),
        ("c", ["90 um", "80 um"], RangeError, "must be finite and ascend"),
        ("Gamma", ["80 um", "90 um"], InputError, "Gamma has no dimension"),
        ("clearence", ["80 um", "90 um"], RangeError, "no parameter 'clearence'"),
        ("limit", ["80 um", "90 um"], RangeError, "changes nothing"),
    ],
)
def test_what_cannot_be_varied_is_refused(rig, name, values, error, said):
    with pytest.raises(error, match=said):
        Axis.of(rig, name, values)
