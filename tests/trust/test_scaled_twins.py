"""The same systems in metres, micrometres and nanoseconds: the same labels, and numbers that scale.

Labels of the unscaled systems are known: Duffing's ladder, published exponents, event location (`numbers.json`), SciPy.
Where the motion is periodic, extremes over the scale agree with the unscaled run's to 1e-6 of the range, and with the
truth as in the other files.
"""

import numpy as np
import pytest
from sympy import Abs
from tests.trust import kinked_models
from tests.trust.asking import EXTREME, Refused, asked, diagram, label, some
from tests.trust.kinked_cases import BY_NAME
from tests.trust.scaled_models import ANGLE, OSCILLATOR, ROTOR, THREE, scaled, size_of
from tests.trust.test_ends_of_runs import ESCAPE, TOUCH, time_of
from tests.trust.truth_numbers import kept
from tests.trust.unforced_models import FLOWS

import whirlmap
from whirlmap.equations import Model, Parameter, Section, State, sqrt
from whirlmap.models import family

#: Scales of length and time.
SCALES = [(1e-9, 1.0), (1e-6, 1.0), (1e3, 1.0), (1.0, 1e-6), (1.0, 1e6), (1e-6, 2.5e-3), (1e-9, 1e-9), (1e3, 1e-6)]
NUMBERS = kept()


def stock(name):
    return family(name).model()


DUFFING = dict(delta=0.3, alpha=-1.0, beta=1.0, omega=1.2)
#: name -> model, powers of its states, values, start, label
SYSTEMS = {
    "duffing-1": (stock("duffing"), OSCILLATOR, dict(**DUFFING, gamma=0.2), (1.0, 0.0), "1T"),
    "duffing-2": (stock("duffing"), OSCILLATOR, dict(**DUFFING, gamma=0.28), (1.0, 0.0), "2T"),
    "duffing-5": (stock("duffing"), OSCILLATOR, dict(**DUFFING, gamma=0.37), (1.0, 0.0), "5T"),
    "duffing-chaos": (stock("duffing"), OSCILLATOR, dict(**DUFFING, gamma=0.5), (1.0, 0.0), "chaotic"),
    "pendulum-chaos": (stock("pendulum"), ANGLE, dict(q=0.5, omega=2 / 3, g=1.15), (0.0, 0.0), "chaotic"),
    "pendulum-rotates": (stock("pendulum"), ANGLE, dict(q=0.5, omega=2 / 3, g=1.4), (0.0, 0.0), "1T"),
    "van-der-pol-torus": (stock("van_der_pol"), OSCILLATOR, dict(mu=1.0, A=0.5, omega=1.387), (1.0, 0.0), "quasi-periodic"),
    "gear-4": (stock("gear_backlash"), OSCILLATOR, BY_NAME["gear-4T-Omega=1"].values, (0.249, 0.382), "4T"),
    "stop": (kinked_models.STOP["when"], OSCILLATOR, BY_NAME["stop-w=0.8"].values, (0.0, 0.1), "1T"),
    "stiff-stop": (kinked_models.STOP["when"], OSCILLATOR, BY_NAME["stiff-stop-w=0.8"].values, (0.0, 0.1), "2T"),
    "dry": (kinked_models.DRY["when"], OSCILLATOR, BY_NAME["dry-w=0.7"].values, (0.0, 0.1), "1T"),
    "rub": (kinked_models.RUB, ROTOR, BY_NAME["rub-w=0.9"].values, (0.0, 0.0, 0.0, 0.0), "1T"),
    "roessler-2": (FLOWS["roessler"][0], THREE, dict(a=0.2, b=0.2, c=3.5), (1.0, 1.0, 0.0), "2T"),
    "lorenz-chaos": (FLOWS["lorenz"][0], THREE, dict(s=10.0, b=8 / 3, r=28.0), (1.0, 1.0, 1.0), "chaotic"),
    "van-der-pol-free": (FLOWS["van_der_pol"][0], {"x": (1, 0), "v": (1, -1)}, dict(mu=1.0), (2.0, 0.0), "1T"),
}  # fmt: skip
MADE = {}


def system_of(name, length, time):
    model, powers, values, start, _ = SYSTEMS[name]
    made = MADE.setdefault((model.name, id(model)), scaled(model, powers))
    begin = {s.name: z * size_of(powers, s.name, length, time) for s, z in zip(model.states, start, strict=True)}
    scales = {"L": length, "tau": time} if any(a for a, _ in powers.values()) else {"tau": time}
    return whirlmap.load(made, **values, **scales, start=begin)


