"""The answer of a search: shares, exclusions, what a claim pins down, and cases that load."""

import json
from dataclasses import replace

import numpy as np
import pytest
from tests.studies.gear_psfd.claims.test_claim_scores import drawn

import whirlmap
from whirlmap.errors import OutputError
from whirlmap.results.wilson import wilson_interval
from whirlmap.studies.gear_psfd.claims.claims import HOLDS, JUDGES, judge_all
from whirlmap.studies.gear_psfd.reproduction.edition_data import edition_of
from whirlmap.studies.gear_psfd.search.answer import (
    Answer,
    best_of,
    edition_share,
    exclusions,
    pinned,
    pooled,
    shares,
    together,
)
from whirlmap.studies.gear_psfd.search.answer_pages import BEGIN, END, case_text, fill, page, write_answer
from whirlmap.studies.gear_psfd.search.coarse_diagrams import Judged, Settings
from whirlmap.studies.gear_psfd.search.ranges import design, ranges
from whirlmap.studies.gear_psfd.search.variants import chosen

N = 64


def judged(name: str, seed: int) -> Judged:
    d = drawn(seed, N)
    found = judge_all(d)
    (variant,) = chosen((), (name,))
    word, score = np.stack([j.word for j in found.values()]), np.stack([j.score for j in found.values()])
    return Judged(variant, tuple(found), design(ranges(), 0, N, seed=seed), word, score, d)


@pytest.fixture(scope="module")
def answered() -> Answer:
    settings = Settings()
    names = ("literal-printed-clock-no-wall", "literal-printed-shaft", "intended-porous-fixed-shaft")
    parts = tuple(judged(name, seed) for seed, name in enumerate(names, 1))
    return Answer(settings, parts, tuple(best_of(j, None, settings) for j in parts))


def test_shares_are_of_the_sets(answered):
    j = answered.judged[0]
    for claim in answered.claims:
        share, low, high = shares(j, claim)
        assert share == (j.word[list(JUDGES).index(claim)] == HOLDS).mean()
        assert low <= share <= high


def test_the_interval_over_variants_covers_the_truth(answered):
    """Two variants in which a claim holds under 5 and 55 % of all sets: 95 of 100 intervals hold their mean, or more."""
    random, claim = np.random.default_rng(7), answered.claims[0]
    row, covered, widths = answered.judged[0].claims.index(claim), 0, []
    for _ in range(400):
        parts = []
        for j, truth in zip(answered.judged[:2], (0.05, 0.55), strict=True):
            word = np.zeros_like(j.word)
            word[row] = np.where(random.uniform(size=N) < truth, HOLDS, 0)
            parts.append(replace(j, word=word))
        share, low, high = edition_share(replace(answered, judged=tuple(parts)), "literal", claim)
        assert share == pytest.approx(np.mean([shares(j, claim)[0] for j in parts]))
        covered += low <= 0.3 <= high
        widths.append(high - low)
    assert covered / 400 >= 0.95
    alone = np.subtract(*wilson_interval(np.array([0.3 * N]), N)[::-1])[0]
    assert np.mean(widths) == pytest.approx(alone / np.sqrt(2), rel=0.05)  # of 2 N independent verdicts


def test_variants_with_more_sets_weigh_no_more(answered):
    """A variant of 64 sets where the claim holds and one of 16 where it does not: half, known as well as 32 sets tell."""
    full, few = answered.judged[:2]
    full = replace(full, word=np.full_like(full.word, HOLDS))
    few = replace(few, word=np.zeros_like(few.word[:, :16]), score=few.score[:, :16], values=few.values[:, :16])
    share, low, high = edition_share(replace(answered, judged=(full, few)), "literal", answered.claims[0])
    expected = wilson_interval(np.array([16]), 32)
    assert [share, low, high] == pytest.approx([0.5, float(expected[0][0]), float(expected[1][0])])


