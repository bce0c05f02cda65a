"""Former spellings of options work for one release, and the warning names the new one."""

import pytest

from whirlmap.cli.common.former_options import FORMER, with_new_spellings
from whirlmap.cli.main import loaded


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
    assert known.issuperset(FORMER[command].values()) and not known & set(FORMER[command])
