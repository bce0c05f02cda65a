"""The number beside each verdict: it says what the verdict stands on."""

import re

import numpy as np
import pytest
from tests.studies.gear_psfd.claims.test_claims import as_the_paper_says, diagram, in_windows, orbit

from whirlmap.studies.gear_psfd.claims.claims import claims
from whirlmap.studies.gear_psfd.claims.measured import MEASURES
from whirlmap.studies.gear_psfd.claims.thresholds import ALMOST_ALL, GROWS, LARGER
from whirlmap.studies.gear_psfd.reproduction.verdicts import judge


def numbers(evidence):
    return {v.claim.id: v.measured.number for v in judge(evidence)}


def first(text):
    return float(re.findall(r"[-+]?[\d.]+", text)[0])


def test_every_claim_has_a_number():
    assert set(MEASURES) == {c.id for c in claims()}
    for verdict in judge(as_the_paper_says()):
        assert verdict.measured.quantity
        assert verdict.measured.wanted
        assert any(c.isdigit() for c in verdict.measured.number), verdict


def test_numbers_of_evidence_in_the_papers_words():
    """Known by construction of the evidence: kinds by windows of s, amplitude s at psi = 0 and s/20 at psi = 0.1."""
    found = numbers(as_the_paper_says())
    assert found["fig2-nonperiodic"] == "100%"
    assert found["fig2-amplitude-grows"] == "+1.00"
    assert found["fig3-low-8T"] == found["fig3-chaos-window"] == found["fig3-mid-8T"] == found["fig3-high-chaos"] == "100%"
    assert first(found["fig3-large-amplitude"]) == pytest.approx(3 * 1.54 / 1.3275, rel=0.01)  # middles of both windows
    assert found["fig4-windows"] == found["fig5-windows"] == "100% / 100% / 100%"
    assert found["fig67-lyapunov"] == "+0.10000 / +0.10000 / +0.10000 / +0.10000; 4 of 4 above zero"
    assert found["fig6-dimension-yp"].startswith("1.28 ± 0.02 / ")
    assert found["fig67-spectrum"] == "40 / 40 / 40 / 40; 30.0% / 30.0% / 30.0% / 30.0%"
    assert found["permeability-regularises"].startswith("100% / ")
    assert found["permeability-suppresses-amplitude"] == "0.05; smaller at 100%"


def test_a_number_meets_what_is_wanted_exactly_where_its_claim_holds():
    wanted = {
        "fig2-nonperiodic": lambda n: n >= 100 * ALMOST_ALL, "fig2-amplitude-grows": lambda n: n > GROWS[1],
        "fig3-low-8T": lambda n: n >= 100 * ALMOST_ALL, "fig3-chaos-window": lambda n: n >= 100 * ALMOST_ALL,
        "fig3-large-amplitude": lambda n: n > LARGER,
    }  # fmt: skip
    against = as_the_paper_says()
    against.diagrams[0.0] = diagram(in_windows((0.3, 2.0)), swing=lambda s: 2 - 0.1 * s)
    against.diagrams[1e-4] = diagram(in_windows((0.5, 1.3)), swing=lambda s: 2 - 0.5 * s)
    words = set()
    for evidence in (as_the_paper_says(), against):
        for v in judge(evidence):
            if v.claim.id in wanted:
                assert wanted[v.claim.id](first(v.measured.number)) == (v.word == "holds"), v
                words.add((v.claim.id, v.word == "holds"))
    assert len(words) == 2 * len(wanted), "each has been met, and not met"


def test_what_is_not_there_is_said_to_be_none():
    evidence = as_the_paper_says()
    for psi in evidence.diagrams:
        evidence.diagrams[psi] = diagram(lambda s: s > 9, ended=lambda s: s > 0)
        evidence.orbits[psi] = orbit(exponent=np.nan, error=np.nan)
        for coordinate in ("yp", "y2"):
            evidence.dimensions[psi, coordinate] = {}
    found = numbers(evidence)
    for name in ("fig2-amplitude-grows", "fig3-large-amplitude", "fig67-lyapunov", "fig6-dimension-yp", "fig7-dimension-y2",
                 "permeability-suppresses-amplitude", "safe-speeds"):  # fmt: skip
        assert found[name].startswith("none"), (name, found[name])
    assert found["permeability-regularises"] == "100% / 100% / 100% / 100%"
    assert not any("nan" in number for number in found.values())
