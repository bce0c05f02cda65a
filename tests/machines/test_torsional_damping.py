"""The damping ratio of a shaft's elastic modes holds for those of its rotation too."""

import numpy as np
import pytest
from tests.machines.test_invariants import TURNING

import whirlmap

ZETA = 0.02


def test_elastic_modes_of_the_rotation_are_damped_by_zeta(tmp_path):
    """A rate of one torsional mode alone is slowed by 2 zeta omega v more than without; the uniform rotation is not."""
    file = tmp_path / "machine.toml"
    file.write_text(TURNING, encoding="utf-8")
    plain, damped = whirlmap.load(file), whirlmap.load(file, **{"shaft.pinion.zeta": ZETA})
    rotor = next(r for r in damped.machine.case.parts.machine.rotors if r.name == "pinion")
    clock = damped.machine.inputs["speed"].value
    assert (rotor.shaft.twisting.frequency > 0).any()
    rest = whirlmap.linear_analysis(plain).equilibrium
    for rate, omega in zip(rotor.arc_rates, rotor.shaft.twisting.frequency, strict=True):
        k = plain.states.index(rate.name)
        x = np.array(rest, dtype=float)
        x[k] = 0.3
        change = damped.reference_rhs(0.0, x) - plain.reference_rhs(0.0, x)
        assert change[k] == pytest.approx(-2 * ZETA * omega / clock * 0.3, rel=1e-9, abs=1e-12)
