"""Computes `numbers.json`, the truth of every case of `kinked_cases`, anew: ``python tests/trust/truth_numbers.py [NAME ...]``.

A slow test compares the numbers kept with those computed anew.
"""

import json
import sys
from pathlib import Path

KEPT = Path(__file__).parent / "numbers.json"


def kept():
    return json.loads(KEPT.read_text()) if KEPT.exists() else {}


def compute(case):
    motion = case.pieces.at(**case.values)
    if case.chaos:
        mean, error, z = motion.spectrum(case.start, settle=case.settle, periods=case.chaos)
        return {"n": 0, "z": z.tolist(), "exponents": mean.tolist(), "errors": error.tolist()}
    orbit = motion.attractor(case.start, settle=case.settle)
    return {"n": None} if orbit is None else orbit.plain()


def main(names):
    from kinked_cases import ALL

    numbers = kept()
    for case in ALL:
        if not names or any(case.name.startswith(n) for n in names):
            numbers[case.name] = compute(case)
            n, largest = numbers[case.name]["n"], numbers[case.name].get("real", numbers[case.name].get("exponents"))
            print(case.name, n, largest, numbers[case.name].get("slides"), flush=True)
    numbers = {case.name: numbers[case.name] for case in ALL if case.name in numbers}
    KEPT.write_text(json.dumps(numbers, indent=1) + "\n")


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[2] / "src"))
    main(sys.argv[1:])
