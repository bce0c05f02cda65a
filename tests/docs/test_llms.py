"""The plain-text index of the documentation: it names every page, leads somewhere, and has the recipes as they are."""

import re
from pathlib import Path

from whirlmap.cli.common.recipes import recipes

ROOT = Path(__file__).parents[2]
INDEX = (ROOT / "docs" / "llms.txt").read_text(encoding="utf-8")
#: Pages that stand for the site's own parts of it: lists of others.
LISTS = {"index.md", "gallery.md", "reference.md"}


def test_it_names_every_page_and_nothing_that_is_not_there():
    links = re.findall(r"\]\(([^)]+)\)", INDEX)
    assert len(links) == len(set(links)) and all((ROOT / "docs" / link).is_file() for link in links)
    docs = ROOT / "docs"
    pages = {page.relative_to(docs).as_posix() for folder in (docs, docs / "machines") for page in folder.glob("*.md")}
    assert pages - LISTS <= set(links)


def test_its_recipes_are_those_that_the_program_prints():
    """To renew: what `whirlmap recipes --all` prints stands behind the heading."""
    _, printed = INDEX.split("## Recipes\n", 1)
    assert printed.partition("### ")[2] == "\n".join(one.text for one in recipes().values()).removeprefix("### ")
