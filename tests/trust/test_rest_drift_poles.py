"""Motions that come to rest, drift, grow, or run into a pole of their equations: closed forms and SciPy.

At rest, drifting and growing are regimes of their own. Truths: equilibria of the equations and their eigenvalues, closed
forms of linear drifts, Floquet multipliers of Hill's equations by SciPy and (Meissner) by products of exponentials, and the
time at which SciPy's solution reaches the pole.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.trust.asking import Refused, asked, diagram, label

import whirlmap
from whirlmap.equations import Model, Parameter, Section, State, cos, sign, sin, t, when
from whirlmap.results.status import Status

x, v = State("x", "1", "displacement", start=1.0), State("v", "1", "velocity")
y, z = State("y", "1", "y", start=1.0), State("z", "1", "z", start=1.0)
q = State("q", "1", "angle", start=0.1)
a, b, c, d, A, k, w, mu, r = (Parameter(n, "1", n) for n in ["a", "b", "c", "d", "A", "k", "w", "mu", "r"])


def forced(name, force, *used, at=x):
    return Model(name=name, states=(at, v), parameters=(*used, w), equations={at: v, v: force}, harmonics=(w,), swing=(at,))


def free(name, rates, *used, section=v, typical=6.28):
    return Model(name=name, states=tuple(rates), parameters=used, equations=rates, section=Section(section, "falling"),
                 typical_time=typical, swing=(next(iter(rates)),))  # fmt: skip


SPRING = free("spring", {x: v, v: -c * v - k * (x - a)}, a, c, k)
TWO_WELLS = free("two_wells", {x: v, v: -c * v + x - x**3}, c)
HANGING = free("hanging", {q: v, v: -c * v - sin(q)}, c)
QUIET = free("quiet_van_der_pol", {x: v, v: mu * (1 - x**2) * v - x}, mu)
LORENZ = free("lorenz_at_rest", {x: 10 * (y - x), y: x * (r - z) - y, z: x * y - 8 * z / 3}, r, section=z - 5, typical=0.7)
UNHEARD = forced("unheard", A * cos(w * t) - c * v - x, A, c)
HILL = forced("hill", -c * v - (a - 2 * b * cos(w * t)) * x, a, b, c)
MEISSNER = forced("free_meissner", -c * v - (a + b * sign(cos(w * t))) * x, a, b, c)
STUCK = forced("stuck", A * cos(w * t) - x - k * sign(v), A, k)

REST = {  # name -> model, values, start, where it rests
    "spring": (SPRING, dict(a=0, c=0.1, k=1), dict(x=1), (0.0, 0.0)),
    "spring-far-away": (SPRING, dict(a=1000, c=0.1, k=1), dict(x=1500), (1000.0, 0.0)),
    "spring-slow": (SPRING, dict(a=2, c=0.02, k=1), dict(x=1), (2.0, 0.0)),
    "spring-overdamped": (SPRING, dict(a=2, c=8, k=1), dict(x=1), (2.0, 0.0)),
    "two-wells": (TWO_WELLS, dict(c=0.25), dict(x=0.2), (1.0, 0.0)),
    "pendulum": (HANGING, dict(c=0.2), dict(q=2.0), (0.0, 0.0)),
    "van-der-pol": (QUIET, dict(mu=-0.2), dict(x=1.0), (0.0, 0.0)),
    "lorenz-origin": (LORENZ, dict(r=0.5), {}, (0.0, 0.0, 0.0)),
    "lorenz-focus": (LORENZ, dict(r=10.0), {}, (24**0.5, 24**0.5, 9.0)),
    "no-force": (UNHEARD, dict(A=0, c=0.1, w=1.3), {}, (0.0, 0.0)),
    "hill-below": (HILL, dict(a=1, b=0.18, c=0.2, w=2), {}, (0.0, 0.0)),
    "hill-detuned": (HILL, dict(a=1.3, b=0.2, c=0.2, w=2), {}, (0.0, 0.0)),
    "meissner-below": (MEISSNER, dict(a=1, b=0.1, c=0.2, w=2), {}, (0.0, 0.0)),
}  # fmt: skip


@pytest.mark.parametrize("name", REST)
def test_at_rest(name):
    model, values, start, where = REST[name]
    system = whirlmap.load(model, start=start, **values)
    assert label(diagram(system), 0) in ("at-rest", "undecided")  # without an exponent it may stay open
    ds = diagram(system, lyapunov=512)
    assert label(ds, 0) == "at-rest"
    mean = ds["mean"].values[0, : len(where)]
    np.testing.assert_allclose(mean, where, rtol=0, atol=1e-4 * max(1.0, np.abs(where).max()))
    found = asked(whirlmap.diagnose, system)
    if isinstance(found, Refused):
        assert model is MEISSNER and found.names_the_jump
    else:
        assert label(found) == "at-rest"


@pytest.mark.parametrize(("values", "start"), [
    (dict(A=0.4, k=1.0, w=0.9), (3.0, 0.0)), (dict(A=1, k=1.8, w=0.8), (0.0, 0.1)),
    pytest.param(dict(A=1, k=1.8, w=0.5), (0.0, 0.0), marks=pytest.mark.slow),
    (dict(A=1e-9, k=1.8e-9, w=2.3), (0.0, 1e-10)), (dict(A=0, k=1.8, w=0.8), (0.0, 0.0)),
])  # fmt: skip
def test_stuck_by_dry_friction(values, start):
    """|A| < F: wherever it stops between -(F - A) and F - A, it stays, near x = 0 too, where rounding of x is small."""
    system = whirlmap.load(STUCK, start=dict(zip("xv", start, strict=True)), **values)
    room = values["k"] - values["A"]
    for ds in (diagram(system), diagram(system, lyapunov=512)):
        assert label(ds, 0) == "at-rest" and float(ds["growth_rate"][0]) == 0.0
        assert -room <= float(ds["mean"].sel(quantity="x")[0]) <= room
    if values["A"]:
        assert label(whirlmap.diagnose(system)) == "at-rest"


X1, X2, V1, V2 = (State(n, "1", n) for n in ("x1", "x2", "v1", "v2"))
BESIDE = Model(
    name="stuck_beside", states=(X1, X2, V1, V2), parameters=(A, c, k, r, w), harmonics=(w,), swing=(X1,),
    equations={X1: V1, X2: V2, V1: A * cos(w * t) - c * V1 - X1 - r * (X1 - X2), V2: r * (X1 - X2) - X2 - k * sign(V2)},
)  # fmt: skip


@pytest.mark.parametrize("start", [(0.0, 0.0, 0.1, 0.0), (0.0, 0.3, 0.1, 0.1)])
def test_a_body_that_sticks_in_a_machine_that_moves(start):
    """The other one swings about it, as the linear oscillator that it is: 1T, with the multiplier 1 of the one held."""
    values = dict(A=1.0, c=0.2, k=3.0, r=0.3, w=1.1)
    system = whirlmap.load(BESIDE, start=dict(zip(("x1", "x2", "v1", "v2"), start, strict=True)), **values)
    ds = diagram(system)
    assert label(ds, 0) == "1T"
    range_of = (ds["maximum"] - ds["minimum"]).sel(quantity=["x1", "x2"]).values[0]
    exact = 2 / abs(1 + values["r"] - values["w"] ** 2 + 1j * values["c"] * values["w"])
    assert range_of[0] == pytest.approx(exact, rel=1e-5) and range_of[1] < 1e-15
    found = whirlmap.diagnose(system)
    assert label(found) == "1T" and '"vote": "neutral"' in found.attrs["indicators"]


ONE = free("one_state", {x: -k * (x - a)}, a, k, section=x + 9, typical=1.0)
CHAIN = free("chain", {x: -k * x + 1, y: k * (x - y), z: k * (y - z) / 2}, k, section=z - 99)
FOUR = free("four", {x: k * (y - x), y: 2 * k * (z - y), z: 3 * k * (q - z), q: k * (a - q) / 2}, a, k, section=x + 9)

NODES = {  # name -> model, values, start of x, rate
    **{f"one-{k:g}-{a:g}-{start:g}": (ONE, dict(k=k, a=a), start, -k)
       for k, a, start in [(1, 2, 5), (1, 2, -3), (1, 0, 1), (1, 2, 2), (100, 2, 5), (100, 2, 2), (0.01, 2, 5),
                           (1e-3, 1e3, 1001), (1e-4, 2, 5), (1e-4, 1e3, 1001), (1e-6, 0, 1)]},
    "two": (SPRING, dict(a=2, c=8, k=1), 5, -4 + 15**0.5),
    "two-slow": (SPRING, dict(a=2, c=1e3, k=1), 5, -500 + 249999**0.5),
    "two-equal": (SPRING, dict(a=2, c=2, k=1), 5, -1.0),
    "three": (CHAIN, dict(k=0.3), 3, -0.15),
    "three-slow": (CHAIN, dict(k=3e-4), 1.0, -1.5e-4),
    "four": (FOUR, dict(a=3, k=1), 3, -0.5),
}  # fmt: skip


TONES = 1.0, (5**0.5 - 1) / 2


def two_tones(name, force, *used):
    return Model(name=name, states=(x, v), parameters=(*used, a, b), equations={x: v, v: force}, harmonics=(a, b),
                 swing=(x,))  # fmt: skip


@pytest.mark.parametrize(("hold", "rests"), [(0.5, False), (0.7, True)])
def test_dry_friction_under_forces_that_never_repeat(hold, rests):
    """Together they reach 0.6: that much friction or more holds the mass, less does not."""
    model = two_tones("stuck_two_tones", 0.5 * cos(a * t) + 0.1 * cos(b * t) - x - k * sign(v), k)
    ds = diagram(whirlmap.load(model, a=TONES[0], b=TONES[1], k=hold, start={"x": 0.0}), lyapunov=None)
    assert (label(ds, 0) == "at-rest") == rests
    assert (float(ds["peak_to_peak"].sel(quantity="x")[0]) > 0.1) != rests


@pytest.mark.parametrize("idle", [1 / 16, 1 / 8, 1 / 3, TONES[1]])
@pytest.mark.parametrize(("swing", "rate"), [(0.04, -0.00500601), (0.1, None)])
def test_parametric_forcing_beside_a_clock_that_drives_nothing(idle, swing, rate):
    """Mathieu's equation; the rate is that of its multipliers, which no other clock changes."""
    period = 2 * np.pi

    def rates(s, z):
        return [z[1], -(0.25 + swing * np.cos(s)) * z[0] - 0.05 * z[1]]

    ends = [solve_ivp(rates, (0, period), z, rtol=1e-11, atol=1e-13).y[:, -1] for z in np.eye(2)]
    truth = float(np.log(np.abs(np.linalg.eigvals(np.array(ends).T)).max())) / period
    assert truth == pytest.approx(rate, rel=1e-5) if rate else truth > 0.005
    model = two_tones("idle_clock", -(0.25 + A * cos(a * t)) * x - c * v, A, c)
    ds = diagram(whirlmap.load(model, A=swing, c=0.05, a=1.0, b=idle, start={"x": 0.0}))
    assert (label(ds, 0) == "at-rest") == (truth < 0)
    if rate:
        exact = idle in (1 / 16, 1 / 8, 1 / 3)  # without a common period the rate is one over a trial
        assert float(ds["growth_rate"][0]) == pytest.approx(truth, rel=1e-5 if exact else 0.1)


