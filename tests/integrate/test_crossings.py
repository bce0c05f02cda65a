"""Crossings located inside the step: order, sliding, saltation, grazing, against SciPy's events and closed forms."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from sympy import Abs, Heaviside

import whirlmap
from whirlmap.equations import Model, Parameter, State, cos, sign, sin, t, when
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.kernels.methods import DOP853, RK4, TSIT5
from whirlmap.results.status import Status

x, v, q, u = (State(n, "1", n) for n in "xvqu")
F, A, w, k, g, b = (Parameter(n, "1", n) for n in ("F", "A", "w", "k", "g", "b"))


def friction(force, name="friction", more=()):
    return Model(name, (x, v), (F, A, w, *more), {x: v, v: A * cos(w * t) - x - force}, harmonics=(w,))


def run(model, values, start, steps, periods, *, method=DOP853, tangents=0, workers=1, **more):
    system = whirlmap.load(model, **values)
    x0 = np.array(start, dtype=float).reshape(model.dimension, -1)
    at = np.repeat(system.vector[:, None], x0.shape[1], axis=1)
    e = Ensemble(
        system.model, at, x0, orders=system.orders, steps=steps, method=method, tangents=tangents, workers=workers,
        orthonormal=False,
    )  # fmt: skip
    return e, e.advance(periods, **more)


def dead_zone(zeta, F_m, F_ah, Omega, start, end):
    """Event location by SciPy, one smooth piece after the other."""

    def rates(time, y, side):
        return [y[1], F_m + F_ah * Omega**2 * np.cos(Omega * time) - 2 * zeta * y[1] - (y[0] - side if side else 0.0)]

    def at(place, direction):
        event = lambda time, y, side: y[0] - place  # noqa: E731
        event.terminal, event.direction = True, direction
        return event

    time, y, side, count = 0.0, np.array(start), 1 if start[0] > 1 else -1 if start[0] < -1 else 0, 0
    while time < end - 1e-14:
        events = [at(1, 1), at(-1, -1)] if side == 0 else [at(side, -side)]
        s = solve_ivp(rates, (time, end), y, method="DOP853", rtol=1e-13, atol=1e-14, events=events, args=(side,))
        time, y = s.t[-1], s.y[:, -1]
        if s.status == 1:
            count, side = count + 1, 0 if side else 1 if s.t_events[0].size else -1
    return y, count


@pytest.mark.parametrize(("method", "order", "steps"), [(DOP853, 8, (12, 24)), (TSIT5, 5, (32, 64)), (RK4, 4, (32, 64))])
def test_the_method_keeps_its_order_through_the_dead_zone(method, order, steps):
    """Seven contacts in four T; a step that steps over them has order two at best."""
    values = {"zeta": 0.05, "F_m": 0.1, "F_ah": 0.2, "Omega": 0.9}
    system = whirlmap.load("gear_backlash", **values)
    truth, count = dead_zone(*values.values(), (1.1, 0.0), 4 * system.period)
    errors = []
    for n in steps:
        e, _ = run(system.model, values, (1.1, 0.0), n, 4, method=method)
        assert e.crossings[0] == count == 7
        errors.append(np.abs(e.x[:, 0] - truth).max())
    assert errors[0] / errors[1] > 2 ** (order - 0.8)


SPELLINGS = {
    "sign": F * sign(v), "when": when(v > 0, F, -F), "abs": F * v / Abs(v), "step": F * (2 * Heaviside(v) - 1),
}  # fmt: skip


@pytest.mark.parametrize("spelling", SPELLINGS)
@pytest.mark.parametrize("steps", [16, 64])
def test_den_hartog_without_a_stop(spelling, steps):
    """Den Hartog's closed form of 1931 for F = 0.3, A = 1, w = 0.8: peak to peak 5.2522098, two crossings in each T."""
    e, s = run(friction(SPELLINGS[spelling], spelling), {"F": 0.3, "A": 1, "w": 0.8}, (0.0, 0.1), steps, 60)
    before = e.crossings[0]
    s = e.advance(4, save_periods=1, extremes="between")
    assert e.crossings[0] - before == 8
    np.testing.assert_allclose(np.ptp(s.saved[:, 0, 0]), 0, atol=1e-7)
    high, low = s.extremes["maximum"][0, 0], s.extremes["minimum"][0, 0]
    assert high - low == pytest.approx(5.2522098, abs=2e-7)


