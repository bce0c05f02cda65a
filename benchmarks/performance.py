"""All of docs/performance.md: ``python benchmarks/performance.py --json FILE`` measures, and writes it.

The short comparison (`whirlmap bench`) is the first part. With ``--from FILE`` nothing is measured: text and pictures
are made again from a file. ``--only`` chooses parts, ``--quick`` takes fewer settings and turns; what a part measured before
stays in the file. Everything runs on one core unless it says so, and times are processor times but for the cores.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np

import whirlmap
from contest import problems, turns
from contest.run import (
    ACCURACIES,
    BY_ACCURACY,
    QUICK,
    SCIPY_ERROR,
    Plan,
    benchmark,
    c_contenders,
    reference_ends,
    scipy_contenders,
    taylor_contenders,
    whirlmap_contenders,
)
from peers import jitcode_runs, pynamicalsys_runs
from performance_report import write
from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.analysis.steady.settling import Settling, settle
from whirlmap.errors import ModelError
from whirlmap.integrate.accuracy import LADDER, choose_steps
from whirlmap.integrate.division import cores
from whirlmap.kernels.methods import METHODS
from whirlmap.results.regime import Regime

PARTS = ("short", "work_precision", "lanes", "cores", "memory", "labelled", "settling", "diagram")
#: Down to 1e-12: the film of the reference has an error of 3e-14, and no fit of it is worth a tighter tolerance.
LONG = Plan(rounds=9, tolerances=tuple(10.0**-k for k in range(5, 13)))
#: Common periods of the transient that settling is held against.
FIXED = 200


def say(text):
    sys.stderr.write(text + "\n")
    sys.stderr.flush()


def short(quick):
    """What ``whirlmap bench --json`` prints."""
    return benchmark(QUICK if quick else Plan(), say)


def work_precision(quick):
    """Error against time for everybody on four problems: rows of the short comparison with a problem's name."""
    plan = replace(QUICK, rounds=3) if quick else LONG
    rows, missing = [], {}
    everything = (problems.gear_pair(0.0, 64), problems.gear_pair(1e-3, 64), problems.duffing(64), problems.jeffcott(64))
    for problem in everything:
        exact = reference_ends(problem)
        contenders = [*whirlmap_contenders(problem, exact, say), *taylor_contenders(problem, plan, say)]
        try:
            contenders += [*scipy_contenders(problem, plan), *c_contenders(problem, plan), *_others(problem, plan, missing)]
        except ModelError as error:
            missing[f"one point at a time, {problem.name}"] = str(error)
        turns.take_turns(contenders, plan.rounds, say)
        low = problem.eccentricity[0]
        rows += [{"problem": problem.name, **c.row(exact), "centre": _centre(c, exact)} for c in contenders]
        say(f"{problem.name}: {int(problem.through_centre.sum())} orbits through the centre, nearest {low.min():.3g} c")
    return {"rows": rows, "missing": missing}


def _centre(contender, exact):
    """Largest error of the points whose orbit passes a bearing's centre; None where there are none."""
    chosen = contender.problem.through_centre
    return float(np.abs(contender.ends - exact)[:, chosen].max()) if chosen.any() else None


def _others(problem, plan, missing):
    """JiTCODE and pynamicalsys, where they are installed."""
    steps = (100, 200, 400)
    for name, make in (
        ("jitcode", lambda: jitcode_runs(problem, ("dop853",), plan.scipy_tolerances)),
        ("pynamicalsys", lambda: pynamicalsys_runs(problem, plan.scipy_tolerances, steps)),
    ):
        try:
            found = list(make())
        except ImportError as error:
            missing[name] = f"not installed: {error}"
            continue
        for method, setting, run in found:
            yield turns.Contender(f"{name} {method}", problem, setting, 1, run, plan.scipy_repeats)


def _seconds(problem, method, steps, workers=1, repeats=5):
    """Shortest wall time of one run."""
    best = np.inf
    for _ in range(repeats):
        ensemble = problem.ensemble(method, steps, workers)
        begin = time.perf_counter()
        ensemble.advance(problem.periods)
        best = min(best, time.perf_counter() - begin)
    return best


def lanes(quick):
    """Time per point and T against the number of points, one core: a block of 8 lanes costs the same full or empty."""
    out = []
    for points in (1, 8, 16, 32, 64, 256, 1024) if quick else (1, 4, 8, 16, 32, 64, 128, 256, 1024, 4096):
        problem = problems.gear_pair(0.0, points)
        seconds = _seconds(problem, "rk4", 100) / (points * problem.periods)
        out.append({"points": points, "us_per_point_and_T": 1e6 * seconds})
        say(f"points: {out[-1]}")
    return out


