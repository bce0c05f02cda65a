"""The validation page: rows that tests recorded, in Markdown, open and failing ones first."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from tests.validation.rows import TIERS

#: Verdicts on the paper's statements, in the order in which they stand.
VERDICTS = ("fails", "partly", "cannot be evaluated", "holds")


@dataclass(frozen=True)
class Checked:
    """A test that ran: its place, its rows, how it ended, and why where that was expected."""

    test: str
    rows: Sequence[dict] = field(default_factory=list)
    outcome: str = "passed"
    expected: str | None = None

    @property
    def place(self) -> str:
        """File and name of the test, without its parameters."""
        return f"`{self.test.partition('[')[0]}`"

    @property
    def state(self) -> str:
        """What a row says that does not hold, or the test that ended elsewhere."""
        return f"open: {self.expected}" if self.expected is not None else "fails"


def page(tests: Iterable[Checked], provenance: str) -> str:
    """Make the page of all that was checked."""
    tests = list(tests)
    rows = [(row, test) for test in tests for row in test.rows if "tier" in row]
    claims = [(row, test) for test in tests for row in test.rows if "verdict" in row]
    wrong = [(row, test) for row, test in rows if not row["holds"]]
    bad = [t for t in tests if t.outcome != "passed" and not any(test is t for _, test in wrong)]
    good = [(row, test) for row, test in rows if row["holds"]]
    counts = ", ".join(f"{sum(row['tier'] == tier for row, _ in rows)} {tier}" for tier in TIERS)
    parts = [
        "# Validation\n\nMade by `make validation` out of a run of the tests; no number is written by hand. "
        "A row is recorded by the test that it names, in the moment in which the test compares.\n\n"
        f"{provenance} Date and version are those of every row.\n\n"
        f"{len(rows)} checks: {counts}; {len(wrong) + len(bad)} of them open or failing."
        f" {len(claims)} verdicts on statements of the paper.\n\n"
        "Of a check of several values, the one nearest to its tolerance is shown. Tolerances are absolute unless they say"
        " *relative*.",
        _open(wrong, bad),
    ]
    if claims:
        parts.append(_claims(claims))
    for tier, title in TIERS.items():
        of_tier = [(row, test) for row, test in good if row["tier"] == tier]
        if of_tier:
            parts.append(f"## {tier.capitalize()}\n\n{title}.\n\n" + _table(HEAD, (_cells(*one) for one in of_tier)))
    return "\n\n".join(parts) + "\n"


HEAD = ("quantity", "value", "truth", "difference", "tolerance", "source", "test")


def _cells(row: dict, test: Checked) -> tuple[str, ...]:
    several = f" ({row['of']} values)" if row["of"] > 1 else ""
    return (row["quantity"] + several, row["value"], row["truth"], row["error"], row["tolerance"], row["source"], test.place)


def _open(wrong: Sequence[tuple[dict, Checked]], bad: Sequence[Checked]) -> str:
    """Rows that do not hold, with the reason, and tests that ended without one."""
    if not wrong and not bad:
        return "## Open and failing\n\nNone."
    lines = [(*_cells(row, test), test.state) for row, test in wrong]
    lines += [("the test ended at something else than a row", "", "", "", "", "", test.place, test.state) for test in bad]
    return "## Open and failing\n\n" + _table((*HEAD, "state"), lines)


def _claims(claims: Sequence[tuple[dict, Checked]]) -> str:
    """Statements of the paper: those that do not come true first."""
    ordered = sorted(claims, key=lambda one: VERDICTS.index(one[0]["verdict"]))
    lines = [(r["quantity"], r["says"], r["verdict"], r["found"], r["source"], t.place) for r, t in ordered]
    return (
        "## Statements of the paper\n\nThe paper gives almost no parameter values, so a statement that fails may be true of"
        " another machine.\n\n" + _table(("statement", "the paper says", "verdict", "found", "where", "test"), lines)
    )


def _table(head: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    def line(cells: Sequence[str]) -> str:
        return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"

    return "\n".join([line(head), "|" + " --- |" * len(head), *map(line, lines)])
