"""``whirlmap new``: a template that loads as it is, with every input of the model in it."""

import shlex

import pytest
from typer.testing import CliRunner

import whirlmap
from whirlmap.cases.case import names, read
from whirlmap.cases.template import template
from whirlmap.cli.main import app
from whirlmap.errors import CaseError

MACHINES = [n for n in names() if n.startswith("machines/") or n == "gear-psfd/machine"]


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
    stock = whirlmap.load(like).details
    for name, value in stock.switches.items():
        assert [line for line in lines if line.removeprefix("# ").startswith(f'{name} = "{value}"')], name
    assert not [line for line in lines if "value = 0," in line and line.startswith("#")]  # what is not in force is not shown


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