@pytest.mark.parametrize("name", NODES)
def test_a_node_is_approached_without_a_crossing(name):
    """At rest with the largest eigenvalue, however slow or fast that is beside the typical time."""
    model, values, start, rate = NODES[name]
    system = whirlmap.load(model, start={"x": start}, **values)
    for ds in (diagram(system), diagram(system, lyapunov=256)):
        assert label(ds, 0) == "at-rest"
        assert float(ds["growth_rate"][0]) == pytest.approx(rate, rel=1e-6)


GHOST = free("ghost", {x: a + x**2}, a, section=x + 99)
LAZY = free("lazy", {x: a + 0 * y, y: -c * y}, a, c, section=x + 9)


def test_what_slows_down_only_for_a_while_does_not_rest():
    """x' = a + x^2 creeps through x = 0, near which it has no equilibrium; x' = a never stops."""
    assert label(diagram(whirlmap.load(GHOST, a=1e-4, start={"x": -1.0})), 0) == "diverged"
    assert label(diagram(whirlmap.load(LAZY, a=1e-3, c=0.1)), 0) == "drifting"


# --- drift ---------------------------------------------------------------------------------------------------------

ROLLING = forced("rolling", A * cos(w * t) - c * v + a, A, a, c)
PENDULUM = forced("whirling_pendulum", a + A * cos(w * t) - c * v - sin(q), A, a, c, at=q)
RATCHET = Model(
    name="ratchet", states=(x, v), parameters=(A, c, k, w), harmonics=(w, 2 * w), swing=(x,),
    equations={x: v, v: A * cos(w * t) + A * cos(2 * w * t) / 2 - when(v > 0, k, -4 * k) - c * v},
)  # fmt: skip
INTEGRAL = Model(name="integral", states=(y, x, v), parameters=(a, A, c, w), harmonics=(w,), swing=(x,),
                 equations={y: a + x, x: v, v: A * cos(w * t) - c * v - x})  # fmt: skip
