"""What tangent vectors cost: time of a step with k of them over that of the plain step, on the gear pair.

Run it with ``python benchmarks/tangents.py``. The films are the plain one (psi = 0, closed form), the porous one
(psi = 1e-3, tables) and the positive arc (psi = 0, tables in the frame of the load). All contenders of a film take turns in
one thread, and the least time of each counts; the vectors are orthonormalised once per T.
"""

import argparse
import time

import numpy as np

import whirlmap
from whirlmap.analysis.motion.ensembles import make_ensemble

#: Method, steps per T, and lanes: eight blocks.
METHOD, STEPS, COUNT = "dop853", 24, 64
STAGES = 12
FILMS = {
    "psi = 0": {"psi": 0.0},
    "psi = 0.001": {"psi": 1e-3},
    "positive arc": {"psi": 0.0, "arc": "positive"},
}
VECTORS = (0, 1, 2, 5, 20)


def contender(changes, vectors):
    """An ensemble that is past its first T: kernels are compiled and cells of tables found."""
    system = whirlmap.load("gear-psfd/reference", s=2.0, **changes)
    speeds = {"s": np.linspace(1.3, 4, COUNT)}
    ensemble, _ = make_ensemble(system, speeds, steps=STEPS, method=METHOD, tangents=vectors, workers=1)
    ensemble.advance(20)
    return ensemble


def one_turn(ensemble, periods):
    """Nanoseconds of this thread per stage and lane."""
    begin = time.thread_time()
    ensemble.advance(periods)
    taken = time.thread_time() - begin
    return taken / (periods * STEPS * STAGES * COUNT) * 1e9


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=15, help="turns of each contender (default 15)")
    turns = parser.parse_args().turns
    print(f"{'film':14}{'k':>4}{'ns per lane and stage':>24}{'ratio':>8}{'1.3 (1 + k/2)':>15}")
    for film, changes in FILMS.items():
        runs = {k: contender(changes, k) for k in VECTORS}
        least = dict.fromkeys(runs, np.inf)
        for _ in range(turns):
            for k, ensemble in runs.items():
                least[k] = min(least[k], one_turn(ensemble, 40 // (1 + k) + 4))
        for k, ns in least.items():
            alive = int((runs[k].status == 0).sum())
            assert alive == COUNT, f"{film}, k = {k}: {COUNT - alive} lanes ended, whose time is not measured"
            print(f"{film:14}{k:4}{ns:24.2f}{ns / least[0]:8.2f}{1.3 * (1 + k / 2) if k else 1:15.2f}")


if __name__ == "__main__":
    main()
