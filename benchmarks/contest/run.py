"""The short benchmark: whirlmap beside heyoka, SciPy and plain C on the gear pair, in one run on one core."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contest.c_reference import CRun, compiler
from contest.problems import Problem, gear_pair
from contest.ratios import Point, ratio
from contest.taylor import FIT_OVER_TOLERANCE, HarmonicsAs, TaylorRun, heyoka, taylor_system
from contest.turns import Contender, scipy_run, take_turns, whirlmap_run
from whirlmap.errors import InputError
from whirlmap.integrate.accuracy import LADDER, choose_steps
from whirlmap.kernels.methods import METHODS
from whirlmap.kernels.running.machine import processor
from whirlmap.kernels.running.root_choice import chosen, reason
from whirlmap.kernels.writing.routine import LANES

Array = NDArray[np.float64]
Say = Callable[[str], None]

#: Permeabilities of the gear pair, as they are called in the result.
PSI = {"psi=0": 0.0, "psi=0.001": 1e-3}
#: Median errors after 8T at which heyoka is compared.
ERRORS = {"1e-5": 1e-5, "1e-7": 1e-7, "1e-9": 1e-9}
#: Median error at which SciPy and the C kernel are compared.
SCIPY_ERROR = 1e-7
#: Right-hand sides per T that a method is tried with; its steps per T follow from its stages.
EVALUATIONS = (48, 72, 96, 132, 180, 250, 350, 480, 660, 900, 1250, 1750)
#: The method whose steps are chosen for each point by an asked accuracy, as every command does, and those accuracies.
BY_ACCURACY, ACCURACIES = "dop853", tuple(10.0 ** (-k / 2) for k in range(6, 21))
#: A setting of ours whose median error is larger than this, or that loses a point (an explicit method on a stiff point,
#: whose steps are then all mended), is of no use to anybody and is left out.
USELESS = 1e-2
#: Steps per T below which RK4 is unstable at the lowest speeds; plain C does not look.
FEWEST_IN_C = 40
#: Tolerance of the reference solutions: heyoka's, and DOP853's where there is no heyoka.
REFERENCE, SUBSTITUTE = 1e-15, 3e-14


@dataclass(frozen=True)
class Plan:
    """How much is measured.

    Attributes
    ----------
    points, scipy_points : int
        Operating points, and those of SciPy, which takes a thousand times as long; whole blocks of lanes, two or more.
    rounds : int
        Turns of each contender.
    tolerances : tuple of float
        Of heyoka.
    taylor : tuple of (batch, harmonics_as)
        Forms of heyoka.
    scipy_tolerances : tuple of float
    scipy_repeats : int
    c_lanes : tuple of int
        Operating points side by side in plain C.
    """

    points: int = 512
    scipy_points: int = 64
    rounds: int = 15
    tolerances: tuple[float, ...] = tuple(10.0**-k for k in range(3, 13))
    taylor: tuple[tuple[int, HarmonicsAs], ...] = ((1, "time"), (4, "time"), (8, "time"), (8, "states"))
    scipy_tolerances: tuple[float, ...] = (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
    scipy_repeats: int = 2
    c_lanes: tuple[int, ...] = (1, 8, 32)


QUICK = Plan(rounds=7, tolerances=(1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9), taylor=((8, "time"),),
             scipy_tolerances=(1e-6, 1e-8, 1e-10), scipy_repeats=1, c_lanes=(1, 8))  # fmt: skip


def steps_per_period(stages: int) -> list[int]:
    """Steps per T that a method of so many stages is tried with."""
    return sorted({max(n // stages, 1) for n in EVALUATIONS})


def benchmark(plan: Plan, say: Say) -> dict[str, Any]:
    """Measure, and return what ``whirlmap bench --json`` prints.

    Notes
    -----
    All errors are largest differences over the states after 8T from the end states of heyoka at a tolerance of 1e-15,
    median over the speeds; all times are processor time, the shortest of several turns. Ratios are their time over
    whirlmap's at equal median error. For heyoka and SciPy the best method and batch of each side count; plain C is RK4
    and is compared with whirlmap's RK4.
    """
    say(f"kernels for {processor()[0]}, roots and reciprocals by {chosen()} ({reason()})")
    missing: dict[str, str] = {}
    peers = _available(missing, say)
    contenders: list[Contender] = []
    exact: dict[Problem, Array] = {}
    for psi in PSI.values():
        problem = gear_pair(psi, plan.points)
        if psi > 0 and "heyoka" in missing:
            continue  # nothing independent of whirlmap's own film table would be left to measure errors with
        few = gear_pair(psi, plan.scipy_points)
        exact |= {p: reference_ends(p, substitute="heyoka" in missing) for p in (problem, few)}
        contenders += whirlmap_contenders(problem, exact[problem], say)
        if "heyoka" in peers:
            contenders += taylor_contenders(problem, plan, say)
        if psi == 0:
            contenders += scipy_contenders(few, plan)
            contenders += c_contenders(problem, plan) if "c_reference" in peers else []
    say(f"{len(contenders)} contenders take turns")
    take_turns(contenders, plan.rounds, say)
    raw = [c.row(exact[c.problem]) for c in contenders]
    compiled = {"processor": processor()[0], "roots": str(chosen())}
    return {**summary(raw, missing), "raw": raw, "missing": missing, **compiled}


def _available(missing: dict[str, str], say: Say) -> set[str]:
    """Names of the optional peers that can run; why the others cannot goes to ``missing``."""
    peers = set()
    for name, check in (("heyoka", heyoka), ("c_reference", compiler)):
        try:
            check()
            peers.add(name)
        except InputError as error:
            missing[name] = str(error).replace("\n ", ";")
            say(f"note: {error}")
    if "heyoka" in missing:
        missing["heyoka"] += f"; errors are measured against DOP853 at {SUBSTITUTE:g}, for psi = 0 alone"
    return peers


def reference_ends(problem: Problem, *, substitute: bool = False) -> Array:
    """End states of the reference solution, shape (state, point): heyoka at 1e-15, or DOP853 where that is asked for."""
    if substitute:
        return scipy_run(problem, "DOP853", SUBSTITUTE)()[1]
    return TaylorRun(problem, taylor_system(problem, harmonics_as="time"), tolerance=REFERENCE, batch=1)()[1]


def whirlmap_contenders(problem: Problem, exact: Array, say: Say) -> list[Contender]:
    """Every method of whirlmap with all of its numbers of steps that get anywhere, and with steps by asked accuracy.

    The steps that an accuracy asks for are chosen before the clock starts, as heyoka's step sizes are not: choosing takes
    two or three common periods, once, of the hundred that a point settles and is recorded.
    """
    out = []
    for accuracy in ACCURACIES:
        rungs = choose_steps(problem.ensemble(BY_ACCURACY, LADDER[0]), accuracy)
        run = whirlmap_run(problem, BY_ACCURACY, rungs.steps)
        out.append(Contender(f"whirlmap {BY_ACCURACY}, steps by accuracy", problem, accuracy, LANES, run))
        say(f"{problem.name}: accuracy {accuracy:g} takes {rungs.steps.min()} to {rungs.steps.max()} steps per T")
    for name, method in METHODS.items():
        for steps in steps_per_period(method.stages):
            c = Contender(f"whirlmap {name}", problem, steps, LANES, whirlmap_run(problem, name, steps))
            c.turn()
            row = c.row(exact)
            if row["worst_error"] is not None and row["median_error"] < USELESS:
                out.append(c)
        say(f"{problem.name}: {name} with {[int(c.setting) for c in out if c.who.endswith(name)]} steps per T")
    return out


def taylor_contenders(problem: Problem, plan: Plan, say: Say) -> list[Contender]:
    """Heyoka in all forms of the plan."""
    out = []
    for tolerance in plan.tolerances:
        for batch, harmonics_as in plan.taylor:
            system = taylor_system(problem, harmonics_as=harmonics_as, fit_error=FIT_OVER_TOLERANCE * tolerance)
            who = "heyoka" if harmonics_as == "time" else "heyoka, harmonics as states"
            run = TaylorRun(problem, system, tolerance=tolerance, batch=batch)
            out.append(Contender(who, problem, tolerance, batch, run))
        film = f", film fit of {system.fit.name}" if system.fit else ""
        say(f"{problem.name}: heyoka compiled for {tolerance:g}{film}")
    return out


def scipy_contenders(problem: Problem, plan: Plan) -> list[Contender]:
    """SciPy's two methods."""
    return [
        Contender(f"scipy {method}", problem, tolerance, 1, scipy_run(problem, method, tolerance), plan.scipy_repeats)
        for method in ("DOP853", "LSODA")
        for tolerance in plan.scipy_tolerances
    ]


