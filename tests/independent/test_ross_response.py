"""Unbalance response of a rotor from parts against ROSS, a finite-element code for rotors of other authors.

What ROSS answered is kept in `ross_response.json`, with what it was asked. To ask it again, in an environment of its own
with ross-rotordynamics and plotly below 6:

    python test_ross_response.py | ROSS_PYTHON ross_response.py > ross_response.json
"""

import json
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from tests.independent.finite_elements import Gearbox
from tests.independent.test_parts import PINION
from tests.independent.test_ross_parts import loaded, question

import whirlmap

HERE = Path(__file__).parent
SPEEDS = [300.0, 500.0, 700.0, 900.0]


def questions(folder):
    """The pinion's shaft with its overhung disk and two unbalances, on the films of whirlmap at four speeds."""
    system = loaded(folder, Gearbox((PINION,), None, speed=SPEEDS[-1], mu=0.015))
    asked = []
    for speed in SPEEDS:
        at = system.replace(s=float(system.values["s"]) * speed / SPEEDS[-1])
        asked.append({**question(Gearbox((PINION,), None, speed=speed, mu=0.015), at), "unbalances": PINION.unbalances})
    return system, asked


def test_the_response_is_that_of_ross(tmp_path):
    """Amplitudes at both journals and the disk, and phases; the largest differences were 1.8e-4 and 2.8e-4 rad."""
    kept = json.loads((HERE / "ross_response.json").read_text())
    system, asked = questions(tmp_path)
    for one, other in zip(json.loads(json.dumps(asked)), kept["asked"], strict=True):
        for b, then in zip(one.pop("bearings"), other.pop("bearings"), strict=True):
            assert then.pop("pedestal") is b.pop("pedestal") is None
            assert then == pytest.approx(b, rel=1e-5)
        assert one == other
    at = float(system.values["s"]) * np.array(SPEEDS) / SPEEDS[-1]
    ds = whirlmap.unbalance_response(system, "s", at)
    clearance = PINION.bearings[0].c
    for name, station in (("bearing1_pinion", 1), ("bearing2_pinion", 6), ("disk1_pinion", 8)):
        for axis in "xy":
            one = ds.sel(rotor="pinion", station=name, axis=axis)
            size, lag = np.array([answer[axis][station] for answer in kept["answered"]]).T
            np.testing.assert_allclose(one["amplitude"] * clearance, size, rtol=1e-3)
            apart = (one["phase"].values - lag + np.pi) % (2 * np.pi) - np.pi
            np.testing.assert_allclose(apart, 0.0, atol=1e-3)


if __name__ == "__main__":
    with TemporaryDirectory() as folder:
        print(json.dumps(questions(folder)[1]))
