"""Claims over many sets at once: the same as one by one, and scores that lead where the verdicts are."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from whirlmap.results.regime import Regime
from whirlmap.studies.gear_psfd.claims.claims import HOLDS, JUDGES, NEED_ORBIT, UNKNOWN, claims, judge_all, own_windows
from whirlmap.studies.gear_psfd.claims.labelled import ORBITS, PSI, S_ORBIT, Labelled, Orbits, least_exponent, median_of
from whirlmap.studies.gear_psfd.search.coarse_diagrams import SPEEDS

S = np.array(SPEEDS)
AT = SPEEDS.index(S_ORBIT)
SHAPE = (len(PSI), S.size)


def labelled(regime, *, exponent=0.1, amplitude=None, period=8, slowness=0.0, lines=np.nan, dimension=np.nan):
    """Diagrams of some sets from their regimes, shape (set, psi, speed)."""
    regime = np.asarray(regime, dtype=np.int8)
    open_motion = np.isin(regime, (Regime.undecided, Regime.chaotic, Regime.quasi_periodic))
    exponents = np.where(open_motion, exponent, np.nan)
    errors = np.where(open_motion, 0.01, np.nan)
    ended = np.isin(regime, (Regime.contact, Regime.diverged))
    pp = np.where(ended, np.nan, S * np.ones(regime.shape) if amplitude is None else amplitude)
    n = len(regime)
    at = (n, len(PSI))
    orbits = Orbits(
        regime[:, :, AT], exponents[:, :, AT], errors[:, :, AT], np.broadcast_to(lines, at), np.broadcast_to(0.0, at),
        {y: (np.broadcast_to(dimension, at), np.broadcast_to(0.02, at)) for y in ORBITS},
    )  # fmt: skip
    periods = np.where(regime == Regime.periodic, period, 0)
    return Labelled(S, regime, periods, exponents, errors, pp, np.full(regime.shape, slowness), 8, 1e-3, orbits)


def part(d: Labelled, k: int) -> Labelled:
    """One of the sets."""
    one = slice(k, k + 1)
    orbits = Orbits(
        d.orbits.regime[one], d.orbits.exponent[one], d.orbits.error[one], d.orbits.lines[one], d.orbits.broadband[one],
        {y: (v[one], e[one]) for y, (v, e) in d.orbits.dimension.items()},
    )  # fmt: skip
    return Labelled(
        d.s, d.regime[one], d.period[one], d.exponent[one], d.error[one], d.amplitude[one], d.slowness[one], d.forced,
        d.least, orbits,
    )  # fmt: skip


def drawn(seed: int, n: int = 6) -> Labelled:
    rng = np.random.default_rng(seed)
    weights = rng.dirichlet(np.ones(6) * 0.4)
    shape = (n, *SHAPE)
    return labelled(
        rng.choice(6, size=shape, p=weights), exponent=rng.normal(0, 0.05, shape), amplitude=rng.lognormal(size=shape),
        period=rng.choice([8, 8, 8, 16, 24], size=shape), slowness=rng.uniform(size=shape),
        lines=rng.choice([np.nan, 3.0, 30.0], (n, 1)), dimension=rng.choice([np.nan, 1.28, 1.41, 1.8], (n, 1)),
    )  # fmt: skip


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6))
def test_a_score_is_one_exactly_where_the_claim_holds(seed):
    for name, found in judge_all(drawn(seed)).items():
        assert np.all((found.score >= 0) & (found.score <= 1)), name
        np.testing.assert_array_equal(found.score == 1.0, found.word == HOLDS, err_msg=name)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6))
def test_a_set_is_judged_the_same_alone(seed):
    d = drawn(seed)
    together = judge_all(d)
    for k in range(len(d.regime)):
        for name, alone in judge_all(part(d, k)).items():
            assert alone.word[0] == together[name].word[k], name
            assert alone.score[0] == pytest.approx(together[name].score[k], abs=1e-14), name


def test_every_verdict_is_met_by_some_drawn_diagram():
    """The draws above enter what they are about."""
    words = {name: set() for name in JUDGES}
    for seed in range(400):
        for name, found in judge_all(drawn(seed)).items():
            words[name] |= set(found.word.tolist())
    rare = {"fig3-chaos-window", "fig3-mid-8T", "fig3-high-chaos", "fig4-windows", "fig5-windows", "fig3-low-8T"}
    for name, found in words.items():
        if name not in rare:
            assert HOLDS in found, name
        assert len(found) >= 2, name


def wanted(psi):
    """Regimes of Figures 3 and 4: where they say chaos and where the period of the forcing."""
    if psi == 1e-4:
        return np.where(((S >= 1.18) & (S <= 1.6)) | (S >= 3.11), Regime.chaotic, Regime.periodic)
    return np.where(((S >= 1.6) & (S <= 1.62)) | (S > 3.15), Regime.chaotic, Regime.periodic)


def test_a_machine_of_the_papers_words_satisfies_the_coarse_diagram():
    regime = np.stack([np.full(S.size, Regime.chaotic), wanted(1e-4), wanted(1e-3), wanted(0.1)])[None]
    amplitude = np.array([1.0, 0.5, 0.2, 0.1])[None, :, None] * S * np.where((S >= 1.48) & (S <= 1.6), 3.0, 1.0)
    amplitude[:, 0] = S
    amplitude[:, 2:] += np.where(regime[:, 2:] == Regime.chaotic, 1.0, 0.0) * 0.1
    found = judge_all(labelled(regime, amplitude=amplitude))
    assert {n for n, j in found.items() if j.word[0] != HOLDS} == set(NEED_ORBIT)
    assert all(found[n].word[0] == UNKNOWN for n in NEED_ORBIT)


def test_scores_grow_on_the_way_to_chaos():
    """Periodic, slow, twice the period, undecided with a falling and a rising exponent, chaotic."""
    stages = [
        labelled(np.full((1, *SHAPE), Regime.periodic)),
        labelled(np.full((1, *SHAPE), Regime.periodic), slowness=0.9),
        labelled(np.full((1, *SHAPE), Regime.periodic), period=16),
        labelled(np.full((1, *SHAPE), Regime.undecided), exponent=-0.02),
        labelled(np.full((1, *SHAPE), Regime.undecided), exponent=0.02),
        labelled(np.full((1, *SHAPE), Regime.chaotic)),
    ]
    scores = [float(judge_all(d)["fig3-high-chaos"].score[0]) for d in stages]
    assert scores == sorted(scores)
    assert len(set(scores)) == len(scores)
    assert scores[-1] == 1.0


def test_growth_without_bound_is_no_chaos():
    """A linear motion that grows has an exponent without error; what is left of it stays below the bound."""
    periods, common = 512, 16 * np.pi
    least = least_exponent(periods, common / 8)
    slow = np.log(1e6) / (common * (40 + 16 + periods / 8 + 6))  # from one to the bound in the whole run
    assert slow < least < 0.003


def test_own_windows_are_true_of_their_own_set():
    d = drawn(3)
    for k in range(3):
        windows = own_windows(d, k)
        claim = claims()[0]
        assert windows
        for name, judged in windows.items():
            assert judged(part(d, k), claim).word[0] == HOLDS, name
    others = [[judged(part(d, j), claim).word[0] == HOLDS for judged in own_windows(d, 0).values()] for j in range(1, 6)]
    assert not all(all(o) for o in others)


def test_median_of_skips_what_is_missing():
    values = np.array([[3.0, np.nan, 1.0, 2.0], [np.nan] * 4, [1.0, 2.0, 3.0, 4.0]])
    np.testing.assert_array_equal(median_of(values, np.ones((3, 4), dtype=bool)), [2.0, np.nan, 2.5])
    np.testing.assert_array_equal(median_of(values, np.array([True, True, False, False])), [3.0, np.nan, 1.5])
