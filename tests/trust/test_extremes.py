"""Extremes, means and rms values between the steps: closed forms of linear oscillators, SciPy's interpolant of others.

The superharmonics of a clock are written as Chebyshev polynomials of its cosine, so that the clock is the only frequency
declared and the motion is n times as fast as it.
"""

from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from sympy import chebyshevt
from tests.trust.asking import EXTREME, label, some
from tests.trust.truth_cycles import Flow
from tests.trust.truth_events import Arc
from tests.trust.truth_linear import Linear, extremes_of
from tests.trust.truth_orbits import Pieces, extremes
from tests.trust.unforced_models import FLOWS

import whirlmap
from whirlmap.equations import Model, Output, Parameter, State, cos, sin, sqrt, states, t

x, v = State("x", "1", "displacement", start=0.5), State("v", "1", "velocity")
z, w, B, k, q = (Parameter(n, "1", n) for n in ["z", "w", "B", "k", "q"])
STATES = ("x", "v")


def oscillator(name, force, *used):
    return Model(name=name, states=(x, v), parameters=(z, *used, w), equations={x: v, v: force - 2 * z * v - x},
                 harmonics=(w,), swing=(x,),
                 outputs={"power": Output(-2 * z * v**2, "1", "power of the damper")})  # fmt: skip


def diagram(model, swept, at, **values):
    system = whirlmap.load(model, **values, **{swept: at[0]})
    return whirlmap.bifurcation_diagram(system, swept, at, lyapunov=0)


def assert_extremes(ds, quantity, low, high, at=0, tolerance=EXTREME):
    here = ds.sel(quantity=quantity)
    found = [float(here[name][at]) for name in ("minimum", "maximum")]
    np.testing.assert_allclose(found, [low, high], rtol=0, atol=tolerance * (high - low))
    assert float(here["peak_to_peak"][at]) == pytest.approx(high - low, rel=2 * tolerance)


#: Orders, damping ratio, speeds over the resonance.
HARMONICS = {
    "first": (1, 0.05, np.linspace(0.98, 1.03, 11)),
    "second": (2, 0.3, np.array([0.3, 0.47, 0.5, 0.61]) * 2),
    "third": (3, 0.02, np.linspace(0.98, 1.02, 11)),
    "fifth": (5, 0.05, np.linspace(0.95, 1.05, 11)),
    "seventh": (7, 0.1, np.array([0.9, 1.0, 1.1, 1.7])),
    "twelfth": (12, 0.2, np.array([0.8, 1.0, 2.0])),
}


@pytest.mark.parametrize("name", HARMONICS)
def test_superharmonics(name, validate):
    n, damping, ratios = HARMONICS[name]
    model = oscillator(f"superharmonic_{n}", chebyshevt(n, cos(w * t)))
    at = ratios / n
    ds = diagram(model, "w", at, z=damping)
    sizes = 1 / np.hypot(1 - ratios**2, 2 * damping * ratios)
    validate(f"superharmonic of order {n}, damping {damping:g}: peak to peak over the resonance",
             ds["peak_to_peak"].sel(quantity="x").values, 2 * sizes, tier="exact", source="linear oscillator in closed form",
             rel=2 * EXTREME)  # fmt: skip
    for i, r in enumerate(ratios):
        size = 1 / np.hypot(1 - r**2, 2 * damping * r)
        # Of the even ones the motion repeats after a half of T, which is a return after one T as well.
        assert label(ds, i) == "1T"
        assert_extremes(ds, "x", -size, size, i)
        assert_extremes(ds, "v", -size * r, size * r, i)
        assert_extremes(ds, "power", -2 * damping * (size * r) ** 2, 0.0, i)
        assert float(ds["rms"].sel(quantity="x")[i]) == pytest.approx(size / np.sqrt(2), rel=EXTREME)
        assert abs(float(ds["mean"].sel(quantity="x")[i])) < EXTREME * size


def test_two_harmonics_and_a_mean():
    model = oscillator("two_harmonics", B + cos(w * t) + chebyshevt(4, cos(w * t)) / 2, B)
    at = np.array([0.21, 0.26, 0.4])
    ds = diagram(model, "w", at, z=0.05, B=0.7)
    for i, speed in enumerate(at):
        truth = Linear(0.1, 1.0, {Fraction(1): 1, Fraction(4): 0.5}, mean=0.7, unit=speed)
        assert_extremes(ds, "x", *truth.extremes(), i)
        assert_extremes(ds, "v", *truth.extremes(1), i)
        assert float(ds["mean"].sel(quantity="x")[i]) == pytest.approx(0.7, rel=EXTREME)
        assert float(ds["rms"].sel(quantity="x")[i]) == pytest.approx(truth.rms, rel=EXTREME)


y, vx, vy = states("y vx vy", "1", "state")
ORBIT = Model(
    name="orbit_of_a_rotor", states=(x, y, vx, vy), parameters=(z, k, B, w), harmonics=(w,), swing=(x, y),
    equations={
        x: vx, y: vy, vx: cos(w * t) + B * chebyshevt(3, cos(w * t)) - 2 * z * vx - x,
        vy: sin(w * t) - 2 * z * vy - k * y,
    },
    outputs={
        "r": Output(sqrt(x**2 + y**2), "1", "radius"),
        "eps": Output(sqrt(x**2 + y**2) / 20, "1", "eccentricity", role="eccentricity", bearing="1"),
    },
)  # fmt: skip


