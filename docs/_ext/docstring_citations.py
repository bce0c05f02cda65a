"""Citation keys in docstrings, such as [benettin1980], become links to the bibliography."""

import re
from typing import Any

from whirlmap.references import references

_KEY = re.compile(r"\[([a-z][\w-]*)\](?!_)")


def cite(_app: Any, _what: str, _name: str, _obj: Any, _options: Any, lines: list[str]) -> None:
    """Replace every key of the bibliography by a citation; other words in brackets stay."""
    for number, line in enumerate(lines):
        lines[number] = _KEY.sub(lambda found: f":cite:t:`{found[1]}`" if found[1] in references() else found[0], line)


def setup(app: Any) -> dict[str, bool]:
    """Register with Sphinx, to run before the sections of a docstring are read."""
    app.connect("autodoc-process-docstring", cite, priority=400)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
