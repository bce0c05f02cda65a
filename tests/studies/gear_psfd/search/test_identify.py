"""The search: the same bits from its seed, killed or not, and a planted machine comes back."""

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import whirlmap
from whirlmap.analysis.steady.settling import Settling
from whirlmap.errors import OutputError, RangeError
from whirlmap.options.execution import Execution
from whirlmap.results.regime import Regime
from whirlmap.results.wilson import wilson_interval
from whirlmap.studies.gear_psfd.claims.claims import HOLDS, claims, own_windows
from whirlmap.studies.gear_psfd.claims.labelled import PSI
from whirlmap.studies.gear_psfd.search import identify, tasks
from whirlmap.studies.gear_psfd.search import refine as refinement
from whirlmap.studies.gear_psfd.search.blocks import Blocks, open_blocks
from whirlmap.studies.gear_psfd.search.coarse_diagrams import Judged, Settings, diagrams, judge_sets, sets_of
from whirlmap.studies.gear_psfd.search.identify import Cost, judged_so_far, search
from whirlmap.studies.gear_psfd.search.ranges import design, ranges
from whirlmap.studies.gear_psfd.search.refine import best_starts, refine
from whirlmap.studies.gear_psfd.search.variants import SPINS, VARIANTS, chosen

#: A variant without tables: its kernels are quick to have.
(QUICK,) = chosen((), ("literal-printed-clock",))
BRIEF = Settings(
    seed=5, speeds=(0.9, 1.61, 3.27, 3.8), settling=Settling(transient=8, most=4, keep=8), exponent_periods=128,
    accuracy=1e-3,
)
ALIKE = ("regime", "status", "lyapunov", "lyapunov_error", "amplitude", "max_eccentricity", "value", "steps", "end_time")


def same(a: xr.Dataset, b: xr.Dataset) -> None:
    for name in ALIKE:
        np.testing.assert_array_equal(a[name].values, b[name].values, err_msg=name)


@pytest.fixture
def small(monkeypatch):
    """Blocks of four sets."""
    monkeypatch.setattr(identify, "BLOCK", 4)


@pytest.mark.parametrize(
    ("count", "n", "low", "high"),
    [(0, 10, 0.0, 0.2775), (5, 10, 0.2366, 0.7634), (9, 10, 0.5958, 0.9821), (81, 263, 0.2553, 0.3662)],
)
def test_wilsons_interval(count, n, low, high):
    """81 of 263: Newcombe, Statistics in Medicine 17 (1998) 857; the others from the closed form by hand."""
    found = wilson_interval(np.array([count]), n)
    assert (float(found[0][0]), float(found[1][0])) == pytest.approx((low, high), abs=6e-5)


def test_2500_sets_are_always_enough():
    low, high = wilson_interval(np.arange(2501), 2500)
    assert ((high - low) / 2).max() < identify.PRECISION
    low, high = wilson_interval(np.array([256]), 512)
    assert float((high - low)[0] / 2) > identify.PRECISION


def test_every_variant_has_sets_of_its_own_whose_blocks_nest():
    settings = Settings()
    drawn = [sets_of(v, settings, 0, 512) for v in VARIANTS]
    assert np.unique(np.concatenate(drawn, axis=1), axis=1).shape[1] == 512 * len(VARIANTS)
    assert (drawn[0] != sets_of(VARIANTS[0], Settings(seed=2), 0, 512)).any(axis=0).all()
    np.testing.assert_array_equal(drawn[0][:, 256:], sets_of(VARIANTS[0], settings, 256, 256))


@pytest.mark.slow
def test_points_of_a_block_do_not_depend_on_its_other_sets():
    sets = design(BRIEF.ranges, 0, 6, seed=BRIEF.seed)
    whole = diagrams(QUICK, sets, BRIEF)
    assert len(set(np.unique(whole["regime"]))) > 2
    same(diagrams(QUICK, sets[:, 2:4], BRIEF, Execution(workers=1)), whole.isel(set=slice(2, 4)))
    assert whole["regime"].shape == (6, len(PSI), 4)