def cores_(quick):
    """Wall time against the number of threads."""
    problem = problems.gear_pair(0.0, 512, periods=16 if quick else 64)
    found = dict.fromkeys(range(1, cores() + 1), np.inf)
    for _ in range(3):
        for n in found:
            found[n] = min(found[n], _seconds(problem, "rk4", 100, workers=n, repeats=1))
    return [{"workers": n, "speed_up": found[1] / s} for n, s in found.items()]


MEMORY = """
import re, sys
from pathlib import Path
import numpy as np
import whirlmap
from whirlmap.analysis.steady.settling import Settling
from whirlmap.sweep.diagrams.in_batches import diagram_in_batches

points, transient = int(sys.argv[1]), int(sys.argv[2])
system = whirlmap.load("gear-psfd/reference", psi=0.0)
settling = Settling(transient=transient, first_window=2, most=1, keep=8)
diagram_in_batches(system, "s", np.linspace(1.0, 4.0, points), settling=settling, steps=60).run()
# not getrusage: its peak is inherited from the process that started this one
print(int(re.search(r"VmHWM:\\s+(\\d+)", Path("/proc/self/status").read_text())[1]) / 1024)
"""


def memory(quick):
    """Largest resident memory of a process that makes a bifurcation diagram of few periods."""
    out = []
    for points, transient in ((100, 1), (100, 50), (1000, 1), (10_000, 1), *(() if quick else ((100_000, 1),))):
        done = subprocess.run(
            [sys.executable, "-c", MEMORY, str(points), str(transient)], check=True, capture_output=True, text=True
        )
        out.append({"points": points, "transient": transient, "MB": float(done.stdout.split()[-1])})
        say(f"memory: {out[-1]}")
    return out


def labelled(quick):
    """Wall time per labelled operating point of a diagram with all cores, kernels compiled before."""
    system = whirlmap.load("gear-psfd/reference", psi=0.0)
    speeds = np.linspace(0.6, 4, 64 if quick else 256)
    whirlmap.bifurcation_diagram(system, "s", speeds[:2], settling=Settling(transient=1))
    begin = time.perf_counter()
    diagram = whirlmap.bifurcation_diagram(system, "s", speeds)
    seconds = time.perf_counter() - begin
    return {"points": speeds.size, "ms_per_point": 1e3 * seconds / speeds.size, "regimes": _counts(diagram)}


def _counts(diagram):
    values, counts = np.unique(diagram["regime"].values, return_counts=True)
    return {Regime(int(v)).name: int(n) for v, n in zip(values, counts, strict=True)}


def settling(quick):
    """Processor time of settling a diagram against that of a fixed transient of 200 common periods; labels of both."""
    system = whirlmap.load("gear-psfd/reference")
    speeds = {"s": np.linspace(0.3, 4, 64 if quick else 600)}
    found, seconds = {}, dict.fromkeys(("fixed", "settling", "plainly"), np.inf)
    for _ in range(3):
        for name in seconds:
            ensemble, _ = make_ensemble(system, speeds)
            begin = time.process_time()
            if name == "fixed":
                common = ensemble.common_multiple
                ensemble.advance(FIXED * common, save_periods=common)
            else:
                options = Settling() if name == "settling" else Settling(transient=FIXED, accelerate=False)
                found[name] = settle(ensemble, options)
            seconds[name] = min(seconds[name], time.process_time() - begin)
    out = {
        "points": speeds["s"].size, "fixed": FIXED, "waited": float(found["settling"].waited.mean()),
        "ratio": seconds["settling"] / seconds["fixed"], "accelerated": int(found["settling"].accelerated.sum()),
        "same": int((found["settling"].multiple == found["plainly"].multiple).sum()),
    }  # fmt: skip
    say(f"settling: {out}")
    return out


def _share(task):
    """SciPy on a share of the points, in a process of its own; wall seconds without compilation."""
    method, tolerance, share, shares, periods = task
    problem = problems.gear_pair(0.0, 600, periods)
    part = np.arange(share, 600, shares)
    mine = problems.Problem(problem.name, problem.system, problem.values[:, part], problem.x0[:, part], periods)
    run = turns.scipy_run(mine, method, tolerance)
    begin = time.perf_counter()
    run()
    return time.perf_counter() - begin


