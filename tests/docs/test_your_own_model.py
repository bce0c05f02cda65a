"""The page on a model of one's own: its code blocks, run as a reader would run them."""

import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

import whirlmap

PAGE = Path(__file__).parents[2] / "docs" / "your_own_model.md"


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The two files of the page, in a folder of their own, which is the current one."""
    model, _session = blocks("python")
    (case,) = blocks("toml")
    (tmp_path / "loose_pedestal.py").write_text(model, encoding="utf-8")
    (tmp_path / "my_case.toml").write_text(case, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_model_is_short_and_names_its_files():
    model, _ = blocks("python")
    code = [line for line in model.splitlines() if line.strip() and not line.startswith(('"""', "from"))]
    assert len(code) <= 20
    text = PAGE.read_text(encoding="utf-8")
    assert "`loose_pedestal.py`" in text
    assert "`my_case.toml`" in text


def test_it_loads_and_moves(folder):
    system = whirlmap.load("my_case.toml")
    assert system.states == ("y", "v")
    assert system.start == {"y": -1.0}
    # Pressed: full stiffness. Lifted: a fifth of it. Both against the weight.
    for y, support in ((-0.5, -0.5), (2.0, 0.4)):
        rates = system.rhs(0.0, [y, 0.3])
        assert rates == pytest.approx([0.3, 1.7**2 - 2 * 0.05 * 0.3 - support - 1])


def test_the_commands_of_the_page_are_commands():
    from whirlmap.cli.main import app

    lines = [line for block in blocks("console") for line in block.splitlines()]
    assert len(lines) == 3
    for line in lines:
        help_text = CliRunner().invoke(app, [line.split()[1], "--help"], env={"COLUMNS": "200", "NO_COLOR": "1"})
        assert help_text.exit_code == 0
        for option in re.findall(r"--[a-z]+", line):
            assert option in help_text.output


def test_diagnose_finds_what_the_page_says(folder):
    from whirlmap.cli.main import app

    result = CliRunner().invoke(app, ["diagnose", "my_case.toml", "--json", "--quiet", "--max-periods", "60"])
    assert result.exit_code == 0, result.output
    verdict = json.loads(result.stdout)
    assert "period 2T" in PAGE.read_text(encoding="utf-8")
    assert (verdict["regime"], verdict["period"]) == ("periodic", 2)


def test_the_python_session_runs(folder):
    _, session = blocks("python")
    names = {}
    exec(session, names)
    assert names["system"].values["zeta"] == 0.04
    assert names["diagram"].sizes["Omega"] == 3
    assert int(names["verdict"]["period_T"]) == 2
