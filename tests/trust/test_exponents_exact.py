"""Exponents known exactly, or from SciPy: constant and periodic linear systems, slaved states, cycles, chaos, torus, jumps.

A value may differ from the truth by three of its errors and a rounding, and an error may not be large beyond need: both
make a claim false. Sums are the mean of the divergence (Liouville), known even where the motion is chaotic.
"""

from functools import partial

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from tests.trust.asking import Refused, asked, label, load, some
from tests.trust.kinked_cases import BY_NAME
from tests.trust.truth_cycles import Flow
from tests.trust.truth_numbers import kept
from tests.trust.truth_orbits import Pieces
from tests.trust.unforced_models import FLOWS

import whirlmap
from whirlmap.equations import Model, Parameter, State, cos, sign, sin, states, t

x, v = State("x", "1", "displacement", start=1.0), State("v", "1", "velocity")
p, q, r, s = states("p q r s", "1", "states")
a, b, c, d, k, w, A = (Parameter(n, "1", n) for n in ["a", "b", "c", "d", "k", "w", "A"])
T = 2 * np.pi

DIAGONAL = Model(name="diagonal", states=(p, q, r), parameters=(a, b, c, w), harmonics=(w,),
                 equations={p: -a * p + cos(w * t), q: -b * q + sin(w * t), r: -c * r + p + q})  # fmt: skip
SHEARED = Model(name="sheared", states=(p, q), parameters=(a, b, k, w), harmonics=(w,),
                equations={p: -a * p + k * q, q: -b * q + cos(w * t)})  # fmt: skip
BREATHING = Model(name="breathing", states=(p, q), parameters=(a, b, k, w), harmonics=(w,),
                  equations={p: -a * (1 + k * cos(w * t)) * p + sin(w * t),
                             q: -b * (1 + k * sin(w * t)) * q + p})  # fmt: skip
OSCILLATOR = Model(name="damped_oscillator", states=(x, v), parameters=(d, w), harmonics=(w,),
                   equations={x: v, v: cos(w * t) - d * v - x})  # fmt: skip
TWO_MASSES = Model(name="two_oscillators", states=(p, q, r, s), parameters=(d, k, w), harmonics=(w,),
                   equations={p: q, q: cos(w * t) - d * q - p, r: s, s: p - 5 * d * s - k * r})  # fmt: skip
HILL = Model(name="hill_forced", states=(x, v), parameters=(a, b, d, w), harmonics=(w,),
             equations={x: v, v: cos(w * t) - d * v - (a + b * cos(w * t)) * x})  # fmt: skip
MEISSNER = Model(name="meissner_forced", states=(x, v), parameters=(a, b, d, w), harmonics=(w,),
                 equations={x: v, v: cos(w * t) - d * v - (a + b * sign(cos(w * t))) * x})  # fmt: skip


def spectrum(system, **options):
    """Exponents and errors by `lyapunov_spectrum`, or the refusal."""
    ds = asked(whirlmap.lyapunov_spectrum, system, **options)
    return ds if isinstance(ds, Refused) else (ds["lyapunov"].values, ds["lyapunov_error"].values)


def agree(found, exact, *, period=T, error_below=1e-3, floor=1e-7, record=None):
    """Within three errors and a rounding, with errors that are worth having (over one period).

    ``record`` is the fixture `validate` with what it says of the row.
    """
    value, error = found
    exact = np.sort(np.asarray(exact, dtype=float))[::-1]
    assert np.all(np.isfinite(value)) and np.all(error >= 0)
    off, allowed = np.abs(value - exact), 3 * error + floor * (np.abs(exact) + 1 / period)
    if record is not None:
        record(value, exact, within=allowed)
    assert np.all(off <= allowed), (value, error, exact)
    assert np.all(error <= error_below * (np.abs(exact) + 1 / period)), (error, exact)