def sticking(F_, A_, w_, start, end):
    """Friction oscillator by SciPy: events at v = 0, and at the force of stiction while it sticks."""
    time, (p, s) = 0.0, start
    side = np.sign(s)
    force = lambda time, p: A_ * np.cos(w_ * time) - p  # noqa: E731
    while time < end - 1e-13:
        if side == 0:
            if abs(force(time, p)) > F_:
                side = np.sign(force(time, p))
                continue
            grid = np.linspace(time, end, 4001)[1:]
            over = np.flatnonzero(np.abs(force(grid, p)) > F_)
            if not over.size:
                return np.array([p, 0.0])
            left = grid[over[0] - 1] if over[0] else time
            time = brentq(lambda z, p=p: abs(force(z, p)) - F_, left, grid[over[0]], xtol=1e-15)
            side = np.sign(force(time, p))
        event = lambda time, y: y[1]  # noqa: E731
        event.terminal, event.direction = True, -side
        made = solve_ivp(
            lambda time, y, side=side: [y[1], force(time, y[0]) - side * F_], (time, end), (p, s), method="DOP853",
            rtol=1e-13, atol=1e-14, events=[event],
        )  # fmt: skip
        time, (p, s) = made.t[-1], made.y[:, -1]
        if made.status == 1:
            s, side = 0.0, 0
    return np.array([p, s])


@pytest.mark.parametrize("frequency", [0.2, 0.3, 0.35, 0.45])
def test_den_hartog_with_stops(frequency):
    """Below the closed form's limit the mass sticks twice or more in each cycle."""
    values = {"F": 0.3, "A": 1, "w": frequency}
    e, _ = run(friction(F * sign(v)), values, (0.0, 0.1), 160, 3)
    truth = sticking(0.3, 1, frequency, (0.0, 0.1), 3 * 2 * np.pi / frequency)
    assert e.status[0] == Status.ok and e.crossings[0] > 6
    np.testing.assert_allclose(e.x[:, 0], truth, atol=2e-10)


@pytest.mark.parametrize("start", [(0.2, 1.0), (0.0, 0.1), (0.0, 0.0)])
@pytest.mark.parametrize("steps", [6, 24])
def test_a_mass_that_never_moves_again_stays_where_it_is(start, steps):
    """Sliding returns to its surface: what locating leaves of the velocity would carry the mass on for ever."""
    e, _ = run(friction(F * sign(v)), {"F": 1.8, "A": 1, "w": 0.8}, start, steps, 20)
    x0 = e.x[0, 0]
    e.advance(200)
    assert e.status[0] == Status.ok and abs(e.x[0, 0] - x0) < 1e-15 and abs(e.x[1, 0]) < 1e-20


@pytest.mark.parametrize("tangents", [0, 1])
@pytest.mark.parametrize("steps", [6, 8, 12])
@pytest.mark.parametrize("v0", [0.0, 1e-17, -1e-17])
def test_a_slide_that_begins_on_the_surface_ends_within_the_step(steps, v0, tangents):
    """v' = -sin t - F sign(v) from rest slides until sin t = F, then goes down; a rate of one side goes up and back."""
    model = Model("down", (x, v), (F, w), {x: v, v: -sin(w * t) - F * sign(v)}, harmonics=(w,))
    _, s = run(model, {"F": 0.1, "w": 1.0}, (0.0, v0), steps, 1, tangents=tangents, save_every=1)
    end, leaves = 2 * np.pi / steps, np.arcsin(0.1)
    free = end - leaves
    expected = [
        np.sin(end) - np.sin(leaves) - np.cos(leaves) * free + 0.05 * free**2, np.cos(end) - np.cos(leaves) + 0.1 * free
    ]  # fmt: skip
    np.testing.assert_allclose(s.saved[0, :, 0], expected, atol=1e-7)


