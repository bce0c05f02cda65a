"""Motions that contract forget their starts without a tangent vector: a damped oscillator, whose exponent is -c/2."""

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.labels.forgetting import FORGOTTEN, STRETCH, forget
from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.equations import Model, Parameter, State, cos, t

x, v = State("x", "1", "displacement"), State("v", "1", "velocity")
c, w = Parameter("c", "1", "damping"), Parameter("w", "1", "frequency")
OSCILLATOR = Model(name="damped", states=(x, v), parameters=(c, w), equations={x: v, v: cos(w * t) - c * v - x},
                   harmonics=(w,), swing=(x,))  # fmt: skip


def test_two_starts_end_at_the_same_place_after_the_time_that_the_exponent_says():
    system, damping = whirlmap.load(OSCILLATOR, c=0.02, w=1.6), np.array([0.02, 0.02, 0.002, 0.002])
    starts = np.array([[1.0, -3.0, 1.0, -3.0], [0.0, 2.0, 0.0, 2.0]])
    run, _ = make_ensemble(system, {"c": damping}, starts=starts, tangents=1, workers=1)
    run.advance(64)
    rows = {}

    def keep(points, section):
        for point in points:
            rows[point] = rows.get(point, 0) + len(section)

    before = run.x.copy()
    plain, ran = forget(run, -damping / 2, np.zeros(4), done=64, most=100_000, keep=keep, progress=None)
    needed = np.log(1 / FORGOTTEN) / (damping / 2 * run.period)
    assert (ran >= needed).all() and (ran % STRETCH == 0).all() and (ran < needed + 2 * STRETCH).all()
    assert [64 + rows[k] for k in range(4)] == ran.tolist() == plain.turns.tolist()
    assert plain.tangents == 0 and np.array_equal(run.x, before)
    steady = 1 / np.hypot(1 - 1.6**2, damping * 1.6)
    assert np.hypot(plain.x[0], plain.x[1] / 1.6) == pytest.approx(steady, rel=1e-6)
    assert np.abs(plain.x[:, 0] - plain.x[:, 1]).max() < 1e-8 and np.abs(plain.x[:, 2] - plain.x[:, 3]).max() < 1e-8


def test_no_point_runs_longer_than_it_may():
    system = whirlmap.load(OSCILLATOR, c=1e-5, w=1.6)
    run, _ = make_ensemble(system, {"c": np.array([1e-5])}, tangents=1, workers=1)
    plain, ran = forget(run, np.array([-5e-6]), np.zeros(1), done=0, most=3000, keep=lambda *_: None, progress=None)
    assert ran.tolist() == [3000] == plain.turns.tolist()