def diagram(quick):
    """Wall time of 600 points on two cores at a median error of 1e-7 after 8T: SciPy's over whirlmap's.

    A diagram settles for some hundred T; in a run of 64 the start of threads and processes counts for little.
    """
    periods = 8 if quick else 64
    short_rows = _rows_near(SCIPY_ERROR)
    problem = problems.gear_pair(0.0, 600, periods)
    accuracy = short_rows["whirlmap"][1]
    begin = time.perf_counter()
    steps = choose_steps(problem.ensemble(BY_ACCURACY, LADDER[0], 2), accuracy).steps
    choosing = time.perf_counter() - begin
    ours = _seconds(problem, BY_ACCURACY, steps, workers=2)
    mine = {"accuracy": accuracy, "seconds": ours, "choosing": choosing}
    out = {"points": 600, "periods": periods, "cores": 2, "whirlmap": mine}
    for name in ("DOP853", "LSODA"):
        tolerance = short_rows[name][1]
        with ProcessPoolExecutor(2) as pool:
            seconds = max(pool.map(_share, [(name, tolerance, i, 2, periods) for i in range(2)]))
        out[name] = {"tolerance": tolerance, "seconds": seconds, "ratio": seconds / ours}
        say(f"diagram: {name} {out[name]}")
    return out


def _rows_near(error):
    """Loosest accuracy asked of whirlmap, and loosest tolerance of SciPy's methods, that meet an error on 64 speeds."""
    problem = problems.gear_pair(0.0, 64)
    exact = reference_ends(problem)
    out = {}
    for accuracy in ACCURACIES:
        steps = choose_steps(problem.ensemble(BY_ACCURACY, LADDER[0]), accuracy).steps
        c = turns.Contender("whirlmap", problem, accuracy, 8, turns.whirlmap_run(problem, BY_ACCURACY, steps))
        c.turn()
        if c.row(exact)["median_error"] < error:
            out["whirlmap"] = ("whirlmap", accuracy)
            break
    for method in ("DOP853", "LSODA"):
        for tolerance in 10.0 ** -np.arange(5.5, 12, 0.5):
            c = turns.Contender("scipy", problem, tolerance, 1, turns.scipy_run(problem, method, tolerance))
            c.turn()
            if c.row(exact)["median_error"] < error:
                out[method] = (method, float(tolerance))
                break
    return out


def machine():
    """The machine in words, without its name."""
    flags = Path("/proc/cpuinfo").read_text(encoding="utf-8") if Path("/proc/cpuinfo").exists() else ""
    vector = "AVX-512" if "avx512f" in flags else "AVX2" if "avx2" in flags else "no AVX2"
    packages = {}
    from importlib.metadata import PackageNotFoundError, version

    for name in ("llvmlite", "numba", "scipy", "heyoka", "jitcode", "pynamicalsys"):
        try:
            packages[name] = version(name)
        except PackageNotFoundError:
            packages[name] = "not installed"
    return {"cores": os.cpu_count(), "vectors": vector, "python": sys.version.split()[0], **packages}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="file of all numbers; parts that it has and --only leaves out are kept")
    parser.add_argument("--from", dest="made", type=Path, help="write text and pictures from this file, measure nothing")
    parser.add_argument("--only", default=",".join(PARTS), help=f"parts: {','.join(PARTS)}")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--docs", type=Path, default=Path(__file__).parents[1] / "docs")
    arguments = parser.parse_args()
    if (arguments.made is None) == (arguments.json is None):
        parser.error("give one of --json and --from")
    if arguments.made:
        write(json.loads(arguments.made.read_text(encoding="utf-8")), arguments.docs)
        return
    result = json.loads(arguments.json.read_text(encoding="utf-8")) if arguments.json.exists() else {}
    functions = {**{part: globals().get(part) for part in PARTS}, "cores": cores_}
    for part in arguments.only.split(","):
        say(f"== {part}")
        result[part] = functions[part](arguments.quick)
        result["machine"], result["methods"] = machine(), list(METHODS)
        quick = {*result.get("quick", [])}
        result["quick"] = sorted(quick | {part} if arguments.quick else quick - {part})
        arguments.json.write_text(json.dumps(result, indent=1), encoding="utf-8")
    write(result, arguments.docs)


if __name__ == "__main__":
    main()