BELT = friction(F * sign(v - b * (1 + 0.3 * sin(w * t))) + v / 20, "belt", (b,))
POSITION = Model(
    "position", (x, v), (F, A, w), {x: v, v: A * cos(w * t) - x - v / 5 - F * sign(x - 0.3 * cos(w * t) + x * v / 5)},
    harmonics=(w,),
)  # fmt: skip
CONTROL = Model("control", (x, v), (F, A, w), {x: v, v: A * cos(w * t) - v / 5 - F * sign(v + x / 2)}, harmonics=(w,))
WALL = Model("wall", (x, v), (k, b, w), {x: v, v: cos(w * t) - v / 5 - x - when(x > 1, k * (x - 1) + b * v)}, harmonics=(w,))
JUMPS = [
    (friction(F * sign(v)), {"F": 0.3, "A": 1, "w": 0.8}, (0.0, 0.1), 2, False),
    (friction(F * sign(v)), {"F": 0.3, "A": 1, "w": 0.3}, (0.0, 0.1), 2, True),
    (BELT, {"F": 0.5, "A": 0.3, "w": 0.7, "b": 0.5}, (0.0, 0.0), 3, True),
    (POSITION, {"F": 0.3, "A": 1, "w": 0.8}, (0.5, 0.1), 2, False),
    (CONTROL, {"F": 1.5, "A": 0.6, "w": 0.8}, (0.5, 0.1), 1, True),
    (WALL, {"k": 2, "b": 0.1, "w": 1.3}, (0.0, 0.3), 3, False),
]


@pytest.mark.parametrize(("model", "values", "start", "periods", "sticks"), JUMPS)
def test_tangent_vectors_are_the_derivative_of_the_flow(model, values, start, periods, sticks):
    """Saltation at jumps, and vectors that slide with a motion that sticks, against differences of neighbours."""
    d = 1e-6
    around = np.array(start)[:, None] + d * np.array([[1, -1, 0, 0], [0, 0, 1, -1]])
    e, _ = run(model, values, around, 64, periods)
    assert (e.crossings > 0).all()
    expected = np.stack([e.x[:, 0] - e.x[:, 1], e.x[:, 2] - e.x[:, 3]]) / (2 * d)
    one, _ = run(model, values, start, 64, periods, tangents=1)
    np.testing.assert_allclose(one.vectors[0, :, 0], expected[0], atol=2e-6)
    two, _ = run(model, values, start, 64, periods, tangents=2)
    if sticks:  # several vectors do not slide
        assert two.status[0] == Status.sticks and one.status[0] == Status.ok
    else:
        np.testing.assert_allclose(two.vectors[..., 0], expected, atol=2e-6)


def test_two_contacts_that_stick_at_once_end_the_run():
    model = Model(
        "two", (x, v, q, u), (F, A, w),
        {x: v, v: A * cos(w * t) - x - (x - q) - F * sign(v), q: u, u: x - 2 * q - F * sign(u)}, harmonics=(w,),
    )  # fmt: skip
    e, _ = run(model, {"F": 2.0, "A": 0.5, "w": 0.8}, (0.1, 0.1, 0.0, 0.1), 24, 5)
    assert e.status[0] == Status.sticks and np.isfinite(e.end_time[0])


def test_endless_crossings_come_to_rest():
    """x'' = -sign(x) - sign(v)/2: each swing is a third of the one before, and at rest both sides push (Zeno)."""
    model = Model("zeno", (x, v), (F, w), {x: v, v: -sign(x) - sign(v) / 2 + F * cos(w * t)}, harmonics=(w,))
    e, _ = run(model, {"F": 0.2, "w": 1.0}, (0.1, 0.0), 24, 3)
    assert e.status[0] == Status.ok and 4 < e.crossings[0] < 100
    np.testing.assert_allclose(e.x[:, 0], 0, atol=1e-7)


def test_a_mass_on_a_preloaded_stop_rests_until_it_is_pulled_off():
    """x'' = A cos(w t) - F (x > 0), from rest on the edge: nothing moves until the force turns at T/4, then x < 0."""
    model = Model("preloaded", (x, v), (F, A, w), {x: v, v: A * cos(w * t) - when(x > 0, F)}, harmonics=(w,))
    quarter = np.pi / 2
    e, s = run(model, {"F": 2.0, "A": 1.0, "w": 1.0}, (0.0, 0.0), 8, 1, save_every=1)
    assert e.status[0] == Status.ok
    np.testing.assert_allclose(s.saved[:2, :, 0], 0, atol=1e-12)  # T/8, T/4
    after = np.array([3, 4]) * np.pi / 4 - quarter
    np.testing.assert_allclose(s.saved[2:4, 0, 0], -after + np.sin(after), atol=1e-8)


