"""Former spellings of options work for one release, and the warning names the new one."""

import pytest

from whirlmap.cli.common import former_options
from whirlmap.cli.common.former_options import FORMER, SHARED
from whirlmap.cli.common.messages import given_twice, taking_values
from whirlmap.cli.main import loaded


def with_new_spellings(command, words):
    return former_options.with_new_spellings(command, words, taking_values(loaded(command).params))


def test_a_former_spelling_is_replaced_and_warned_of_once(capsys):
    found = with_new_spellings("speeds", ["rig", "--tolerance", "c=5%", "--tolerance=M=10%", "--", "--tolerance"])
    assert found == ["rig", "--input-tolerance", "c=5%", "--input-tolerance=M=10%", "--", "--tolerance"]
    said = capsys.readouterr().err
    assert said.count("warning: --tolerance is now --input-tolerance") == 1 and said.count("\n") == 1


def test_other_commands_keep_their_options(capsys):
    words = ["duffing", "--vary", "gamma=0.2:0.3:4", "--tolerance", "1e-6", "--points", "3"]
    assert with_new_spellings("bifurcation", words) == words and not capsys.readouterr().err


@pytest.mark.parametrize("command", FORMER)
def test_the_new_spellings_exist_and_the_former_ones_are_not_shown(command):
    known = {name for p in loaded(command).params for name in p.opts}
    former = {name for name in FORMER[command] if (command, name) not in SHARED}
    assert known.issuperset(FORMER[command].values()) and not known & former


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("diagnose", ["duffing", "--title", "--points", "--set", "--points=3"]),
        ("diagnose", ["duffing", "--title=--points"]),
        ("speeds", ["rig", "--title", "--tolerance", "--quiet"]),
        ("identify", ["--out", "--refine"]),
    ],
)
def test_a_value_that_looks_like_a_former_option_is_a_value(command, words, capsys):
    assert with_new_spellings(command, words) == words and not capsys.readouterr().err


def test_a_value_that_looks_like_an_option_is_not_given_twice():
    given_twice(loaded("diagnose").params, ["duffing", "--set", "--title", "--title", "a", "--title", "a"])


def test_the_tolerance_of_returns_is_that_of_other_commands(capsys):
    words = ["rig", "--tolerance", "1e-6", "--tolerance=1e-5", "--quiet"]
    assert with_new_spellings("speeds", words) == words and not capsys.readouterr().err
    both = with_new_spellings("speeds", ["rig", "--tolerance", "c=5%", "--tolerance", "1e-5"])
    assert both == ["rig", "--input-tolerance", "c=5%", "--tolerance", "1e-5"]
    labelling = loaded("bifurcation"), loaded("speeds"), loaded("improve"), loaded("attractors"), loaded("basins")
    assert all("--tolerance" in taking_values(command.params) for command in labelling)