def test_the_radius_of_an_orbit_and_the_film_that_is_left():
    """Extremes of outputs, and of film thickness, which are limits of a machine."""
    at = np.array([0.31, 0.34, 0.9])
    ds = diagram(ORBIT, "w", at, z=0.04, k=1.3, B=0.4)
    for i, speed in enumerate(at):
        across = Linear(0.08, 1.0, {Fraction(1): 1, Fraction(3): 0.4}, unit=speed)
        up = Linear(0.08, 1.3, {Fraction(1): -1j}, unit=speed)
        low, high = extremes_of(lambda s, a=across, b=up: np.hypot(a.of(s), b.of(s)), 2 * np.pi / speed, 3 * speed)
        assert_extremes(ds, "r", low, high, i)
        assert float(ds["max_eccentricity"][i, 0]) == pytest.approx(high / 20, abs=EXTREME * (high - low) / 20)
        assert float(ds["min_film"][i, 0]) == pytest.approx(1 - high / 20, abs=EXTREME * (high - low) / 20)


DUFFING = Pieces("x v", (), ("v", "gamma*cos(omega*t) - delta*v - alpha*x - beta*x**3"), frequency="omega")
#: Points of Duffing's oscillator with one attractor, and the period of each.
DUFFING_AT = {
    "hardening": (dict(alpha=1.0, beta=4.0, delta=0.1, gamma=2.5, omega=2.0), (2.0, 0.0)),
    "subharmonic": (dict(alpha=0.0, beta=1.0, delta=0.2, gamma=8.0, omega=1.3), (1.0, 0.0)),
    "two-wells": (dict(alpha=-1.0, beta=1.0, delta=0.3, gamma=0.28, omega=1.2), (1.0, 0.0)),
    "slow": (dict(alpha=1.0, beta=5.0, delta=0.2, gamma=8.0, omega=0.5), (1.0, 0.0)),
    "superharmonic": (dict(alpha=1.0, beta=0.5, delta=0.1, gamma=1.0, omega=0.33), (0.0, 0.0)),
}


@pytest.mark.parametrize("name", DUFFING_AT)
def test_duffings_oscillator(name, validate):
    """Newton's method on SciPy's map of the attractor found, whose label it confirms; extremes of its interpolant."""
    values, start = DUFFING_AT[name]
    system = whirlmap.load("duffing", **values, start=dict(zip(STATES, start, strict=True)))
    ds = whirlmap.bifurcation_diagram(system, "gamma", [values["gamma"]], lyapunov=0, states=list(STATES))
    n = int(ds["period_T"][0])
    assert n > 0
    orbit = DUFFING.at(**values).described(ds["section"].values[0, 0], n)
    assert orbit.largest < 1
    assert np.abs(orbit.z - ds["section"].values[0, 0]).max() < 1e-5 * np.ptp([orbit.low, orbit.high])
    here = ds.sel(quantity=list(STATES))
    validate(f"Duffing, {name}: extremes of displacement and velocity on its {n}T orbit",
             [here["minimum"].values[0], here["maximum"].values[0]], [orbit.low, orbit.high], tier="independent",
             source="Newton's method on SciPy's map", within=EXTREME * np.subtract(orbit.high, orbit.low))  # fmt: skip
    for i, quantity in enumerate(STATES):
        assert_extremes(ds, quantity, orbit.low[i], orbit.high[i])


#: Cycles without forcing: the relaxation oscillator's velocity and Roessler's z are spikes.
CYCLES = {
    "van_der_pol": (dict(mu=3.0), (2.0, 0.0), 150.0),
    "brusselator": (dict(a=1.0, b=3.5), (1.0, 1.0), 200.0),
    "roessler": (dict(a=0.2, b=0.2, c=2.5), (1.0, 1.0, 0.0), 2000.0),
    "predator_prey": (dict(r=1.0, k=3.0, a=1.0, m=0.3), (1.0, 1.0), 800.0),
}


@pytest.mark.parametrize("name", some(CYCLES, ["van_der_pol", "brusselator"]))
def test_cycles_without_forcing(name):
    values, start, time = CYCLES[name]
    model, names, rates, cut = FLOWS[name]
    truth = Flow(names, rates, cut, **values).cycle(start, time, near=1e-8)
    system = whirlmap.load(model, **values, start=dict(zip(names.split(), start, strict=True)))
    swept = next(iter(values))
    ds = whirlmap.bifurcation_diagram(system, swept, [values[swept]], lyapunov=0)
    for i, quantity in enumerate(names.split()):
        assert_extremes(ds, quantity, truth.low[i], truth.high[i], tolerance=1e-4 if name == "roessler" else EXTREME)


@pytest.mark.slow
def test_the_film_of_a_rotor():
    """The rig's smallest film against SciPy's interpolant of the same rates, settled for 200 turns."""
    system = whirlmap.load("machines/jeffcott-rig")
    ds = whirlmap.label_points(system, {system.parameters[0]: [system.vector[0]]}, lyapunov=0, ends=True)
    assert label(ds, 0) == "1T"
    made = solve_ivp(system.reference_rhs, (0, system.period), ds["end_state"].values[0], method="DOP853", rtol=1e-11,
                     atol=1e-13, dense_output=True)  # fmt: skip
    low, high = extremes([Arc((), 0.0, system.period, made.sol)], system.model.dimension)
    for i, quantity in enumerate(system.states):
        assert_extremes(ds, quantity, low[i], high[i])