FREE_ROLLING = free("free_rolling", {x: v, v: a - c * v}, a, c, section=v - 1)

DRIFT = {  # name -> model, values, drifting state, its mean rate
    "rolling": (ROLLING, dict(A=1, a=0.5, c=0.1, w=1.0), "x", 5.0),
    "rolling-back": (ROLLING, dict(A=1, a=-0.02, c=0.1, w=1.0), "x", -0.2),
    "rolling-slowly": (ROLLING, dict(A=1, a=1e-4, c=0.1, w=2.0), "x", 1e-3),
    "integral": (INTEGRAL, dict(A=1, a=0.3, c=0.2, w=0.8), "y", 0.3),
    "whirling-pendulum": (PENDULUM, dict(A=0.3, a=1.5, c=0.5, w=2.0), "q", 2.981174),
    "ratchet": (RATCHET, dict(A=1, c=0.2, k=0.1, w=1.0), "x", 0.458947),
}  # fmt: skip


def mean_rate(model, values, name):
    """Mean rate of a state over 200 T after 400 T, by SciPy (LSODA with short steps: the ratchet's rates jump)."""
    if model is PENDULUM:
        def rates(t, s):
            return [s[1], values["a"] + values["A"] * np.cos(values["w"] * t) - values["c"] * s[1] - np.sin(s[0])]
    else:
        def rates(t, s):
            f = values["A"] * (np.cos(values["w"] * t) + np.cos(2 * values["w"] * t) / 2)
            return [s[1], f - (values["k"] if s[1] > 0 else -4 * values["k"]) - values["c"] * s[1]]
    T = 2 * np.pi / values["w"]
    made = solve_ivp(rates, (0, 300 * T), [0.1 if name == "q" else 1.0, 0.0], t_eval=[200 * T, 300 * T], max_step=T / 200,
                     rtol=1e-6)  # fmt: skip
    return (made.y[0, 1] - made.y[0, 0]) / (100 * T)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["whirling-pendulum", "ratchet"])
