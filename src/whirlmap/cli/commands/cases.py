"""``whirlmap cases``: the stock cases, with a line on each."""

from whirlmap.cases.case import names, read
from whirlmap.cli.common import report


def cases(
    *, json: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.cases` says."""
    found = [read(name) for name in names()]
    if json:
        report.print_json({"cases": [{"name": c.name, "model": c.family.name, "description": c.description} for c in found]})
        return
    rows = [(c.name, c.family.name, first_sentence(c.description)) for c in found]
    report.show(report.table("Cases", ("name", "model", "what it is"), rows))


def first_sentence(text: str) -> str:
    """First sentence of a description."""
    return text.partition(". ")[0].rstrip(".")