LINEAR = {  # name -> model, values, exact exponents
    "mild": (DIAGONAL, dict(a=0.05, b=0.5, c=2.0, w=1), [-0.05, -0.5, -2]),
    "fast": (DIAGONAL, dict(a=0.05, b=2.0, c=80.0, w=1), [-0.05, -2, -80]),
    "faster": (DIAGONAL, dict(a=0.3, b=40.0, c=200.0, w=2.0), [-0.3, -40, -200]),
    "equal": (DIAGONAL, dict(a=0.4, b=0.4001, c=9.0, w=1), [-0.4, -0.4001, -9]),
    "sheared": (SHEARED, dict(a=1.0, b=2.0, k=100.0, w=1), [-1, -2]),
    "sheared-fast": (SHEARED, dict(a=0.1, b=60.0, k=30.0, w=1), [-0.1, -60]),
    "breathing": (BREATHING, dict(a=0.3, b=1.0, k=0.9, w=1), [-0.3, -1]),
    "breathing-fast": (BREATHING, dict(a=0.3, b=20.0, k=3.0, w=1), [-0.3, -20]),
    "oscillator": (OSCILLATOR, dict(d=0.2, w=0.7), [-0.1, -0.1]),
    "overdamped": (OSCILLATOR, dict(d=20.0, w=0.7), (-10 + np.array([1, -1]) * np.sqrt(99)).tolist()),
    "two-masses": (TWO_MASSES, dict(d=0.2, k=3.0, w=0.7), [-0.1, -0.1, -0.5, -0.5]),
}  # fmt: skip


@pytest.mark.parametrize("name", LINEAR)
def test_linear_systems(name, validate):
    model, values, exact = LINEAR[name]
    found = spectrum(whirlmap.load(model, **values))
    # Directions a distance of 1e-4 apart in rate do not part within the run: theirs mix, the sum stays.
    floor = 5e-4 if name == "equal" else 1e-7
    shown = ", ".join(f"{key} {number:g}" for key, number in values.items())
    record = partial(validate, f"{model.name}, {shown}: Lyapunov exponents", tier="exact", source="closed form")
    # Pairs of complex multipliers turn.
    agree(found, exact, period=T / values["w"], error_below=2e-2, floor=floor, record=record)


@pytest.mark.parametrize("name", some(["mild", "fast", "sheared-fast", "breathing-fast", "overdamped"], ["fast"]))
def test_linear_systems_diagnosed(name):
    model, values, exact = LINEAR[name]
    ds = whirlmap.diagnose(whirlmap.load(model, **values))
    assert label(ds) == "1T" and float(ds["confidence"]) > 0.9
    agree((ds["lyapunov"].values, ds["lyapunov_error"].values), exact, period=T / values["w"], error_below=2e-2)


@pytest.mark.parametrize(("b_", "w_"), [(0.3, 0.9), (0.6, 1.4)])
def test_hills_equation(b_, w_, validate):
    """The monodromy matrix by SciPy."""
    def rates(time, m):
        return (np.array([[0, 1], [-(1 + b_ * np.cos(w_ * time)), -0.3]]) @ m.reshape(2, 2)).ravel()

    m = solve_ivp(rates, (0, T / w_), np.eye(2).ravel(), method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1].reshape(2, 2)
    exact = np.log(np.abs(np.linalg.eigvals(m))) / (T / w_)
    record = partial(validate, f"Hill's equation, b {b_:g}, w {w_:g}: Lyapunov exponents", tier="independent",
                     source="monodromy matrix by SciPy, DOP853")  # fmt: skip
    agree(spectrum(whirlmap.load(HILL, a=1, b=b_, d=0.3, w=w_)), exact, period=T / w_, error_below=3e-2, record=record)


@pytest.mark.parametrize(("b_", "w_"), [(0.3, 0.9), (0.6, 2.0)])
def test_meissners_equation(b_, w_, validate):
    """Stiffness switched by time: products of exponentials; no saltation, for the surface does not meet the state."""
    def flow(stiffness, time):
        return expm(np.array([[0, 1], [-stiffness, -0.5]]) * time)

    m = flow(1 + b_, T / w_ / 4) @ flow(1 - b_, T / w_ / 2) @ flow(1 + b_, T / w_ / 4)
    exact = np.log(np.abs(np.linalg.eigvals(m))) / (T / w_)
    assert exact.max() < 0
    found = spectrum(whirlmap.load(MEISSNER, a=1, b=b_, d=0.5, w=w_))
    if isinstance(found, Refused):
        assert found.names_the_jump
    else:
        record = partial(validate, f"Meissner's equation, b {b_:g}, w {w_:g}: Lyapunov exponents", tier="exact",
                         source="products of matrix exponentials")  # fmt: skip
        agree(found, exact, period=T / w_, error_below=3e-2, record=record)


# --- chaos, torus and cycles, with slaved states of known rate -------------------------------------------------------

