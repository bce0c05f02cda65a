"""What every stock case gives today, so that a later version can be compared: labels, sections, exponents, sizes.

    python benchmarks/stock_results.py record before.npz
    python benchmarks/stock_results.py compare before.npz after.npz

A diagram of 64 points and a map of 16 x 16 points of each case, `safe_speeds` of each machine, `attractors` and what
``diagnose --json`` prints. `compare` names every number that is not the same to the last bit.
"""

import argparse
import json
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import xarray as xr

import whirlmap
from whirlmap.errors import RangeError

#: Case: parameter of its diagram and map with its range, and the second parameter of the map.
CASES = {
    "duffing": (("gamma", 0.2, 0.65), ("delta", 0.2, 0.4)),
    "pendulum": (("g", 0.9, 1.6), ("q", 0.4, 0.6)),
    "van_der_pol": (("omega", 1.0, 8.0), ("A", 1.0, 6.0)),
    "gear_backlash": (("Omega", 0.4, 1.6), ("F_ah", 0.05, 0.2)),
    "lorenz": (("rho", 10.0, 180.0), ("sigma", 8.0, 12.0)),
    "roessler": (("c", 2.0, 6.0), ("a", 0.1, 0.25)),
    "jeffcott": (("s", 0.5, 2.5), ("Gamma", 0.9, 1.1)),
    "gear-psfd/reference": (("s", 0.3, 4.0), ("xi_m", 0.02, 0.2)),
    "gear-psfd/machine": (("s", 0.3, 4.0), ("psi", 1e-4, 1e-2)),
    "gear-psfd/intended": (("s", 0.3, 4.0), ("psi", 1e-4, 1e-2)),
    "gear-psfd/literal": (("s", 0.3, 4.0), ("psi", 1e-4, 1e-2)),
    "machines/jeffcott-rig": (("s", 0.3, 4.0), ("Gamma", 0.5, 2.0)),
    "machines/turbo-gearbox": (("s", 0.3, 2.0), ("xi_m", 0.02, 0.2)),
}
MACHINES = {"machines/jeffcott-rig": (0.3, 3.0), "machines/turbo-gearbox": (0.5, 1.5), "gear-psfd/machine": (0.5, 3.0)}


def variables(ds: xr.Dataset, under: str) -> dict[str, np.ndarray]:
    """Arrays of a Dataset by name."""
    return {f"{under}/{name}": v.values for name, v in ds.variables.items() if v.dtype.kind in "fiub"}


def record(path: str, only: str) -> None:
    """Compute everything and write it into one file; cases that it holds already are left as they are."""
    kept: dict[str, np.ndarray] = dict(np.load(path)) if Path(path).exists() else {}
    warnings.simplefilter("ignore")
    for case, ((name, low, high), (other, other_low, other_high)) in CASES.items():
        if only not in case or f"{case}/diagnose" in kept:
            continue
        system = whirlmap.load(case)
        if other not in system.parameters:
            print(f"{case} has no {other}", file=sys.stderr)
            other, other_low, other_high = next(
                (p, 0.9 * v, 1.1 * v) for p, v in system.parameters.items() if p != name and v > 0
            )
        ds = whirlmap.bifurcation_diagram(system, name, np.linspace(low, high, 64))
        kept |= variables(ds, f"{case}/diagram")
        grid = {name: np.linspace(low, high, 16), other: np.linspace(other_low, other_high, 16)}
        kept |= variables(whirlmap.regime_map(system, grid), f"{case}/map")
        try:
            kept |= variables(whirlmap.attractors(system, starts=64), f"{case}/attractors")
        except RangeError as error:  # a run that does not move gives no box of starts
            print(error, file=sys.stderr)
        if case in MACHINES:
            kept |= variables(whirlmap.safe_speeds(system, np.linspace(*MACHINES[case], 12), 0.5), f"{case}/speeds")
        command = [sys.executable, "-m", "whirlmap", "diagnose", case, "--json"]
        said = subprocess.run(command, capture_output=True, text=True, check=False).stdout
        kept[f"{case}/diagnose"] = np.array(said)
        print(f"{case} recorded", file=sys.stderr, flush=True)
        np.savez_compressed(path, **kept)


def compare(before: str, after: str) -> int:
    """Print what differs between two records; 1 where anything does."""
    one, two = np.load(before), np.load(after)
    differ = 0
    for name in sorted({*one.files, *two.files}):
        if name not in one.files or name not in two.files:
            print(f"{name}: only in {before if name in one.files else after}")
            differ = 1
        elif name.endswith("/diagnose"):
            a, b = (json.loads(str(d[name]) or "{}") for d in (one, two))
            for key in sorted({*a, *b} - {"provenance", "command"}):
                if a.get(key) != b.get(key):
                    was, now = (str(d.get(key))[:60] for d in (a, b))
                    print(f"{name}: {key}" + (f" {was} -> {now}" if was != now else ", in digits beyond the first"))
                    differ = 1
        elif not np.array_equal(a := one[name], b := two[name], equal_nan=one[name].dtype.kind == "f"):
            moved = (a != b) & ~((a != a) & (b != b)) if a.shape == b.shape else np.ones(1)
            floats = a.shape == b.shape and a.dtype.kind == "f"
            largest = np.nanmax(np.abs(b - a)) / np.nanmax(np.abs(a)) if floats else np.nan
            print(f"{name}: {int(np.sum(moved))} of {moved.size} numbers differ, by {largest:.1e} of the largest")
            differ = 1
    print("all equal to the last bit" if not differ else "differences above")
    return differ


def main() -> int:
    """Record or compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("record", "compare"))
    parser.add_argument("files", nargs="+")
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    if options.what == "record":
        record(options.files[0], options.only)
        return 0
    return compare(*options.files)


if __name__ == "__main__":
    sys.exit(main())
