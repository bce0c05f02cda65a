"""Tables of Markdown."""

from collections.abc import Iterable, Sequence


def code(text: object) -> str:
    """A word as code; a bar would end the cell."""
    return f"`{text}`".replace("|", "\\|") if str(text) else ""


def table(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Write a table; every cell is one line."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join("| " + " | ".join(" ".join(str(cell).split()) for cell in line) + " |" for line in lines) + "\n"
