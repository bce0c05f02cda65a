"""Lanes against one lane, and against SciPy: both ratios from one run.

Run it with ``python benchmarks/lanes.py``, or with ``--full`` for the whole diagram of 600 speeds x 300 common periods, on
one core. The contenders take turns, so that a machine that changes its speed changes it for all; medians are printed.

1. whirlmap's lanes: RK4, phase-locked, 32 operating points in one call.
2. The same generated kernel compiled for a single lane.
3. SciPy's `solve_ivp` (DOP853 and LSODA) with a Numba right-hand side: the same generated code, one point. Its tolerance is
   chosen so that its error over a common period equals that of the lanes, by bisection on rtol.
"""

import argparse
import json
import time

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import whirlmap
from whirlmap.analysis.points import make_ensemble
from whirlmap.kernels import source
from whirlmap.kernels.lanes import Waves
from whirlmap.kernels.methods import RK4

STEPS = 100


def lane_time(system, speeds, periods):
    """Seconds per right-hand side and lane, one core."""
    ensemble, _ = make_ensemble(system, {"s": speeds}, steps=STEPS, method="rk4", workers=1)
    ensemble.advance(ensemble.common_multiple)
    begin = time.perf_counter()
    ensemble.advance(periods * ensemble.common_multiple)
    taken = time.perf_counter() - begin
    return taken / (periods * ensemble.common_multiple * STEPS * RK4.stages * speeds.size)


def single_lane_module(model):
    """The same kernel, generated for one lane."""
    kept = source.LANES
    source.LANES = 1
    try:
        text = source.kernel_source(model, RK4, tangents=False, kind="locked")
    finally:
        source.LANES = kept
    names = {}
    exec(compile(text.text.replace("cache=True, ", ""), "single_lane", "exec"), names)
    return text, names


def single_time(system, made, periods):
    """Seconds per right-hand side of the single-lane kernel."""
    text, names = made
    model = system.plain_model()
    p = text.hoisted.evaluate(system.vector[:, None]).ravel()
    ensemble, _ = make_ensemble(system, steps=STEPS, method="rk4")
    waves = Waves.of(system.orders, STEPS, text.nodes)
    common = system.common_multiple
    tables, offsets = np.zeros(1), np.zeros(1, np.int64)
    y, h = ensemble.x[:, 0].copy(), np.full(model.dimension, ensemble.period[0] / STEPS)

    def run(n):
        names["advance"](
            y, h, p, tables, offsets, waves.table, waves.starts, waves.lengths, np.zeros(len(waves.lengths), np.int64), n,
            np.zeros(1, np.int64), np.ones(1, np.int64), -np.ones(1, np.int64), n + 1, np.zeros((0, model.dimension)),
            n + 1, np.zeros((1, 1)), np.zeros(0),
        )  # fmt: skip

    run(STEPS)
    begin = time.perf_counter()
    run(periods * common * STEPS)
    return (time.perf_counter() - begin) / (periods * common * STEPS * RK4.stages)


def scipy_times(system, made):
    """Seconds per common period of DOP853 and LSODA at the error of the lanes, and that error."""
    text, names = made
    p = text.hoisted.evaluate(system.vector[:, None]).ravel()
    frequencies = np.array([float(system.values[n]) for n in ("r_p", "r_g", "r_m")])
    rates, scratch = names["rates"], names["SCRATCH"]

    @njit
    def rhs(t, y, p, frequencies):
        c = np.empty(7)
        for j in range(3):
            c[2 * j], c[2 * j + 1] = np.cos(frequencies[j] * t), np.sin(frequencies[j] * t)
        dy = np.empty(y.size)
        rates(y, c, p, np.zeros(1), np.zeros(1, np.int64), np.zeros(scratch), dy, np.zeros(1))
        return dy

    start, _ = make_ensemble(system, steps=STEPS, method="rk4")
    x0, end = start.x[:, 0].copy(), system.common_period
    exact = solve_ivp(rhs, (0, end), x0, "DOP853", args=(p, frequencies), rtol=1e-12, atol=1e-13).y[:, -1]
    start.advance(system.common_multiple)
    error = np.abs(start.x[:, 0] - exact).max()

    def solved(method, log_tol):
        return solve_ivp(rhs, (0, end), x0, method, args=(p, frequencies), rtol=10**log_tol, atol=10**log_tol)

    def excess(log_tol, method):
        return np.log10(np.abs(solved(method, log_tol).y[:, -1] - exact).max() / error)

    out = {}
    for method in ("DOP853", "LSODA"):
        log_tol = brentq(excess, -11, -3, args=(method,), xtol=0.1)
        best = np.inf
        for _ in range(3):
            begin = time.perf_counter()
            solved(method, log_tol)
            best = min(best, time.perf_counter() - begin)
        out[method] = best
    return out, error


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--full", action="store_true", help="600 speeds x 300 common periods")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    system = whirlmap.load("gear-psfd/intended", psi=0.0, s=2.0)
    speeds, periods = (np.linspace(0.3, 4, 600), 300) if arguments.full else (np.linspace(0.3, 4, 64), 20)
    made = single_lane_module(system.plain_model())
    lanes, singles = [], []
    for _ in range(1 if arguments.full else 5):
        lanes.append(lane_time(system, speeds, periods))
        singles.append(single_time(system, made, 20))
    lane, single = float(np.median(lanes)), float(np.median(singles))
    peers, error = scipy_times(system, made)
    per_common = lane * STEPS * RK4.stages * system.common_multiple
    porous = lane_time(system.replace(psi=1e-3), speeds, min(periods, 20))
    result = {
        "ns_per_rhs": {"lanes": lane * 1e9, "single_lane": single * 1e9, "lanes, psi = 0.001": porous * 1e9},
        "single_lane_over_lanes": single / lane,
        "scipy_over_lanes": {name: seconds / per_common for name, seconds in peers.items()},
        "porous_over_plain": porous / lane,
        "error_over_common_period": float(error),
    }
    if arguments.json:
        print(json.dumps(result))
    else:
        for name, value in result.items():
            print(f"{name}: {value}")


if __name__ == "__main__":
    main()
