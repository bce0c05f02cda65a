"""What labelled diagrams cost, and what they say: processor time of diagrams, in turns with another version of the code.

    python benchmarks/labels.py [--points 200] [--against OTHER/src] [--only machine]

Each diagram is computed in a process of its own, `TIMES` times after a short one that compiles, in turns with the other
version where one is given; the shortest time of each counts. Labels are those of the last run.
"""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

TIMES = 2

#: Case, changes, parameter and its range.
DIAGRAMS = {
    "duffing": ("duffing", {}, "gamma", 0.2, 0.65),
    "pendulum": ("pendulum", {}, "g", 0.9, 1.6),
    "van der Pol, tongues": ("van_der_pol", {"mu": 5.0, "A": 5.0}, "omega", 1.0, 8.0),
    "gear_backlash": ("gear_backlash", {}, "Omega", 0.4, 1.6),
    "gear-psfd/reference": ("gear-psfd/reference", {}, "s", 0.3, 4.0),
    "gear-psfd/machine": ("gear-psfd/machine", {}, "s", 0.3, 4.0),
    "gear-psfd/intended, psi = 1e-4": ("gear-psfd/intended", {"psi": 1e-4}, "s", 0.3, 4.0),
}


def measure(name: str, points: int) -> None:
    """Print the processor time of one diagram and how many points have each label, as JSON."""
    import time

    import numpy as np

    import whirlmap
    from whirlmap.results.regime import Regime

    case, changes, parameter, low, high = DIAGRAMS[name]
    system, values = whirlmap.load(case, **changes), np.linspace(low, high, points)
    length = {} if "rule" in sys.argv else {"lyapunov": 1024}  # the version before counted common periods
    whirlmap.bifurcation_diagram(system, parameter, values[:: max(points // 4, 1)], workers=1, **length)
    spent = []
    for _ in range(TIMES):
        begin = time.process_time()
        ds = whirlmap.bifurcation_diagram(system, parameter, values, workers=1, **length)
        spent.append(time.process_time() - begin)
    kinds, counts = np.unique(ds["regime"].values, return_counts=True)
    labels = {Regime(int(k)).label: int(n) for k, n in zip(kinds, counts, strict=True)}
    print(json.dumps({"seconds": min(spent), "labels": labels}))


def asked(name: str, points: int, source: str) -> dict:
    """Measure with the code of a source folder, in a process of its own."""
    environment = {**os.environ, "PYTHONPATH": source, "OPENBLAS_NUM_THREADS": "1"}
    new = ["rule"] if (Path(source) / "whirlmap/analysis/labels").exists() else []
    command = [sys.executable, __file__, "--one", name, "--points", str(points), *new]
    return json.loads(subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout)


def main() -> None:
    """Print seconds, ratio and labels of every diagram."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=200)
    parser.add_argument("--against", help="src folder of another version")
    parser.add_argument("--only", default="")
    parser.add_argument("--one", help=argparse.SUPPRESS)
    parser.add_argument("more", nargs="*", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        measure(options.one, options.points)
        return
    own = str(Path(__file__).parent.parent / "src")
    for name in (n for n in DIAGRAMS if options.only in n):
        before = asked(name, options.points, options.against) if options.against else None
        now = asked(name, options.points, own)
        said = ", ".join(f"{n} {label}" for label, n in now["labels"].items())
        print(f"{name}: {now['seconds']:.2f} s: {said}")
        if before:
            was = ", ".join(f"{n} {label}" for label, n in before["labels"].items())
            print(f"    before {before['seconds']:.2f} s, ratio {now['seconds'] / before['seconds']:.2f}: {was}")


if __name__ == "__main__":
    main()
