"""Coexisting attractors of one operating point: many start states, one batch, gathered, each with evidence and basin."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, Unpack

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.indicators.section_indicators import LEAST
from whirlmap.analysis.labels.labelling import measure
from whirlmap.analysis.labels.regime import regime
from whirlmap.analysis.motion.ensembles import TANGENT_STEPS, cyclic_states, make_ensemble, run_attributes, tangent_steps
from whirlmap.analysis.steady.returns import settle_and_record
from whirlmap.analysis.variational.exponents_with_section import run_with_section
from whirlmap.analysis.variational.lyapunov import mean_and_error
from whirlmap.errors import RangeError
from whirlmap.integrate.accuracy import LADDER, StepVerdict, doubtful
from whirlmap.integrate.ranges import plain_numbers
from whirlmap.integrate.system import System
from whirlmap.options.computed import LABELLING, Integration, Labelling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import LabellingParts
from whirlmap.results.regime import Regime
from whirlmap.results.schema import names_coordinate, regime_variable, status_variable, variable, with_attributes
from whirlmap.results.status import Status
from whirlmap.sweep.attractors.attractor_search import Search
from whirlmap.sweep.attractors.attractors_so_far import found_so_far
from whirlmap.sweep.attractors.known_attractors import Found
from whirlmap.sweep.attractors.start_states import Ends, box_ends, default_box, draw_starts, repeated
from whirlmap.sweep.interruptible import Work, in_parts
from whirlmap.sweep.points.point_variables import points_dataset

Array = NDArray[np.float64]

#: Starts whose steps per T are chosen by the accuracy, settled; all take the most that one of them needs.
PILOT = 64
#: T over which all indicators are asked of each attractor, where nothing else is.
EVIDENCE = 2048
#: Section points of each attractor that the Dataset keeps.
KEPT = 512
#: What starts come to that reach no attractor.
OUTCOMES = (Regime.contact, Regime.diverged, Regime.drifting, Regime.growing, Regime.not_settled, Regime.undecided)


@in_parts("attractors")
def attractors(
    system: System,
    *,
    starts: int | ArrayLike = 256,
    box: Mapping[str, Ends] | None = None,
    seed: int = 0,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    **_given: Unpack[LabellingParts],
) -> Work:
    """Find the attractors of one operating point that many start states lead to.

    Parameters
    ----------
    system : System
        Its values and start states count.
    starts : int or array, shape (state, start)
        How many start states are drawn at random from the box, or the start states themselves, all at phase zero.
    box : mapping of state to (low, high), optional
        Where starts are drawn, uniformly; the ends may have a unit, ``("-20 um", "20 um")``. The other states keep the
        system's start values. Without any box all states are drawn from `default_box`.
    seed : int
        Of the drawing.
    labelling : Labelling, optional
        How points are measured; or its parts as keywords, ``settling``, ``lyapunov``, ``method``, ``steps``, ``accuracy``.
        ``lyapunov`` is 256 or more.
    execution : Execution, optional
        How it is run, which changes no number; or its parts as keywords, ``workers``, ``progress``.

    Returns
    -------
    xr.Dataset
        Over ``attractor``, numbered from 1 by falling share: the variables of `label_points` (``regime``, ``period_T``,
        extremes, ...) with the exponent of periodic ones as well, ``vote(indicator, attractor)`` and the numbers behind
        it (see `regime`), ``starts``, ``share`` and ``share_error``, ``section(attractor, member, state)``: its points at
        phase zero of the common period, at most `KEPT`, NaN beyond. Over ``outcome`` (`OUTCOMES`):
        ``outcome_starts``, ``outcome_share``, ``outcome_share_error``. Over ``start``: ``start_state(state, start)``,
        ``attractor_of`` (0: none), ``start_regime``, ``start_status``.

    Raises
    ------
    RangeError
        Where a state is unknown, a box is empty, or starts have another shape.
    InputError
        A unit that a state does not have.

    Notes
    -----
    1. All starts settle as one batch. Those that return are on the same orbit where a point of it is theirs, at a phase of
       the forcing that is the same: orbits are closed by Newton's method (`periodic_orbits.closed_orbit`), and compared to
       ten tolerances of settling. Angles are compared modulo their period. The phases are those of the common period, or of
       what is left of it where a harmonic has no amplitude (`repeat_time`).
    2. Those that do not return belong to a known orbit where they converge to it. Of the others, `LANES` and then twice as
       many each time are labelled (`label_points`). Those that come out chaotic, quasi-periodic or locked (and cycles of
       unforced models) are traced over 2048 section points (`attractor_search.TRACE`), and the others are on the same
       attractor where 32 of their section points (`RECORD`) lie on the trace (`on_set`). What has no label then runs on
       while it approaches a known orbit, and is traced. Sets are one where their distributions do not differ beyond chance
       (`whirlmap.analysis.indicators.distribution`); two that do are traced over four times as many points, and must differ
       again.
    3. The label of every attractor comes from one more run with all indicators. A start that ends in contact or diverges,
       or whose label is undecided, has no attractor, and is counted as such.

    The error of a share is that of a binomial share after Laplace, sqrt(p (1 - p) / (n + 3)) with p = (k + 1) / (n + 2):
    it is not zero where all starts agree. It is NaN in a search that was stopped while starts ran: those that come to an
    end early are no random part. An attractor of share p is missed by n starts with probability (1 - p)^n. The attribute
    ``box`` (JSON) has the ranges from which starts were drawn.
    An orbit that is unstable, or whose basin is thinner than the starts, is not seen; a chaotic transient longer
    than settling and exponent's run is taken for an attractor. Orbits closer than ten tolerances of settling are one (those
    that Newton's method does not close, as where dry friction holds a mass: closer than `SAME_POINT`).

    ``attractors.parts`` gives the `Work`, which counts starts, and the measurement of the attractors as one more. Who stops
    keeps the starts that have come to an attractor or ended; the others have ``start_status`` failed, and of the attractors
    no more is known than `found_so_far` says.

    References
    ----------
    [parker1989] orbits by Newton's method.
    """
    if labelling.lyapunov is not None and not LEAST <= labelling.lyapunov <= 10_000_000:
        raise RangeError(f"lyapunov must lie between {LEAST} and 10000000 T, not {labelling.lyapunov}")
    drawn = isinstance(starts, int | np.integer)
    if drawn:
        box = default_box(system, labelling, execution) if box is None else box
        x = draw_starts(system, int(starts), box, seed)  # type: ignore[arg-type]
    else:
        if box is not None:
            raise RangeError("box: found one, expected none where the start states themselves are given")
        x = plain_numbers("starts", starts)
        if x.ndim != 2 or x.shape[0] != system.model.dimension or not x.shape[1] or not np.isfinite(x).all():
            raise RangeError(
                f"starts have shape {x.shape}, expected {system.model.dimension} states ({' '.join(system.states)}) by"
                " one or more starts, all finite"
            )
    n = x.shape[1]
    search: Search | None = None
    evidence: tuple[xr.Dataset, dict[str, Any]] | None = None
    doubts: str | None = None
    missing = "all starts had come to an attractor"

    def parts(_: Work) -> Iterator[int]:
        nonlocal search, evidence, doubts, missing
        same, doubts = _one_step(system, labelling, execution, x)
        search = Search(system, same, execution, x)
        search.run()
        missing = "the attractors were measured"
        yield n
        evidence = _evidence(system, same, execution, search.found)
        yield n + 1

    def gather(work: Work) -> xr.Dataset | None:
        if search is None:
            return None
        gathered = np.ones(n, dtype=bool)
        if evidence is None:
            search.gather_some()
            gathered = search.gathered  # a start that has settled alone has no outcome yet: it is not undecided
            if not gathered.any():
                return None
        settled = work.done = int(gathered.sum()) + work.complete
        known = found_so_far(system, search) if evidence is None else evidence
        ds = _dataset(system, search.labelling, search.found, x, known, gathered)
        if evidence is None:
            where = f"after {settled} of {n} starts" if settled < n else f"before {missing}"
            ds.attrs["incomplete"] = f"interrupted {where}"
        if doubts:
            ds.attrs["accuracy_not_met"] = doubts
        return ds if box is None else ds.assign_attrs(seed=seed, box=json.dumps(box_ends(system, box)))

    return Work(n + 1, parts, gather)


def _one_step(
    system: System, labelling: Labelling, execution: Execution, starts: Array
) -> tuple[Labelling, str | None]:
    """Choose the steps per T that all starts take, and say where they do not meet the accuracy.

    With steps of their own, starts on one orbit would settle on as many slightly different ones, as integrated. Where the
    motion passes corners and the accuracy is out of reach, all take the most steps of the ladder: between steps the
    corners shift a weakly attracting orbit by more than it attracts, which can make two of it (the dead zone, 8 and 16 T).
    """
    if labelling.integration.steps is not None or not system.model.forced:
        return labelling, None
    order = np.lexsort(starts)  # the same starts, whatever order they come in, and from all parts of a grid
    some = starts[:, order[np.linspace(0, order.size - 1, min(PILOT, order.size)).astype(int)]]
    ensemble, _ = make_ensemble(
        system, repeated(system, some.shape[1]), starts=some, integration=labelling.integration, execution=execution
    )  # fmt: skip
    settling = replace(labelling.settling, keep=1)
    settle_and_record(ensemble, settling, cyclic=cyclic_states(system), progress=execution.progress)
    steps = int(max(ensemble.point_steps.max(), TANGENT_STEPS))
    if (ensemble.step_verdict == StepVerdict.nonsmooth).any():
        steps = LADDER[-1]
    integration = Integration(labelling.integration.method, steps)
    return replace(labelling, integration=integration), doubtful(ensemble.step_verdict, system.model) or None


def _evidence(
    system: System, labelling: Labelling, execution: Execution, found: Found
) -> tuple[xr.Dataset, dict[str, Any]]:
    """Variables of `label_points` over the attractors with the votes of all indicators about each, and attributes."""
    if not found.representative:
        return xr.Dataset(), {}
    count = len(found.representative)
    cycle = system.strobe
    keep = max(labelling.settling.keep, 2 * cycle * max(found.multiple))
    options = replace(labelling, settling=replace(labelling.settling, keep=keep))
    values = repeated(system, count)
    measured, ensemble = measure(system, values, options, execution, starts=np.stack(found.representative, axis=1))
    ds = points_dataset(system, values, measured).reset_coords(list(values), drop=True).rename(point="attractor")
    tangent, _ = make_ensemble(
        system, values, starts=ensemble.x, tangents=1, turn=ensemble.period, execution=execution,
        integration=Integration(ensemble.method.name, tangent_steps(ensemble)),
    )  # fmt: skip
    length = -(-(labelling.lyapunov or EVIDENCE) // cycle) * cycle
    rates, record = run_with_section(tangent, length, align=-(-length // 10 // cycle) * cycle, progress=execution.progress)
    mean, spread = mean_and_error(rates[:, 0], cycle)
    record = record[: np.isfinite(record[:, 0]).all(axis=1).sum()]
    members = record[cycle - 1 :: cycle][:KEPT]
    returned = measured.returns.multiple
    inside = (returned == 0) | (np.arange(members.shape[0])[:, None] < returned)
    ds["section"] = variable(
        ("attractor", "member", "state"), np.where(inside[:, None, :], members, np.nan).transpose(2, 0, 1), "1",
        "section points, once per common period or at crossings", unit_of_each=" ".join(s.unit for s in system.model.states),
    )  # fmt: skip
    judged = regime(
        tangent.status, measured.returns.multiple, exponent=mean, exponent_error=spread,
        duration=length * tangent.period, section=record, common=cycle, cyclic=cyclic_states(system),
    )  # fmt: skip
    # The label is that of `label_points`; what the indicators say of it is beside it.
    known = ["regime", "rule", "confidence", "rotation_number", "winding", "closes"]
    votes = judged.drop_vars(known).rename(point="attractor").assign(
        lyapunov=variable("attractor", mean, "1/time", "largest Lyapunov exponent"),
        lyapunov_error=variable("attractor", spread, "1/time", "one standard error of it, from block means"),
    )
    return ds.drop_vars(set(ds.data_vars) & set(votes.data_vars)).merge(votes), run_attributes(system, ensemble)


def _share(count: NDArray[np.int64], settled: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Share, and its error after Laplace: NaN while some starts run, for those that end early are no random part."""
    total = int(settled.sum())
    p = (count + 1) / (total + 2)
    return count / total, np.sqrt(p * (1 - p) / (total + 3)) if settled.all() else np.full(p.shape, np.nan)


