"""A small reproduction of one edition, and the report of it: few speeds, and no pictures."""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.studies.gear_psfd.claims.test_claims import dimension, orbit

from whirlmap.analysis.steady.settling import Settling
from whirlmap.integrate.loading import load
from whirlmap.studies.gear_psfd.claims.labelled import ORBITS, PSI
from whirlmap.studies.gear_psfd.reproduction.edition_data import EDITIONS, EditionData, Quality, diagram_of
from whirlmap.studies.gear_psfd.reproduction.live_diagrams import live_diagrams
from whirlmap.studies.gear_psfd.reproduction.report import Finished, write_report
from whirlmap.studies.gear_psfd.reproduction.verdicts import judge

FEW = Quality(6, Settling(transient=20, most=4, keep=16), 64, Settling(transient=20, most=4), 0, 0)
#: What an edition is said to be: it would end a script and begin an element, were it not escaped.
HOSTILE = 'as derived</script><img src="http://example.org/x.png">&amp;'


@pytest.fixture(scope="session")
def evidence() -> EditionData:
    """Computed diagrams of the edition whose verdicts differ most; points of Figures 6 and 7 are made up."""
    edition = replace(next(e for e in EDITIONS if e.name == "intended"), says=HOSTILE)
    system = load(edition.case)
    diagrams = {psi: diagram_of(edition, system.replace(psi=psi), FEW) for psi in PSI}
    dimensions = {(psi, y): dimension(1.3) for psi in PSI for y in ORBITS}
    return EditionData(edition, system, FEW, diagrams, {psi: orbit() for psi in PSI}, dimensions)


@pytest.fixture(scope="session")
def finished(evidence: EditionData) -> Finished:
    return Finished(evidence, judge(evidence), [], live_diagrams(evidence))


@pytest.fixture(scope="session")
def report(finished: Finished, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report as a file."""
    path = tmp_path_factory.mktemp("report") / "report.html"
    write_report(path, [finished], quality="quick")
    return path
