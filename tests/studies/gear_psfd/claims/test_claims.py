"""Claims as functions: evidence made to the paper's own words satisfies them, and evidence against them does not."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from whirlmap.results.regime import Regime
from whirlmap.results.status import Status
from whirlmap.studies.gear_psfd.claims.claims import JUDGES, WORDS, claims
from whirlmap.studies.gear_psfd.claims.labelled import PSI, S_ORBIT
from whirlmap.studies.gear_psfd.reproduction.edition_data import EDITIONS, QUALITIES, EditionData, speeds
from whirlmap.studies.gear_psfd.reproduction.verdicts import judge, labelled, safe_windows

#: What is read of a system here: the paper's clock.
SYSTEM = SimpleNamespace(period=2 * np.pi)


def diagram(chaotic, *, swing=lambda s: 0.1 * s, ended=lambda s: np.zeros(s.shape, bool)):
    """A diagram whose chaotic speeds are given by a mask of s; every other speed returns with the forcing."""
    s = speeds(QUALITIES["full"])
    where = chaotic(s)
    regime = np.where(where, Regime.undecided, Regime.periodic)
    regime = np.where(ended(s), Regime.contact, regime)
    pp = np.where(ended(s), np.nan, swing(s))
    return xr.Dataset(
        {
            "regime": ("s", regime), "period_T": ("s", np.where(where, 0, 8)),
            "status": ("s", np.where(ended(s), Status.contact, Status.ok)),
            "lyapunov": ("s", np.where(where, 0.1, np.nan)), "lyapunov_error": ("s", np.where(where, 0.01, np.nan)),
            "maximum": (("s", "quantity"), pp[:, None]), "minimum": (("s", "quantity"), 0 * pp[:, None]),
        },
        coords={"s": s, "paper_s": ("s", s), "quantity": ["yp"]}, attrs={"common_multiple": 8},
    )  # fmt: skip


def orbit(exponent=0.1, error=0.01, lines=40, broadband=0.3):
    return xr.Dataset(
        {"regime": int(Regime.undecided), "lyapunov": ("exponent", [exponent]), "lyapunov_error": ("exponent", [error])},
        attrs={"indicators": json.dumps({"spectrum": {"lines": lines, "broadband_fraction": broadband}})},
    )


def dimension(value, error=0.02):
    return {"plane": xr.Dataset({"status": 0, "D2": value, "D2_error": error})}


def in_windows(*windows):
    return lambda s: np.any([(s >= a) & (s <= b) for a, b in windows], axis=0)


def as_the_paper_says():
    """EditionData in which everything is as the paper says; amplitudes grow with s and fall with psi."""
    fig3 = in_windows((1.18, 1.6), (3.11, 9))
    high = lambda s: 0.2 * s * np.where((s >= 1.48) & (s <= 1.6), 3.0, 1.0)  # noqa: E731
    diagrams = {
        0.0: diagram(lambda s: s > 0, swing=lambda s: s),
        1e-4: diagram(fig3, swing=high),
        1e-3: diagram(in_windows((1.6, 1.62), (3.15, 9)), swing=lambda s: 0.1 * s),
        0.1: diagram(in_windows((1.6, 1.62), (3.15, 9)), swing=lambda s: 0.05 * s),
    }
    dims = {(psi, y): dimension(v) for psi in PSI for y, v in (("yp", 1.28), ("y2", 1.41))}
    return EditionData(EDITIONS[1], SYSTEM, QUALITIES["full"], diagrams, {psi: orbit() for psi in PSI}, dims)


def test_every_claim_has_one_judge():
    assert [c.id for c in claims()] == list(JUDGES)
    assert len(claims()) == 16


def test_evidence_in_the_papers_words_satisfies_every_claim():
    verdicts = {v.claim.id: v for v in judge(as_the_paper_says())}
    assert {i: v.word for i, v in verdicts.items()} == dict.fromkeys(JUDGES, "holds")
    assert all(any(ch.isdigit() for ch in v.found) for v in verdicts.values()), "a verdict carries its number"


def test_a_calm_machine_refutes_the_chaos():
    calm = {psi: diagram(lambda s: s < 0, swing=lambda s: 1 / s) for psi in PSI}
    e = EditionData(
        EDITIONS[1], SYSTEM, QUALITIES["full"], calm, {psi: orbit(-0.1, 0.01, 4, 0.0) for psi in PSI},
        {(psi, y): {} for psi in PSI for y in ("yp", "y2")},
    )  # fmt: skip
    words = {v.claim.id: v.word for v in judge(e)}
    assert words["fig2-nonperiodic"] == "fails"
    assert words["fig2-amplitude-grows"] == "fails"
    assert words["fig3-low-8T"] == words["fig3-mid-8T"] == "holds"
    assert words["fig3-chaos-window"] == words["fig3-high-chaos"] == "fails"
    assert words["fig4-windows"] == words["fig5-windows"] == "partly"
    assert words["fig67-lyapunov"] == words["fig67-spectrum"] == "fails"
    assert words["fig6-dimension-yp"] == words["safe-speeds"] == "cannot be evaluated"
    assert words["permeability-regularises"] == "fails"


def test_contact_everywhere_is_no_motion_to_judge():
    gone = {psi: diagram(lambda s: s < 0, ended=lambda s: s > 0) for psi in PSI}
    ended = xr.Dataset({"regime": int(Regime.contact)}, attrs={"indicators": "{}"})
    e = EditionData(
        EDITIONS[0], SYSTEM, QUALITIES["full"], gone, dict.fromkeys(PSI, ended),
        {(psi, y): {} for psi in PSI for y in ("yp", "y2")},
    )  # fmt: skip
    words = {v.claim.id: v.word for v in judge(e)}
    assert set(words.values()) <= set(WORDS)
    assert "holds" not in words.values()
    for claim in ("fig2-nonperiodic", "fig2-amplitude-grows", "fig67-lyapunov", "permeability-suppresses-amplitude"):
        assert words[claim] == "cannot be evaluated"


def test_the_wrong_dimension_fails():
    e = as_the_paper_says()
    wrong = {key: dimension(1.9) for key in e.dimensions}
    words = {v.claim.id: v.word for v in judge(EditionData(e.edition, e.system, e.quality, e.diagrams, e.orbits, wrong))}
    assert words["fig6-dimension-yp"] == words["fig7-dimension-y2"] == "fails"


def test_a_motion_without_a_known_dimension_leaves_the_claim_open():
    e = as_the_paper_says()

    def word(at, motion):
        dims = {key: {} if key[0] == at else dimension(1.9) for key in e.dimensions}
        orbits = e.orbits | {at: motion}
        return {v.claim.id: v.word for v in judge(replace(e, orbits=orbits, dimensions=dims))}["fig6-dimension-yp"]

    ended = xr.Dataset({"regime": int(Regime.contact)}, attrs={"indicators": "{}"})
    assert word(1e-4, orbit()) == "cannot be evaluated"  # undecided: it may be the motion that the paper means
    assert word(1e-4, ended) == "fails"
    assert word(1e-4, orbit().assign(regime=int(Regime.quasi_periodic))) == "fails"  # the others decide
    tori = dict.fromkeys(PSI, orbit().assign(regime=int(Regime.quasi_periodic)))
    words = {v.claim.id: v.word for v in judge(replace(e, orbits=tori))}
    assert words["fig6-dimension-yp"] == "cannot be evaluated"  # as the claim's measure says


def test_safe_windows_are_the_stretches_that_return():
    windows = safe_windows(labelled(as_the_paper_says()), PSI.index(1e-4))
    assert [(round(a, 1), round(b, 1)) for a, b, _ in windows] == [(0.3, 1.2), (1.6, 3.1)]


@pytest.mark.parametrize("quality", QUALITIES.values())
def test_named_speeds_are_always_computed(quality):
    s = speeds(quality)
    assert {1.60, 1.61, 1.62, S_ORBIT} <= set(s.tolist())
    assert np.all(np.diff(s) > 0)
    assert QUALITIES["full"].speeds >= 600
    assert QUALITIES["full"].points >= 20_000
