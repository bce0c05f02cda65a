"""The validation page: what its fixture refuses, how a run becomes a page, and that docs has the page of these tests."""

import ast
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from tests.validation.rows import Validation

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "validation.md"
FOUR = """
import pytest

@pytest.mark.xfail(strict=True, reason="a known gap")
def test_open(validate):
    validate("gap", 1.25, 1.0, tier="exact", source="a closed form", rel=1e-9)

def test_wrong(validate):
    validate("holds here", "2T", "2T", tier="published", source="Somebody 1999")
    validate("wrong label", "1T", "2T", tier="published", source="Somebody 1999")

def test_good(validate):
    validate("many", [1.0, 2.1, 3.0], [1.0, 2.0, 3.0], tier="independent", source="SciPy", within=0.2)
    validate.claim("all is chaotic", "fails", "none of 3", says="chaotic everywhere", source="Fig. 2")
    validate.claim("low is 8T", "holds", "3 of 3", says="8T", source="Fig. 3")

def test_elsewhere(validate):
    validate("sum", 0.0, 0.0, tier="invariant", source="Liouville", within=0)
    assert not "something else"

def test_without_rows():
    raise AssertionError("not run with --validation")
"""


class Node:
    def __init__(self):
        self.node, self.user_properties = self, []


@pytest.fixture
def check():
    return Validation(Node())


SAYS = {"tier": "exact", "source": "here"}


def test_a_comparison_that_does_not_hold_fails(check):
    check("same", 1.0 + 1e-12, 1.0, rel=1e-9, **SAYS)
    for value in (1.1, np.nan, np.inf):
        with pytest.raises(AssertionError, match=r"what: .*expected 1 \(1e-09 relative\)"):
            check("what", value, 1.0, rel=1e-9, **SAYS)
    with pytest.raises(AssertionError, match="expected 2T"):
        check("label", "1T", "2T", **SAYS)
    with pytest.raises(AssertionError, match="no event, expected"):
        check("event", "no event", 0.1, within=1.0, **SAYS)
    with pytest.raises(AssertionError):
        check("one of many", [0, 0, 1e-3], 0, within=[1, 1, 1e-4], **SAYS)
    with pytest.raises(AssertionError, match="rel or within"):
        check("how near?", 1.0, 1.0, **SAYS)
    with pytest.raises(AssertionError):
        check("which tier?", 1.0, 1.0, tier="good", source="here", rel=1)


def test_what_fails_is_recorded_too_with_the_entry_that_is_farthest(check):
    with pytest.raises(AssertionError):
        check("many", [1.0, 2.5, 3.1], [1.0, 2.0, 3.0], within=0.2, **SAYS)
    (name, row), = check._node.user_properties  # fmt: skip
    assert name == "validation" and not row["holds"]
    assert (row["value"], row["truth"], row["error"], row["of"]) == ("2.5", "2", "5.0e-01", 3)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("validated")
    (folder / "conftest.py").write_text((ROOT / "conftest.py").read_text(encoding="utf-8"), encoding="utf-8")
    (folder / "test_four.py").write_text(FOUR, encoding="utf-8")
    run = [sys.executable, "-m", "pytest", "-q", "--rootdir", str(folder), "--validation", "page.md"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(run, cwd=folder, env=environment, capture_output=True, text=True, timeout=120)
    assert "2 failed, 1 passed, 1 deselected, 1 xfailed" in done.stdout, done.stdout + done.stderr
    return (folder / "page.md").read_text(encoding="utf-8")


def test_open_and_failing_rows_stand_first_with_their_numbers(made):
    heads = re.findall(r"^## (.+)$", made, flags=re.MULTILINE)
    assert heads == ["Open and failing", "Statements of the paper", "Invariant", "Published", "Independent"]
    wrong = made[made.index("## Open") : made.index("## Statements")]
    assert "| gap | 1.25 | 1 | 2.5e-01 | 1e-09 relative |" in wrong and "open: a known gap" in wrong
    assert "| wrong label | 1T | 2T |" in wrong and "`test_four.py::test_elsewhere`" in wrong
    assert "5 checks: 1 exact, 1 invariant, 2 published, 1 independent; 3 of them open or failing" in made


def test_rows_that_hold_stand_by_tier_and_claims_that_fail_before_those_that_hold(made):
    assert "| many (3 values) | 2.1 | 2 | 1.0e-01 | 0.2 | SciPy |" in made[made.index("## Independent") :]
    assert made.index("all is chaotic") < made.index("low is 8T")
    assert re.search(r"Run on 20\d\d-\d\d-\d\d with whirlmap \d", made)


#: Tests that are skipped where another program is not installed.
NEED_MORE = {("tests/independent/test_auto.py", "test_branches_and_events_are_those_that_auto_finds")}


def takes_it(function):
    return "validate" in [argument.arg for argument in function.args.args]


def recording():
    """Every test that takes the fixture, by file and name."""
    for file in (ROOT / "tests").rglob("test_*.py"):
        if file.parent == Path(__file__).parent:
            continue
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef) and node.name.startswith("test_") and takes_it(node):
                yield file.relative_to(ROOT).as_posix(), node.name


def test_the_page_in_docs_is_of_the_tests_of_today():
    """`make validation` renews it; its numbers are those of its own run, and are not compared."""
    text = PAGE.read_text(encoding="utf-8")
    on_page = set(re.findall(r"`(tests/[\w/]+\.py)::(test_\w+)`", text))
    assert on_page | NEED_MORE == set(recording())
    assert int(re.search(r"^(\d+) checks", text, flags=re.MULTILINE)[1]) >= 60
    assert text.index("## Open and failing") < text.index("## Exact") < text.index("## Independent")