def test_claims_that_exclude_each_other_are_found(answered):
    j = answered.judged[2]
    word = j.word.copy()
    a, b = (j.claims.index(c) for c in ("safe-speeds", "permeability-regularises"))
    word[a], word[b] = np.where(np.arange(N) < 24, HOLDS, 0), np.where(np.arange(N) >= 40, HOLDS, 0)
    pairs = exclusions(replace(answered, judged=(replace(j, word=word),)), "intended")
    assert ["permeability-regularises", "safe-speeds"] in [p["claims"] for p in pairs]
    word[b, 0] = HOLDS
    pairs = exclusions(replace(answered, judged=(replace(j, word=word),)), "intended")
    assert ["permeability-regularises", "safe-speeds"] not in [p["claims"] for p in pairs]
    a, b = (answered.claims.index(c) for c in ("safe-speeds", "permeability-regularises"))
    counts, expected = together(replace(answered, judged=(replace(j, word=word),)), "intended")
    assert counts[a, b] == 1
    assert expected[a, b] == pytest.approx(24 * 25 / N)


def test_independence_is_asked_within_each_variant(answered):
    """Two claims that hold everywhere in one variant and nowhere in the other are independent in both."""
    first, second = answered.judged[:2]
    parts = (replace(first, word=np.full_like(first.word, HOLDS)), replace(second, word=np.zeros_like(second.word)))
    counts, expected = together(replace(answered, judged=parts), "literal")
    assert (counts == N).all()
    assert expected == pytest.approx(N)  # over both variants together it would be half of that


def test_a_group_that_decides_is_pinned_down():
    values = design(ranges(), 0, 512, seed=4)
    names = [r.name for r in ranges()]
    place = ranges()[names.index("Lambda")].place(values[names.index("Lambda")])
    rng = np.random.default_rng(0)
    holds = np.stack([place < 0.25, rng.uniform(size=512) < 0.25, np.arange(512) < 29])
    distance, limit = pinned(holds, values, ranges())
    assert distance[0].argmax() == names.index("Lambda")
    assert distance[0].max() == pytest.approx(0.75, abs=0.01)
    assert (distance[0] > limit[0]).sum() <= 2
    assert (distance[1] > limit[1]).sum() <= 1
    assert np.isnan(distance[2]).all() and np.isnan(limit[2])


def test_everything_is_written_and_the_cases_load(answered, tmp_path):
    files = write_answer(answered, tmp_path / "answer")
    names = {f.name for f in files}
    assert {"answer.md", "answer.json", "literal-best.toml", "intended-best.toml", "marginals-literal.png"} <= names
    assert all(f.stat().st_size > 0 for f in files)
    found = json.loads((tmp_path / "answer" / "answer.json").read_text())
    assert set(found["variants"]) == {j.variant.name for j in answered.judged}
    for edition, best in answered.best.items():
        system = whirlmap.load(str(tmp_path / "answer" / f"{edition}-best.toml"))
        assert system.model.switches["edition"] == edition
        assert system.model.switches["contact"] == best.variant.contact
        for name, value in best.values.items():
            assert float(system.values[name]) == value
        assert float(system.values["j_p"]) == best.variant.changes["j_p"]
        assert (system.common_multiple, float(system.values["s"])) == (8, 3.27)
        assert edition_of(str(tmp_path / "answer" / f"{edition}-best.toml")).scale == 1.0
    with pytest.raises(OutputError, match="exists already"):
        write_answer(answered, tmp_path / "answer")
    write_answer(answered, tmp_path / "answer", force=True)


def test_a_claim_that_holds_nowhere_is_said_to(answered):
    parts = tuple(replace(j, word=np.where(np.arange(len(j.claims))[:, None] == 2, 0, j.word)) for j in answered.judged)
    text = page(replace(answered, judged=parts), {})
    assert text.count("Claims that hold nowhere: ") == 2
    assert text.count("`fig3-low-8T`") >= 4
    for part in text.split("Claims that hold nowhere: ")[1:]:
        assert "`fig3-low-8T`" in part.split("\n")[0]


def test_pages_are_filled_between_their_marks(tmp_path):
    here = tmp_path / "page.md"
    here.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n")
    fill(here, "new")
    fill(here, "newer")
    assert here.read_text() == f"before\n{BEGIN}\n\nnewer\n{END}\nafter\n"
    here.write_text("no marks")
    with pytest.raises(OutputError, match="begin: whirlmap identify"):
        fill(here, "new")


def test_a_case_says_what_it_is(answered):
    text = case_text("literal", answered.best["literal"], answered)
    assert "Not the paper's own numbers" in text
    holds, values = pooled(answered, "literal")
    assert holds.shape == (13, 2 * N)
    assert values.shape[1] == 2 * N