def test_the_drift_comes_out_again(name):
    model, values, state, rate = DRIFT[name]
    assert mean_rate(model, values, state) == pytest.approx(rate, rel=1e-3)


@pytest.mark.parametrize("name", DRIFT)
def test_drift(name):
    model, values, _, rate = DRIFT[name]
    system = whirlmap.load(model, **values)
    ds = asked(diagram, system)
    assert not isinstance(ds, Refused), ds.sentence
    if model is RATCHET and label(ds, 0) == "sticks":
        return  # dry friction: the run may end where the motion sticks
    assert label(ds, 0) == "drifting"
    said = [name for name in ds.data_vars if "drift" in name]
    assert said, "the rate of the drift is nowhere"
    found = ds[said[0]].values.reshape(-1)
    assert np.abs(found - rate).min() < 2e-2 * abs(rate)


def test_a_fall_without_forcing_drifts():
    ds = asked(diagram, whirlmap.load(FREE_ROLLING, a=0.5, c=0.1))
    assert label(ds, 0) in ("drifting", "undecided")  # an unforced run has no section to return to


# --- growth ----------------------------------------------------------------------------------------------------------

RESONANT = forced("resonant", cos(w * t) - x, *())
NEGATIVE = forced("negative_damping", A * cos(w * t) + c * v - x, A, c)
SPIRAL = free("spiral", {x: v, v: c * v - x}, c)


