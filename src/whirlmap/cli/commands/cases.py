"""``whirlmap cases``: the stock cases, with a line on each."""

from whirlmap.cli.common import options, report

EXAMPLES = (
    "whirlmap cases",
    "whirlmap cases --json",
)


def cases(json: options.Json = False) -> None:
    """List the stock cases: named sets of parameters, each number with its source.

    Every other command takes one of these names, or the path of a case file of your own. `whirlmap show CASE`
    prints all that is in a case.
    """
    from whirlmap.cases.case import names, read

    found = [read(name) for name in names()]
    if json:
        report.print_json({"cases": [{"name": c.name, "model": c.family.name, "description": c.description} for c in found]})
        return
    rows = [(c.name, c.family.name, first_sentence(c.description)) for c in found]
    report.show(report.table("Cases", ("name", "model", "what it is"), rows))


def first_sentence(text: str) -> str:
    """First sentence of a description."""
    return text.partition(". ")[0].rstrip(".")
