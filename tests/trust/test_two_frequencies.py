"""Models of two and three forcing frequencies, swept: every point has the period, rms and extremes of its own frequencies.

Linear ones are exact by superposition (`truth_linear`); Duffing's oscillator and the dry friction of two tones by SciPy
(`truth_orbits`).
"""

from fractions import Fraction

import numpy as np
import pytest
from tests.trust.asking import EXTREME, label
from tests.trust.truth_linear import Linear, extremes_of
from tests.trust.truth_orbits import Pieces

import whirlmap
from whirlmap.equations import Model, Parameter, State, cos, sin, states, t
from whirlmap.results.files import write

x, v = State("x", "1", "displacement"), State("v", "1", "velocity")
a, b, g, c, B, r, q, F = (Parameter(n, "1", n) for n in ["a", "b", "g", "c", "B", "r", "q", "F"])


def oscillator(name, force, harmonics, *used):
    return Model(name=name, states=(x, v), parameters=used, equations={x: v, v: force - c * v - x}, harmonics=harmonics,
                 swing=(x,))  # fmt: skip


TWO = oscillator("two_tones", cos(a * t) + B * sin(b * t), (a, b), a, b, c, B)
THREE = oscillator("three_tones", cos(a * t) + B * cos(b * t) + B * sin(g * t), (a, b, g), a, b, g, c, B)
PRODUCT = oscillator("product_of_tones", cos(a * t) * cos(b * t), (a, b), a, b, c)
RATIO = oscillator("ratio_of_tones", cos(a * t) + B * sin(r * a * t), (a, r * a), a, r, c, B)
CUBIC = oscillator("cubic_two_tones", cos(a * t) + B * cos(b * t) - q * x**3, (a, b), a, b, c, B, q)

y, vx, vy = states("y vx vy", "1", "state")
ROTOR = Model(  # two unbalances that turn against each other
    name="counter_rotating", states=(x, y, vx, vy), parameters=(a, b, c, B), harmonics=(a, b), swing=(x, y),
    equations={
        x: vx, y: vy, vx: a**2 * cos(a * t) + B * b**2 * cos(b * t) - c * vx - x,
        vy: a**2 * sin(a * t) - B * b**2 * sin(b * t) - c * vy - x * 0 - y,
    },
)  # fmt: skip


def exact(values):
    return [Fraction(value).limit_denominator(1000) for value in values]


#: Name -> model, fixed values, what is swept over which exact values, and the forces of each value.
SWEEPS = {
    "slower": (TWO, dict(a=1, c=0.2, B=0.5), "b", ["1/4", "1/3", "2/5", "1/2", "3/5", "2/3"],
               lambda w: {Fraction(1): 1, w: -0.5j}),
    "slower-fine": (TWO, dict(a=1, c=0.3, B=0.5), "b", ["9/20", "23/50", "47/100"], lambda w: {Fraction(1): 1, w: -0.5j}),
    "faster": (TWO, dict(a=1, c=0.2, B=0.5), "b", ["5/4", "3/2", "2", "5/2", "3"], lambda w: {Fraction(1): 1, w: -0.5j}),
    "across": (TWO, dict(a=1, c=0.2, B=2), "b", ["4/5", "9/10", "11/10", "6/5"], lambda w: {Fraction(1): 1, w: -2j}),
    "first": (TWO, dict(b=1.5, c=0.2, B=0.5), "a", ["1/2", "3/4", "1", "2"], lambda w: {w: 1, Fraction(3, 2): -0.5j}),
    "negative": (TWO, dict(a=1, c=0.2, B=0.5), "b", ["-2/3", "-1/2"], lambda w: {Fraction(1): 1, -w: 0.5j}),
    "ratio": (RATIO, dict(a=0.9, c=0.2, B=0.5), "r", ["1/3", "1/2", "4/5", "3/2"], lambda w: {Fraction(1): 1, w: -0.5j}),
    "three": (THREE, dict(a=1, g=0.5, c=0.2, B=0.5), "b", ["1/3", "2/3", "3/4", "5/4"],
              lambda w: {Fraction(1): 1, w: 0.5, Fraction(1, 2): -0.5j}),
    "product": (PRODUCT, dict(a=1, c=0.2), "b", ["1/4", "1/2", "3/4"], lambda w: {1 + w: 0.5, 1 - w: 0.5}),
}  # fmt: skip


