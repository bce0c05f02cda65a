"""The system of a result is had again from what the result carries."""

import json
from typing import Any

import numpy as np
import pytest
import xarray as xr

import whirlmap
from whirlmap.errors import InputError
from whirlmap.explorer.control import controls_of, system_at
from whirlmap.explorer.exploration import of_result, opened
from whirlmap.explorer.recorded_system import recorded_system
from whirlmap.integrate.loading import pieces
from whirlmap.results.provenance import provenance


@pytest.mark.parametrize(
    ("case", "changes"),
    [
        ("duffing", {"gamma": 0.29}),
        ("gear-psfd/machine", {"mu": "0.02 Pa*s", "s": 2.5}),
        ("gear-psfd/intended", {"psi": 0.0, "arc": "positive", "r_p": "1/5"}),
        ("machines/turbo-gearbox", {"c": "70 um"}),
        ("machines/two-shaft-gearbox", {}),
    ],
)
def test_every_number_is_the_same(case: str, changes: dict[str, Any]) -> None:
    system = whirlmap.load(case, **changes)
    again = recorded_system(provenance(pieces(system)), "a file")
    assert dict(again.values) == dict(system.values)
    assert again.machine is not None
    assert system.machine is not None
    assert dict(again.machine.given) == dict(system.machine.given)
    assert again.model.switches == system.model.switches
    assert pieces(again).model_hash == pieces(system).model_hash


def test_another_case_of_that_name_is_refused() -> None:
    attributes = dict(provenance(pieces(whirlmap.load("duffing"))))
    with pytest.raises(InputError, match="the equations"):
        recorded_system(attributes | {"model_hash": "another"}, "a file")
    with pytest.raises(InputError, match="--case"):
        recorded_system(attributes | {"case": "gone.toml"}, "a file")
    with pytest.raises(InputError, match="found no case"):
        recorded_system({}, "a file")


def test_what_is_no_map_is_refused(tmp_path: Any) -> None:
    with pytest.raises(InputError, match="no labelled points"):
        of_result(xr.Dataset(), "a file")
    with pytest.raises(InputError, match="no store"):
        opened(str(tmp_path))
    assert opened("duffing") is None


def test_values_of_inputs_have_their_unit() -> None:
    system = whirlmap.load("gear-psfd/machine")
    controls = controls_of(system, {"s": ([0.5, 2.0], "1"), "c": ([40.0, 60.0], "um")})
    assert controls["c"].unit == "um"
    assert controls["s"].shown_unit == "rpm"
    made = system_at(system, controls, {"c": 45.0, "s": 1.5})
    assert dict(made.values) == dict(whirlmap.load("gear-psfd/machine", c="45 um", s=1.5).values)
    groups = [name for name, note in system.notes.items() if note.startswith("group")]
    assert not set(groups) & set(controls)  # they follow from the inputs
    assert json.dumps([c.symbol for c in controls.values()], ensure_ascii=False).count("\\") == 0


def test_the_speed_stands_beside_an_input_in_a_map() -> None:
    system = whirlmap.load("machines/jeffcott-rig")
    controls = controls_of(system, {"speed": ([100.0, 600.0], "rad/s"), "c": ([40.0, 80.0], "um")})
    assert (controls["speed"].unit, controls["c"].unit) == ("rad/s", "um")
    made = system_at(system, controls, {"speed": 300.0, "c": 60.0})
    assert dict(made.values) == dict(whirlmap.load("machines/jeffcott-rig", speed="300 rad/s", c="60 um").values)


@pytest.mark.parametrize(
    ("values", "log"),
    [
        (np.geomspace(0.01, 0.2, 12), True), (np.linspace(0.01, 0.2, 12), False), (np.geomspace(1, 100, 3), True),
        ([1.0, 40.0], True), ([1.0, 20.0], False), (np.linspace(0.0, 1.0, 5), False), (np.linspace(1.0, 100.0, 40), False),
    ],
)  # fmt: skip
def test_axes_in_equal_ratios_are_logarithmic(values, log) -> None:
    assert controls_of(whirlmap.load("duffing"), {"gamma": (list(values), "1")})["gamma"].log is log
