"""What divisions cost beside estimates on this processor: an entry of `whirlmap.kernels.running.root_choice.MEASURED`.

Run it with ``python benchmarks/roots.py``. The films are the plain one (psi = 0, closed form), the porous one (psi = 1e-3,
tables) and the positive arc (psi = 0, tables in the frame of the load) of the gear pair. Both ways take turns in one thread,
each first in every other turn; the least time of each counts. A processor without estimates has nothing to measure.
"""

import argparse
import time

import numpy as np

import whirlmap
from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.kernels.methods import METHODS
from whirlmap.kernels.running.machine import processor
from whirlmap.kernels.running.root_choice import RootChoice, possible, using

#: Lanes: eight blocks; and T of one turn.
COUNT, PERIODS = 64, 40
FILMS = {"psi = 0": {"psi": 0.0}, "psi = 0.001": {"psi": 1e-3}, "positive arc": {"psi": 0.0, "arc": "positive"}}
#: Method, steps per T, and tangent vectors.
RUNS = (("dop853", 24, 0), ("dop853", 24, 1), ("rk4", 120, 0))
WAYS = [RootChoice(way, way) for way in ("estimates", "divisions")]


def contender(changes, method, steps, tangents, way):
    """An ensemble that is past its first T: kernels are compiled and cells of tables found."""
    with using(way):
        system = whirlmap.load("gear-psfd/reference", s=2.0, **changes)
        speeds = {"s": np.linspace(1.3, 4, COUNT)}
        ensemble, _ = make_ensemble(system, speeds, steps=steps, method=method, tangents=tangents, workers=1)
        ensemble.advance(20)
    return ensemble


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=30, help="turns of each contender (default 30)")
    turns = parser.parse_args().turns
    if not all(map(possible, WAYS)):
        raise SystemExit(f"kernels for {processor()[0]} have no estimates of whole vectors: they always divide")
    print(f"processor {processor()[0]}; ns per lane and stage")
    print(f"{'film':14}{'method':>8}{'vectors':>9}{'estimates':>11}{'divisions':>11}{'ratio':>8}")
    for film, changes in FILMS.items():
        for method, steps, tangents in RUNS:
            ensembles = {way: contender(changes, method, steps, tangents, way) for way in WAYS}
            least = dict.fromkeys(WAYS, np.inf)
            for turn in range(turns):
                for way in WAYS[:: 1 if turn % 2 else -1]:
                    begin = time.thread_time()
                    with using(way):
                        ensembles[way].advance(PERIODS)
                    least[way] = min(least[way], time.thread_time() - begin)
            for way, ensemble in ensembles.items():
                assert (ensemble.status == 0).all(), f"{film}, {way}: lanes ended, whose time is not measured"
            a, b = (1e9 * least[way] / (PERIODS * steps * METHODS[method].stages * COUNT) for way in WAYS)
            print(f"{film:14}{method:>8}{tangents:9}{a:11.2f}{b:11.2f}{b / a:8.2f}", flush=True)


if __name__ == "__main__":
    main()
