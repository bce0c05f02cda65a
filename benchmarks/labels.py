"""What labels cost: diagrams of 600 points with regimes and exponents against the same ones without, in one run.

    python benchmarks/labels.py [--points 600] [--lyapunov 1024]

Both are computed in turn, `TIMES` times, after a first one of each that compiles; the ratio is that of the shortest times.
"""

import argparse
import time

import numpy as np

import whirlmap
from whirlmap.sweep.diagram import bifurcation_diagram

TIMES = 3

#: Mostly chaotic; periodic throughout, twice, the second dimensional.
DIAGRAMS = {
    "duffing, gamma 0.2 to 0.65": ("duffing", "gamma", 0.2, 0.65),
    "gear-psfd/reference, s 0.3 to 4": ("gear-psfd/reference", "s", 0.3, 4.0),
    "gear-psfd/machine, s 0.3 to 4": ("gear-psfd/machine", "s", 0.3, 4.0),
}


def main() -> None:
    """Print seconds, ratio and labels of every diagram."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=600)
    parser.add_argument("--lyapunov", type=int, default=1024)
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    for name, (case, parameter, low, high) in DIAGRAMS.items():
        if options.only not in name:
            continue
        system, values = whirlmap.load(case), np.linspace(low, high, options.points)
        spent: dict[int, list[float]] = {0: [], options.lyapunov: []}
        for length in spent:
            bifurcation_diagram(system, parameter, values[::50], lyapunov=length)
        for _ in range(TIMES):
            for length, times in spent.items():
                begin = time.perf_counter()
                ds = bifurcation_diagram(system, parameter, values, lyapunov=length)
                times.append(time.perf_counter() - begin)
        bare, labelled = (min(times) for times in spent.values())
        kinds, counts = np.unique(ds["regime"].values, return_counts=True)
        labels = ", ".join(f"{n} {regime_name(k)}" for k, n in zip(kinds, counts, strict=True))
        print(f"{name}: {bare:.2f} s without, {labelled:.2f} s with labels, ratio {labelled / bare:.2f}: {labels}")


def regime_name(code: int) -> str:
    """Word of a regime."""
    from whirlmap.results.regime import Regime

    return Regime(int(code)).label


if __name__ == "__main__":
    main()
