"""Films that thin without settling: oil whip of the stock rotor, and closed forms of gaps that close as powers of time."""

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.diagnosis.diagnosis import diagnose
from whirlmap.analysis.diagnosis.diagnosis_json import verdict_json
from whirlmap.analysis.trends.film_thinning import thinning_power
from whirlmap.equations import Model, Parameter, State, Stop, cos, t
from whirlmap.integrate.system import System
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status
from whirlmap.sweep.points.label_points import label_points

q = State("q", "1", "gap", start=1.0)
a, n, w = (Parameter(name, "1", name) for name in "anw")


def closing(power, floor=0):
    """A gap that closes as q' = -a (q - floor)^n: as t^(-1/(n - 1)), or to a floor."""
    return Model(
        name="closing", states=(q,), parameters=(a, w), harmonics=(w,), swing=(q,),
        equations={q: -a * (q - floor) ** power * (1 + cos(w * t) / 4)}, stops={"contact": Stop(q, "closed")},
    )  # fmt: skip


@pytest.mark.parametrize(("power", "wanted"), [(2, -1.0), (3, -0.5), (4, -1 / 3)])
def test_gaps_that_close_as_powers_of_time_are_not_settled(power, wanted):
    ds = label_points(System(closing(power), {"a": 1.0, "w": 1.0}), {"a": [1.0, 3.0]}, lyapunov=1024)
    assert (ds["regime"].values == Regime.not_settled).all() and (ds["status"].values == Status.ok).all()
    assert ds["thinning"].values == pytest.approx(wanted, rel=0.02)


def test_a_gap_that_comes_to_a_floor_is_settled():
    ds = label_points(System(closing(1, 0.05), {"a": 1.0, "w": 1.0}), {"a": [0.01, 0.1, 1.0]}, lyapunov=1024)
    assert not (ds["regime"].values == Regime.not_settled).any() and np.isnan(ds["thinning"].values).all()
    exponential = label_points(System(closing(1), {"a": 1.0, "w": 1.0}), {"a": [0.1]}, lyapunov=1024)
    assert not (exponential["regime"].values == Regime.not_settled).any()


def test_the_power_is_that_of_the_narrowest_gap():
    model = closing(3)
    times = np.arange(200.0, 264.0)
    values = np.array([1.0, 1.0])
    thin = (times[:, None]) ** -0.5
    assert thinning_power(model, values, thin, 199.5, 1.0) == pytest.approx(-0.5, abs=0.01)
    assert np.isnan(thinning_power(model, values, 0.03 + 0 * thin, 199.5, 1.0))
    assert np.isnan(thinning_power(model, values, 0.03 + np.exp(-0.3 * (times[:, None] - 200)), 199.5, 1.0))  # to a floor
    assert np.isnan(thinning_power(model, values, thin[::-1], 199.5, 1.0))


@pytest.mark.slow  # minutes: a film that thins for ever, followed at 256 steps per T and more
def test_oil_whip_of_the_stock_rotor_is_locked_at_one_half_and_thins():
    rigid = label_points(whirlmap.load("jeffcott"), {"s": [2.5, 2.6, 2.9]}, lyapunov=256)
    assert [Regime(int(r)).label for r in rigid["regime"].values] == ["periodic", "not-settled", "not-settled"]
    assert rigid["rotation_number"].values[1:] == pytest.approx(0.5, abs=0.01)
    flexible = label_points(whirlmap.load("jeffcott", rotor="flexible"), {"s": [2.3, 2.7, 4.0]}, lyapunov=256)
    assert [Regime(int(r)).label for r in flexible["regime"].values] == ["periodic", "not-settled", "not-settled"]
    assert (flexible["status"].values == Status.ok).all()
    assert flexible["rotation_number"].values[1:] == pytest.approx(0.5, abs=1e-3)
    power = flexible["thinning"].values[1:]  # falls towards -1/2: -0.68 after 260 T
    assert (power > -0.75).all() and (power < -0.5).all()
    said = verdict_json(diagnose.find(whirlmap.load("jeffcott")))
    assert said["regime"] == "not-settled" and said["period"] is None
    assert said["rotation_number"] == said["winding"] == pytest.approx(0.5, abs=0.01)
