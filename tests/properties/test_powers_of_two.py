"""Units that differ by powers of two change no bit: nothing in the way from the equations to a label has a scale of its own.

The models carry their units in their parameters, so that one kernel serves all of them: what differs is data alone.
"""

import numpy as np
import pytest

from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.analysis.steady.settling import Settling
from whirlmap.analysis.variational.floquet import floquet_multipliers
from whirlmap.analysis.variational.lyapunov import lyapunov_spectrum
from whirlmap.equations import Model, Parameter, Section, State, cos, t
from whirlmap.integrate.system import System
from whirlmap.results.regime import Regime
from whirlmap.sweep.points.label_points import label_points

x, v = State("x", "1", "x", start=1.0), State("v", "1", "v")
y, z = State("y", "1", "y", start=1.0), State("z", "1", "z")
alpha, beta, delta, gamma = (Parameter(n, "1", n) for n in ("alpha", "beta", "delta", "gamma"))
omega, loop = Parameter("omega", "1", "omega", above=0), Parameter("loop", "1", "time of a loop", above=0)
a, b, c, rate, fold = (Parameter(n, "1", n) for n in ("a", "b", "c", "rate", "fold"))
DUFFING = Model(
    "duffing-units", (x, v), (delta, alpha, beta, gamma, omega),
    {x: v, v: gamma * cos(omega * t) - delta * v - alpha * x - beta * x**3}, harmonics=(omega,), swing=(x,),
)  # fmt: skip
ROESSLER = Model(
    "roessler-units", (x, y, z), (a, b, c, rate, fold, loop),
    {x: -rate * (y + z), y: rate * x + a * y, z: b + fold * z * (x - c)}, section=Section(x, "rising"), typical_time=loop,
    swing=(x,),
)  # fmt: skip
UNITS = [(2.0**-20, 1.0), (1.0, 2.0**12), (2.0**10, 2.0**-16)]


def duffing(length, time):
    values = {
        "delta": 0.3 / time, "alpha": -1 / time**2, "beta": 1 / (length * time) ** 2, "gamma": 0.37 * length / time**2,
        "omega": 1.2 / time,
    }  # fmt: skip
    system = System(DUFFING, values, {"x": length})
    return system, {"gamma": np.linspace(0.2, 0.65, 12) * length / time**2}, np.array([length, length / time])


def roessler(length, time):
    values = {
        "a": 0.2 / time, "b": 0.2 * length / time, "c": 4.0 * length, "rate": 1 / time, "fold": 1 / (length * time),
        "loop": 5.9 * time,
    }  # fmt: skip
    system = System(ROESSLER, values, {"x": length, "y": length, "z": 0.0})
    return system, {"c": np.linspace(2.5, 6.0, 12) * length}, np.full(3, length)


def labelled(made, length, time):
    system, values, size = made(length, time)
    settling = Settling(transient=100) if system.model.forced else Settling(transient=50, most=16)
    ds = label_points(system, values, settling=settling, lyapunov=256)
    counted = ("regime", "period_T", "settled_after", "steps", "step_error", "confidence", "winding")
    found = {n: ds[n].values for n in counted}
    found |= {n: ds[n].values * time for n in ("lyapunov", "lyapunov_error")}
    found |= {n: ds[n].values[:, : size.size] / size for n in ("minimum", "maximum", "mean", "rms")}
    return found


@pytest.mark.parametrize("made", [duffing, roessler])
def test_labels_and_numbers_are_the_same_to_the_bit(made):
    ours = labelled(made, 1.0, 1.0)
    assert {Regime.periodic, Regime.chaotic} <= set(ours["regime"])
    for length, time in UNITS:
        theirs = labelled(made, length, time)
        for name, values in ours.items():
            np.testing.assert_array_equal(theirs[name], values, err_msg=f"{name} with {length}, {time}")


def test_spectra_are_the_same_to_the_bit():
    ours, _, _ = duffing(1.0, 1.0)
    one = lyapunov_spectrum(ours, transient=50, common_periods=100, starts=2)
    for length, time in UNITS:
        other = lyapunov_spectrum(duffing(length, time)[0], transient=50, common_periods=100, starts=2)
        for name in ("lyapunov", "lyapunov_error"):
            np.testing.assert_array_equal(other[name].values * time, one[name].values)


@pytest.mark.parametrize("time", [1.0, 2.0**-30, 2.0**26])
def test_multipliers_are_those_of_any_unit(time):
    """They multiply to exp(-delta T); in nanoseconds they came out as 2.6 and 0.08, with an error of 5e-12."""
    system, values, _ = duffing(1.0, time)
    system = system.replace(gamma=values["gamma"][0])
    ensemble, _ = make_ensemble(system, {"gamma": values["gamma"][:1]})
    ensemble.advance(200)
    found = floquet_multipliers(system, ensemble.x[:, 0], system.period)
    truth = -0.3 * 2 * np.pi / 1.2 / 2  # of each modulus: the pair is complex
    np.testing.assert_allclose(found["log_modulus"].values, truth, atol=1e-12)
    assert (found["log_modulus_error"].values <= 1e-11).all()
