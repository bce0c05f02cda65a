"""Each wrong machine has one clear message, which names file, table and key."""

import re

import pytest
from tests.machines.wrong_machines import GOOD, IDLER, WRONG, mesh

import whirlmap
from whirlmap.cases import read
from whirlmap.errors import CaseError


def written(folder, text):
    file = folder / "wrong.toml"
    file.write_text(text, encoding="utf-8")
    return file


def test_the_machine_that_they_are_made_of_loads(tmp_path):
    assert len(whirlmap.load(written(tmp_path, GOOD)).states) > 30


@pytest.mark.parametrize("fault", WRONG)
def test_the_message_names_file_table_and_key(tmp_path, fault):
    before, after, said = WRONG[fault]
    text = GOOD + after if before is None else GOOD.replace(before, after, 1)
    assert text != GOOD
    file = written(tmp_path, text)
    with pytest.raises(CaseError) as error:
        read(file)
    message = str(error.value)
    assert message.startswith(str(file)) and "\n" not in message
    for words in said:
        assert words in message, message


def test_one_module_in_two_units_is_one(tmp_path):
    two = IDLER + mesh("second", "pinion", "idler").replace('"3 mm"', '"0.3 cm"')
    assert len(whirlmap.load(written(tmp_path, GOOD + two)).states) > 50


def test_the_line_is_that_of_the_key_in_its_own_table(tmp_path):
    """The same key stands in four bearings."""
    file = written(tmp_path, GOOD.replace('c = "50 um"\n[[support]]', 'c = "50 kg"\n[[support]]'))
    with pytest.raises(CaseError) as error:
        read(file)
    line = int(re.search(r"line (\d+)", str(error.value))[1])
    assert file.read_text().splitlines()[line - 1] == 'c = "50 kg"'


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"shaft.pinion.m": "3 kg"}, "follows from the elements"),
        ({"bearing.drive_end.c": "-3 um"}, "must be above 0"),
        ({"bearing.driv_end.c": "3 um"}, "Did you mean 'bearing.drive_end.c'?"),
        ({"shaft.pinion.elements.5.d": "60 mm"}, "elements.1 to elements.2"),
        ({"bearing.drive_end.film": "long"}, "short | porous | printed"),
        ({"bearing.drive_end.c": "40"}, "drive_end.c"),
        ({"modes": "0"}, "found 'modes', a key of parts, expected the part as well: shaft.pinion.modes, shaft.gear.modes"),
        ({"K_m": "3 N/m"}, "expected the part as well: mesh.teeth.K_m"),
        ({"c": "50 um"}, "bearing.gear_other.c, bearing.c for all of these"),
    ],
)
def test_wrong_changes_say_what_is_wrong(tmp_path, changes, said):
    with pytest.raises(CaseError) as error:
        whirlmap.load(written(tmp_path, GOOD), **changes)
    assert said in str(error.value)