@pytest.mark.slow  # the same blocks by one process and by three; killed searches go on to the same bits in the quick suite
def test_shares_together_are_the_whole(small, tmp_path):
    whole = Blocks(None)
    assert list(search((QUICK,), BRIEF, whole, sets=10)) == [
        f"literal-printed-clock.{a:06d}-{b:06d}" for a, b in ((0, 4), (4, 8), (8, 10))
    ]
    shared = open_blocks(tmp_path / "store", BRIEF.identity(), resume=False)
    second = open_blocks(tmp_path / "store", BRIEF.identity(), resume=True)
    assert len(list(search((QUICK,), BRIEF, second, sets=10, share=(2, 2)))) == 2
    assert judged_so_far(second, QUICK, BRIEF) is None  # the first block is the other share's
    assert len(list(search((QUICK,), BRIEF, shared, sets=10, share=(1, 2)))) == 1
    a, b = (judged_so_far(blocks, QUICK, BRIEF) for blocks in (whole, shared))
    assert a is not None and b is not None
    np.testing.assert_array_equal(a.score, b.score)
    np.testing.assert_array_equal(a.values, b.values)
    assert a.values.shape == (len(BRIEF.ranges), 10)


def test_what_is_finished_is_not_computed_again(small, monkeypatch, tmp_path):
    store = tmp_path / "store"
    list(search((QUICK,), BRIEF, open_blocks(store, BRIEF.identity(), resume=False), sets=4))
    (store / "literal-printed-clock.000000-000004 (copy).nc").write_bytes(b"")
    monkeypatch.setattr(tasks, "diagrams", lambda *_, **__: pytest.fail("computed again"))
    for sets in (4, 3):
        assert list(search((QUICK,), BRIEF, open_blocks(store, BRIEF.identity(), resume=True), sets=sets)) == []


def test_a_store_of_another_search_is_refused(tmp_path):
    store = tmp_path / "store"
    open_blocks(store, BRIEF.identity(), resume=False)
    with pytest.raises(OutputError, match="--resume"):
        open_blocks(store, BRIEF.identity(), resume=False)
    with pytest.raises(OutputError, match="seed: found 5, now 6"):
        open_blocks(store, BRIEF.identity() | {"seed": 6}, resume=True)
    (store / "search.json").write_text("{")
    with pytest.raises(OutputError, match="not the manifest"):
        open_blocks(store, BRIEF.identity(), resume=True)


def test_time_and_precision_end_a_search(small, monkeypatch):
    told = []
    late = {"cost": Cost({QUICK.name: 100.0}), "deadline": time.monotonic() + 5}
    assert list(search((QUICK,), BRIEF, Blocks(None), sets=8, told=told.append, **late)) == []
    assert told == ["literal-printed-clock: sets from 0 on left out, the time is over"]  # once, not for every block
    told.clear()
    tight = {"cost": Cost({QUICK.name: 100.0}), "deadline": time.monotonic() + 350}
    left_out = Blocks(None)
    assert list(search((QUICK,), BRIEF, left_out, sets=5, told=told.append, **tight)) == []  # nor the shorter one behind it
    assert len(told) == 1
    monkeypatch.setattr(identify, "precise", lambda judged: judged.word.shape[1] >= 4)
    told.clear()
    assert len(list(search((QUICK,), BRIEF, Blocks(None), sets=12, told=told.append))) == 1
    assert told == ["literal-printed-clock: 4 sets are enough"]
    with pytest.raises(RangeError, match="share"):
        list(search((QUICK,), BRIEF, Blocks(None), sets=4, share=(3, 2)))


KILLED = """
import sys
from pathlib import Path
from whirlmap.analysis.steady.settling import Settling
from whirlmap.options.execution import Execution
from whirlmap.studies.gear_psfd.search import identify
from whirlmap.studies.gear_psfd.search.blocks import open_blocks
from whirlmap.studies.gear_psfd.search.coarse_diagrams import Settings
from whirlmap.studies.gear_psfd.search.variants import chosen
identify.BLOCK = 4
settings = Settings(seed=5, speeds=(0.9, 1.61, 3.27, 3.8), settling=Settling(transient=8, most=4, keep=8),
                    exponent_periods=128, accuracy=1e-3)
blocks = open_blocks(Path(sys.argv[1]), settings.identity(), resume=True)
for name in identify.search(chosen((), ("literal-printed-clock",)), settings, blocks, sets=400):
    print(name, flush=True)
"""