def hill_rate(c_, a_, b_, w_, square):
    """Largest growth rate of x'' + c x' + (a + ...) x = 0 from its monodromy matrix."""
    T = 2 * np.pi / w_
    if square:  # exponentials of constant matrices: half of T with a + b, a quarter before and one after
        def flow(stiffness, time):
            from scipy.linalg import expm
            return expm(np.array([[0, 1], [-stiffness, -c_]]) * time)
        matrix = flow(a_ + b_, T / 4) @ flow(a_ - b_, T / 2) @ flow(a_ + b_, T / 4)
    else:
        def rates(s, m):
            m = m.reshape(2, 2)
            return (np.array([[0, 1], [-(a_ - 2 * b_ * np.cos(w_ * s)), -c_]]) @ m).ravel()
        matrix = solve_ivp(rates, (0, T), np.eye(2).ravel(), method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1].reshape(2, 2)
    return np.log(np.abs(np.linalg.eigvals(matrix)).max()) / T


GROWTH = {  # name -> model, values, exponential rate (0: in proportion to time)
    "resonance": (RESONANT, dict(w=1.0), 0.0),
    "negative-damping": (NEGATIVE, dict(A=1, c=0.02, w=2.0), 0.01),
    "negative-damping-small-force": (NEGATIVE, dict(A=1e-3, c=0.05, w=0.7), 0.025),
    "hill-above": (HILL, dict(a=1, b=0.21, c=0.2, w=2), "hill"),
    "hill-far-above": (HILL, dict(a=1, b=0.4, c=0.2, w=2), "hill"),
    "meissner-above": (MEISSNER, dict(a=1, b=0.3, c=0.1, w=2), "square"),
    "meissner-wide": (MEISSNER, dict(a=1, b=0.6, c=0.05, w=1.9), "square"),
}  # fmt: skip


@pytest.mark.parametrize("name", GROWTH)
def test_growth(name):
    model, values, rate = GROWTH[name]
    if isinstance(rate, str):
        rate = hill_rate(values["c"], values["a"], values["b"], values["w"], rate == "square")
        assert rate > 2e-3
    system = whirlmap.load(model, **values)
    assert label(diagram(system), 0) in ("growing", "undecided", "diverged")  # without an exponent it may stay open
    ds = asked(diagram, system, lyapunov=512)
    if isinstance(ds, Refused):
        assert model is MEISSNER and ds.names_the_jump
        return
    assert label(ds, 0) in ("growing", "diverged") if rate > 0.02 else label(ds, 0) == "growing"
    if label(ds, 0) == "growing" and rate:
        said = [name for name in ds.data_vars if "grow" in name]
        assert said, "the rate of growth is nowhere"
        assert float(ds[said[0]].values.reshape(-1)[0]) == pytest.approx(rate, rel=0.05)


def test_a_spiral_without_forcing_grows():
    assert label(diagram(whirlmap.load(SPIRAL, c=0.05), lyapunov=512), 0) in ("growing", "diverged")


@pytest.mark.parametrize(("b_", "grows"), [(0.2000, False), (0.2009, True)])
def test_the_threshold_of_hills_equation(b_, grows):
    """Delicate: 0.2 % from the threshold, rates of 1e-4. Open is allowed, the wrong side is not, nor a torus."""
    rate = hill_rate(0.2, 1.0, b_, 2.0, False)
    assert (rate > 0) == grows and abs(rate) < 3e-4
    allowed = {"growing", "undecided", "not-settled"} if grows else {"at-rest", "undecided", "not-settled"}
    assert label(diagram(whirlmap.load(HILL, a=1, b=b_, c=0.2, w=2.0), lyapunov=512), 0) in allowed


# --- poles -----------------------------------------------------------------------------------------------------------

PULL_IN = forced("pull_in", A * cos(w * t) - c * v - x + a / (b - x) ** 2, A, a, b, c)
SINGLE = forced("single_pole", A * cos(w * t) - c * v - x + a / (b - x), A, a, b, c)
BOTH = forced("two_poles", A * cos(w * t) - c * v - x + a * x / (b**2 - x**2), A, a, b, c)
CUBED = forced("cubed_pole", A * cos(w * t) - c * v - x + a / (b - x) ** 3, A, a, b, c)
ATTRACTING = free("attracting", {x: v, v: -c * v - x + a / (b - x) ** 2}, a, b, c)

FORCES = {
    "pull_in": lambda s, p: p["a"] / (p["b"] - s) ** 2, "single_pole": lambda s, p: p["a"] / (p["b"] - s),
    "two_poles": lambda s, p: p["a"] * s / (p["b"] ** 2 - s**2), "cubed_pole": lambda s, p: p["a"] / (p["b"] - s) ** 3,
    "attracting": lambda s, p: p["a"] / (p["b"] - s) ** 2,
}  # fmt: skip


