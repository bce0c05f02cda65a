"""Following branches of periodic orbits and equilibria against a parameter: `continue_orbit`."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Unpack

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.analysis.branches.limits import Limits
from whirlmap.errors import RangeError
from whirlmap.integrate.loading import pieces
from whirlmap.integrate.ranges import Range
from whirlmap.integrate.system import System
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import LabellingParts
from whirlmap.results.provenance import provenance
from whirlmap.results.schema import with_attributes
from whirlmap.sweep.branches.branch import Branch
from whirlmap.sweep.branches.branch_dataset import dataset
from whirlmap.sweep.branches.following import Branches, Direction
from whirlmap.sweep.branches.free_parameters import FreeParameters, Varied
from whirlmap.sweep.branches.resuming import refuse_other, resumed
from whirlmap.sweep.branches.seeds import Beginning, Seed
from whirlmap.sweep.branches.seeds_of_files import seeds_of_diagram, seeds_of_point
from whirlmap.sweep.interruptible import Work, in_parts

Array = NDArray[np.float64]
#: Starts from which coexisting motions are sought.
STARTS = 256
#: Error of the segments of orbits that steps are chosen for.
ACCURACY = 1e-11
#: Times the accuracy that an error between the points at which it is checked may be without a word.
ROUGH = 100.0


@in_parts("continue")
def continue_orbit(
    system: System,
    parameter: str,
    values: str | Range | Sequence[Any],
    *,
    begin: float | str | None = None,
    period: int | None = None,
    direction: Direction = "both",
    orbit: Mapping[str, float] | Sequence[float] | None = None,
    seeds: xr.Dataset | None = None,
    coexisting: bool = False,
    starts: int = STARTS,
    doublings: int = 0,
    points: int = 2000,
    longest: float = 0.02,
    resume: xr.Dataset | None = None,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    **_given: Unpack[LabellingParts],
) -> Work:
    """Follow branches of periodic orbits, or of equilibria, against one parameter, stable or not.

    Parameters
    ----------
    system : System
        Its values and start states count.
    parameter : str
        Name of the varied parameter, or of a dimensional input of the case.
    values : (start, stop), or str
        The range: two numbers, two texts with a unit, or ``"START:STOP"``.
    begin : float or str, optional
        Value at which the branch begins; the start of the range where absent.
    period : int, optional
        T of one return (of an unforced cycle: crossings of its section); that of the settled motion where absent.
    direction : {"up", "down", "both"}
        In which the branch is followed from its first point.
    orbit : mapping of state to number, or sequence, optional
        A state near the orbit at phase zero, of an unforced model near the equilibrium (near the cycle, where a period is
        given), from which Newton's method begins instead of from the settled motion.
    seeds : xr.Dataset, optional
        A labelled diagram with the section of all states, whose point at ``begin`` is the first orbit; where that is absent,
        one point of each stretch of one period is, and what lies on an earlier branch is dropped.
    coexisting : bool
        Whether all periodic attractors at ``begin`` are followed (`attractors`).
    starts : int
        Start states from which these are sought.
    doublings : int
        How many successive period doublings are followed onto their doubled branches.
    points : int
        Most points of a branch in each direction.
    longest : float
        Longest step, in units of the range and of the sizes of the states; where the branch is straight, of the range alone.
    resume : xr.Dataset, optional
        What an interrupted run with the same arguments has left: its branches go on where they stood.
    labelling : Labelling, optional
        How the settled motion is found; or its parts as keywords. ``accuracy`` is also the largest error of the segments
        of an orbit, 1e-11 where absent.
    execution : Execution, optional
        How it is run, which changes no number; or its parts as keywords, ``workers``, ``progress``.

    Returns
    -------
    xr.Dataset
        Over ``point``, branch after branch: the parameter, ``branch_of``, ``arclength``, ``section(point, period, state)``,
        ``stable``, ``unstable``, ``log_modulus(point, multiplier)`` and ``argument``, extremes of states and outputs as in
        diagrams, ``steps``, ``segments``, ``step_error``, ``duration``. Over ``branch``: ``kind``, ``period_T``,
        ``first_point``, ``end(branch, side)``. Over ``event``: ``event_kind``, ``event_branch``, the parameter as
        ``event_NAME``, ``event_section``, ``event_log_modulus``, ``event_argument``, ``event_surface``, ``event_contacts``.

    Raises
    ------
    RangeError
        An unknown parameter or state, a range that does not ascend, a parameter that changes the ratio of two frequencies of
        the forcing; no periodic motion to begin with, or none that Newton's method finds.
    InputError
        A unit that the quantity does not have.

    Notes
    -----
    Multiple shooting on the stroboscopic map of a forced model, on the declared section of an unforced one, followed by
    pseudo-arclength [keller1977]; the step follows Newton's iterations and the angle of the tangents. Monodromy matrices are
    those of the tangent dynamics; only the derivative by the parameter is a difference, on which no solution depends.
    Folds, branch points, period doublings, Neimark-Sacker and Hopf points and grazing orbits are located between corrected
    points of the branch. Not followed: tori, the branches that cross at a branch point, orbits that slide along a surface
    (the end is ``kink``). Two events of one kind within one step cancel: it is halved where multipliers come so near the
    unit circle that they may cross it and come back. What they do not show is not seen: ``longest`` makes steps shorter.

    References
    ----------
    [keller1977] pseudo-arclength. [lust2001] small multipliers. [chandrupatla1997] roots between two points.
    """
    if direction not in ("up", "down", "both"):
        raise RangeError(f"direction is up, down or both, not {direction!r}")
    if sum((orbit is not None, seeds is not None, coexisting)) > 1:
        raise RangeError("a branch begins from a given orbit, from a file, or from the attractors: give one of them")
    for name, count, least in (("points", points, 2), ("doublings", doublings, 0), ("starts", starts, 1)):
        if not least <= count <= 1_000_000:
            raise RangeError(f"{name} must lie between {least} and 1000000, not {count}")
    if period is not None and not 1 <= period <= 4096:
        raise RangeError(f"period must lie between 1 and 4096 T, not {period}")
    if not 1e-6 <= longest <= 1:
        raise RangeError(f"longest must lie between 1e-6 and 1, not {longest}")
    varied = Varied.of(system, parameter, values)
    free = FreeParameters(system, (varied,))
    value = varied.low if begin is None else varied.read(begin)
    accuracy = labelling.integration.accuracy or ACCURACY
    first = Beginning(free, (value,), labelling, execution, accuracy)
    limits = Limits(np.array([varied.low]), np.array([varied.high]), longest, points, accuracy)
    run = Branches(limits, direction, doublings)

    facts = {"begin": value, "direction": direction, "doublings": doublings, "longest": longest, "accuracy": accuracy}

    def parts(work: Work) -> Iterator[int]:
        known: list[Branch] = []
        found: list[Seed] = []
        if resume is not None:
            refuse_other(resume, attributes(system, (varied,), [], work, resume, accuracy) | facts)
            known = resumed(first, resume)
        elif orbit is not None:
            found = first.given(orbit, period)
        elif seeds is not None:
            found = seeds_of_point(first, seeds) if begin is not None else seeds_of_diagram(first, seeds)
        else:
            found = first.coexisting(starts) if coexisting else first.settled(period)
        if not found and not known:
            place = f"{varied.given} = {varied.shown(value):g}"
            raise RangeError(f"{place}: Newton's method does not find the orbit of the settled motion")
        for done in run.follow(found, known):
            if execution.progress:
                execution.progress(1)
            work.total = max(work.total, done + 1)
            yield done
        work.total = max(work.done, 1)
        yield work.total

    def gather(work: Work) -> xr.Dataset | None:
        if not run.branches:
            return None
        ds = dataset(system, (varied,), run.branches, run.measuring)
        return with_attributes(ds, attributes(system, (varied,), run.branches, work, ds, accuracy) | facts)

    return BranchWork(run, parts, gather)


def attributes(
    system: System, varied: Sequence[Varied], branches: Sequence[Branch], work: Work, ds: xr.Dataset, accuracy: float
) -> dict[str, Any]:
    """Attributes of a Dataset of branches: where it comes from, what was varied, and what stopped each."""
    steps = "chosen for each orbit: see steps"
    origin = provenance(pieces(system), method="dop853", steps_per_period=steps, citations=("prince1981", "keller1977"))
    facts: dict[str, Any] = {
        "varied": " ".join(v.name for v in varied), "given": " ".join(v.given for v in varied),
        "unit_given": " ".join(v.unit or "1" for v in varied), "size_given": [v.size for v in varied],
        "range": [end for v in varied for end in (v.low, v.high)],
        "why": "; ".join(f"branch {k + 1}: {' | '.join(b.reasons())}" for k, b in enumerate(branches)),
    }  # fmt: skip
    doubts = sorted(set().union(*(b.doubts() for b in branches)))
    rough = ds["step_error"].values > ROUGH * accuracy
    if rough.any():
        doubts.append(f"the steps of {rough.sum()} points leave errors up to {ds['step_error'].values[rough].max():.1g}")
    if doubts:
        facts["doubts"] = "; ".join(doubts)
    if any(b.system.model.switchings == {} and b.kinked() for b in branches):
        facts["not_sought"] = (
            f"{branches[0].system.model.name} names no surface (switchings=), so grazing orbits are not sought"
        )
    if not work.complete:
        facts["incomplete"] = f"interrupted after {len(ds['point'])} points"
    return {**origin, **facts}


class BranchWork(Work):
    """Work that follows branches, which can be asked for as they are."""

    def __init__(self, found: "Branches", parts: Any, gather: Any) -> None:
        super().__init__(1, parts, gather)
        self.found = found
