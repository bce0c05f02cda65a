"""Lanes against one lane, and against SciPy: both ratios from one run, on one core.

Run it with ``python benchmarks/lanes.py``, or with ``--full`` for the whole diagram of 600 speeds x 300 common periods.

1. whirlmap's lanes: RK4, phase-locked, 100 steps per T.
2. The same module written and compiled for blocks of a single lane, in a process of its own that takes turns with 1.
3. Two points in a block with steps of their own (255 and 256 per T) over the same with equal steps.
4. SciPy's `solve_ivp` (DOP853 and LSODA) with a Numba right-hand side at the tolerance that gives the lanes' median error.
"""

import argparse
import json
import subprocess
import sys
import time

STEPS = 100


def lane_time(psi, count, common_periods):
    """Seconds per right-hand side and lane."""
    import numpy as np

    import whirlmap
    from whirlmap.analysis.motion.ensembles import make_ensemble

    system = whirlmap.load("gear-psfd/reference", psi=psi, s=2.0)
    ensemble, _ = make_ensemble(system, {"s": np.linspace(0.3, 4, count)}, steps=STEPS, method="rk4", workers=1)
    ensemble.advance(ensemble.common_multiple)
    begin = time.thread_time()
    ensemble.advance(common_periods * ensemble.common_multiple)
    taken = time.thread_time() - begin
    return taken / (common_periods * ensemble.common_multiple * STEPS * 4 * count)


def own_steps_ratio():
    """Time of a block of two points with steps of their own over that with equal ones; six of its lanes never run."""
    import numpy as np

    import whirlmap
    from whirlmap.analysis.motion.ensembles import make_ensemble

    system = whirlmap.load("gear-psfd/machine")
    times = {}
    for steps in (255, 256):
        for _ in range(3):
            first, _ = make_ensemble(system, {"s": np.full(2, system.values["s"])}, steps=256, workers=1)
            ensemble = first.subset(np.arange(2), steps=np.array([steps, 256]))
            ensemble.advance(1)
            begin = time.thread_time()
            ensemble.advance(300)
            times[steps] = min(times.get(steps, np.inf), time.thread_time() - begin)
    return times[255] / times[256]


def write_for_one_lane():
    """Make the kernels' module of vectors again, for blocks of one lane, before anything imports it."""
    import importlib.util

    spec = importlib.util.find_spec("whirlmap.kernels.writing.routine")
    module = importlib.util.module_from_spec(spec)
    text = spec.loader.get_source(spec.name)
    assert "LANES = 8" in text
    sys.modules[spec.name] = module
    exec(compile(text.replace("LANES = 8", "LANES = 1"), spec.origin, "exec"), vars(module))


def scipy_ratios(count):
    """Time of SciPy's methods over that of the lanes at the lanes' median error after 8T, and that error."""
    import numpy as np

    from contest.problems import gear_pair
    from contest.ratios import time_at
    from contest.run import SUBSTITUTE
    from contest.turns import Contender, scipy_run, whirlmap_run

    problem, many = gear_pair(0.0, 16), gear_pair(0.0, count)
    exact = scipy_run(problem, "DOP853", SUBSTITUTE)()[1]

    def row(run, turns, of=problem, against=exact):
        contender = Contender("", of, 0, 1, run)
        for _ in range(turns):
            contender.turn()
        return contender.row(against)

    ours = row(whirlmap_run(problem, "rk4", STEPS), 1)
    fast = row(whirlmap_run(many, "rk4", STEPS), 5, many, np.zeros_like(many.x0))["us_per_lane_and_T"]
    out = {}
    for method in ("DOP853", "LSODA"):
        rows = [row(scipy_run(problem, method, 10.0**-k), 2) for k in range(5, 11)]
        curve = [(r["median_error"], r["us_per_lane_and_T"]) for r in rows]
        out[method] = time_at(curve, ours["median_error"]) / fast
    return out, ours["median_error"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--full", action="store_true", help="600 speeds x 300 common periods")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--single", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.single:
        write_for_one_lane()
        print(lane_time(0.0, 8, 20))
        return
    count, periods = (600, 300) if arguments.full else (64, 100)
    lanes, singles = [], []
    for _ in range(1 if arguments.full else 3):
        lanes.append(lane_time(0.0, count, periods))
        done = subprocess.run([sys.executable, __file__, "--single"], check=True, capture_output=True, text=True)
        singles.append(float(done.stdout))
    porous = min(lane_time(1e-3, count, 100) for _ in range(3))
    peers, error = scipy_ratios(count)
    result = {
        "ns_per_rhs": {"lanes": min(lanes) * 1e9, "single_lane": min(singles) * 1e9, "lanes, psi = 0.001": porous * 1e9},
        "single_lane_over_lanes": min(singles) / min(lanes),
        "scipy_over_lanes": peers,
        "porous_over_plain": porous / min(lanes),
        "median_error_after_8T": error,
        "own_steps_over_equal": own_steps_ratio(),
    }
    if arguments.json:
        print(json.dumps(result))
    else:
        for name, value in result.items():
            print(f"{name}: {value}")


if __name__ == "__main__":
    main()
