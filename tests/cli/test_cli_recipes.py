"""The recipes: every command of each is run in an empty folder, as a reader would type them."""

import json
import shlex
from itertools import pairwise
from pathlib import Path

import pytest
from tests.cli.test_cli_contract import KEYS
from typer.testing import CliRunner

from whirlmap.cli import main
from whirlmap.cli.common.recipes import recipes

ROOT = Path(__file__).parents[2]
RECIPES = recipes()
SLOW = [pytest.mark.slow, pytest.mark.timeout(1200)]
#: Recipes of some seconds each, which are run with the long ones.
SECONDS = {"bifurcation-diagram", "branches"}


def run(line):
    return CliRunner(env={"COLUMNS": "160"}).invoke(main.app, shlex.split(line))


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=SLOW if one.long or name in SECONDS else []) for name, one in RECIPES.items()]
)
def test_its_commands_answer(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for line in RECIPES[name].commands:
        program, _, rest = line.partition(" ")
        assert program == "whirlmap"
        done = run(rest)
        assert done.exit_code == 0 and done.stdout.strip(), (line, done.output)
        written = [place for option, place in pairwise(shlex.split(line)) if option in ("--out", "--store")]
        assert all(Path(place).exists() for place in written), line


def test_there_are_ten_and_they_name_pages_and_keys_that_are_there():
    assert len(RECIPES) == 10
    for one in RECIPES.values():
        assert (ROOT / "docs" / one.page).is_file()
        promised = {key for line in one.commands for key in KEYS.get(line.split()[1], "").split()}
        assert one.keys and set(one.keys) <= promised, one.name


def test_they_are_listed_printed_and_told_to_programs():
    assert all(name in run("recipes").stdout for name in RECIPES)
    assert json.loads(run("recipes --json").stdout)["recipes"][0]["commands"] == list(RECIPES["label-one-point"].commands)
    one = run("recipes safe-speeds").stdout
    assert one == RECIPES["safe-speeds"].text and "    whirlmap speeds" in one
    assert one in run("recipes --all").stdout
    refused = run("recipes safe-speed")
    assert refused.exit_code == 2 and "Did you mean 'safe-speeds'?" in refused.stderr
    assert run("recipes safe-speeds --all").exit_code == 2