def time_of_pole(model, values, start, duration, pole):
    """Time at which SciPy's solution comes within 1e-6 of the pole; None where it never does. With the motion's end."""
    force = FORCES[model.name]

    def rates(s, m):
        return [m[1], values.get("A", 0) * np.cos(values.get("w", 1) * s) - values["c"] * m[1] - m[0] + force(m[0], values)]

    def near(s, m):
        return (abs(m[0]) if model is BOTH else m[0]) - pole * (1 - 1e-6)

    near.terminal = True
    made = solve_ivp(rates, (0, duration), start, method="DOP853", rtol=1e-10, atol=1e-12, events=near, dense_output=True)
    return (float(made.t[-1]) if made.status == 1 else None), made


POLES = {  # model, values, start
    "pull-in": (PULL_IN, dict(A=0.5, a=0.1, b=1.2, c=0.1, w=0.9), (0.0, 0.0)),
    "pull-in-at-once": (PULL_IN, dict(A=0.1, a=0.3, b=1.2, c=0.1, w=0.9), (0.5, 0.0)),
    "pull-in-late": (PULL_IN, dict(A=0.05, a=0.05, b=1.2, c=0.02, w=0.9), (0.0, 0.0)),
    "single": (SINGLE, dict(A=0.6, a=0.2, b=1.1, c=0.1, w=0.8), (0.0, 0.0)),
    "two-poles": (BOTH, dict(A=0.9, a=0.3, b=1.0, c=0.1, w=0.7), (0.0, 0.0)),
    "cubed": (CUBED, dict(A=0.5, a=0.05, b=1.0, c=0.1, w=1.0), (0.0, 0.0)),
    "fast": (PULL_IN, dict(A=2.0, a=1e-4, b=1.2, c=0.1, w=1.0), (0.0, 0.0)),
}
NO_POLES = {
    "pull-in-small": (PULL_IN, dict(A=0.1, a=0.1, b=1.2, c=0.2, w=0.6), (0.0, 0.0)),
    "single-small": (SINGLE, dict(A=0.1, a=0.1, b=1.1, c=0.2, w=0.6), (0.0, 0.0)),
    "cubed-near": (CUBED, dict(A=0.25, a=0.02, b=1.0, c=0.2, w=0.5), (0.0, 0.0)),
}


@pytest.mark.parametrize("name", POLES)
def test_a_pole_is_not_stepped_over(name):
    """The run ends there, near the time at which SciPy arrives; whatever follows is no motion, so that no label is given."""
    model, values, start = POLES[name]
    pole = values["b"]
    T = 2 * np.pi / values["w"]
    at, _ = time_of_pole(model, values, start, 60 * T, pole)
    assert at is not None
    ds = diagram(whirlmap.load(model, start=dict(zip("xv", start, strict=True)), **values), lyapunov=256)
    assert Status(int(ds["status"][0])) != Status.ok
    assert label(ds, 0) not in ("quasi-periodic", "chaotic", "undecided") and not label(ds, 0).endswith("T")
    if np.isfinite(float(ds["end_time"][0])):
        assert float(ds["end_time"][0]) == pytest.approx(at, abs=0.2 * T)


@pytest.mark.parametrize("name", NO_POLES)
def test_a_motion_beside_a_pole_is_labelled(name):
    model, values, start = NO_POLES[name]
    T = 2 * np.pi / values["w"]
    at, made = time_of_pole(model, values, start, 120 * T, values["b"])
    assert at is None and np.abs(made.sol(120 * T) - made.sol(119 * T)).max() < 1e-6
    ds = diagram(whirlmap.load(model, start=dict(zip("xv", start, strict=True)), **values))
    assert label(ds, 0) == "1T"
    fine = made.sol(np.linspace(119 * T, 120 * T, 20001))[0]
    assert float(ds["maximum"].sel(quantity="x")[0]) == pytest.approx(fine.max(), abs=2e-5 * np.ptp(fine) + 1e-7)


def test_a_pole_without_forcing():
    at, _ = time_of_pole(ATTRACTING, dict(a=0.5, b=1.2, c=0.1), (0.0, 0.0), 50.0, 1.2)
    assert at is not None
    ds = diagram(whirlmap.load(ATTRACTING, a=0.5, b=1.2, c=0.1, start={"x": 0.0}))
    assert Status(int(ds["status"][0])) != Status.ok