def answer(name, length, time):
    wanted = SYSTEMS[name][4]
    return asked(diagram, system_of(name, length, time), lyapunov=0 if wanted.endswith("T") else 512)


ANSWERS = {}


def unscaled(name):
    if name not in ANSWERS:
        ANSWERS[name] = answer(name, 1.0, 1.0)
    return ANSWERS[name]


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("scales", some(SCALES, SCALES[5:8:2]))
def test_label_and_extremes(name, scales):
    _, powers, _, _, wanted = SYSTEMS[name]
    one, ds = unscaled(name), answer(name, *scales)
    if isinstance(ds, Refused):
        assert ds.names_the_jump and isinstance(one, Refused)
        return
    assert label(ds, 0) == wanted
    if wanted.endswith("T"):
        for quantity in ds["quantity"].values:
            size = size_of(powers, str(quantity), *scales)
            low, high = (float(one[n].sel(quantity=quantity)[0]) for n in ("minimum", "maximum"))
            found = [float(ds[n].sel(quantity=quantity)[0]) / size for n in ("minimum", "maximum")]
            np.testing.assert_allclose(found, [low, high], rtol=0, atol=1e-6 * (high - low))


@pytest.mark.parametrize("name", ["gear-4", "stop", "stiff-stop", "dry", "rub"])
def test_the_unscaled_ones_are_right(name):
    case = {"gear-4": "gear-4T-Omega=1", "stop": "stop-w=0.8", "stiff-stop": "stiff-stop-w=0.8", "dry": "dry-w=0.7",
            "rub": "rub-w=0.9"}[name]  # fmt: skip
    ds, truth = unscaled(name), NUMBERS[case]
    assert label(ds, 0) == SYSTEMS[name][4]
    found = np.array([ds[n].values[0, : len(truth["low"])] for n in ("minimum", "maximum")])
    np.testing.assert_allclose(found, [truth["low"], truth["high"]], rtol=0,
                               atol=EXTREME * np.subtract(truth["high"], truth["low"]).max())  # fmt: skip


@pytest.mark.parametrize("name", some(["duffing-1", "gear-4", "van-der-pol-free", "roessler-2"], ["duffing-1"]))
@pytest.mark.parametrize("scales", some([(1e-9, 1.0), (1e-6, 2.5e-3), (1e3, 1e6)], [(1e-9, 1.0)]))
def test_diagnosis(name, scales):
    """The perturbed ensemble stays on one attractor at any scale; exponents count per unit of the model's time."""
    wanted = SYSTEMS[name][4]
    one, ds = whirlmap.diagnose(system_of(name, 1.0, 1.0)), whirlmap.diagnose(system_of(name, *scales))
    assert label(one) == label(ds) == wanted
    value, error = ds["lyapunov"].values * scales[1], ds["lyapunov_error"].values * scales[1]
    allowed = 3 * np.hypot(error, one["lyapunov_error"].values) + 1e-4
    np.testing.assert_array_less(np.abs(value - one["lyapunov"].values), allowed)


@pytest.mark.parametrize("length", [1e-9, 1e-6, 1e3])
def test_attractors(length):
    """Two orbits of Duffing's oscillator share the plane, whatever its unit."""
    box = {"x": (-2 * length, 2 * length), "v": (-2 * length, 2 * length)}
    ds = whirlmap.attractors(system_of("duffing-1", length, 1.0), starts=64, box=box, lyapunov=256)
    assert ds["period_T"].values.tolist() == [1, 1] and int(ds["starts"].sum()) == 64
    np.testing.assert_allclose(ds["mean"].sel(quantity="x").values.sum() / length, 0, atol=1e-4)


@pytest.mark.parametrize("length", [1e-9, 1e-6, 1.0, 1e3])
def test_an_escape(length):
    """Divergence is seen at its time, whatever the unit of length."""
    values = dict(A=0.5, d=0.1, w=0.8)
    at = time_of(ESCAPE, values, (0.0, 0.0), 1e5)
    made = MADE.setdefault("escape", scaled(ESCAPE, OSCILLATOR))
    ds = diagram(whirlmap.load(made, **values, L=length, tau=1.0))
    assert label(ds, 0) in ("diverged", "unresolved")
    assert float(ds["end_time"][0]) == pytest.approx(at, abs=0.05 * 2 * np.pi / 0.8)