@pytest.mark.parametrize("name", SWEEPS)
def test_sweeps_of_one_frequency(name, validate):
    model, fixed, swept, at, forces = SWEEPS[name]
    at = sorted(exact(at))
    system = whirlmap.load(model, **fixed, **{swept: float(at[0])})
    ds, exact_rms = whirlmap.bifurcation_diagram(system, swept, [float(w) for w in at], lyapunov=0), []
    for k, w in enumerate(at):
        truth = Linear(fixed["c"], 1.0, forces(w), unit=fixed["a"] if swept == "r" else 1.0)
        numbers = {**fixed, swept: w}
        declared = [Fraction(1), w] if swept == "r" else exact([numbers[name] for name in "abg" if name in numbers])
        n = truth.common(declared)
        said = label(ds, k)
        fastest = max(abs(float(f)) for f in declared) * truth.unit
        T, at_times = 2 * np.pi / fastest, np.array([0.3, 1.1, 2.9])
        # A motion may repeat sooner than its forcing's declared harmonics do.
        repeats = [m for m in range(1, n + 1) if np.abs(truth.of(m * T + at_times) - truth.of(at_times)).max() < 1e-9]
        assert said in {f"{n}T", f"{repeats[0]}T"}, (float(w), said, n)
        low, high = truth.extremes()
        at_x = ds.isel({swept: k}).sel(quantity="x")
        assert abs(float(at_x["minimum"]) - low) < EXTREME * (high - low), float(w)
        assert abs(float(at_x["maximum"]) - high) < EXTREME * (high - low), float(w)
        assert float(at_x["rms"]) == pytest.approx(truth.rms, rel=2e-5), float(w)
        exact_rms.append(truth.rms)
    validate(f"forcing of several frequencies, {name}: rms over the sweep", ds["rms"].sel(quantity="x").values, exact_rms,
             tier="exact", source="superposition", rel=2e-5)  # fmt: skip


@pytest.mark.parametrize("at", [np.sqrt(2) / 2, (np.sqrt(5) - 1) / 2, 1 / np.pi])
def test_frequencies_without_a_common_period(at):
    """The motion has no frequency but the two of the forcing: locked, once."""
    ds = whirlmap.bifurcation_diagram(whirlmap.load(TWO, a=1, b=at, c=0.2, B=0.5), "b", [at])
    assert label(ds, 0) == "locked" and int(ds["period_T"][0]) == 1


@pytest.mark.parametrize(("a_", "b_", "g_"), [(2**0.5, 3**0.5, 1.0), (1.0, (5**0.5 - 1) / 2, 2**0.5 - 1)])
def test_no_two_of_three_frequencies_have_a_common_period(a_, b_, g_, tmp_path):
    """The attributes of what is computed can be written: no number of T stands for what has none."""
    system = whirlmap.load(THREE, a=a_, b=b_, g=g_, c=0.2, B=0.5)
    ds = whirlmap.bifurcation_diagram(system, "c", [0.2])
    assert label(ds, 0) == "locked" and "common_multiple" not in ds.attrs
    assert write(ds, tmp_path / "three.nc").is_file()


def test_a_sweep_through_frequencies_without_a_common_period():
    """Ten points over an interval, as anyone would type it: no rms may be that of another point."""
    at = np.linspace(0.6, 0.9, 10)
    ds = whirlmap.bifurcation_diagram(whirlmap.load(TWO, a=1, b=0.6, c=0.2, B=0.5), "b", at, lyapunov=0)
    for k, w in enumerate(at):
        size = np.sqrt(sum(abs(f / (1 - u**2 + 0.2j * u)) ** 2 for u, f in ((1.0, 1.0), (w, 0.5))) / 2)
        # The record of a torus ends within a beat.
        assert float(ds["rms"].sel(quantity="x")[k]) == pytest.approx(size, rel=1e-2)


@pytest.mark.parametrize("slow", [1 / 113, 1 / 187])
def test_extremes_hold_a_turn_of_the_slow_wheel_and_nothing_of_the_start(slow):
    system = whirlmap.load(THREE, a=1, b=1 / 37, g=slow, c=0.004, B=30)  # damped so little that 512 T forget a third
    ds = whirlmap.bifurcation_diagram(system, "B", [20.0, 30.0])
    assert [label(ds, k) for k in range(2)] == ["locked"] * 2
    for k, force in enumerate((20, 30)):
        amplitudes = [1 / 0.004, *(force / np.hypot(1 - w**2, 0.004 * w) for w in (1 / 37, slow))]
        assert ds["peak_to_peak"].values[k, 0] == pytest.approx(2 * sum(amplitudes), rel=1e-3)


