"""The study's data and documents: complete, in known words, and true to the model."""

import re
import tomllib
from importlib.resources import files
from pathlib import Path

import pytest

from whirlmap.models import family
from whirlmap.models.gear_pair_machine import INPUTS

STUDY = files("whirlmap.studies.gear_psfd")
MODEL_PAGE = Path(__file__).parents[2] / "docs" / "model.md"
FIELDS = {"number", "printed", "derived", "verdict", "why", "editions"}
CLAIMS = {
    "fig2-nonperiodic", "fig2-amplitude-grows", "fig3-low-8T", "fig3-chaos-window", "fig3-large-amplitude",
    "fig3-mid-8T", "fig3-high-chaos", "fig4-windows", "fig5-windows", "fig67-lyapunov", "fig6-dimension-yp",
    "fig7-dimension-y2", "fig67-spectrum", "permeability-regularises", "permeability-suppresses-amplitude",
    "safe-speeds",
}  # fmt: skip


def table(name, key):
    return tomllib.loads(STUDY.joinpath(name).read_text(encoding="utf-8"))[key]


def rows():
    return table("equations.toml", "equation")


def row(number):
    (found,) = [r for r in rows() if r["number"] == number]
    return found


def test_every_equation_of_the_paper_has_one_row():
    numbered = [r["number"] for r in rows() if re.fullmatch(r"[\d, ]+", r["number"])]
    assert sorted(int(n) for number in numbered for n in re.findall(r"\d+", number)) == list(range(1, 42))


def test_what_the_paper_does_not_number_has_rows_too():
    text = " | ".join(r["number"] for r in rows())
    for what in ("film integrals", "ψ = 0", "clock", "s_1, s_2", "undefined symbols", "8T"):
        assert what in text
    assert any("C_om" in r["printed"] for r in rows())


@pytest.mark.parametrize("r", rows(), ids=lambda r: r["number"])
def test_rows_are_complete(r):
    assert set(r) == FIELDS
    assert all(isinstance(text, str) and text.strip() == text and text for text in r.values())
    assert r["verdict"] in {"ok", "typo", "error", "ambiguous"}
    assert r["why"].endswith(".")
    assert "  " not in "".join(r.values())


@pytest.mark.parametrize(
    ("number", "verdict"),
    [("5", "error"), ("7", "error"), ("11", "error"), ("18, 19", "typo"), ("20", "error"), ("21", "ok"),
     ("26, 28", "ok"), ("30", "typo"), ("31", "error"), ("32", "typo"), ("33", "error"), ("34", "error"),
     ("35", "ok"), ("36", "error"), ("38", "ok"), ("39", "typo")],
)  # fmt: skip
def test_verdicts_that_the_algebra_tests_derive(number, verdict):
    """The same findings as `tests/independent/test_audit.py`."""
    assert row(number)["verdict"] == verdict


def test_every_claim_is_there_once():
    claims = table("claims.toml", "claim")
    assert len(claims) == 16
    assert {c["id"] for c in claims} == CLAIMS
    for claim in claims:
        assert {"where", "says", "measure"} <= set(claim)


def test_claims_name_the_papers_permeabilities():
    assert {c["psi"] for c in table("claims.toml", "claim") if "psi" in c} == {0.0, 1e-4, 1e-3, 0.1}


def test_the_audit_has_the_sections_that_the_code_points_to():
    text = STUDY.joinpath("audit.md").read_text(encoding="utf-8")
    headings = re.findall(r"^#+ ([\d.]+[A-F]?)\.? ", text, re.MULTILINE)
    for section in ("2.B", "2.E", "3.1", "3.2", "3.4", "4.1", "4.3", "4.4", "6.2", "6.4"):
        assert section in headings
    for path in re.findall(r"`(tests/[\w/]+(?:\.py)?)/?`", text):
        assert (Path(__file__).parents[2] / path).exists()


@pytest.mark.parametrize("edition", ["literal", "intended", "physical"])
def test_the_model_page_names_every_symbol(edition):
    """`docs/model.md` is written by hand: it must not fall behind the model."""
    model = family("gear_pair").model(edition=edition)
    named = set(re.findall(r"`(\w+)`", MODEL_PAGE.read_text(encoding="utf-8")))
    symbols = [*model.states, *model.parameters, *INPUTS]
    missing = {q.name for q in symbols} | set(model.outputs) | set(model.stops) | set(model.switches)
    assert missing - named == set()


def test_the_model_page_says_which_edition_reads_what():
    literal = {p.name for p in family("gear_pair").model(edition="literal").parameters}
    physical = {p.name for p in family("gear_pair").model(edition="physical").parameters}
    assert literal - physical == {"xi_5"}
    assert physical - literal == {"kappa_g", "Gamma_2", "chi_p", "chi_g"}
    assert family("gear_pair").model(edition="physical").switches["arc"] == "positive"
    assert family("gear_pair").model(edition="literal").switches["film"] == "printed"
