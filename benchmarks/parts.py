"""Cost of machines from parts: per state and step over that of the gear pair, and of compiling, in one run on one core.

    python benchmarks/parts.py            # or --json
"""

import argparse
import json
import os
import tempfile
import time

import numpy as np

import whirlmap
from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.kernels.running import lanes
from whirlmap.kernels.running import machine as machine_code
from whirlmap.kernels.running.machine import compile_assembly

#: Gear pair, then machines from parts.
CASES = ("gear-psfd/machine", "machines/two-shaft-gearbox")
LANES, STEPS, TIMES = 8, 128, 5


def time_per_state_and_step(case, vectors):
    """Processor seconds of a block of eight lanes, one thread, without or with tangent vectors."""
    ensemble, _ = make_ensemble(whirlmap.load(case), one_speed(case), steps=STEPS, tangents=vectors, workers=1)
    ensemble.advance(ensemble.common_multiple if not vectors else 1)
    periods = 64 if not vectors else 8
    best = np.inf
    for _ in range(TIMES):
        begin = time.process_time()
        ensemble.advance(periods)
        best = min(best, time.process_time() - begin)
    return best / (periods * STEPS * ensemble.model.dimension * (1 + vectors))


def one_speed(case):
    """Eight equal points, by the parameter that the case's model declares as its speed."""
    system = whirlmap.load(case)
    return {system.model.speed.name: np.full(LANES, system.values[system.model.speed.name])}


def compile_seconds(case):
    """Processor seconds of LLVM for the kernels of a plain run and of one with tangent vectors, without the cache."""
    taken, chosen = [], os.environ.get("WHIRLMAP_CACHE")

    def timed(text):
        begin = time.process_time()
        made = compile_assembly(text)
        taken.append(time.process_time() - begin)
        return made

    machine_code.compile_assembly = timed
    lanes._compiled.cache_clear()
    with tempfile.TemporaryDirectory() as folder:
        os.environ["WHIRLMAP_CACHE"] = folder
        try:
            for vectors in (0, 2):
                ensemble, _ = make_ensemble(whirlmap.load(case), one_speed(case), steps=STEPS, tangents=vectors, workers=1)
                ensemble.advance(1)
        finally:
            os.environ.pop("WHIRLMAP_CACHE")
            if chosen is not None:
                os.environ["WHIRLMAP_CACHE"] = chosen
            machine_code.compile_assembly = compile_assembly
    return taken


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    rows = {}
    for case in CASES:
        dimension = whirlmap.load(case).model.dimension
        rows[case] = {
            "states": dimension,
            **{f"ns, {k} tangent vectors": 1e9 * time_per_state_and_step(case, k) for k in (0, 4)},
            "compiling, s": sum(compile_seconds(case)),
        }
    pair, machine = (rows[case] for case in CASES)
    result = {"each": rows, "over the gear pair": {name: machine[name] / pair[name] for name in machine}}
    print(json.dumps(result) if arguments.json else json.dumps(result, indent=1))


if __name__ == "__main__":
    main()
