"""How votes combine: every rule with a case that would come out otherwise without it."""

import numpy as np
import pytest
from tests.analysis.maps import GOLDEN, circle_map, henon, logistic

from whirlmap.analysis.indicators.birkhoff import RotationNumber
from whirlmap.analysis.indicators.section_coordinates import Watch, rotation_numbers_of
from whirlmap.analysis.indicators.section_indicators import SectionEvidence, evidence_of
from whirlmap.analysis.labels.regime import decide, regime
from whirlmap.analysis.labels.votes import Evidence, Vote
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status


def section_evidence(section, cyclic=None):
    return evidence_of(Watch(section, cyclic)(section, np.arange(section.shape[2])))


def judged(*, status=Status.ok, multiple=0, exponent=0.1, error=0.001, duration=1000.0, late=None, K=0.99, low=0.95,
           digits=1.5, before=1.0, uneven=0.0, closes=False, winding=None, final=False, returns=True):  # fmt: skip
    turned = winding or RotationNumber(np.nan, np.nan, "through-centre")
    numbers = (np.array([v]) for v in (K, low, digits, before, digits, uneven, closes))
    late = exponent * duration / 2 if late is None else late
    e = Evidence(np.array([status]), np.array([multiple]), np.array([exponent]), np.array([error]), np.array([duration]),
                 np.array([late]), SectionEvidence(*numbers, 1024, 1024), (turned,), final, returns)  # fmt: skip
    found = decide(e)
    return Regime(int(found["regime"][0])), float(found["confidence"][0]), found


TORUS = {"exponent": 0.0, "K": 0.02, "low": -0.02, "digits": 9.0}


@pytest.mark.parametrize(
    ("given", "label"),
    [
        ({}, Regime.chaotic),
        (TORUS, Regime.quasi_periodic),
        ({"multiple": 3, "exponent": -0.1, "K": np.nan, "low": np.nan, "digits": np.nan}, Regime.periodic),
        ({"status": Status.contact}, Regime.contact),
        ({"status": Status.diverged}, Regime.diverged),
        ({"status": Status.unresolved}, Regime.undecided),
        ({"multiple": 3}, Regime.undecided),  # returns, though tangent vectors grow
        ({"digits": 9.0}, Regime.undecided),  # grows, though averages converge
        ({"K": 0.02, "low": -0.02}, Regime.undecided),  # grows, though the walk is bounded
        ({"K": 0.5, "low": 0.1, "digits": 4.0}, Regime.undecided),  # an exponent alone is no chaos
        ({"exponent": 0.001, "error": 1e-4}, Regime.undecided),  # too little growth to tell from shear
        ({**TORUS, "exponent": -0.1}, Regime.undecided),  # contracts: a transient, not a torus
        ({**TORUS, "K": 0.99, "low": 0.95}, Regime.undecided),
        ({**TORUS, "digits": 3.9}, Regime.undecided),  # averages that converge slowly need a longer run
        ({**TORUS, "digits": 3.9, "final": True}, Regime.quasi_periodic),
        ({**TORUS, "digits": 4.2}, Regime.quasi_periodic),  # grown by one since a quarter of the record
        ({**TORUS, "digits": 4.2, "before": 4.1}, Regime.undecided),  # they stand still
        ({**TORUS, "digits": 4.2, "before": 4.1, "final": True, "error": 0.1}, Regime.undecided),
        ({**TORUS, "uneven": 0.1}, Regime.undecided),  # its extent still changes: a transient
        ({**TORUS, "closes": True}, Regime.undecided),  # an orbit of high period, on its way
        ({**TORUS, "digits": 3.0, "winding": RotationNumber(0.381966011, 1e-9, "ok")}, Regime.quasi_periodic),
        ({**TORUS, "digits": 3.0, "winding": RotationNumber(1 / 3 + 1e-9, 1e-9, "ok")}, Regime.undecided),  # hops
        ({**TORUS, "winding": RotationNumber(8 / 27, 1e-8, "ok")}, Regime.undecided),  # locked to 8/27, for all one knows
        ({**TORUS, "digits": 3.0, "before": 2.5, "winding": RotationNumber(0.381966, 1e-3, "ok")}, Regime.undecided),
        ({**TORUS, "exponent": -0.001, "error": 1e-4, "late": -0.5}, Regime.undecided),  # little, but more than three errors
        ({**TORUS, "exponent": 0.005, "error": 1e-4, "late": 0.7}, Regime.quasi_periodic),  # shear, which comes to an end
        ({"K": 0.5, "low": 0.1, "digits": 2.7, "final": True}, Regime.chaotic),  # but for one over the longest run
        ({**TORUS, "exponent": -0.1, "returns": False}, Regime.locked),  # no return can be seen
        ({**TORUS, "exponent": -0.1, "digits": 1.0, "returns": False}, Regime.locked),  # nothing is left of the start
        ({**TORUS, "exponent": -0.01, "digits": 1.0, "returns": False}, Regime.undecided),
        ({**TORUS, "K": np.nan, "low": np.nan}, Regime.quasi_periodic),  # the 0-1 test may have no say
        ({"exponent": np.nan, "error": np.nan}, Regime.undecided),
    ],
)
def test_rules(given, label):
    assert judged(**given)[0] == label


