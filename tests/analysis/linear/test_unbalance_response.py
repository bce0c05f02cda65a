"""Response to unbalance: closed forms, films in series with a shaft by hand, and the nonlinear motion at small unbalance."""

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.linear.amplification import Critical, criticals
from whirlmap.equations import Model, Parameter, State, cos, sin, states, t
from whirlmap.errors import InputError, RangeError, WhirlmapError

s = Parameter("s", "1", "speed over omega_0", above=0)
zeta, b = Parameter("zeta", "1", "damping ratio"), Parameter("b", "1", "eccentricity", at_least=0)


def on_springs() -> Model:
    """A Jeffcott rotor on linear springs, time in radians of its turning, s = omega/omega_0."""
    x, y, vx, vy = states("x y vx vy", "1", "of the rotor")

    def rate(q: State, v: State, force):
        return -2 * zeta / s * v - q / s**2 + b * force

    return Model(
        name="springs", states=(x, y, vx, vy), parameters=(s, zeta, b),
        equations={x: vx, y: vy, vx: rate(x, vx, cos(t)), vy: rate(y, vy, sin(t))}, harmonics=(1,),
        start="equilibrium", speed=s, bodies={"rotor": (x, y)}, unbalances={"rotor": b},
    )  # fmt: skip


@pytest.mark.parametrize("damping", [0.005, 0.02, 0.1, 0.3])
def test_on_linear_springs_it_is_the_closed_form(damping):
    system = whirlmap.load(on_springs(), s=1.0, zeta=damping, b=0.01)
    at = np.linspace(0.2, 3.0, 300)
    ds = whirlmap.unbalance_response(system, "s", at)
    amplitude = 0.01 * at**2 / np.hypot(1 - at**2, 2 * damping * at)
    lag = np.arctan2(2 * damping * at, 1 - at**2)
    for axis, later in (("x", 0.0), ("y", np.pi / 2)):
        one = ds.sel(rotor="rotor", station="rotor", axis=axis)
        np.testing.assert_allclose(one["amplitude"], amplitude, rtol=1e-12)
        np.testing.assert_allclose(one["phase"] - later, lag, atol=1e-12)
        np.testing.assert_allclose(ds["total"].sel(station="rotor", axis=axis), 2 * amplitude, rtol=1e-12)
    np.testing.assert_allclose(ds["major"][0, 0], amplitude, rtol=1e-12)
    # 1/A^2 is a parabola in 1/s^2, with its least value at 1 - 2 zeta^2.
    middle = 1 - 2 * damping**2
    half = np.sqrt(1 - middle**2)
    peak, low = middle**-0.5, (middle + half) ** -0.5
    assert ds["critical"].values == pytest.approx([peak], rel=1e-5)
    assert ds["critical_amplitude"].values == pytest.approx([0.01 / (2 * damping * np.sqrt(1 - damping**2))], rel=1e-4)
    assert ds["critical_low"].values == pytest.approx([low], rel=1e-5)
    if middle > half:
        high = (middle - half) ** -0.5
        assert ds["amplification"].values == pytest.approx([peak / (high - low)], rel=2e-4)


def test_amplification_factor_and_margins_of_api_617():
    """AF = N_c/(N_2 - N_1); below the range 17 (1 - 1/(AF - 1.5)) %, above it 10 % more; below 2.5 nothing is asked for."""
    one = Critical(3000.0, 1.0, 2800.0, 3400.0)
    assert one.factor == 5.0 and not one.one_sided
    assert one.required(4000.0) == pytest.approx(0.17 * (1 - 1 / 3.5))
    assert one.required(1000.0) == pytest.approx(0.10 + 0.17 * (1 - 1 / 3.5))
    assert one.margin(4000.0, 9000.0) == 0.25 and one.margin(1000.0, 2500.0) == pytest.approx(0.2)
    assert one.margin(2000.0, 9000.0) == 0.0
    assert Critical(3000.0, 1.0, 2400.0, 3600.0).required(4000.0) == pytest.approx(0.0)
    assert Critical(3000.0, 1.0, 2000.0, 4000.0).required(4000.0) == 0.0
    assert Critical(3000.0, 1.0, None, 3300.0).factor == 5.0 and Critical(3000.0, 1.0, None, 3300.0).one_sided
    assert Critical(3000.0, 1.0, None, None).factor is None and Critical(3000.0, 1.0, None, None).required(1.0) is None


def test_a_half_power_speed_beyond_a_higher_peak_is_none():
    at = np.linspace(0.0, 10.0, 401)
    curve = np.exp(-((at - 4.0) ** 2)) + 3 * np.exp(-((at - 6.0) ** 2))
    low, high = criticals(at, curve + 0.8 * np.exp(-((at - 4.0) ** 2)))[:1], criticals(at, curve)[-1]
    assert low[0].speed == pytest.approx(4.2, abs=0.3) and low[0].high is None and low[0].low is not None
    assert high.low is not None and high.high is not None


def test_a_peak_that_no_points_resolve_has_no_factor():
    (one,) = criticals(np.array([0.5, 0.9, 1.3, 1.7]), np.array([0.0024, 0.0101, 0.0151, 0.0103]))
    assert one.speed == 1.3 and one.amplitude == 0.0151 and one.factor is None


