"""Listings of objects: a few lines and short tables, as text in a terminal and as HTML in a notebook."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from textwrap import wrap

#: Columns of a printed line; longer ones end in "...". A last column of a table for which less is left is not printed.
WIDTH, LEAST = 110, 20


@dataclass(frozen=True)
class Rows:
    """Rows of text under their columns. ``details`` are shown in a notebook on a click, and in a terminal not at all."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    details: bool = False

    def lines(self) -> list[str]:
        """The table as aligned lines."""
        cells = [self.columns, *self.rows]
        widths = [2 + max(len(row[i]) for row in cells) for i in range(len(self.columns))]
        shown = len(widths) - (sum(widths) > WIDTH and sum(widths[:-1]) > WIDTH - LEAST)
        return [f"{self.title}:", *("  " + "".join(map(str.ljust, row[:shown], widths)).rstrip() for row in cells)]

    def html(self) -> str:
        """The table as HTML, in notebooks' own style."""
        head = _row("th", self.columns)
        body = "".join(_row("td", row) for row in self.rows)
        opened = "" if self.details else " open"
        return (
            f"<details{opened}><summary>{escape(self.title)} ({len(self.rows)})</summary>"
            f"<table><thead>{head}</thead><tbody>{body}</tbody></table></details>"
        )


def _row(tag: str, cells: Sequence[str]) -> str:
    return "<tr>" + "".join(f'<{tag} style="text-align: left">{escape(cell)}</{tag}>' for cell in cells) + "</tr>"


@dataclass(frozen=True)
class Listing:
    """A title, facts of one line each, and tables."""

    title: str
    facts: Sequence[str] = ()
    tables: Sequence[Rows] = ()

    def text(self) -> str:
        """All of it but details, for a terminal."""
        lines = [self.title]
        for fact in self.facts:
            lines += wrap(fact, WIDTH, initial_indent="  ", subsequent_indent="    ")
        for table in self.tables:
            if table.rows and not table.details:
                lines += table.lines()
        return "\n".join(line if len(line) <= WIDTH else line[: WIDTH - 3] + "..." for line in lines)

    def html(self) -> str:
        """All of it, for a notebook."""
        facts = "".join(f"<div>{escape(fact)}</div>" for fact in self.facts)
        tables = "".join(table.html() for table in self.tables if table.rows)
        return f"<div><div><b>{escape(self.title)}</b></div>{facts}{tables}</div>"


class Listed:
    """What prints itself as its `Listing`; a dataclass that inherits it is declared with ``repr=False``."""

    def listing(self) -> Listing:
        """What there is to print."""
        raise NotImplementedError

    def __repr__(self) -> str:
        return self.listing().text()

    def _repr_html_(self) -> str:
        return self.listing().html()


def brackets(facts: Mapping[str, str]) -> str:
    """Facts as one line: ``speed (no safe speeds), load (no bearing loads)``."""
    return ", ".join(f"{name} ({words})" for name, words in facts.items())
