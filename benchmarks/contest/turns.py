"""Contenders taking turns: a machine that changes its speed then changes it for all."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contest.problems import Problem

Array = NDArray[np.float64]

#: Processor seconds of all lanes over a run, and their end states.
Run = Callable[[], tuple[float, Array]]


@dataclass
class Contender:
    """One method of integrating one problem.

    Attributes
    ----------
    who : str
        Integrator and method.
    problem : Problem
    setting : float
        Tolerance, asked accuracy, or steps per T.
    batch : int
        Operating points side by side.
    run : callable
        See `Run`; everything that happens once has happened before.
    repeats : int
        Most turns that it takes; slow ones need few.
    """

    who: str
    problem: Problem
    setting: float
    batch: int
    run: Run
    repeats: int = 1_000
    seconds: float = field(default=np.inf)
    ends: Array | None = None

    def turn(self) -> None:
        """Run once; the shortest time counts."""
        seconds, self.ends = self.run()
        self.seconds = min(self.seconds, seconds)

    def row(self, exact: Array) -> dict[str, Any]:
        """What was measured, against the exact end states, shape (state, point).

        Errors are largest over the states, then median and largest over the points whose orbit stays clear of a
        bearing's centre; None where a point was lost.
        """
        assert self.ends is not None, "a contender is measured after its turns"
        error = np.abs(self.ends - exact).max(axis=0)[~self.problem.through_centre]
        return {
            "who": self.who,
            "psi": self.problem.psi,
            "batch": self.batch,
            "tol_or_steps": self.setting,
            "median_error": number(np.median(np.nan_to_num(error, nan=np.inf))),
            "worst_error": number(error.max()),
            "us_per_lane_and_T": 1e6 * self.seconds / (self.problem.points * self.problem.periods),
        }


def number(x: Any) -> float | None:
    """Return a finite number, or None: JSON has no other."""
    return float(x) if np.isfinite(x) else None


def take_turns(contenders: Sequence[Contender], rounds: int, say: Callable[[str], None]) -> None:
    """Let everybody run once in each round, after one turn that is not counted."""
    for c in contenders:
        c.turn()
        c.seconds = np.inf
    begin = time.monotonic()
    for i in range(rounds):
        for c in contenders:
            if i < c.repeats:
                c.turn()
        say(f"round {i + 1} of {rounds}: {time.monotonic() - begin:.0f} s")


def whirlmap_run(problem: Problem, method: str, steps: int | NDArray[np.int64], workers: int = 1) -> Run:
    """Whirlmap's lanes on one core: kernels, tables and ensembles are made before the clock starts."""

    def run() -> tuple[float, Array]:
        ensemble = problem.ensemble(method, steps, workers)
        begin = time.thread_time()
        ensemble.advance(problem.periods)
        return time.thread_time() - begin, np.where(ensemble.running, ensemble.x, np.nan)

    return run


def scipy_run(problem: Problem, method: str, tolerance: float) -> Run:
    """SciPy's `solve_ivp` on a Numba right-hand side, one point after the other; rtol = atol = tolerance."""
    from scipy.integrate import solve_ivp

    from contest.scalar_code import evaluate_inputs, numba_rhs, scalar_code

    rhs = numba_rhs(problem.model)
    inputs = evaluate_inputs(scalar_code(problem.model).hoisted, problem.values)
    rhs(0.0, problem.x0[:, 0], np.ascontiguousarray(inputs[:, 0]))  # compiles

    def run() -> tuple[float, Array]:
        out = np.full_like(problem.x0, np.nan)
        begin = time.thread_time()
        for i in range(problem.points):
            span = (0.0, problem.period[i] * problem.periods)
            p = np.ascontiguousarray(inputs[:, i])
            solved = solve_ivp(rhs, span, problem.x0[:, i], method, args=(p,), rtol=tolerance, atol=tolerance)
            if solved.success:
                out[:, i] = solved.y[:, -1]
        return time.thread_time() - begin, out

    return run
