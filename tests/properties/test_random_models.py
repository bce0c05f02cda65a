"""Random models: the compiled kernels against the reference kernel, and lanes against themselves in other company.

Equations are sums of random terms: monomials, guarded terms, roots, reciprocals, sines of states, tables of one and two
coordinates, and harmonics of random exact orders. Points differ in parameters and start, and end at stops, at the bound or
not at all. ``WHIRLMAP_MODELS=200`` tries more models than the suite does.
"""

import os
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from whirlmap.equations import Model, Parameter, State, cos, t, when
from whirlmap.equations.parts import Output, Stop
from whirlmap.equations.pieces import Table
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.system import System
from whirlmap.kernels.running.reference import reference_rates
from whirlmap.results.status import Status

MODELS = int(os.environ.get("WHIRLMAP_MODELS", "5"))

x, y = State("x", "1", "x"), State("y", "1", "y")
angle = State("z", "rad", "angle", cyclic=2 * np.pi)
a, b = Parameter("a", "1", "a"), Parameter("b", "1", "b")
omega, order = Parameter("omega", "1", "omega", above=0), Parameter("r", "1", "order", order=True)
EDGES = np.linspace(-1.5, 1.5, 13)


def rough(p, u):
    """Too rough for its cells: the polynomial of another cell is another number."""
    return np.sin(6 * u + p), np.abs(np.cos(5 * u)) * p


def rough_in_two(p, u, w):
    return (np.sin(4 * u + 3 * w) * (1 + p),)


LINE = Table("line", ("u",), ("f", "g"), rough, rough, lambda p: (EDGES + 0.02 * p,), 3)
PLANE = Table("plane", ("u", "w"), ("f",), rough_in_two, rough_in_two, lambda p: (EDGES, EDGES[::2]), 4)


def terms(s, o):
    """What the rates are sums of; ``s`` and ``o`` are states, or sines of angles."""
    return [
        s, s * o, s**3, -(s**5) * o / 4, a * s**2, b,
        when(s > sp.Rational(1, 3), a * s**2, -o), when(sp.Or(s < 0, o > sp.Rational(1, 2)), s * o), when(sp.Abs(s) > b, s),
        sp.Abs(s) * o, sp.sign(s) * b, sp.sqrt(1 + s**2), 1 / (2 + o**2), (1 + s**2) ** sp.Rational(-3, 2),
        (1 + o**2) ** sp.Rational(1, 4), sp.sin(s), sp.cos(2 * s + a), sp.sin(s - o) * o, sp.sin(40 * s) / 9, sp.exp(-s * s),
        sp.tanh(3 * s), sp.atan2(s, 2 + o**2), LINE(a, s)[0], LINE(a, s)[1] * o, LINE(a, o)[0] * s, PLANE(b, s, o)[0],
        sp.cos(omega * t), s * sp.sin(omega * t), cos(order * omega * t + b), o * cos(order * omega * t),
    ]  # fmt: skip


@st.composite
def systems(draw):
    """A model with numbers, and how many points of it run."""
    states = draw(st.sampled_from([(x, y), (x, angle), (y, angle, x), (x,)]))
    rates = {}
    for i, s in enumerate(states):
        pool = terms(*(sp.sin(q) if q.cyclic else q for q in (s, states[i - 1])))  # angles have no bound
        which = draw(st.lists(st.integers(0, len(pool) - 1), min_size=1, max_size=4, unique=True))
        rates[s] = sum((draw(st.sampled_from([-1, sp.Rational(1, 2), 1, 0.7])) * pool[k] for k in which), sp.Integer(0))
        rates[s] -= s / 2 if s.cyclic is None else 0
    used = {e.args[0].name for rate in rates.values() for e in rate.atoms(sp.Function) if type(e).__name__ == "tabulated"}
    shown = states[0] if states[0].cyclic is None else states[1]
    stops = {"wall": Stop(b + sp.Rational(1, 2) - shown, "wall")} if draw(st.booleans()) else {}
    model = Model(
        name="random", states=states, parameters=(a, b, omega, order), equations=rates,
        harmonics=(omega, order * omega), outputs={"size": Output(sp.sqrt(sum(s**2 for s in states)), "1", "size")},
        clocks={"a": a, "b": b},  # reads both, whichever the terms do
        stops=stops, bound=draw(st.sampled_from([1.2, 20.0])), tables=tuple(q for q in (LINE, PLANE) if q.name in used),
    )  # fmt: skip
    ratio = Fraction(draw(st.integers(-3, 7)) or 1, draw(st.sampled_from([1, 2, 3, 7])))
    system = System(model, {"a": 0.3, "b": 0.4, "omega": 1.3, "r": ratio})
    return system, draw(st.integers(1, 40)), draw(st.integers(0, 2**32 - 1))


