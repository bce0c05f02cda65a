"""Switches of a case in a page, which choose terms of the model by words; and the units in which inputs are written."""

import pytest

import whirlmap
from whirlmap.errors import InputError
from whirlmap.explorer.control import system_at
from whirlmap.explorer.exploration import Exploration
from whirlmap.explorer.exports import commands, script
from whirlmap.explorer.limits import Refused
from whirlmap.explorer.motion import motion
from whirlmap.explorer.page_data import page_data
from whirlmap.explorer.saved.saved_page import saved_data
from whirlmap.explorer.session import Session


@pytest.fixture(scope="module")
def rig() -> Exploration:
    return Exploration(whirlmap.load("machines/jeffcott-rig"), {})


def test_switches_are_controls_with_their_words(rig: Exploration) -> None:
    controls = {c["name"]: c for c in page_data(rig)["controls"]}
    assert (controls["arc"]["value"], controls["arc"]["choices"]) == ("positive", ["fixed", "positive"])
    assert "choices" not in controls["c"]
    assert not any("choices" in c for c in page_data(Exploration(whirlmap.load("duffing"), {}))["controls"])


def test_a_switch_chooses_the_terms_that_loading_chooses(rig: Exploration) -> None:
    values = {"arc": "fixed", "c": 9e-5}
    found = system_at(rig.system, rig.controls, values)
    want = whirlmap.load("machines/jeffcott-rig", arc="fixed", c="90 um")
    assert found.model is want.model
    assert found.values == pytest.approx(want.values)
    assert "--set arc=fixed" in commands(rig, values)[0]
    assert ", arc='fixed'" in script(rig, values, motion(found, rig.labelling))


def test_a_switch_that_changes_the_states_is_refused_with_what_to_do(rig: Exploration) -> None:
    with pytest.raises(InputError, match=r"^rotor = rigid, arc = fixed: .* with --set rotor=rigid --set arc=fixed$"):
        system_at(rig.system, rig.controls, {"rotor": "rigid", "arc": "fixed"})


@pytest.mark.parametrize("values", [{"arc": "open"}, {"arc": 1}, {"c": "fixed"}, {"film": "porous"}, {"arc": ["fixed"]}])
def test_unknown_words_are_refused(rig: Exploration, values: dict) -> None:
    with Session(rig) as session, pytest.raises(Refused) as found:
        session.motion({"values": values})
    assert found.value.status == 422


def test_inputs_are_written_in_the_unit_of_the_case(rig: Exploration) -> None:
    c, k = rig.controls["c"], rig.controls["K"]
    assert (c.shown_unit, c.value * c.shown_size) == ("um", pytest.approx(100))
    assert (k.shown_unit, k.value * k.shown_size) == ("N/mm", pytest.approx(38.7))
    speed = Exploration(whirlmap.load("machines/two-shaft-gearbox"), {}).controls["speed"]
    assert (speed.shown_unit, speed.value * speed.shown_size) == ("rpm", pytest.approx(9000))


def test_a_script_names_inputs_of_parts(rig: Exploration) -> None:
    e = Exploration(whirlmap.load("machines/two-shaft-gearbox"), {})
    m = motion(rig.system, rig.labelling)  # of any system: the changes alone are asked
    text = script(e, {"shaft.pinion.m": 17.0}, m)
    compile(text, "motion.py", "exec")
    assert "**{'shaft.pinion.m': '17.0 kg'}" in text


def test_a_saved_page_has_no_switches(rig: Exploration) -> None:
    assert saved_data(rig)[0]["page"]["controls"] == []