GRAZE = Model("graze", (x, v, q), (g, w), {x: v, v: -x, q: when(x > g, x - g) - q / 10 + cos(w * t) / 100}, harmonics=(w,))


@pytest.mark.parametrize("steps", [8, 12, 16, 24, 48])
@pytest.mark.parametrize("depth", [1e-2, 1e-4, 1e-6, 1e-8])
def test_dips_between_the_ends_of_a_step_are_seen(depth, steps):
    """x = cos(t) looks over the edge once in each T. A dip below the step's own error is nobody's to see."""
    if depth < {8: 1e-6, 12: 1e-8}.get(steps, 0):
        return
    e, _ = run(GRAZE, {"g": 1 - depth, "w": 1.0}, (np.cos(0.3), -np.sin(0.3), 0.0), steps, 10)
    assert e.crossings[0] == 20
    if steps <= 24:
        assert e.grazings[0] == (20 if depth == 1e-8 else 0)
    above, _ = run(GRAZE, {"g": 1 + max(depth, 1e-5), "w": 1.0}, (np.cos(0.3), -np.sin(0.3), 0.0), steps, 10)
    assert above.crossings[0] == 0


def test_switched_stiffness_of_meissner():
    """x'' + (1 + F sign(cos t)) x = 0: multipliers from the two trigonometric pieces, surfaces of time alone."""
    model = Model("meissner", (x, v), (F, w), {x: v, v: -(1 + F * sign(cos(w * t))) * x}, harmonics=(w,))
    fast, slow = np.sqrt(1.3), np.sqrt(0.7)

    def piece(rate, time):
        c, s = np.cos(rate * time), np.sin(rate * time)
        return np.array([[c, s / rate], [-rate * s, c]])

    expected = piece(fast, np.pi / 2) @ piece(slow, np.pi) @ piece(fast, np.pi / 2)
    e, _ = run(model, {"F": 0.3, "w": 1.0}, (1.0, 0.5), 16, 1, tangents=2)
    np.testing.assert_allclose(e.vectors[..., 0].T, expected, atol=1e-9)
    np.testing.assert_allclose(e.x[:, 0], expected @ [1.0, 0.5], atol=1e-9)


def test_company_changes_no_bit_of_a_crossing():
    rng = np.random.default_rng(3)
    starts = rng.uniform(-2, 2, (2, 21))
    values, more = {"F": 0.3, "A": 1, "w": 0.4}, {"tangents": 1, "save_periods": 1}
    together, s = run(friction(F * sign(v)), values, starts, 16, 5, workers=2, **more)
    for i in (0, 7, 20):
        alone, a = run(friction(F * sign(v)), values, starts[:, i], 16, 5, **more)
        np.testing.assert_array_equal(a.saved[..., 0], s.saved[..., i])
        np.testing.assert_array_equal(alone._y[:, 0], together._y[:, i])


def test_a_wall_behind_a_stop_ends_the_run_where_it_is():
    """A crossing and an end in one step: the run ends at the second, at its own time."""
    from whirlmap.equations import Stop

    model = Model(
        "stopped", (x, v), (k, w), {x: v, v: when(x > 1, k) + 0 * cos(w * t)}, harmonics=(w,),
        stops={"contact": Stop(2 - x, "the far wall")},
    )  # fmt: skip
    e, _ = run(model, {"k": 2.0, "w": 1.0}, (0.0, 1.0), 4, 2)  # 1 to the step, then 1 = s + s^2
    assert e.status[0] == Status.contact
    assert e.end_time[0] == pytest.approx(1 + (np.sqrt(5) - 1) / 2, abs=1e-9)


def test_vectors_stay_finite_where_a_slide_is_left_and_crossed_at_no_speed():
    """A pendulum with dry friction, in chaos: some slides end where the rate across the surface is zero to the last bit."""
    pendulum = friction(F * sign(v) + k * v + sin(x) - x, "pendulum", (k,))
    starts = np.array([np.linspace(-2, 2, 512), np.full(512, 0.1)])
    e, _ = run(pendulum, {"F": 0.15, "k": 0.1, "A": 1, "w": 2 / 3}, starts, 16, 150, tangents=1)
    assert (e.status == Status.ok).all() and np.isfinite(e.vectors).all()
