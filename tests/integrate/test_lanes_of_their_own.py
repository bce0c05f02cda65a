"""Points of one block take their own steps from their own phases, for their own time: the bits are those of each alone."""

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.kernels.running import lanes

STEPS = np.array([24, 32, 48, 24, 64, 96, 20, 24, 36, 48, 128])
PERIODS = np.array([5, 9, 4, 5, 1, 7, 12, 6, 3, 8, 2])
PHASES = np.array([0, 3, 0, 1, 0, 0, 2, 0, 5, 0, 0])

#: Case, varied parameter, tangent vectors, method.
RUNS = [
    ("duffing", "gamma", (0.2, 0.5), 0, "dop853"),
    ("duffing", "gamma", (0.2, 0.5), 2, "tsit5"),
    ("pendulum", "g", (0.9, 1.6), 1, "rk4"),
    ("van_der_pol", "mu", (1.0, 5.0), 1, "dop853"),
    ("lorenz", "rho", (20.0, 30.0), 2, "rk4"),
    ("gear_backlash", "F_ah", (0.1, 0.3), 1, "dop853"),
    ("gear-psfd/machine", "s", (0.3, 4.0), 0, "dop853"),
    ("gear-psfd/machine", "s", (0.3, 4.0), 2, "dop853"),
    ("gear-psfd/intended", "s", (0.6, 4.0), 1, "tsit5"),
    ("machines/turbo-gearbox", "s", (0.4, 2.0), 1, "dop853"),
]


def ensemble(case, name, values, tangents, method, steps, phases):
    e, _ = make_ensemble(whirlmap.load(case), {name: values}, steps=steps, tangents=tangents, method=method)
    e = e.subset(np.arange(values.size), orth=2) if tangents > 1 else e
    e.turns[:] = phases
    return e


def arrays(e, periods, extremes):
    run = e.advance(periods, save_periods=1, extremes=extremes)
    return {"y": e._y, "turns": e.turns, "status": e.status, "saved": run.saved, "growth": run.growth,
            "crossings": e.crossings, **run.extremes}  # fmt: skip


@pytest.mark.parametrize("extremes", [True, "between"])
@pytest.mark.parametrize(("case", "name", "ends", "tangents", "method"), RUNS)
def test_a_point_in_company_is_a_point_alone(case, name, ends, tangents, method, extremes):
    values = np.linspace(*ends, STEPS.size)
    whole = arrays(ensemble(case, name, values, tangents, method, STEPS, PHASES), PERIODS, extremes)
    for i in range(0, STEPS.size, 3):
        alone = ensemble(case, name, values[[i]], tangents, method, STEPS[[i]], PHASES[[i]])
        for key, array in arrays(alone, int(PERIODS[i]), extremes).items():
            got = whole[key][..., i]
            if key in ("saved", "growth"):
                rest, got = got[PERIODS[i] :], got[: PERIODS[i]]
                assert (np.isnan(rest) | (rest == 0)).all()
            np.testing.assert_array_equal(got, array[..., 0], err_msg=f"{key} of point {i}")


@pytest.mark.parametrize("tangents", [0, 1])
def test_phases_that_are_counted_are_each_lane_s_own(monkeypatch, tangents):
    monkeypatch.setattr(lanes, "LONGEST", 48 * 20)  # some lanes of a block read tables, others count
    test_a_point_in_company_is_a_point_alone("gear-psfd/machine", "s", (0.3, 4.0), tangents, "tsit5", "between")


def test_lanes_that_fail_go_on_beside_others():
    """Films that need shorter steps now and then: mended lanes re-enter at their own steps."""
    values, steps = np.linspace(0.3, 4.0, 16), np.array([4, 6, 8, 12] * 4)
    whole = ensemble("gear-psfd/reference", "s", values, 1, "rk4", steps, 0)
    found = arrays(whole, 60, True)
    for i in range(16):
        alone = ensemble("gear-psfd/reference", "s", values[[i]], 1, "rk4", steps[[i]], 0)
        for key, array in arrays(alone, 60, True).items():
            np.testing.assert_array_equal(found[key][..., i], array[..., 0], err_msg=f"{key} of point {i}")