@pytest.mark.slow
def test_a_killed_search_goes_on_to_the_same_bits(small, tmp_path):
    store = tmp_path / "store"
    command = [sys.executable, "-c", KILLED, str(store)]
    run = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=dict(os.environ))
    assert run.stdout is not None
    for _ in range(2):
        run.stdout.readline()  # two blocks are finished: it is in the third
    time.sleep(0.05)
    run.send_signal(signal.SIGKILL)
    run.wait()
    run.stdout.close()
    left = sorted(p.name for p in store.glob("*.nc"))
    assert 2 <= len(left) < 100
    blocks = open_blocks(store, BRIEF.identity(), resume=True)
    sets = 4 * (len(left) + 1)
    assert len(list(search((QUICK,), BRIEF, blocks, sets=sets))) == 1
    fresh = Blocks(None)
    list(search((QUICK,), BRIEF, fresh, sets=sets))
    for name in fresh.names(QUICK.name):
        same(blocks[name], fresh[name])


@pytest.mark.slow  # eight generations of eight sets
def test_a_refinement_is_the_same_when_it_goes_on(small, tmp_path):
    store = tmp_path / "store"
    blocks = open_blocks(store, BRIEF.identity(), resume=False)
    list(search((QUICK,), BRIEF, blocks, sets=8))
    start = judged_so_far(blocks, QUICK, BRIEF)
    assert start is not None
    (chosen_start,) = best_starts([start])
    asked = iter([True, True, False])
    short = refine(chosen_start, BRIEF, blocks, generations=3, more=lambda: next(asked))
    assert short.values.shape[1] == 16  # two generations of eight, and the first is the design's own
    again = open_blocks(store, BRIEF.identity(), resume=True)
    long = refine(start, BRIEF, again, generations=3)
    np.testing.assert_array_equal(long.score[:, :16], short.score)
    fresh = refine(start, BRIEF, Blocks(None), generations=3)
    np.testing.assert_array_equal(long.values, fresh.values)
    np.testing.assert_array_equal(long.score, fresh.score)
    assert not np.isclose(long.values[:, -1], start.values[:, :].T).all(axis=1).any()


def test_a_refinement_begins_with_the_best_by_claims_and_by_score(monkeypatch):
    """Set 5 has the worst score and all claims: it is in the first generation, beside the three best scores."""
    sets = sets_of(QUICK, BRIEF, 0, 8)
    judged = judge_sets(QUICK, diagrams(QUICK, sets, BRIEF), BRIEF)
    score = np.tile(np.linspace(0.9, 0.2, 8), (judged.score.shape[0], 1))
    score[:, 5] = 0.0
    word = np.zeros_like(judged.word)
    word[:, 5] = HOLDS
    begun = []
    monkeypatch.setattr(refinement, "POPULATION", 4)
    monkeypatch.setattr(refinement, "differential_evolution", lambda objective, *_, init, **__: begun.append(init))
    refine(replace(judged, score=score, word=word), BRIEF, Blocks(None), generations=1)
    places = np.stack([r.place(row) for r, row in zip(BRIEF.ranges, sets, strict=True)], axis=1)
    assert {int(np.abs(places - row).max(axis=1).argmin()) for row in begun[0]} == {0, 1, 2, 5}


@pytest.mark.slow
def test_a_planted_machine_is_found_again():
    """A known set's own diagram, turned into claims, is searched for from a design that does not hold it."""
    (variant,) = chosen((), ("intended-porous-fixed-shaft",))
    here = Settings(
        seed=11, speeds=(0.6, 1.61, 2.3, 3.27), settling=Settling(transient=20, most=4, keep=8), exponent_periods=128,
        accuracy=1e-3,
    )  # fmt: skip
    known = judge_sets(variant, diagrams(variant, design(ranges(), 4000, 64, seed=77), here), here)
    d = known.labelled
    windows = [own_windows(d, k) for k in range(64)]
    blocks, claim = Blocks(None), claims()[0]
    list(search((variant,), here, blocks, sets=128))
    start = judged_so_far(blocks, variant, here)
    assert start is not None

    def holds(found, asked):
        """Whether each set satisfies all windows."""
        return np.all([judge(found.labelled, claim).word == HOLDS for judge in asked.values()], axis=0)

    # Of the sets with contact, an answer to the forcing and open motion, that with the most windows which the search has to
    # find: no set of its design satisfies them all.
    rich = [k for k in range(64) if all(m[k].any() for m in (d.kinds["with the forcing"], d.kinds["contact"], d.open))]
    planted = max((k for k in rich if not holds(start, windows[k]).any()), key=lambda k: len(windows[k]))
    asked = windows[planted]
    assert len(asked) > len(PSI) and holds(known, asked)[planted]
    met = []

    def score(found):
        met.append(holds(found, asked).any())
        return np.mean([judge(found.labelled, claim).score for judge in asked.values()], axis=0)

    refine(start, here, blocks, generations=40, score=score, more=lambda: not any(met))
    assert any(met), "no set of 40 generations satisfies all windows"


