"""Computes `numbers.json`, the truth of every case of `kinked_cases`, anew.

``python -m tests.trust.truth_numbers NAME ...`` computes some of them.

A slow test compares the numbers kept with those computed anew.
"""

import json
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


def kept(name="numbers.json"):
    """Truths of a file beside this one."""
    return json.loads((HERE / name).read_text()) if (HERE / name).exists() else {}


def write(numbers, name="numbers.json"):
    """One line for each case."""
    lines = ",\n".join(f"{json.dumps(key)}: {json.dumps(value)}" for key, value in numbers.items())
    (HERE / name).write_text("{\n" + lines + "\n}\n")


def compute(case):
    motion = case.pieces.at(**case.values)
    if case.chaos:
        mean, error, z = motion.spectrum(case.start, settle=case.settle, periods=case.chaos)
        return {"n": 0, "z": z.tolist(), "exponents": mean.tolist(), "errors": error.tolist()}
    if case.known:
        return {"n": 0, "orbits": several(motion, case)}
    orbit = motion.attractor(case.start, settle=case.settle)
    return {"n": None} if orbit is None else orbit.plain()


def several(motion, case, starts=16):
    """Orbits that starts of a box come to, with their shares, largest first."""
    box = np.array(case.known["box"])
    found = []
    for z in np.random.default_rng(7).uniform(box[:, 0], box[:, 1], (starts, len(box))):
        orbit = motion.attractor(z, settle=case.settle) or motion.attractor(z, settle=6 * case.settle)
        assert orbit is not None, f"{case.name}: nothing returns from {z}"
        same = [o for o in found if o["n"] == orbit.n and np.abs(np.subtract(o["high"], orbit.high)).max() < 1e-6]
        if same:
            same[0]["share"] += 1 / starts
        else:
            found.append({**orbit.plain(), "share": 1 / starts})
    return sorted(found, key=lambda o: -o["share"])


def main(names):
    from tests.trust.kinked_cases import ALL

    numbers = kept()
    for case in ALL:
        if not names or any(case.name.startswith(n) for n in names):
            numbers[case.name] = compute(case)
            if case.known:
                print(case.name, [(o["n"], round(o["share"], 3), round(np.hypot(o["real"][0], o["imaginary"][0]), 4))
                                  for o in numbers[case.name]["orbits"]], flush=True)  # fmt: skip
                continue
            n, largest = numbers[case.name]["n"], numbers[case.name].get("real", numbers[case.name].get("exponents"))
            print(case.name, n, largest, numbers[case.name].get("slides"), flush=True)
    numbers = {case.name: numbers[case.name] for case in ALL if case.name in numbers}
    write(numbers)


if __name__ == "__main__":
    main(sys.argv[1:])
