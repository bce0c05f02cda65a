"""The page on a model of one's own: its code blocks, run as a reader would run them."""

import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

import whirlmap
from whirlmap import equations
from whirlmap.equations.allowed import _WAYS_OUT, FUNCTIONS, STEPS
from whirlmap.errors import CaseError, ModelError

PAGE = Path(__file__).parents[2] / "docs" / "your_own_model.md"


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The two files of the page, in a folder of their own, which is the current one."""
    model, _session, _spool = blocks("python")
    case, _ = blocks("toml")
    (tmp_path / "loose_pedestal.py").write_text(model, encoding="utf-8")
    (tmp_path / "my_case.toml").write_text(case, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_model_is_short_and_names_its_files():
    model, _, _ = blocks("python")
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
    assert len(lines) == 6
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
    _, session, _ = blocks("python")
    names = {}
    exec(session, names)
    assert names["system"].values["zeta"] == 0.04
    assert names["diagram"].sizes["Omega"] == 3
    assert int(names["verdict"]["period_T"]) == 2


def table(title):
    """Rows of a table of the page, cell by cell."""
    text = PAGE.read_text(encoding="utf-8")
    rows = text[text.index(f"| {title} |") :].split("\n\n")[0].splitlines()[2:]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]


def declare(folder, force):
    """A model whose force is an expression, as somebody would write it into a file."""
    (folder / "mine.py").write_text(f"""
import math
import numpy as np
from scipy.interpolate import interp1d
from sympy import *
from whirlmap.equations import *
y, v, k = State("y", "1", "y"), State("v", "1", "v"), Parameter("k", "1", "stiffness")
MINE = Model("mine", (y, v), (k,), {{y: v, v: -k * y - v + ({force})}}, section=Section(v, "falling"))
""")
    (folder / "mine.toml").write_text('model = "mine.py:MINE"\nk = 1.5\n')
    return whirlmap.load(folder / "mine.toml")


def test_the_page_lists_every_function_that_works(tmp_path):
    listed = [name for row in table("functions") for name in re.findall(r"`(\w+)`", row[0])]
    known = {f.__name__ for f in FUNCTIONS} - {"Piecewise"} | {"when", "sqrt", "cbrt"}
    assert sorted(listed) == sorted(known)
    terms = []
    for name in listed:
        assert callable(getattr(equations, name)), name
        arguments = {"when": "y > 0.1, y, 0", "atan2": "y, k", "Max": "y, 0.2", "Min": "y, 0.2", "acosh": "1 + y"}
        terms.append(f"{name}({arguments.get(name, 'y')})")
    rate = declare(tmp_path, " + ".join(terms)).rhs(0.0, [0.3, 0.0])[1]
    here = {**vars(equations), "y": 0.3, "k": 1.5, "magnitude": abs, "when": lambda c, a, b: a if c else b}
    expected = sum(float(eval(term, here)) for term in terms)
    assert rate == pytest.approx(expected - 1.5 * 0.3, rel=1e-12)


REFUSED = [(code, row[1]) for row in table("not") for code in re.findall(r"`([^`]+)`", row[0])]


@pytest.mark.parametrize("code", [code for code, _ in REFUSED])
def test_what_the_page_calls_refused_is_refused_with_a_way_out(code, tmp_path):
    with pytest.raises((ModelError, CaseError), match=r"expected|Expected|such as|which are|real|not finite"):
        declare(tmp_path, code)


def test_the_page_has_everything_that_is_refused_by_name():
    codes = " ".join(code for code, _ in REFUSED).replace("y % 1", "Mod")
    for refused in (*STEPS, *_WAYS_OUT):
        assert refused.__name__.removesuffix("ing") in codes, refused


def test_numbers_of_a_model_of_ones_own_may_stand_plainly(folder):
    from whirlmap.cli.main import app

    plain = 'model = "loose_pedestal.py:LOOSE_PEDESTAL"\nzeta = 0.05\nsoft = { value = 0.2 }\nb = 1\nOmega = "1.7"\n'
    (folder / "plain.toml").write_text(plain)
    (folder / "more.toml").write_text('extends = "plain.toml"\nzeta = 0.04\n')
    assert whirlmap.load("plain.toml").values == whirlmap.load("my_case.toml").values
    system = whirlmap.load("more.toml")
    assert system.values["zeta"] == 0.04 and system.notes["b"] == "no source given"
    shown = CliRunner().invoke(app, ["show", "plain.toml"], env={"COLUMNS": "160"}).output
    assert shown.count("no source given") == 4
    assert json.loads(whirlmap.simulate(system, periods=1).attrs["parameters"])["b"]["source"] == "no source given"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('model = "loose_pedestal.py:LOOSE_PEDESTAL"\nzeta = true', "line 2: zeta: found True, expected a number, or"),
        ('extends = "my_case.toml"\nzeta = "soft"', "line 2: zeta: found 'soft', expected a number"),
        ('extends = "my_case.toml"\nzetta = 1', "Did you mean 'zeta'"),
        ('extends = "my_case.toml"\nzeta = "5 mm"', "found the unit 'mm', expected no unit"),
        ('extends = "duffing"\ngamma = 0.3', "line 2: gamma: found 0.3, expected an entry such as"),
    ],
)
def test_other_plain_entries_are_refused(text, message, folder):
    (folder / "plain.toml").write_text(text)
    with pytest.raises(CaseError) as error:
        whirlmap.load("plain.toml")
    assert message in str(error.value)