@pytest.mark.parametrize("variants", [1, 2, 3])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_shares_take_every_block_once_and_not_always_the_same_variants(variants, n, monkeypatch):
    taken = []
    monkeypatch.setattr(identify, "BLOCK", 4)
    monkeypatch.setattr(identify, "sets_of", lambda *_: None)
    monkeypatch.setattr(identify, "computed", lambda asked, *_, **__: iter([taken.append(t.name) for t in asked] and []))
    for i in range(1, n + 1):
        before = len(taken)
        list(search(VARIANTS[:variants], BRIEF, Blocks(None), sets=4 * 12, share=(i, n)))
        own = {name.rpartition(".")[0] for name in taken[before:]}
        assert len(own) == min(variants, 12 * variants // n)
    assert len(taken) == len(set(taken)) == 12 * variants


def test_a_changed_reading_is_another_search(monkeypatch):
    before = BRIEF.identity()
    monkeypatch.setitem(SPINS["intended"], "shaft", (1 / 4, 1 / 8))
    assert {k for k, v in BRIEF.identity().items() if v != before[k]} == {"readings"}


def test_identity_is_plain_data():
    assert json.loads(json.dumps(BRIEF.identity())) == BRIEF.identity()
    assert BRIEF.identity() != Settings(seed=5).identity()


def test_labels_of_a_block_are_the_codes_of_regimes():
    ds = diagrams(QUICK, design(BRIEF.ranges, 0, 2, seed=1), BRIEF)
    assert set(np.unique(ds["regime"])) <= {int(r) for r in Regime}
    assert ds.attrs["variant"] == QUICK.name
    assert ds.attrs["common_period"] == pytest.approx(16 * np.pi)


def judged_case(case: str, reading: str) -> tuple[Judged, set[str]]:
    """Judge the numbers of a case in one reading; and the claims that hold."""
    (variant,), settings = chosen((), (reading,)), Settings()
    system = whirlmap.load(case)
    values = np.array([[float(system.values.get(r.name, 1.0))] for r in settings.ranges])
    judged = judge_sets(variant, diagrams(variant, values, settings), settings)
    return judged, {c for c, holds in zip(judged.claims, judged.holds[:, 0], strict=True) if holds}


@pytest.mark.slow
def test_the_set_nearest_to_figure_3_makes_four_of_its_claims_true():
    _, held = judged_case("gear-psfd/intended-fig3", "intended-porous-positive-clock")
    assert {c for c in held if c.startswith("fig3")} == {
        "fig3-low-8T", "fig3-chaos-window", "fig3-large-amplitude", "fig3-high-chaos",
    }  # fmt: skip


@pytest.mark.slow
def test_the_numbers_of_intended_make_the_claims_about_permeability_true_but_for_one_speed():
    """At psi = 1e-3 one speed less returns than at 1e-4, where it is locked with a high period; at 0.1 twice as many do."""
    judged, held = judged_case("gear-psfd/intended", "intended-porous-fixed-shaft")
    assert {"permeability-suppresses-amplitude", "fig3-low-8T", "fig3-large-amplitude"} <= held
    lost = (judged.labelled.regime[0] != Regime.periodic).sum(axis=-1)
    assert lost[1] > 4 and lost[3] < lost[1]  # not one slow point: whole windows stop returning
    assert "permeability-regularises" not in held and np.diff(lost).max() == 1
    assert 14 - lost[3] == 2 * (14 - lost[1])