def test_confidence_is_the_share_that_speaks():
    assert judged()[1] == 1.0
    assert judged(K=0.5, low=0.1)[1] == pytest.approx(2 / 3)
    assert judged(digits=9.0)[1] == 0.0


def test_votes_stand_beside_the_label():
    votes = judged()[2]["vote"][:, 0].tolist()
    assert votes == [Vote.none, Vote.chaotic, Vote.chaotic, Vote.chaotic]


def test_a_batch_is_judged_point_by_point():
    """Chaos, a torus and a cycle side by side, and the same alone."""
    angle = 2 * np.pi * circle_map(0.4, 0.7, 1024)
    torus, cycle = np.stack([np.cos(angle), np.sin(angle)], axis=1), np.tile([[0.1, 2.0], [0.3, 1.0]], (512, 1))
    section = np.stack([henon(1024), torus, cycle], axis=2)
    ds = regime(
        [0, 0, 0], [0, 0, 2], exponent=[0.419, 0.0, -0.3], exponent_error=[0.01, 0.001, 0.001], duration=1024,
        section=section,
    )  # fmt: skip
    assert ds["regime"].values.tolist() == [Regime.chaotic, Regime.quasi_periodic, Regime.periodic]
    alone = regime([0], [0], exponent=[0.0], exponent_error=[0.001], duration=1024, section=section[:, :, 1:2])
    for name in ("zero_one", "digits", "winding"):
        np.testing.assert_array_equal(alone[name].values[0], ds[name].values[1])


def test_bits_of_evidence_do_not_depend_on_the_company():
    """More points than are judged together; some with a coordinate that stands still, with bands of chaos, or broken."""
    henons = np.stack([henon(300) * (1 + k) for k in range(40)], axis=2)
    henons[:, 1, 3:6] = 7.0
    henons[:, :, 8:12] = np.stack([logistic(3.574, 300), logistic(3.574, 300)], axis=1)[:, :, None]
    henons[9, 0, 20] = np.nan
    whole, turns = section_evidence(henons), rotation_numbers_of(henons)
    assert np.isfinite(whole.growth).sum() == 39
    for k in range(40):
        alone = section_evidence(henons[:, :, k : k + 1])
        for name in ("growth", "growth_low", "digits"):
            np.testing.assert_array_equal(getattr(alone, name)[0], getattr(whole, name)[k])
        assert repr(rotation_numbers_of(henons[:, :, k : k + 1])[0]) == repr(turns[k])


def test_one_coordinate_turns_in_the_plane_of_its_last_value():
    x = np.cos(2 * np.pi * GOLDEN * np.arange(512))
    for section in (x[:, None, None], np.stack([np.ones(512), x], axis=1)[:, :, None]):
        turned = rotation_numbers_of(section)[0].number
        assert turned in (pytest.approx(GOLDEN), pytest.approx(1 - GOLDEN))


def test_evidence_does_not_depend_on_scale_shift_or_rotation():
    x = henon(1024)
    turn = np.array([[np.cos(1.0), -np.sin(1.0)], [np.sin(1.0), np.cos(1.0)]])
    torus = np.stack([np.cos(2 * np.pi * GOLDEN * np.arange(1024)), np.sin(2 * np.pi * GOLDEN * np.arange(1024))], axis=1)
    for points, chaotic in ((x, True), (torus, False)):
        for moved in (points, 1e-5 * points + 3.0, points @ turn, points * np.array([1e-3, 1e3])):
            e = section_evidence(moved[:, :, None])
            assert (e.growth[0] > 0.9) == chaotic and (e.digits[0] < 3) == chaotic


def test_an_angle_enters_by_its_circle():
    """A rotation that winds on and one that is wrapped are the same motion."""
    angle = 2 * np.pi * GOLDEN * np.arange(1024)
    for phase in (angle, angle % (2 * np.pi)):
        e = section_evidence(phase[:, None, None], cyclic={0: 2 * np.pi})
        assert e.digits[0] > 8
        turned = rotation_numbers_of(phase[:, None, None], {0: 2 * np.pi})[0].number
        assert turned in (pytest.approx(GOLDEN), pytest.approx(1 - GOLDEN))


def test_short_still_and_broken_sections_are_not_judged():
    short = section_evidence(henon(100)[:, :, None])
    still = section_evidence(np.ones((512, 2, 1)))
    broken = henon(512)[:, :, None].copy()
    broken[7] = np.nan
    for e in (short, still, section_evidence(broken)):
        assert np.isnan(e.growth[0]) and np.isnan(e.digits[0])
    settling = section_evidence((logistic(3.2, 512) + 1e-9 * 0.9 ** np.arange(512))[:, None, None])
    assert np.isnan(settling.growth[0]) and settling.closes[0]  # what is left of it without its cycle is not judged
