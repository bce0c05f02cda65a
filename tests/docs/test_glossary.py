"""Words that the glossary has replaced do not come back into the source."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8")
SOURCE = {path: path.read_text(encoding="utf-8") for path in sorted((ROOT / "src").rglob("*.py"))}


def formerly() -> list[str]:
    """Words in the first column of the table of former words; several in one row stand between commas."""
    table = PAGE.partition("<!-- begin formerly -->")[2].partition("<!-- end formerly -->")[0]
    rows = [line.split("|")[1] for line in table.splitlines() if line.startswith("|")][2:]
    return [word.strip().strip("`") for row in rows for word in row.split(",")]


def test_the_table_of_former_words_is_read():
    assert "short cut" in formerly() and "tangent_run" in formerly()


@pytest.mark.parametrize("word", formerly())
def test_former_words_do_not_occur_in_the_source(word):
    gone = re.compile(rf"(?<!\w){re.escape(word)}(?!\w)".replace(r"\ ", r"[\s#:]+"), re.IGNORECASE)
    found = [f"{path.relative_to(ROOT)}: {m.group()}" for path, text in SOURCE.items() for m in gone.finditer(text)]
    assert not found


def test_every_row_of_the_glossary_has_a_term_and_its_meaning():
    rows = [line for line in PAGE.splitlines() if line.startswith("|") and not set(line) <= set("|-")]
    assert len(rows) > 80 and all(cell.strip() for row in rows for cell in row.strip("|").split("|"))
