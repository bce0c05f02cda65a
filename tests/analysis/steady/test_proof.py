"""Returns of motions that hardly move: what is left of their way, against multipliers that are known."""

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.analysis.steady import proof, settling
from whirlmap.analysis.steady.settled import Settled
from whirlmap.analysis.steady.settling import Settling, settle
from whirlmap.equations import Model, Parameter, State, cos, t
from whirlmap.integrate.system import System

w = Parameter("w", "1", "w", above=0)


def alternating(slow, *, size=1e-3, fast=0.05):
    """A forced relaxation of rate ``fast`` beside an oscillation at half of the forcing, which decays at the rate ``slow``.

    Its multipliers over T are exp(-fast T) and, twice, -exp(-slow T): the motion is 1T, or none. All states hold both.
    """
    modes = np.array([[-fast, 0, 0], [0, -slow, -0.5], [0, 0.5, -slow]])
    basis = np.eye(3) + 0.4 * np.random.default_rng(7).normal(size=(3, 3))
    matrix, push = basis @ modes @ np.linalg.inv(basis), basis[:, 0]
    # x' = -fast x + cos t: x = (fast cos t + sin t)/(1 + fast^2); a little of its transient goes along.
    start = basis @ np.array([fast / (1 + fast**2) + 1e-3, size, 0.0])
    states = tuple(State(f"x{i}", "1", "x", start=float(s)) for i, s in enumerate(start))
    rates = {
        s: sum(float(a) * q for a, q in zip(row, states, strict=True)) + float(p) * cos(w * t)
        for s, row, p in zip(states, matrix, push, strict=True)
    }
    model = Model(name="alternating", states=states, parameters=(w,), harmonics=(w,), equations=rates, swing=states[:1])
    return System(model, {"w": 1.0})


def test_a_motion_that_still_alternates_is_not_doubled(monkeypatch):
    system = alternating(1e-5, size=1e-4)
    found = whirlmap.label_points(system, {"w": np.ones(1)})
    assert whirlmap.labels(found).item() == "periodic" and found.period_T.item() == 1
    assert found.lyapunov.item() == pytest.approx(-1e-5, rel=0.05)
    ensemble, _ = make_ensemble(system, {"w": np.ones(1)}, steps=32)
    assert settle(ensemble, Settling()).multiple.item() in (0, 1)
    # The regime is entered: without the proof it counts as a return after two periods.
    monkeypatch.setattr(settling, "unproved", lambda *_: proof.Unproved(np.zeros(0, int), np.ones(0), np.zeros(0, int)))
    again, _ = make_ensemble(system, {"w": np.ones(1)}, steps=32)
    assert settle(again, Settling()).multiple.item() == 2


def test_a_motion_that_leaves_its_orbit_grows():
    found = whirlmap.label_points(alternating(-2e-5), {"w": np.ones(1)})
    assert whirlmap.labels(found).item() == "growing"
    assert found.lyapunov.item() == pytest.approx(2e-5, rel=1e-3)


def test_way_that_is_left_is_the_change_times_mu_over_one_less_mu():
    """The oscillation of size a alternates: over two periods it changes by a (1 - mu), and a is left."""
    slow = 1e-4
    for size, stands in ((1e-3, False), (1e-8, True)):
        ensemble, _ = make_ensemble(alternating(slow, size=size, fast=20.0), {"w": np.ones(1)}, steps=256)
        ensemble.advance(4)
        settled = Settled.none(ensemble)
        settled.multiple[:], settled.scale[:] = 2, 1.0
        found = proof.unproved(ensemble, settled, np.arange(1), 1e-6, {}, np.array([1000]))
        assert found.points.tolist() == ([] if stands else [0])
        if not stands:
            assert found.strict == pytest.approx([np.expm1(2 * slow * 2 * np.pi)], rel=1e-6)
