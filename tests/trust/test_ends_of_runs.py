"""Motions whose first period says little of the rest: contact, growth and escape come later, and so do the ends of runs.

Steps that are chosen while the rotor still swings freely must not carry a stiff stop, and an end that such steps invent
("diverged", "contact") must not be believed; ends that are true come at the time that SciPy finds for them.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.trust.asking import EXTREME, Refused, asked, diagram, extreme_error, label
from tests.trust.truth_numbers import kept
from tests.trust.truth_orbits import Pieces

import whirlmap
from whirlmap.equations import Model, Parameter, State, Stop, cos, sin, sqrt, t, when
from whirlmap.results.status import Status

x, v = State("x", "1", "displacement"), State("v", "1", "velocity")
q = State("q", "1", "angle", cyclic=6.283185307179586)
A, B, c, d, k, w, a, g = (Parameter(n, "1", n) for n in ["A", "B", "c", "d", "k", "w", "a", "g"])


def forced(name, force, *used, at=x, **more):
    return Model(name=name, states=(at, v), parameters=(*used, w), equations={at: v, v: force}, harmonics=(w,),
                 swing=(at,), **more)  # fmt: skip


# --- contact that comes late -------------------------------------------------------------------------------------------

STIFF = forced("late_stop", A * cos(w * t) - d * v - x - k * when(x > 1, x - 1), A, d, k)
STIFF_PIECES = Pieces("x v", ("x - 1",), ("v", "A*cos(w*t) - d*v - x - k*(x-1)*(1+s0)/2"), parts=200)
BOTH = forced("late_stops", A * cos(w * t) - d * v - x - k * when(x > 1, x - 1, when(x < -1, x + 1)), A, d, k)
BOTH_PIECES = Pieces("x v", ("x - 1", "x + 1"),
                     ("v", "A*cos(w*t) - d*v - x - k*((x-1)*(1+s0)/2 + (x+1)*(1-s1)/2)"), parts=200)  # fmt: skip
TEETH = forced(
    "late_teeth", g + A * w**2 * cos(w * t) - 2 * d * v - k * (when(x > 1, x - 1) + when(x < -1, x + 1)), g, A, d, k
)
TEETH_PIECES = Pieces("x v", ("x - 1", "x + 1"),
                      ("v", "g + A*w**2*cos(w*t) - 2*d*v - k*((x-1)*(1+s0)/2 + (x+1)*(1-s1)/2)"), parts=100)  # fmt: skip
PARAMETRIC = forced("late_parametric", -d * v - (1 + A * cos(w * t)) * x - k * x**3, A, d, k)
PARAMETRIC_PIECES = Pieces("x v", (), ("v", "-d*v - (1 + A*cos(w*t))*x - k*x**3"), parts=100)

#: name -> model, pieces, values, start, periods that the truth settles
LATE = {
    "stop-100": (STIFF, STIFF_PIECES, dict(A=0.08, d=0.04, k=100, w=1.0), (0.0, 0.0), 300),
    "stop-1000": (STIFF, STIFF_PIECES, dict(A=0.09, d=0.06, k=1000, w=1.03), (0.0, 0.0), 300),
    "stop-10000": (STIFF, STIFF_PIECES, dict(A=0.1, d=0.06, k=10000, w=1.02), (0.0, 0.0), 300),
    "stop-strong": (STIFF, STIFF_PIECES, dict(A=0.9, d=0.3, k=5000, w=0.75), (0.0, 0.0), 200),
    "both-1000": (BOTH, BOTH_PIECES, dict(A=0.1, d=0.06, k=1000, w=1.0), (0.0, 0.0), 300),
    "both-100": (BOTH, BOTH_PIECES, dict(A=0.2, d=0.1, k=100, w=1.1), (0.0, 0.0), 300),
    "teeth-1": (TEETH, TEETH_PIECES, dict(g=0.5, A=0.1, d=0.03, k=1, w=1.0), (1.5, 0.0), 400),
    "teeth-stiff": (TEETH, TEETH_PIECES, dict(g=30.0, A=0.02, d=0.2, k=100, w=9.8), (1.3, 0.0), 400),
    "parametric": (PARAMETRIC, PARAMETRIC_PIECES, dict(A=0.6, d=0.1, k=1.0, w=2.0), (1e-6, 0.0), 300),
    "parametric-stiff": (PARAMETRIC, PARAMETRIC_PIECES, dict(A=0.6, d=0.1, k=1e4, w=2.0), (1e-9, 0.0), 300),
    "parametric-soft": (PARAMETRIC, PARAMETRIC_PIECES, dict(A=0.6, d=0.1, k=1e-4, w=2.0), (1e-3, 0.0), 300),
}  # fmt: skip
NUMBERS = kept("numbers_late.json")


def truth_of(name):
    _, pieces, values, start, settle = LATE[name]
    return pieces.at(**values).attractor(start, settle=settle).plain()


@pytest.mark.parametrize("name", LATE)
def test_contact_and_growth_that_come_late(name):
    model, _, values, start, _ = LATE[name]
    truth = NUMBERS[name]
    ds = diagram(whirlmap.load(model, **values, start=dict(zip("xv", start, strict=True))))
    assert label(ds, 0) == f"{truth['n']}T"
    assert extreme_error(ds, "xv", truth["low"], truth["high"]) < EXTREME


@pytest.mark.slow
@pytest.mark.parametrize("name", ["stop-1000", "parametric"])
def test_diagnosed(name):
    model, _, values, start, _ = LATE[name]
    ds = whirlmap.diagnose(whirlmap.load(model, **values, start=dict(zip("xv", start, strict=True))))
    assert label(ds) == f"{NUMBERS[name]['n']}T" and float(ds["confidence"]) > 0.5


@pytest.mark.slow
@pytest.mark.parametrize("name", LATE)
def test_the_late_truths_come_out_again(name):
    again, truth = truth_of(name), NUMBERS[name]
    assert again["n"] == truth["n"] and np.hypot(truth["real"][0], truth["imaginary"][0]) < 0.95
    np.testing.assert_allclose([again["low"], again["high"]], [truth["low"], truth["high"]], rtol=0,
                               atol=1e-7 * max(truth["high"]))  # fmt: skip


# --- a rotor that rubs ---------------------------------------------------------------------------------------------------

y, vx, vy = State("y", "1", "y"), State("vx", "1", "vx"), State("vy", "1", "vy")
_r = sqrt(x**2 + y**2)
_N = when(_r > 1, k * (1 - 1 / sqrt(_r**2 + 1e-30)))
RUB = Model(
    name="late_rub", states=(x, y, vx, vy), parameters=(A, B, c, d, k, w), harmonics=(w,), swing=(x, y),
    equations={
        x: vx, y: vy, vx: A * w**2 * cos(w * t) - d * vx - x - _N * (x - c * y),
        vy: A * w**2 * sin(w * t) - d * vy - y - B - _N * (y + c * x),
    },
)  # fmt: skip


def largest_radius(w_):
    """Largest radius over 200 turns from rest, by SciPy."""
    values = dict(k=25.0)

    def rates(s, z):
        px, py, ux, uy = z
        r = np.hypot(px, py)
        n = values["k"] * (1 - 1 / r) if r > 1 else 0.0
        return [ux, uy, 0.3 * w_**2 * np.cos(w_ * s) - 0.1 * ux - px - n * (px - 0.1 * py),
                0.3 * w_**2 * np.sin(w_ * s) - 0.1 * uy - py - 0.1 - n * (py + 0.1 * px)]

    made = solve_ivp(rates, (0, 400 * np.pi / w_), [0.0] * 4, method="DOP853", rtol=1e-8, atol=1e-10, max_step=0.1)
    return np.hypot(made.y[0], made.y[1]).max()


#: Speed -> largest radius.
RADII = {0.85: 1.021, 0.9: 1.0621, 0.95: 1.0786, 1.0: 1.0818, 1.05: 1.1173}


@pytest.mark.parametrize("w_", RADII)
def test_a_rub_is_bounded(w_):
    """Whatever the label: a motion that goes on, within the radius that SciPy finds."""
    values = dict(A=0.3, B=0.1, c=0.1, d=0.1, k=25.0, w=w_)
    ds = diagram(whirlmap.load(RUB, **values))
    assert Status(int(ds["status"][0])) == Status.ok
    for name in ("minimum", "maximum"):
        assert abs(float(ds[name].sel(quantity="x")[0])) < 1.02 * RADII[w_]


@pytest.mark.slow
@pytest.mark.parametrize("w_", RADII)
def test_the_radii_come_out_again(w_):
    assert largest_radius(w_) == pytest.approx(RADII[w_], rel=0.02)


# --- ends that are true ------------------------------------------------------------------------------------------------

ESCAPE = forced("escape", A * cos(w * t) - d * v - x + x**3, A, d)
HELMHOLTZ = forced("helmholtz", A * cos(w * t) - d * v - x + x**2, A, d)
TOUCH = forced("touch", A * cos(w * t) + d * v - x, A, d, stops={"contact": Stop(1 - x**2, "the wall is touched")})


def time_of(model, values, start, reached, periods=80):
    """Time at which |x| reaches a value, by SciPy; None where it does not within some periods."""
    force = {"escape": lambda s: -s + s**3, "helmholtz": lambda s: -s + s**2, "touch": lambda s: -s}[model.name]
    sign = 1 if model.name == "touch" else -1

    def rates(s, z):
        return [z[1], values["A"] * np.cos(values["w"] * s) + sign * values["d"] * z[1] + force(z[0])]

    def event(s, z):
        return reached - abs(z[0])

    event.terminal = True
    made = solve_ivp(rates, (0, periods * 2 * np.pi / values["w"]), start, method="DOP853", rtol=1e-12, atol=1e-13,
                     events=event)  # fmt: skip
    return float(made.t[-1]) if made.status == 1 else None


ESCAPES = {  # model, values, start
    "at-once": (ESCAPE, dict(A=0.1, d=0.1, w=0.8), (1.5, 1.0)),
    "second-swing": (ESCAPE, dict(A=0.5, d=0.1, w=0.8), (0.0, 0.0)),
    "later": (ESCAPE, dict(A=0.195, d=0.05, w=0.8), (0.0, 0.0)),
    "helmholtz": (HELMHOLTZ, dict(A=0.2, d=0.1, w=0.85), (0.0, 0.0)),
    "helmholtz-later": (HELMHOLTZ, dict(A=0.075, d=0.05, w=0.85), (0.0, 0.0)),
}
BOUNDED = {
    "below": (ESCAPE, dict(A=0.1, d=0.2, w=0.8), (0.0, 0.0)),
    "helmholtz-below": (HELMHOLTZ, dict(A=0.05, d=0.1, w=0.7), (0.0, 0.0)),
}


@pytest.mark.parametrize("name", ESCAPES)
def test_an_escape_is_seen_at_its_time(name):
    model, values, start = ESCAPES[name]
    at = time_of(model, values, start, 1e5)
    assert at is not None
    ds = diagram(whirlmap.load(model, **values, start=dict(zip("xv", start, strict=True))))
    assert Status(int(ds["status"][0])) in (Status.diverged, Status.unresolved) and not label(ds, 0).endswith("T")
    # An error of 1e-6 at the start moves the last escape by 0.08 T, and the end is known to a step.
    assert float(ds["end_time"][0]) == pytest.approx(at, abs=0.1 * 2 * np.pi / values["w"])


@pytest.mark.parametrize("name", BOUNDED)
def test_a_motion_below_escape_is_periodic(name):
    model, values, start = BOUNDED[name]
    assert time_of(model, values, start, 1e5) is None
    assert label(diagram(whirlmap.load(model, **values, start=dict(zip("xv", start, strict=True)))), 0) == "1T"


@pytest.mark.parametrize(("d_", "w_", "start"), [(0.02, 1.4, 0.0), (0.05, 0.6, 0.1), (0.1, 3.0, 0.01), (0.03, 1.02, 0.0)])
def test_the_time_of_a_contact(d_, w_, start):
    """A negatively damped oscillator reaches its wall after some turns: the time to 1e-6 of T."""
    values = dict(A=0.05, d=d_, w=w_)
    at = time_of(TOUCH, values, (start, 0.0), 1.0)
    assert at > 2 * 2 * np.pi / w_
    ds = diagram(whirlmap.load(TOUCH, **values, start={"x": start}))
    assert label(ds, 0) == "contact"
    assert float(ds["end_time"][0]) == pytest.approx(at, abs=1e-5 * 2 * np.pi / w_)


@pytest.mark.parametrize("share", [0.999, 0.99999])
def test_a_wall_that_is_nearly_touched(share):
    """A linear oscillator that starts on its orbit, of an amplitude just short of the wall."""
    w_, d_ = 0.7, 0.2
    answer = 1 / (1 - w_**2 + 1j * d_ * w_)
    force = share / abs(answer)
    start = {"x": (force * answer).real, "v": (1j * w_ * force * answer).real}
    assert label(diagram(whirlmap.load(TOUCH, A=force, d=-d_, w=w_, start=start)), 0) == "1T"
    beyond = diagram(whirlmap.load(TOUCH, A=force * 1.001 / share, d=-d_, w=w_, start={"x": 0.0, "v": 0.0}))
    assert label(beyond, 0) == "contact"


SPIN = forced("spin_up", B + A * cos(w * t) - d * v - sin(q), A, B, d, at=q)


def test_a_pendulum_that_spins_up():
    """Driven to a hundred turns per forcing period, far faster than at first: no end of the run, no chaos."""
    system = whirlmap.load(SPIN, A=0.3, B=3.0, d=0.03, w=1.0)
    ds = asked(diagram, system, lyapunov=512)
    assert not isinstance(ds, Refused), ds.sentence
    # Its phase creeps towards a lock with the forcing, with an exponent of -1.2e-5 per T: it settles over 80 thousand T.
    assert label(ds, 0) == "not-settled"
    assert float(ds["mean"].sel(quantity="v")[0]) == pytest.approx(100.0, rel=1e-3)