def c_contenders(problem: Problem, plan: Plan) -> list[Contender]:
    """Plain C with the steps of whirlmap's RK4."""
    return [
        Contender("c_reference rk4", problem, steps, lanes, CRun(problem, steps=steps, lanes=lanes))
        for lanes in plan.c_lanes
        for steps in steps_per_period(METHODS["rk4"].stages)
        if steps >= FEWEST_IN_C
    ]


def curves(raw: Iterable[dict[str, Any]], who: str, psi: float) -> list[Sequence[Point]]:
    """(error, time) curves of everybody whose name begins so, one for each name and batch."""
    found: dict[tuple[str, int], list[Point]] = {}
    for row in raw:
        if row["who"].startswith(who) and row["psi"] == psi and row["median_error"] is not None:
            found.setdefault((row["who"], row["batch"]), []).append((row["median_error"], row["us_per_lane_and_T"]))
    return list(found.values())


def summary(raw: list[dict[str, Any]], missing: dict[str, str]) -> dict[str, Any]:
    """Ratios of the result; one that cannot be had is None, and ``missing`` says why."""

    def at(key: str, ours: str, theirs: str, psi: float, error: float) -> float | None:
        mine, other = curves(raw, ours, psi), curves(raw, theirs, psi)
        found = ratio(mine, other, error)
        if found is None and key.partition(" ")[0] not in missing:
            missing[key] = f"the measured curves do not both reach a median error of {error:g}"
        return found

    return {
        "heyoka": {
            name: {text: at(f"heyoka {name} {text}", "whirlmap", "heyoka", psi, error) for text, error in ERRORS.items()}
            for name, psi in PSI.items()
        },
        "scipy": {m: at(f"scipy {m}", "whirlmap", f"scipy {m}", 0.0, SCIPY_ERROR) for m in ("DOP853", "LSODA")},
        "c_reference": at("c_reference", "whirlmap rk4", "c_reference", 0.0, SCIPY_ERROR),
    }