def points(system, n, seed):
    """Values of the parameters and start states, these away from thresholds and edges of cells."""
    rng = np.random.default_rng(seed)
    values = np.repeat(system.vector[:, None], n, axis=1)
    values[0], values[1] = rng.choice([0.1, 0.3, 0.9], n), rng.choice([0.2, 0.4, 1.3], n)
    values[2] = rng.uniform(0.8, 1.5, n)
    start = rng.integers(-10, 11, (system.model.dimension, n)) / 8 + rng.uniform(0.05, 0.075, (system.model.dimension, n))
    return values, start


def exact(system, time, start, values):
    """The reference kernel, point by point: tables know one value of their parameter at a time."""
    rates = reference_rates(system.model, tables="read")
    return np.stack([rates(time[k], start[:, k], values[:, k]) for k in range(start.shape[1])], axis=1)


def textbook(system, start, values, steps, count, period):
    """Kutta's method by the reference kernel, the state after each step, shape (step, state, point)."""
    h, now, out = period / steps, start, []
    for n in range(count):
        f = lambda c, at: exact(system, (n + c) * h, at, values)  # noqa: E731, B023
        k1 = f(0.0, now)
        k2 = f(0.5, now + h / 2 * k1)
        k3 = f(0.5, now + h / 2 * k2)
        k4 = f(1.0, now + h * k3)
        now = now + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        out.append(now)
    return np.stack(out)


def within(system, states, values):
    """Whether states are in bounds and before the wall."""
    counted = [i for i, s in enumerate(system.model.states) if s.cyclic is None]
    good = np.isfinite(states).all(axis=-2) & (np.abs(states[..., counted, :]).sum(axis=-2) < system.model.bound)
    return good & (values[1] + 0.5 > states[..., counted[0], :]) if system.model.stops else good


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("WHIRLMAP_CACHE", str(tmp_path_factory.mktemp("kernels")))
        yield


tried = settings(
    max_examples=MODELS, deadline=None, derandomize=MODELS < 10, suppress_health_check=list(HealthCheck),
    phases=(Phase.generate,),  # every model is compiled: to find the smallest that fails would take minutes
)  # fmt: skip


def surfaces(ensemble):
    """Surfaces at which the rates of a model have a kink or a jump."""
    return ensemble._groups[0].kernel.source.sizes.surfaces


@tried
@given(systems())
def test_rates_and_jacobian(case):
    """Rates to rounding; the Jacobian against central differences of the reference."""
    system, n, seed = case
    _, start = points(system, n, seed)
    values, time = np.repeat(system.vector[:, None], n, axis=1), np.full(n, 0.37)
    got, expected = system.rhs(0.37, start), exact(system, time, start, values)
    np.testing.assert_allclose(got, expected, rtol=1e-12, atol=1e-12)
    slopes = system.jacobian(0.37, start)
    step = 1e-6
    for j in range(system.model.dimension):
        up, down = start.copy(), start.copy()
        up[j] += step
        down[j] -= step
        difference = (exact(system, time, up, values) - exact(system, time, down, values)) / (2 * step)
        np.testing.assert_allclose(slopes[:, j], difference, rtol=1e-6, atol=1e-6)