def test_a_map_over_both_frequencies_and_labels_of_scattered_points():
    grid = {"a": np.array([1.0, 1.2]), "b": np.array([0.4, 0.6])}
    ds = whirlmap.regime_map(whirlmap.load(TWO, a=1, b=0.4, c=0.2, B=0.5), grid, lyapunov=0)
    for i, wa in enumerate(exact(grid["a"])):
        for j, wb in enumerate(exact(grid["b"])):
            truth = Linear(0.2, 1.0, {wa: 1, wb: -0.5j})
            assert label(ds, (i, j)) == f"{truth.common()}T"
            assert float(ds["rms"].sel(quantity="x")[i, j]) == pytest.approx(truth.rms, rel=2e-5)
    points = {"a": np.array([1.0, 1.0, 0.5]), "b": np.array([0.5, 0.75, 1.0])}
    ds = whirlmap.label_points(whirlmap.load(TWO, a=1, b=0.4, c=0.2, B=0.5), points, lyapunov=0)
    for k, (wa, wb) in enumerate(zip(exact(points["a"]), exact(points["b"]), strict=True)):
        truth = Linear(0.2, 1.0, {wa: 1, wb: -0.5j})
        assert label(ds, k) == f"{truth.common()}T"
        assert float(ds["rms"].sel(quantity="x")[k]) == pytest.approx(truth.rms, rel=2e-5)


def test_two_unbalances_that_turn_against_each_other():
    at = exact(["2/5", "1/2", "3/5"])
    system = whirlmap.load(ROTOR, a=0.8, b=0.4, c=0.2, B=1.5)
    ds = whirlmap.bifurcation_diagram(system, "b", [float(w) for w in at], lyapunov=0)
    for k, w in enumerate(at):
        truth = Linear(0.2, 1.0, {Fraction(4, 5): 0.64, w: 1.5 * float(w) ** 2})
        across = Linear(0.2, 1.0, {Fraction(4, 5): -0.64j, w: 1.5j * float(w) ** 2})
        assert label(ds, k) == f"{truth.common()}T"
        for quantity, motion in (("x", truth), ("y", across)):
            low, high = motion.extremes()
            assert float(ds["peak_to_peak"].sel(quantity=quantity)[k]) == pytest.approx(high - low, rel=EXTREME)


TONES = Pieces("x v", (), ("v", "cos(a*t) + B*cos(b*t) - c*v - x - q*x**3"), frequency="common")
#: Slower frequency -> common period over T, and a state of the orbit near which Newton's method begins, found by settling.
CUBIC_AT = {"1/2": 2, "2/3": 3, "3/5": 5}


def test_a_cubic_spring_under_two_tones():
    """Truth: settled by SciPy over common periods, then Newton's method; multipliers inside 0.4."""
    at = exact(CUBIC_AT)
    ds = whirlmap.bifurcation_diagram(whirlmap.load(CUBIC, a=1, b=0.5, c=0.4, B=0.5, q=0.3), "b",
               sorted(map(float, at)), lyapunov=0)  # fmt: skip
    for w, n in zip(at, CUBIC_AT.values(), strict=True):
        motion = TONES.at(a=1.0, b=float(w), c=0.4, B=0.5, q=0.3, common=1 / n)
        orbit = motion.attractor((0.0, 0.0), settle=12, most=1)
        assert orbit.largest < 0.4
        here = ds.sel(b=float(w))
        assert label(here) == f"{n}T"
        found = np.array([float(here[name].sel(quantity="x")) for name in ("minimum", "maximum")])
        np.testing.assert_allclose(found, [orbit.low[0], orbit.high[0]], rtol=0, atol=EXTREME * np.ptp(found))


def test_superposition_is_the_truth():
    """The closed form satisfies the equation, and its extremes those of a fine sampling."""
    truth = Linear(0.2, 1.0, {Fraction(1): 1, Fraction(2, 5): -0.5j}, mean=0.3)
    ts = np.linspace(0, 40, 400001)
    left = truth.of(ts, 2) + 0.2 * truth.of(ts, 1) + truth.of(ts)
    np.testing.assert_allclose(left, 0.3 + np.cos(ts) + 0.5 * np.sin(0.4 * ts), atol=1e-12)
    assert truth.common() == 5
    low, high = truth.extremes()
    assert low == pytest.approx(truth.of(ts).min(), abs=1e-7) and high == pytest.approx(truth.of(ts).max(), abs=1e-7)
    assert extremes_of(np.cos, 2 * np.pi, 1.0) == pytest.approx((-1, 1), abs=1e-13)