@pytest.mark.parametrize("scales", [(1e-9, 1.0), (1.0, 1.0), (1e3, 1e-6), (1e-6, 2.5e-3)], ids=str)
def test_a_contact(scales):
    values = dict(A=0.05, d=0.1, w=3.0)
    at = time_of(TOUCH, values, (0.01, 0.0), 1.0)
    made = MADE.setdefault("touch", scaled(TOUCH, OSCILLATOR))
    ds = diagram(whirlmap.load(made, **values, L=scales[0], tau=scales[1], start={"x": 0.01 * scales[0]}))
    assert label(ds, 0) == "contact"
    assert float(ds["end_time"][0]) == pytest.approx(at * scales[1], rel=1e-6)


# --- small motions -------------------------------------------------------------------------------------------------------

y, v = State("y", "m", "displacement"), State("v", "m/s", "velocity")
K, C, m, W, g = (Parameter(n, "1", n) for n in ["K", "C", "m", "W", "g"])
_d = (y + Abs(y)) / 2
HERTZ = Model(name="hertz_contact", states=(y, v), parameters=(K, C, m, W), start="equilibrium", swing=(y,),
              typical_time=2 * 3.14 * sqrt(m / K), section=Section(v, "rising"),
              equations={y: v, v: (W - C * v - K * _d * sqrt(_d + 1e-300)) / m})  # fmt: skip
MAGNET = Model(name="magnet", states=(y, v), parameters=(K, C, m, W, g), start="equilibrium", swing=(y,),
               typical_time=6 * sqrt(m / K), section=Section(v, "rising"),
               equations={y: v, v: (W / (1 - y / g) ** 2 - C * v - K * y) / m})  # fmt: skip
CUBIC = Model(name="cubic_sag", states=(y, v), parameters=(K, C, m, W, g), start="equilibrium", swing=(y,),
              typical_time=6 * sqrt(m / K), section=Section(v, "rising"),
              equations={y: v, v: (W - C * v - K * y * (1 + (y / g) ** 2)) / m})  # fmt: skip


def pair(stiffness, damping, mass):
    return np.roots([mass, damping, stiffness])


@pytest.mark.parametrize(("W_", "K_"), [(100.0, 8.3687e9), (1.0, 8.3687e9), (1e4, 1e11), (1e-3, 1e6)])
def test_hertz_contact(W_, K_):
    """Stiffness 1.5 K sqrt(delta) at delta = (W/K)^(2/3), from nanometres to micrometres."""
    found = whirlmap.linear_analysis(whirlmap.load(HERTZ, K=K_, C=20.0, m=0.6, W=W_))
    delta = (W_ / K_) ** (2 / 3)
    assert found.equilibrium[0] == pytest.approx(delta, rel=1e-8)
    exact = pair(1.5 * K_ * np.sqrt(delta), 20.0, 0.6)
    np.testing.assert_allclose(np.sort_complex(found.eigenvalues), np.sort_complex(exact), rtol=1e-6)


@pytest.mark.parametrize("gap", [1e-9, 2e-6, 1e-3, 1.0, 1e4])
def test_a_magnet_over_a_gap(gap):
    """W/K = 0.1 gap: the sag solves u (1 - u)^2 = 0.1; stiffness K (1 - 2 u/(1 - u))."""
    u = np.sort(np.roots([1, -2, 1, -0.1]).real)[0]
    found = whirlmap.linear_analysis(whirlmap.load(MAGNET, K=1e4, C=2.0, m=0.5, W=1e3 * gap, g=gap))
    assert found.equilibrium[0] == pytest.approx(u * gap, rel=1e-8)
    exact = pair(1e4 * (1 - 2 * u / (1 - u)), 2.0, 0.5)
    np.testing.assert_allclose(np.sort_complex(found.eigenvalues), np.sort_complex(exact), rtol=1e-6)


@pytest.mark.parametrize("gap", [1e-9, 1e-6, 1.0, 1e6])
@pytest.mark.parametrize("stiff", [1e-6, 1e9])
def test_a_sag_on_a_cubic_spring(gap, stiff):
    """W/K = 2 gap: u + u^3 = 2, so that u = 1; stiffness 4 K."""
    found = whirlmap.linear_analysis(whirlmap.load(CUBIC, K=stiff, C=0.2 * np.sqrt(stiff), m=1.0, W=2 * gap * stiff, g=gap))
    assert found.equilibrium[0] == pytest.approx(gap, rel=1e-8)
    exact = pair(4 * stiff, 0.2 * np.sqrt(stiff), 1.0)
    np.testing.assert_allclose(np.sort_complex(found.eigenvalues), np.sort_complex(exact), rtol=1e-6)