def _dataset(
    system: System, labelling: Labelling, found: Found, starts: Array, known: tuple[xr.Dataset, dict[str, Any]],
    settled: NDArray[np.bool_],
) -> xr.Dataset:  # fmt: skip
    """Dataset of a search; ``known`` are the attractors and attributes, of `_evidence` or `found_so_far`.

    ``settled`` are the starts that count.
    """
    ds, attributes = known
    of = found.of
    if found.representative:
        # An attractor is what has a label, once labels are known.
        sure = np.flatnonzero((ds["regime"].values != Regime.undecided) | ("vote" not in ds))
        counts = np.bincount(of[of >= 0], minlength=len(found.representative))[sure]
        order = sure[np.argsort(-counts, kind="stable")]
        number = np.zeros(len(found.representative) + 1, dtype=np.int64)
        number[order] = np.arange(1, order.size + 1)
        of = number[of]  # -1 is the last, which is 0
        ds = ds.isel(attractor=order).assign_coords(attractor=np.arange(1, order.size + 1))
    else:
        of = np.zeros(starts.shape[1], dtype=np.int64)
        attributes = run_attributes(system, Search(system, labelling, EXECUTION, starts[:, :1]).ensemble(starts[:, :1]))
    label = found.outcome.copy()
    if found.representative:
        label[of > 0] = ds["regime"].values[of[of > 0] - 1]
    label[found.status == Status.contact], label[found.status == Status.diverged] = Regime.contact, Regime.diverged
    size = int(ds.sizes.get("attractor", 0))
    counts = np.bincount(of, minlength=size + 1)[1:]
    ended = np.array([(label[(of == 0) & settled] == r).sum() for r in OUTCOMES])
    for dim, k, prefix, what in (("attractor", counts, "", "attractor"), ("outcome", ended, "outcome_", "outcome")):
        share, error = _share(k, settled)
        ds[f"{prefix}starts"] = variable(dim, k, "1", f"starts that came to this {what}")
        ds[f"{prefix}share"] = variable(dim, share, "1", f"share of the starts that came to this {what}")
        ds[f"{prefix}share_error"] = variable(dim, error, "1", "one standard error of it, binomial after Laplace")
    units = " ".join(s.unit for s in system.model.states)
    ds["start_state"] = variable(("state", "start"), starts, "1", "start states", unit_of_each=units)
    ds["attractor_of"] = variable("start", of, "1", "attractor that a start came to, 0 where none")
    ds["start_regime"] = regime_variable("start", label)
    ds["start_status"] = status_variable("start", np.where(settled, found.status, Status.failed))
    ds = ds.assign_coords(
        state=names_coordinate("state", system.states, "state"),
        outcome=names_coordinate("outcome", [r.label for r in OUTCOMES], "how starts without an attractor end"),
    )
    s = labelling.settling
    return with_attributes(ds, attributes | {
        "transient": s.transient, "most": s.most, "tolerance": s.tolerance,
        "lyapunov_periods": labelling.longest(system.strobe),
    })  # fmt: skip
