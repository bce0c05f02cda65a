"""Threshold of the rigid rotor on plain short bearings, in nonlinear simulation."""

import numpy as np
import pytest

import whirlmap
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.equilibrium import start_states
from whirlmap.integrate.system import System
from whirlmap.models import family

THRESHOLDS = {0.10: 2.7413, 0.30: 2.6058, 0.50: 2.5417}  # eccentricity: omega_s sqrt(c/g)
WHIRL = {0.10: 0.50294, 0.30: 0.51942, 0.50: 0.51464}
TURNS = 120


def rotor(eps, s):
    """Gamma follows from the eccentricity: N = 1/(Gamma s) = eps sqrt(B^2 + D^2)."""
    B, D = -2 * eps / (1 - eps**2) ** 2, np.pi / (2 * (1 - eps**2) ** 1.5)
    return [s, 1 / (s * eps * np.hypot(B, D)), 0.0]


@pytest.fixture(scope="module")
def runs():
    """Every eccentricity at 0.97 and 1.03 of its threshold, disturbed by 1e-4 c: deviations (save, axis, point)."""
    model = family("jeffcott").model(rotor="rigid")
    points = [(eps, ratio) for eps in THRESHOLDS for ratio in (0.97, 1.03)]
    values = np.array([rotor(eps, ratio * THRESHOLDS[eps]) for eps, ratio in points]).T
    rest, found = start_states(model, values)
    assert found.all()
    np.testing.assert_allclose(np.hypot(rest[0], rest[1]), [eps for eps, _ in points], atol=1e-10)
    orders = System(model, {"s": 1.0, "Gamma": 1.0, "b": 0.0}).orders
    e = Ensemble(model, values, rest + np.array([[1e-4], [0], [0], [0]]), orders=orders, steps=200)
    saved = e.advance(TURNS, save_every=20).saved[:, :2]
    assert (e.status == 0).all()
    return points, saved - rest[:2]


def test_below_the_threshold_it_decays_and_above_it_grows(runs):
    points, deviation = runs
    size = np.hypot(deviation[:, 0], deviation[:, 1])
    third = size.shape[0] // 3
    early, late = size[third : 2 * third].max(axis=0), size[2 * third :].max(axis=0)
    for i, (eps, ratio) in enumerate(points):
        assert (late[i] > 1.1 * early[i]) == (ratio > 1), (eps, ratio, early[i], late[i])
        assert (late[i] < 0.9 * early[i]) == (ratio < 1), (eps, ratio, early[i], late[i])


def test_it_whirls_at_the_tabulated_ratio(runs, validate):
    """Turns of the deviation per turn of the shaft; curvature over 3 % of speed is below 1e-3."""
    _, deviation = runs
    half = deviation.shape[0] // 2
    angle = np.unwrap(np.arctan2(deviation[half:, 1], deviation[half:, 0]), axis=0)
    turns = (angle[-1] - angle[0]) / (2 * np.pi)
    shaft = (angle.shape[0] - 1) * 20 / 200
    ratio = turns / shaft
    for i, eps in enumerate(THRESHOLDS):
        middle = (ratio[2 * i] + ratio[2 * i + 1]) / 2  # it changes with speed: between 0.97 and 1.03 lies 1
        validate(f"rigid rotor on plain short bearings, eccentricity {eps:g}: whirl ratio at the threshold, simulated",
                 middle, WHIRL[eps], tier="independent", source="closed-form film integrals and Routh-Hurwitz", within=1e-3)


def test_the_very_threshold_is_bracketed_by_a_few_per_mil(validate):
    """Growth per turn falls through zero between 0.97 and 1.03: linear interpolation hits 1 to the printed digits."""
    model = family("jeffcott").model(rotor="rigid")
    ratios = np.array([0.99, 1.0, 1.01])
    values = np.array([rotor(0.3, r * THRESHOLDS[0.30]) for r in ratios]).T
    rest, _ = start_states(model, values)
    orders = System(model, {"s": 1.0, "Gamma": 1.0, "b": 0.0}).orders
    e = Ensemble(model, values, rest + np.array([[1e-5], [0], [0], [0]]), orders=orders, steps=200)
    e.advance(40)  # the fast modes die
    size = []
    for _ in range(2):
        part = e.advance(40, save_every=5)
        size.append(np.log(np.hypot(*(part.saved[:, :2] - rest[:2]).transpose(1, 0, 2)).max(axis=0)))
    rate = (size[1] - size[0]) / 40
    assert rate[0] < 0 < rate[2]
    zero = np.interp(0.0, rate, ratios)
    validate("rigid rotor, eccentricity 0.3: speed of zero growth in simulation over the threshold", zero, 1.0,
             tier="independent", source="closed-form film integrals and Routh-Hurwitz",
             within=2e-4)  # five printed digits, and a peak between samples


def test_the_stock_case_decays_below_and_grows_above_its_linear_threshold():
    """The film group is held; within 1 % of `stability_threshold` a small kick turns from decay to growth."""
    system = whirlmap.load("jeffcott", b=0)
    limit = whirlmap.stability_threshold(system, "s", (2.0, 3.0))
    values = np.repeat(system.vector[:, None], 2, axis=1)
    values[system.parameters.index("s")] = limit * np.array([0.99, 1.01])
    rest, found = start_states(system.model, values)
    assert found.all()
    e = Ensemble(system.model, values, rest + np.array([[1e-5], [0], [0], [0]]), orders=system.orders, steps=200)
    e.advance(40)  # the fast modes die
    parts = [e.advance(40, save_every=5).saved[:, :2] - rest[:2] for _ in range(2)]
    size = [np.hypot(part[:, 0], part[:, 1]).max(axis=0) for part in parts]
    assert size[1][0] < size[0][0] and size[1][1] > size[0][1]


def test_the_gear_pair_begins_to_whirl_at_its_linear_threshold(validate):
    """20 states without unbalance and transmission error: a small kick grows at the rate of the eigenvalue, within 1 %."""
    system = whirlmap.load("gear-psfd/machine", arc="fixed", b_p=0, b_g=0, E=0)
    limit = whirlmap.stability_threshold(system, "s", (2.0, 4.0))
    ratios = np.array([0.99, 1.01])
    values = np.repeat(system.vector[:, None], 2, axis=1)
    values[system.parameters.index("s")] = limit * ratios
    rest, found = start_states(system.model, values)
    assert found.all()
    modes = [whirlmap.linear_analysis(system.replace(s=limit * r)) for r in ratios]
    kick = np.stack([m.eigenvectors[:, 0].real / np.abs(m.eigenvectors[:, 0]).max() for m in modes], axis=1)
    e = Ensemble(system.model, values, rest + 1e-5 * kick, orders=system.orders, steps=64)
    turns, teeth = 30, 20  # saves every tooth, over turns of the pinion
    path = e.advance(turns * teeth, save_every=64).saved - rest
    assert (e.status == 0).all()
    time = np.arange(path.shape[0]) * system.period
    growth = []
    for i, m in enumerate(modes):
        left = np.linalg.inv(m.eigenvectors)[0]  # the least damped mode alone
        growth.append(np.polyfit(time, np.log(np.abs(np.einsum("j,tj->t", left, path[:, :, i]))), 1)[0])
        assert growth[i] == pytest.approx(m.eigenvalues[0].real, rel=1e-2)
    assert growth[0] < 0 < growth[1]
    validate("gear pair of 20 states: speed of zero growth in simulation over the linear threshold",
             np.interp(0.0, growth, ratios), 1.0, tier="invariant", source="eigenvalues of its own Jacobian", within=1e-3)