SLAVED = Model(name="slaved_duffing", states=(x, v, r), parameters=(A, k), harmonics=(1.2,),
               equations={x: v, v: A * cos(1.2 * t) - 0.3 * v + x - x**3, r: -k * (r - x)})  # fmt: skip


@pytest.mark.parametrize("k_", some([0.02, 8.0, 60.0], [60.0]))
def test_a_slaved_state_of_a_chaotic_motion(k_, validate):
    """-k exactly, beside the two exponents of Duffing's oscillator, whose sum is -0.3."""
    value, error = spectrum(whirlmap.load(SLAVED, A=0.5, k=k_), common_periods=1600)
    assert np.abs(value + k_).min() < 1e-6 * (k_ + 1)
    at = int(np.argmin(np.abs(value + k_)))
    rest, errors = np.delete(value, at), np.delete(error, at)
    validate("Duffing, chaotic: sum of the exponents", rest.sum(), -0.3, tier="invariant", source="mean divergence",
             within=1e-6)  # fmt: skip
    assert rest[0] == pytest.approx(0.1057, abs=3 * errors[0] + 0.002)
    assert np.all(errors < 0.01)


@pytest.mark.parametrize("periods", some([400, 1600], [400]))
def test_lorenz(periods, validate):
    """0.9056, 0 and -14.572, of sum -41/3 exactly."""
    model = FLOWS["lorenz"][0]
    system = whirlmap.load(model, s=10, b=8 / 3, r=28, start={"x": 1, "y": 1, "z": 1})
    value, error = spectrum(system, common_periods=periods)
    validate(f"Lorenz: exponents over {periods} turns", value, [0.9056, 0, -14.5723], tier="published",
             source="Sprott, common chaotic systems", within=3 * error + 2e-4)  # fmt: skip
    validate(f"Lorenz: sum of the exponents over {periods} turns", value.sum(), -41 / 3, tier="invariant",
             source="mean divergence", within=1e-5)  # fmt: skip
    assert error[0] < 0.02


#: Mean of the divergence of the forced van der Pol oscillator over 10 000 units of time, by SciPy.
TORUS = -1.0307513


def mean_divergence():
    mu, A_, w_ = 1.0, 0.5, 1.387
    made = solve_ivp(lambda s, z: [z[1], mu * (1 - z[0] ** 2) * z[1] - z[0] + A_ * np.cos(w_ * s), mu * (1 - z[0] ** 2)],
                     (0, 12000), [1.0, 0.0, 0.0], method="DOP853", rtol=1e-9, atol=1e-10, t_eval=[2000, 12000])  # fmt: skip
    return (made.y[2, 1] - made.y[2, 0]) / 10000


@pytest.mark.slow
def test_the_mean_divergence_comes_out_again():
    assert mean_divergence() == pytest.approx(TORUS, abs=1e-5)


@pytest.mark.slow
def test_a_torus():
    """Forced van der Pol: the largest exponent is zero; the sum is the mean of mu (1 - x^2)."""
    system = whirlmap.load("van_der_pol", mu=1.0, A=0.5, omega=1.387)
    value, error = spectrum(system, common_periods=1600)
    assert abs(value[0]) < 3 * error[0] + 1e-6
    assert value.sum() == pytest.approx(TORUS, abs=3 * np.hypot(*error) + 3e-4)
    ds = whirlmap.diagnose(system)
    assert label(ds) == "quasi-periodic"
    assert abs(float(ds["lyapunov"][0])) < 3 * float(ds["lyapunov_error"][0]) + 1e-6


def test_an_undamped_oscillator_has_two_zeros():
    """No sign from rounding, nor from a strobe in step with the orbit."""
    value, error = spectrum(whirlmap.load(OSCILLATOR, d=0, w=0.6180339887))
    assert np.all(np.abs(value) < 3 * error + 1e-9)


FREE = {  # name -> values, start, time to settle, typical time of the model, exponents (None: from the cycle by SciPy)
    "hopf": (dict(m=1.0, w=3.0), (0.5, 0.0), None, [0, -2]),
    "hopf-weak": (dict(m=0.01, w=3.0), (0.1, 0.0), None, [0, -0.02]),
    "slaved_hopf": (dict(w=3.0, k=200.0), (0.5, 0.0, 0.0), None, [0, -2, -200]),
    "van_der_pol": (dict(mu=1.0), (2.0, 0.0), 150.0, None),
    "van_der_pol-stiff": (dict(mu=5.0), (2.0, 0.0), 200.0, None),
    "fitzhugh_nagumo": (dict(e=0.08, a=0.7, b=0.8, I=0.5), (0.0, 0.0), 600.0, None),
    "brusselator": (dict(a=1.0, b=3.0), (1.2, 1.0), 200.0, None),
    "predator_prey": (dict(r=1.0, k=3.0, a=1.0, m=0.3), (1.0, 1.0), 800.0, None),
}