@tried
@given(systems(), st.integers(1, 9))
def test_steps_are_the_textbooks_until_a_point_ends(case, save_every):
    system, n, seed = case
    values, start = points(system, n, seed)
    steps, turns = 9, 2
    e = Ensemble(system.model, values, start, orders=system.orders, steps=steps, redo=False)
    segment = e.advance(turns, save_every=save_every, extremes=True)
    with np.errstate(all="ignore"):
        orbit, moved = (textbook(system, start + d, values, steps, steps * turns, e.period) for d in (0.0, 1e-12))
        good, other = (np.logical_and.accumulate(within(system, q, values)) for q in (orbit, moved))
        apart = np.where(good[:, None], np.abs(orbit - moved), 0.0).max(axis=(0, 1))
    calm = (good == other).all(axis=0) & (apart < 1e-9)  # others make rounding large, beyond the edges of tables above all
    if surfaces(e):  # the textbook steps over them, the kernel cuts its steps there
        return
    expected = np.where(good[:, None], orbit, np.nan)
    np.testing.assert_array_equal(e.running[calm], good[-1, calm])
    every = expected[save_every - 1 :: save_every][: len(segment.saved)]
    np.testing.assert_allclose(segment.saved[..., calm], every[..., calm], rtol=1e-10, atol=1e-10)
    largest = np.where(good[-1], expected.max(axis=0), np.nan)
    np.testing.assert_allclose(segment.extremes["maximum"][:-1, calm], largest[:, calm], rtol=1e-10, atol=1e-10)


@tried
@given(systems(), st.integers(1, 5), st.sampled_from(["none", "one", "two", "all"]))
def test_company_changes_no_bit(case, save_every, tangents):
    """Lanes that end, wait for mended steps and come back: a point has the bits that it has alone."""
    system, n, seed = case
    count = min({"none": 0, "one": 1, "two": 2, "all": 9}[tangents], system.model.dimension)
    values, start = points(system, n, seed)

    def run(which):
        e = Ensemble(
            system.model, values[:, which], start[:, which], orders=system.orders, steps=5, tangents=count, workers=1
        )  # fmt: skip
        parts = [e.advance(1, save_every=save_every, extremes=True), e.advance(3, save_every=save_every, extremes=True)]
        return [e._y, e.status, e.end_time, *(q for p in parts for q in (p.saved, p.growth, *p.extremes.values()))]

    together = run(np.arange(n))
    for which in (np.random.default_rng(seed).permutation(n), np.array([0]), np.array([n - 1])):
        for got, expected in zip(run(which), together, strict=True):
            np.testing.assert_array_equal(got, expected[..., which])


@tried
@given(systems())
def test_tangent_vectors_follow_the_jacobian(case):
    """Kutta's method for the tangent vectors by the Jacobian at the stages, whatever number of them is carried."""
    system, _, seed = case
    n, steps = system.model.dimension, 7
    start = points(system, 1, seed)[1] * 0.5
    h, now, vectors = system.period / steps, start[:, 0], np.eye(n)
    for k in range(steps):
        if not within(system, now[:, None], system.vector[:, None]).all():
            return
        f = lambda c, at: system.rhs((k + c) * h, at)  # noqa: E731, B023
        g = lambda c, at, w: system.jacobian((k + c) * h, at) @ w  # noqa: E731, B023
        k1, l1 = f(0.0, now), g(0.0, now, vectors)
        k2, l2 = f(0.5, now + h / 2 * k1), g(0.5, now + h / 2 * k1, vectors + h / 2 * l1)
        k3, l3 = f(0.5, now + h / 2 * k2), g(0.5, now + h / 2 * k2, vectors + h / 2 * l2)
        k4, l4 = f(1.0, now + h * k3), g(1.0, now + h * k3, vectors + h * l3)
        now = now + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        vectors = vectors + h / 6 * (l1 + 2 * l2 + 2 * l3 + l4)
    if not within(system, now[:, None], system.vector[:, None]).all():
        return
    _, r = np.linalg.qr(vectors)
    growth = np.log(np.abs(np.diagonal(r)))
    if growth.min() < -9:  # what is left of nearly parallel vectors is rounding
        return
    for count in {1, min(2, n), n}:
        e = Ensemble(
            system.model, system.vector[:, None], start, orders=system.orders, steps=steps, tangents=count,
            sizes=np.ones((n, 1)),
        )  # fmt: skip
        e._y[n : n * (1 + count)] = np.eye(n)[:count].reshape(-1, 1)
        found = e.advance(1).growth[0, :, 0]
        if surfaces(e):
            return
        assert e.status[0] == Status.ok
        np.testing.assert_allclose(found, growth[:count], rtol=1e-6, atol=1e-7)
