"""The plain-text index of the documentation: it names every page, leads somewhere, and has the recipes as they are."""

import re
from pathlib import Path

from whirlmap.cli.common.recipes import recipes

ROOT = Path(__file__).parents[2]
INDEX = (ROOT / "docs" / "llms.txt").read_text(encoding="utf-8")


def test_it_names_every_page_and_nothing_that_is_not_there():
    links = re.findall(r"\]\(([^)]+)\)", INDEX)
    assert len(links) == len(set(links)) and all((ROOT / "docs" / link).is_file() for link in links)
    docs = ROOT / "docs"
    made = {docs / "examples", docs / "reference" / "generated"}  # by the site
    pages = {
        p.relative_to(docs).as_posix() for p in docs.rglob("*.md") if p.name != "index.md" and not made & set(p.parents)
    }
    assert pages <= set(links)


def test_its_recipes_are_those_that_the_program_prints():
    """To renew: what `whirlmap recipes --all` prints stands behind the heading."""
    _, printed = INDEX.split("## Recipes\n", 1)
    assert printed.partition("### ")[2] == "\n".join(one.text for one in recipes().values()).removeprefix("### ")
