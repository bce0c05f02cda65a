"""The answer of a search, in numbers: how often each claim holds, which exclude each other, and the best sets."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.results.regime import Regime
from whirlmap.results.wilson import wilson_interval
from whirlmap.studies.gear_psfd.claims.claims import NEED_ORBIT, WORDS
from whirlmap.studies.gear_psfd.claims.labelled import PSI, Array
from whirlmap.studies.gear_psfd.search.blocks import Blocks
from whirlmap.studies.gear_psfd.search.coarse_diagrams import Judged, Settings
from whirlmap.studies.gear_psfd.search.identify import judged_so_far
from whirlmap.studies.gear_psfd.search.ranges import Range
from whirlmap.studies.gear_psfd.search.refine import all_sets, refined
from whirlmap.studies.gear_psfd.search.variants import SPINS, Variant

#: Sets with both claims that would be expected of independent ones, from which "never both" says something: one of an
#: edition's 78 pairs would be so by chance in 3 searches of 100 (78 exp(-8)).
EXPECTED = 8.0
#: How often a group seems pinned down by any claim where none is.
ONE_IN = 0.01
#: Sets under which a claim holds, from which where they lie says something.
ENOUGH = 30


@dataclass(frozen=True)
class Best:
    """The best set of a variant, from design and refinement."""

    variant: Variant
    values: dict[str, float]
    score: float
    words: dict[str, str]
    refined: bool

    @property
    def met(self) -> list[str]:
        """Claims that hold, of those that a diagram decides."""
        return [claim for claim, word in self.words.items() if word == "holds"]

    @property
    def missed(self) -> dict[str, str]:
        """Claims that do not hold, with their verdict; those that need more than a diagram are not among them."""
        return {claim: word for claim, word in self.words.items() if word != "holds"}


@dataclass(frozen=True)
class Answer:
    """What a search found.

    Attributes
    ----------
    settings : Settings
    judged : tuple of Judged
        The design's sets of every variant that has any.
    bests : tuple of Best
        Of every variant, in the order of ``judged``.
    missing : tuple of str
        Variants that were asked for and have no set yet: no number speaks of them.
    """

    settings: Settings
    judged: tuple[Judged, ...]
    bests: tuple[Best, ...]
    missing: tuple[str, ...] = ()

    @property
    def best(self) -> dict[str, Best]:
        """The best set of each edition."""
        return {
            e: max((b for b in self.bests if b.variant.edition == e), key=lambda b: (len(b.met), b.score))
            for e in self.editions
        }

    @property
    def claims(self) -> tuple[str, ...]:
        """Claims that a labelled diagram decides."""
        return tuple(c for c in self.judged[0].claims if c not in NEED_ORBIT)

    def of(self, edition: str) -> tuple[Judged, ...]:
        """Variants of one edition."""
        return tuple(j for j in self.judged if j.variant.edition == edition)

    @property
    def editions(self) -> tuple[str, ...]:
        """Editions that were searched."""
        return tuple(e for e in SPINS if self.of(e))

    def summary(self) -> dict[str, Any]:
        """Return everything as plain data, for ``--json``."""
        return {
            "seed": self.settings.seed,
            "missing": list(self.missing),
            "variants": {
                j.variant.name: {
                    "sets": j.values.shape[1],
                    "claims": {c: dict(zip(("share", "low", "high"), shares(j, c), strict=True)) for c in self.claims},
                    "regimes": regimes(j),
                }
                for j in self.judged
            },
            "editions": {
                e: {c: dict(zip(("share", "low", "high"), edition_share(self, e, c), strict=True)) for c in self.claims}
                for e in self.editions
            },
            "excluded": {e: exclusions(self, e) for e in self.editions},
            "best": {
                e: {"variant": b.variant.name, "score": b.score, "holds": b.met, "missed": b.missed, "values": b.values,
                    "refined": b.refined}
                for e, b in self.best.items()
            },
        }  # fmt: skip


def answer(variants: tuple[Variant, ...], settings: Settings, blocks: Blocks) -> Answer | None:
    """Read a store; None where no block is finished."""
    judged = tuple(j for v in variants if (j := judged_so_far(blocks, v, settings)) is not None)
    if not judged:
        return None
    bests = tuple(best_of(j, refined(j.variant, settings, blocks), settings) for j in judged)
    there = {j.variant.name for j in judged}
    return Answer(settings, judged, bests, tuple(v.name for v in variants if v.name not in there))


def best_of(design: Judged, refinement: Judged | None, settings: Settings) -> Best:
    """Return the best set of one variant."""
    everything = all_sets(design, refinement)
    k = int(everything.order[0])
    read = set(design.variant.system().parameters)
    words = {c: WORDS[int(everything.word[i, k])] for i, c in enumerate(everything.claims) if c not in NEED_ORBIT}
    values = {r.name: float(everything.values[i, k]) for i, r in enumerate(settings.ranges) if r.name in read}
    return Best(design.variant, values, float(everything.total[k]), words, k >= design.values.shape[1])


def shares(judged: Judged, claim: str) -> tuple[float, float, float]:
    """Share of sets under which a claim holds, with its 95 % interval."""
    holds = judged.holds[judged.claims.index(claim)]
    low, high = wilson_interval(np.array([holds.sum()]), holds.size)
    return float(holds.mean()), float(low[0]), float(high[0])


def edition_share(answer: Answer, edition: str, claim: str) -> tuple[float, float, float]:
    """Share of an edition's sets under which a claim holds, every variant counted alike, with its 95 % interval.

    The mean over variants; Wilson's interval counts as many sets of each as the variant with the fewest has. Each variant
    has sets of its own, so that all are independent; that shares differ between variants makes their mean better known than
    the interval says, never less.
    """
    found = answer.of(edition)
    share = float(np.mean([shares(j, claim)[0] for j in found]))
    sets = len(found) * min(j.values.shape[1] for j in found)
    low, high = wilson_interval(np.array([share * sets]), sets)
    return share, float(low[0]), float(high[0])


def regimes(judged: Judged) -> dict[str, float]:
    """Share of all operating points of each kind; ``not known`` where a run failed."""
    out = {name: float(mask.mean()) for name, mask in judged.labelled.kinds.items()}
    return {**out, "not known": float((judged.labelled.regime < 0).mean())}


def contact_by_psi(judged: Judged) -> dict[float, float]:
    """Share of operating points that end in contact, at each permeability."""
    return {psi: float((judged.labelled.regime[:, k] == Regime.contact).mean()) for k, psi in enumerate(PSI)}


def pooled(answer: Answer, edition: str) -> tuple[NDArray[np.bool_], Array]:
    """Which claims hold, shape (claim, set), and the values (group, set), of all variants of an edition together."""
    found = answer.of(edition)
    rows = [found[0].claims.index(c) for c in answer.claims]
    return np.concatenate([j.holds[rows] for j in found], axis=1), np.concatenate([j.values for j in found], axis=1)


def together(answer: Answer, edition: str) -> tuple[NDArray[np.int64], Array]:
    """Sets with each pair of claims, and how many would be expected if claims were independent within every variant.

    Both have shape (claim, claim). Independent over all variants taken together would be another question: claims that are
    common in the same variants would then seem to belong together.
    """
    counts = np.zeros((len(answer.claims),) * 2, dtype=np.int64)
    expected = np.zeros(counts.shape)
    for j in answer.of(edition):
        holds = j.holds[[j.claims.index(c) for c in answer.claims]].astype(np.int64)
        counts += holds @ holds.T
        expected += np.outer(holds.sum(axis=1), holds.sum(axis=1)) / holds.shape[1]
    return counts, expected


def exclusions(answer: Answer, edition: str) -> list[dict[str, Any]]:
    """Pairs of claims that never hold together, though at least `EXPECTED` sets of independent ones would have both."""
    counts, expected = together(answer, edition)
    pairs = [(a, b) for a in range(len(counts)) for b in range(a)]
    return [
        {"claims": [answer.claims[b], answer.claims[a]], "together": 0, "expected": float(expected[a, b])}
        for a, b in pairs
        if counts[a, b] == 0 and expected[a, b] >= EXPECTED
    ]


def pinned(holds: NDArray[np.bool_], values: Array, ranges: tuple[Range, ...]) -> tuple[Array, Array]:
    """How far each claim pins each group down.

    Returns
    -------
    distance : array, shape (claim, group)
        Largest difference (Kolmogorov-Smirnov) between the distribution of the group's place in its range where the claim
        holds, and the design's; 0 means left free.
    limit : array, shape (claim,)
        What some group of some claim would exceed once in a hundred times if no claim cared for any; NaN where it holds
        under fewer than `ENOUGH` sets.
    """
    places = np.stack([r.place(values[k]) for k, r in enumerate(ranges)])
    n = holds.sum(axis=1)
    distance = np.full((len(holds), len(ranges)), np.nan)
    for c in np.flatnonzero(n >= ENOUGH):
        inside = np.sort(places[:, holds[c]], axis=1)
        step = np.arange(n[c])
        distance[c] = np.maximum(inside - step / n[c], (step + 1) / n[c] - inside).max(axis=1)  # the design is uniform
    one = np.sqrt(-0.5 * np.log(ONE_IN / (2 * distance.size)))  # Kolmogorov's limit for one of so many (Bonferroni)
    return distance, np.where(n >= ENOUGH, one / np.sqrt(np.maximum(n, 1)), np.nan)