def test_films_in_series_with_a_shaft():
    """A flexible shaft on the films' eight coefficients, written out: u = k (K + iC + k)^-1 x."""
    system = whirlmap.load("jeffcott", rotor="flexible", k=3.0, xi=0.02, b=0.01)
    at = [0.5, 0.9, 1.3, 1.7]
    ds = whirlmap.unbalance_response(system, "s", at)
    for i, speed in enumerate(at):
        film = whirlmap.film_coefficients(system.replace(s=speed))["1"]
        dynamic = film.load * (film.K + 1j * film.C)
        journal = np.linalg.solve(dynamic + 3.0 * np.eye(2), 3.0 * np.eye(2))  # u for x
        shaft = -np.eye(2) + 2j * 0.02 / speed * np.eye(2) + 3.0 / speed**2 * (np.eye(2) - journal)
        x = np.linalg.solve(shaft, 0.01 * np.array([1, -1j]))
        for station, expected in (("rotor", x), ("journals", journal @ x)):
            one = ds.isel(s=i).sel(rotor="rotor", station=station)
            found = one["amplitude"].values * np.exp(-1j * one["phase"].values)
            np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_the_nonlinear_motion_tends_to_it():
    """Peak to peak of the settled motion: the difference falls with the square of a small unbalance."""
    apart = []
    for size in (0.04, 0.02):
        system = whirlmap.load("jeffcott", b=size)
        at = [0.8, 1.2, 1.6, 2.0]
        ds = whirlmap.unbalance_response(system, "s", at)
        motion = whirlmap.bifurcation_diagram(system, "s", at, accuracy=1e-9)
        swing = motion["peak_to_peak"].sel(quantity=["ux", "uy"]).values
        apart.append(np.abs(swing / ds["total"].sel(station="rotor").values.T - 1).max())
    assert 1e-5 < apart[1] < 0.005
    assert apart[0] / apart[1] == pytest.approx(4.0, rel=0.1)


def test_each_rotor_of_a_gear_pair_has_its_own_frequency():
    """One unbalance at a time, and no transmission error: the motion is that rotor's line of the response."""
    for other, rotor in (("b_g", "pinion"), ("b_p", "gear")):
        alone = {"b_p": 1e-3, "b_g": 1e-3} | {other: 0.0}
        system = whirlmap.load("gear-psfd/intended", s=0.5, E=0.0, **alone)
        ds = whirlmap.unbalance_response(system, "s", [0.4, 0.5, 0.6, 0.7])
        assert ds["rotor"].values.tolist() == [rotor]
        motion = whirlmap.bifurcation_diagram(system, "s", [0.5, 0.6], accuracy=1e-9)
        for station, x, y in (("pinion", "xp", "yp"), ("gear", "xg", "yg")):
            swing = motion["peak_to_peak"].sel(quantity=[x, y]).values
            np.testing.assert_allclose(swing, ds["total"].sel(station=station, s=[0.5, 0.6]).values.T, rtol=5e-3)


def test_it_is_linear_in_each_unbalance_and_adds_up():
    system = whirlmap.load("gear-psfd/intended", s=0.5)
    one = whirlmap.unbalance_response(system, "s", [0.4, 0.5, 0.6, 0.7])
    twice = whirlmap.unbalance_response(system.replace(b_p=2 * float(system.values["b_p"])), "s", [0.4, 0.5, 0.6, 0.7])
    np.testing.assert_allclose(twice["amplitude"].sel(rotor="pinion"), 2 * one["amplitude"].sel(rotor="pinion"), rtol=1e-9)
    np.testing.assert_allclose(twice["amplitude"].sel(rotor="gear"), one["amplitude"].sel(rotor="gear"), rtol=1e-9)
    np.testing.assert_allclose(one["total"], 2 * one["amplitude"].sum("rotor"), rtol=1e-12)


@pytest.mark.parametrize(("ask", "words"), [
    (lambda: whirlmap.unbalance_response(whirlmap.load("jeffcott"), "Gamma", [1, 2, 3, 4]), "another parameter"),
    (lambda: whirlmap.unbalance_response(whirlmap.load("jeffcott"), "s", [1, 2, 3]), "4 or more"),
    (lambda: whirlmap.unbalance_response(whirlmap.load("jeffcott"), "s", [1, 3, 2, 4]), "ascend"),
    (lambda: whirlmap.unbalance_response(whirlmap.load("jeffcott", b=0), "s", [1, 2, 3, 4]), "all zero"),
    (lambda: whirlmap.unbalance_response(whirlmap.load("duffing"), "omega", [1, 2, 3, 4]), "expected a model"),
])  # fmt: skip
def test_what_has_no_response_is_refused(ask, words):
    with pytest.raises(RangeError, match=words):
        ask()


def test_an_unknown_station_is_refused():
    system = whirlmap.load("jeffcott", b=0.1)
    with pytest.raises(InputError, match=r"rotr.*rotor"):
        whirlmap.unbalance_response(system, "s", [1, 2, 3, 4], stations=["rotr"])


def test_stations_are_states_or_outputs():
    x, v = states("x v", "1", "of a mass")
    with pytest.raises(WhirlmapError, match="stations"):
        Model(name="m", states=(x, v), parameters=(), equations={x: v, v: -x}, stations={"a": ("x", "z")})
