"""Parts of pages that are made from the program itself, so that no page can say something else than the program does.

A page has a comment where such a part stands, ``<!-- generated: commands -->``, which readers of the file do not see.
"""

import re
from collections.abc import Callable
from functools import cache
from typing import Any

from sphinx.errors import ExtensionError

from case_keys import entry_keys, machine_tables, models
from command_pages import commands
from result_tables import datasets, json_objects, labels, statuses

#: Name in the comment -> what writes the part, as Markdown.
PARTS: dict[str, Callable[[], str]] = {
    "commands": commands, "entry-keys": entry_keys, "machine-tables": machine_tables, "models": models,
    "datasets": datasets, "json": json_objects, "labels": labels, "statuses": statuses,
}  # fmt: skip
MARK = re.compile(r"^<!-- generated: ([\w-]+) -->$", re.MULTILINE)


@cache
def part(name: str) -> str:
    """One part, made once for a build."""
    if name not in PARTS:
        raise ExtensionError(f"there is no generated part {name!r}; there are {', '.join(PARTS)}")
    return PARTS[name]()


def fill(_app: Any, _docname: str, source: list[str]) -> None:
    """Put the parts into a page that is read."""
    source[0] = MARK.sub(lambda found: part(found[1]), source[0])


def setup(app: Any) -> dict[str, bool]:
    """Register with Sphinx."""
    app.connect("source-read", fill)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
