"""Campbell diagrams against closed forms: rotors on springs, and the oil whip of the rigid rotor."""

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.linear.campbell import campbell
from whirlmap.equations import Model, Parameter, cos, sin, states, t
from whirlmap.errors import RangeError
from whirlmap.films.linear import linear_film, whip_threshold, whirl_ratio_squared
from whirlmap.integrate.system import System


def on_springs(gyro=0.3, ratio=1.0, xi=0.0, **roles):
    """A centre on springs of stiffness 1 and ratio^2, with a gyroscopic coupling g s; time in radians of the clock."""
    x, y, vx, vy = states("x y", "1", "centre") + states("vx vy", "1", "velocity")
    s, g, b = Parameter("s", "1", "speed", above=0), Parameter("g", "1", "coupling"), Parameter("b", "1", "unbalance")
    model = Model(
        name="springs", states=(x, y, vx, vy), parameters=(s, g, b),
        equations={
            x: vx, y: vy,
            vx: -x / s**2 - g * vy - 2 * xi / s * vx + b * cos(t),
            vy: -(ratio**2) * y / s**2 + g * vx - 2 * xi / s * vy + b * sin(t),
        },
        harmonics=(1,), clocks={"shaft": 1}, start="equilibrium", swing=(x, y),
        **({"bodies": {"disc": (x, y)}, "speed": s} | roles),
    )  # fmt: skip
    return System(model, {"s": 1.0, "g": gyro, "b": 0.1})


def test_gyroscopic_modes_split_as_in_closed_form_and_whirl_both_ways(validate):
    """w^2 -+ g s w - 1 = 0; forward meets the shaft at 1/sqrt(1 - g), backward at 1/sqrt(1 + g)."""
    s, g = np.linspace(0.5, 2.0, 301), 0.3
    ds = campbell(on_springs(g), "s", s)
    half = g * s / 2
    expected = {1: half + np.sqrt(half**2 + 1), -1: -half + np.sqrt(half**2 + 1)}
    assert ds.sizes["mode"] == 2
    for mode in ds["mode"].values:
        sense = set(ds["whirl"].sel(mode=mode).values.tolist())
        assert len(sense) == 1
        np.testing.assert_allclose(ds["frequency"].sel(mode=mode), expected[sense.pop()], rtol=1e-8)
    np.testing.assert_allclose(ds["growth"], 0, atol=1e-8)
    validate("gyroscopic rotor, g 0.3: backward and forward critical speed", ds["critical"].values,
             [1 / np.sqrt(1 + g), 1 / np.sqrt(1 - g)], tier="exact", source="1/sqrt(1 +- g)", rel=1e-4)  # fmt: skip
    assert ds["critical_whirl"].values.tolist() == [-1, 1]


def test_unequal_springs_without_coupling_swing_along_lines():
    ds = campbell(on_springs(0.0, ratio=1.5, xi=0.05), "s", np.linspace(0.5, 2, 61))
    np.testing.assert_allclose(ds["frequency"].T, np.sqrt(np.array([1.0, 2.25]) - 0.05**2) * np.ones((61, 1)), rtol=1e-8)
    np.testing.assert_allclose(ds["damping_ratio"].sel(mode=0), 0.05, rtol=1e-7)
    assert (ds["whirl"] == 0).all()


def test_oil_whirl_is_forward_at_the_known_ratio_and_loses_its_damping_at_the_threshold():
    film, p = linear_film(0.3, 0.0), float(whip_threshold(0.3, 0.0))
    system = whirlmap.load("jeffcott", s=p, Gamma=1 / (p * float(film.load)))
    ds = campbell(system, "s", np.array([0.99, 1.0, 1.01]) * p)
    least = int(np.abs(ds["growth"].isel(s=1).values).argmin())
    mode = ds.isel(mode=least)
    assert mode["growth"].values[0] < 0 < mode["growth"].values[2]
    assert abs(mode["growth"].values[1]) < 1e-7
    assert float(mode["frequency"][1]) / p == pytest.approx(np.sqrt(float(whirl_ratio_squared(film))), rel=1e-6)
    assert (mode["whirl"] == 1).all()


def test_modes_keep_their_sense_of_whirl_over_coarse_steps():
    """Between these speeds the frequencies move by as much as they are apart."""
    ds = campbell(on_springs(0.3), "s", np.array([0.05, 1.0, 3.0]))
    assert (ds["whirl"] == ds["whirl"].isel(s=0)).all()


def test_film_coefficients_at_half_the_clearance_are_the_tabulated_ones():
    film = linear_film(0.5, 0.0)
    np.testing.assert_allclose(film.K, [[2.9233, 3.9766], [-0.8577, 2.2099]], rtol=1e-3)
    np.testing.assert_allclose(film.C, [[6.6148, 2.2450], [2.2450, 3.0539]], rtol=1e-3)


@pytest.mark.parametrize("values", [[2.0, 1.0], [1.0], [1.0, np.nan]])
def test_values_that_do_not_ascend_are_refused(values):
    with pytest.raises(RangeError, match="ascend"):
        campbell(on_springs(), "s", values)
