"""Sine and cosine of vectors: right to the last places over all magnitudes, and of a lane's own angle alone."""

import math

import mpmath
import numpy as np
import pytest
import sympy as sp

from whirlmap.equations import Model, State
from whirlmap.integrate.system import System
from whirlmap.kernels.running import machine
from whirlmap.kernels.writing.sines import LIMIT, PARTS

#: Units of the last place. The GNU C library's own error is 1.99 at the doubles nearest to multiples of pi/2.
ALLOWED = 1.5 if machine.fuses() else 2.0

x, y = (State(name, "1", name) for name in "xy")


@pytest.fixture(scope="module")
def system():
    return System(Model("sines", (x, y), (), {x: sp.sin(x), y: sp.cos(y)}), {})


def values(system, v):
    """Sines and cosines of angles, shape (2, angle)."""
    return system.rhs(0.0, np.stack([v, v]))


def worst(got, v):
    """Largest error in units of the last place, over both functions."""
    with mpmath.workprec(300):
        exact = [[f(mpmath.mpf(float(a))) for a in v] for f in (mpmath.sin, mpmath.cos)]
        return max(
            abs(float((mpmath.mpf(float(g)) - e) / mpmath.mpf(float(np.spacing(abs(float(e)))))))
            for row, true in zip(got, exact, strict=True)
            for g, e in zip(row, true, strict=True)
        )


def near_quarters():
    """The doubles nearest to multiples of pi/2, whole ones up to the limit and those that continued fractions find."""
    rng = np.random.default_rng(3)
    counts = np.concatenate([np.arange(1, 300), rng.integers(1, int(LIMIT / 1.6), 500)])
    with mpmath.workprec(200):
        at = [float(mpmath.mpf(int(k)) * mpmath.pi / 2) for k in counts]
        for power in range(-52, -22):  # angles m 2^power that are nearest to n pi/2, by the convergents of pi/2^(power+1)
            rest, (m0, m1), (n0, n1) = mpmath.pi / mpmath.mpf(2) ** (power + 1), (0, 1), (1, 0)
            while m1 < 2**53 and m1 * mpmath.mpf(2) ** power < LIMIT:
                if m1:
                    at.append(float(m1 * mpmath.mpf(2) ** power))
                whole = int(mpmath.floor(rest))
                (m0, m1), (n0, n1) = (m1, whole * m1 + m0), (n1, whole * n1 + n0)
                rest = 1 / (rest - whole)
    return np.array(at)


def test_parts_are_a_quarter_turn():
    with mpmath.workprec(300):
        left = mpmath.pi / 2 - sum(mpmath.mpf(p) for p in PARTS)
    assert abs(left) < mpmath.mpf(2) ** -160


def test_last_places(system):
    rng = np.random.default_rng(1)
    v = np.concatenate([
        rng.uniform(-7, 7, 2000), rng.uniform(-1e3, 1e3, 1000),
        10.0 ** rng.uniform(-300, 9, 2000) * rng.choice([-1, 1], 2000),
        [0.0, -0.0, 5e-324, -1e-310, 1e-20, LIMIT, -LIMIT],
    ])  # fmt: skip
    assert worst(values(system, v), v) < ALLOWED


def test_near_multiples_of_quarter_turns(system):
    v = near_quarters()
    assert np.abs(values(system, v)).min() < 1e-17  # some are so near that two parts of pi/2 would not do
    for angles in (v, -v, np.nextafter(v, 0)):
        assert worst(values(system, angles), angles) < ALLOWED


def test_limits(system):
    v = np.array([0.0, np.inf, -np.inf, np.nan])
    got = values(system, v)
    np.testing.assert_array_equal(got[:, 0], [0.0, 1.0])
    assert np.isnan(got[:, 1:]).all()


def test_far_angles_are_those_of_the_c_library(system):
    v = np.concatenate([[np.nextafter(LIMIT, np.inf), -1e15, 1e22, 1e300], np.linspace(-9 * LIMIT, -1.1 * LIMIT, 500)])
    np.testing.assert_array_equal(values(system, v), [[math.sin(a) for a in v], [math.cos(a) for a in v]])


def test_neighbours_beyond_the_limit_change_no_bit(system):
    """Near lanes are read with far ones and others that are infinite or not a number, in every place of a block."""
    rng = np.random.default_rng(5)
    v = rng.uniform(-50, 50, 64)
    alone = values(system, v)
    for broken in (1e12, np.inf, np.nan):
        mixed = v.copy()
        mixed[rng.permutation(64)[:20]] = broken
        same = mixed == v
        np.testing.assert_array_equal(values(system, mixed)[:, same], alone[:, same])


def test_processors_without_fused_products_ask_the_c_library(system, monkeypatch, tmp_path):
    monkeypatch.setattr("whirlmap.kernels.running.lanes.fuses", lambda: False)
    plain = System(Model("sines-called", (x, y), (), {x: sp.sin(x), y: sp.cos(y)}), {})
    v = np.random.default_rng(2).uniform(-30, 30, 100)
    np.testing.assert_allclose(values(plain, v), values(system, v), rtol=1e-15)


def test_levels_have_fused_products_from_the_third(monkeypatch):
    monkeypatch.setattr(machine, "processor", lambda: ("", ""))
    for level, expected in (("x86-64", False), ("x86-64-v2", False), ("x86-64-v3", True), ("x86-64-v4", True)):
        monkeypatch.setenv("WHIRLMAP_CPU", level)
        assert machine.fuses() is expected