@pytest.mark.parametrize("name", some(FREE, ["hopf", "van_der_pol-stiff", "predator_prey"]))
def test_cycles_have_one_zero(name, validate):
    values, start, time, exact = FREE[name]
    tier, source = ("exact", "closed form") if exact else ("independent", "cycle by SciPy, mean divergence along it")
    model, names, rates, cut = FLOWS["hopf" if name == "hopf-weak" else name.removesuffix("-stiff")]
    if exact is None:
        cycle = Flow(names, rates, cut, **values).cycle(start, time)
        exact = [0.0, cycle.divergence]
    system = whirlmap.load(model, **values, start=dict(zip(names.split(), start, strict=True)))
    value, error = spectrum(system)
    validate(f"{name}, cycle: Lyapunov exponents", value, exact, tier=tier, source=source, within=3 * error + 1e-5)
    assert error[0] < 0.02 and abs(value[0]) <= 3 * error[0] + 1e-6
    ds = whirlmap.diagnose(system)
    assert label(ds) == "1T"
    value, error = ds["lyapunov"].values, ds["lyapunov_error"].values
    assert np.all(np.abs(value - exact) <= 3 * error + 1e-5), (value, error, exact)


# --- jumps: saltation ------------------------------------------------------------------------------------------------

NUMBERS = kept()
JUMPING = ["dry-w=0.7", "uneven-w=0.7", "pendulum-A=0.5", "relay-w=1", "preloaded-w=0.9", "damped-wall-w=0.6",
           "contact-friction-w=0.8", "square-wave-w=1.8", "friction-damper-w=1"]  # fmt: skip


@pytest.mark.parametrize("name", JUMPING)
def test_periodic_motions_across_jumps(name):
    """Refused, or those of the saltation matrices of `truth_orbits`."""
    case, truth = BY_NAME[name], NUMBERS[name]
    found = spectrum(load(case.models[0], case.values, truth["z"]))
    if isinstance(found, Refused):
        assert found.names_the_jump
        return
    exact = np.log(np.hypot(truth["real"], truth["imaginary"])) / (truth["n"] * case.period)
    agree(found, exact, period=case.period, error_below=5e-2, floor=1e-6)


CHAOS_ACROSS_JUMPS = ["chaos-pendulum", "chaos-stop", "chaos-belt"]


@pytest.mark.slow
@pytest.mark.parametrize("name", CHAOS_ACROSS_JUMPS)
def test_chaos_across_kinks_and_jumps(name):
    case, truth = BY_NAME[name], NUMBERS[name]
    found = spectrum(load(case.models[0], case.values, case.start), count=1, common_periods=1600)
    if isinstance(found, Refused):
        assert case.jumps and found.names_the_jump
        return
    assert found[0][0] == pytest.approx(truth["exponents"][0], abs=3 * np.hypot(found[1][0], truth["errors"][0]) + 2e-3)


def test_duffings_multipliers():
    """One orbit each by Newton's method on SciPy's map; the sum of exponents is -delta."""
    duffing = Pieces("x v", (), ("v", "gamma*cos(omega*t) - delta*v - alpha*x - beta*x**3"), frequency="omega")
    values = dict(alpha=1.0, beta=4.0, delta=0.1, gamma=2.5, omega=2.0)
    system = whirlmap.load("duffing", **values, start={"x": 2.0, "v": 0.0})
    ds = whirlmap.diagnose(system)
    n = int(ds["period_T"])
    orbit = duffing.at(**values).described(whirlmap.section(system, transient=600, points=n)["section"].values[0, 0], n)
    agree((ds["lyapunov"].values, ds["lyapunov_error"].values), orbit.exponents, period=np.pi, error_below=5e-2, floor=1e-6)
    found = whirlmap.floquet_multipliers(system, orbit.z, n * np.pi)
    value = found["real"].values + 1j * found["imaginary"].values
    for one in orbit.multipliers:
        assert np.abs(value - one).min() < 1e-8
