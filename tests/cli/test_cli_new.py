"""``whirlmap new``: a template that loads as it is, with every input of the model in it."""

import re
import shlex

import pytest
from typer.testing import CliRunner

import whirlmap
from whirlmap.cases.case import STOCK, names, read
from whirlmap.cases.template import template
from whirlmap.cli.main import app
from whirlmap.errors import CaseError

FROM_PARTS = [n for n in names() if read(n).parts]
MACHINES = [n for n in names() if (n.startswith("machines/") or n == "gear-psfd/machine") and n not in FROM_PARTS]


def run(line):
    return CliRunner().invoke(app, shlex.split(line))


@pytest.mark.parametrize("like", MACHINES)
def test_a_template_is_the_machine_that_it_was_made_from(like, tmp_path):
    file = tmp_path / "mine.toml"
    assert run(f"new {file} --like {like}").exit_code == 0
    mine, stock = whirlmap.load(file), whirlmap.load(like)
    given = dict(mine.values)
    assert given.pop("s") == pytest.approx(stock.values["s"], rel=5e-4)  # a speed in rpm has four digits
    assert given == {name: value for name, value in stock.values.items() if name != "s"} and mine.start == stock.start
    text = file.read_text()
    groups = read(like).family.groups
    for q in groups.inputs:
        assert f"{q.name} = {{" in text and q.meaning in text, q.name


@pytest.mark.parametrize("like", MACHINES)
def test_a_template_has_a_speed_in_rpm_and_the_switches_in_force(like, tmp_path):
    file = tmp_path / "mine.toml"
    run(f"new {file} --like {like}")
    lines = file.read_text().splitlines()
    assert not [line for line in lines if line.startswith("s = ")]
    assert [line for line in lines if line.startswith("speed = ") and 'unit = "rpm"' in line]
    assert not [line for line in lines if 'unit = "rad/s"' in line]
    stock = whirlmap.load(like).machine
    for name, value in stock.switches.items():
        assert [line for line in lines if line.removeprefix("# ").startswith(f'{name} = "{value}"')], name
    assert not [line for line in lines if "value = 0," in line and line.startswith("#")]  # what is not in force is not shown


@pytest.mark.parametrize("like", FROM_PARTS)
def test_a_machine_from_parts_is_its_own_template(like, tmp_path):
    file = tmp_path / "mine.toml"
    assert run(f"new {file} --like {like}").exit_code == 0
    mine, stock = whirlmap.load(file), whirlmap.load(like)
    assert mine.values == stock.values and mine.model is stock.model


def test_the_template_from_parts_shows_every_table_with_comments(tmp_path):
    file = tmp_path / "mine.toml"
    assert run(f"new {file} --parts").exit_code == 0
    assert whirlmap.load(file).values == whirlmap.load("machines/two-shaft-gearbox").values
    text = file.read_text()
    for kind in ("shaft", "disk", "bearing", "support", "mesh", "coupling", "unbalance"):
        assert re.search(rf"^\[\[{kind}\]\]", text, re.MULTILINE)
    assert text.count("#") > 20
    done = run(f"new {tmp_path / 'other.toml'} --parts --like machines/jeffcott-rig")
    assert done.exit_code == 2 and "--like" in done.stderr and not (tmp_path / "other.toml").exists()


def test_what_exists_is_kept_and_other_suffixes_are_refused(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text("mine")
    for place, word in ((file, "--force"), (tmp_path / "mine.txt", ".toml"), (tmp_path / "a" / "b.toml", "a")):
        done = run(f"new {place}")
        assert done.exit_code == 2 and word in done.stderr
    assert file.read_text() == "mine"
    assert run(f"new {file} --force").exit_code == 0 and "gear_pair" in file.read_text()


def test_a_model_without_dimensions_has_no_template():
    with pytest.raises(CaseError, match="no dimensional inputs"):
        template(read("duffing"))


#: Comments that would be entries, switches or tables without their mark.
COMMENTED = re.compile(r"^# ?(?=[\w\[\]\"'-]+\s*(?:=|$))", re.MULTILINE)


def uncommented(text, folder):
    """The system of a file all of whose commented entries are taken for what they say, and how many there are."""
    more, count = COMMENTED.subn("", text)
    (folder / "all.toml").write_text(more)
    return whirlmap.load(folder / "all.toml"), count


@pytest.mark.parametrize("name", names())
def test_a_stock_case_says_nothing_else_in_its_comments(name, tmp_path):
    text = (STOCK / f"{name}.toml").read_text()
    system, _ = uncommented(text, tmp_path)
    assert system.values == whirlmap.load(name).values and system.model is whirlmap.load(name).model


@pytest.mark.parametrize("name", [*MACHINES, "gear-psfd/reference", "gear-psfd/literal"])
def test_a_template_is_the_same_machine_without_its_comment_marks(name, tmp_path):
    text = template(read(name))
    (tmp_path / "mine.toml").write_text(text)
    (system, count), mine = uncommented(text, tmp_path), whirlmap.load(tmp_path / "mine.toml")
    assert count >= 1 and system.values == mine.values and system.model is mine.model
    assert system.machine.switches == mine.machine.switches
    stock = whirlmap.load(name)
    assert {k: v for k, v in mine.values.items() if k != "s"} == {k: v for k, v in stock.values.items() if k != "s"}


@pytest.mark.parametrize("name", ["gear-psfd/intended", "gear-psfd/literal-best", "jeffcott"])
def test_a_case_without_dimensions_is_no_machine_to_begin_with(name, tmp_path):
    done = run(f"new {tmp_path / 'a.toml'} --like {name}")
    assert done.exit_code == 2 and "no speed in rpm follows; expected a machine" in done.stderr
    assert not list(tmp_path.iterdir())
