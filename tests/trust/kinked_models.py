"""Oscillators with kinks, jumps and stops, as users write them, and beside each the same equations in pieces.

The pieces are what `truth_orbits` solves; `test_kinks_and_jumps.py` holds the two against each other at random states.
Lengths are over the gap, time over one radian of the linear oscillator.
"""

from sympy import Abs, Heaviside, Max, Min
from tests.trust.truth_orbits import Pieces

from whirlmap.equations import Model, Parameter, State, cos, sign, sin, sqrt, states, t, when

x, v = State("x", "1", "displacement"), State("v", "1", "velocity")
q = State("x", "1", "angle", cyclic=6.283185307179586)


def parameters(names):
    return {n: Parameter(n, "1", n) for n in names.split()}


_P = parameters("A B F G a b c d e k m w")
A, B, F, G, a, b, c, d, e, k, m, w = _P.values()


def oscillator(name, force, *used, at=x):
    """``x'' = force``."""
    return Model(name=name, states=(at, v), parameters=(*used, w), equations={at: v, v: force}, harmonics=(w,), swing=(at,))


# --- dry friction, in every way that it is written -----------------------------------------------------------------

_FORMS = {
    "sign": F * sign(v),
    "when": when(v > 0, F, -F),
    "abs": F * v / abs(v),
    "root": F * v / sqrt(v**2),
    "heaviside": F * (2 * Heaviside(v) - 1),
    "max": F * (Max(v, 0) - Max(-v, 0)) / abs(v),
}
DRY = {form: oscillator(f"dry_{form}", A * cos(w * t) - d * v - x - f, F, A, d) for form, f in _FORMS.items()}
DRY_PIECES = Pieces("x v", ("v",), ("v", "A*cos(w*t) - d*v - x - F*s0"))

UNEVEN = oscillator("dry_uneven", A * cos(w * t) - d * v - x - when(v > 0, F, -G), F, G, A, d)
UNEVEN_PIECES = Pieces("x v", ("v",), ("v", "A*cos(w*t) - d*v - x - F*(1+s0)/2 + G*(1-s0)/2"))

BELT = oscillator("belt", A * cos(w * t) - d * v - x - F * sign(v - b) / (1 + (v - b) ** 2), F, A, b, d)
BELT_PIECES = Pieces("x v", ("v - b",), ("v", "A*cos(w*t) - d*v - x - F*s0/(1 + (v - b)**2)"))

PENDULUM = oscillator("dry_pendulum", A * cos(w * t) - d * v - sin(q) - F * sign(v), F, A, d, at=q)
PENDULUM_PIECES = Pieces("x v", ("v",), ("v", "A*cos(w*t) - d*v - sin(x) - F*s0"), cyclic={"x": 6.283185307179586})

CONTACT_FRICTION = oscillator(
    "contact_friction", A * cos(w * t) + B - d * v - x - k * Max(x - 1, 0) * (1 + F * sign(v)), A, B, F, d, k
)
CONTACT_FRICTION_PIECES = Pieces(
    "x v", ("x - 1", "v"), ("v", "A*cos(w*t) + B - d*v - x - k*(x-1)*(1+s0)/2*(1 + F*s1)")
)

# --- kinks ------------------------------------------------------------------------------------------------------

BILINEAR = {
    "when": oscillator("bilinear_when", A * cos(w * t) - d * v - when(x > 0, x, k * x), A, d, k),
    "abs": oscillator("bilinear_abs", A * cos(w * t) - d * v - (1 + k) * x / 2 - (1 - k) * Abs(x) / 2, A, d, k),
    "min": oscillator("bilinear_min", A * cos(w * t) - d * v - Max(x, 0) - k * Min(x, 0), A, d, k),
}
BILINEAR_PIECES = Pieces("x v", ("x",), ("v", "A*cos(w*t) - d*v - x*(1+s0)/2 - k*x*(1-s0)/2"))

STOP = {
    "when": oscillator("stop_when", A * cos(w * t) + B - d * v - x - k * when(x > 1, x - 1), A, B, d, k),
    "max": oscillator("stop_max", A * cos(w * t) + B - d * v - x - k * Max(x - 1, 0), A, B, d, k),
    "abs": oscillator("stop_abs", A * cos(w * t) + B - d * v - x - k * (x - 1 + abs(x - 1)) / 2, A, B, d, k),
}
STOP_PIECES = Pieces("x v", ("x - 1",), ("v", "A*cos(w*t) + B - d*v - x - k*(x-1)*(1+s0)/2"), parts=128)

BOTH_STOPS = {
    "nested": oscillator(
        "stops_nested", A * cos(w * t) + B - d * v - a * x - k * when(x > 1, x - 1, when(x < -1, x + 1)), A, B, a, d, k
    ),
    "max": oscillator(
        "stops_max", A * cos(w * t) + B - d * v - a * x - k * (Max(x - 1, 0) - Max(-x - 1, 0)), A, B, a, d, k
    ),
}  # fmt: skip
BOTH_STOPS_PIECES = Pieces(
    "x v", ("x - 1", "x + 1"), ("v", "A*cos(w*t) + B - d*v - a*x - k*((x-1)*(1+s0)/2 + (x+1)*(1-s1)/2)"), parts=128
)

GEAR_PIECES = Pieces(
    "x v", ("x - 1", "x + 1"),
    ("v", "F_m + F_ah*Omega**2*cos(Omega*t) - 2*zeta*v - (x-1)*(1+s0)/2 - (x+1)*(1-s1)/2"), frequency="Omega",
)  # fmt: skip

HALF_WAVE = oscillator("half_wave", A * Max(cos(w * t), 0) - d * v - x - b * x**3, A, b, d)
HALF_WAVE_PIECES = Pieces("x v", ("cos(w*t)",), ("v", "A*cos(w*t)*(1+s0)/2 - d*v - x - b*x**3"))

# --- forces that jump in the displacement or in time -----------------------------------------------------------------

DAMPED_WALL = oscillator(
    "damped_wall", A * cos(w * t) - d * v - x - when(x > 1, k * (x - 1) + c * v), A, c, d, k
)
DAMPED_WALL_PIECES = Pieces("x v", ("x - 1",), ("v", "A*cos(w*t) - d*v - x - (k*(x-1) + c*v)*(1+s0)/2"), parts=128)

PRELOADED = oscillator("preloaded_wall", A * cos(w * t) - d * v - x - when(x > 1, F + k * (x - 1)), A, F, d, k)
PRELOADED_PIECES = Pieces("x v", ("x - 1",), ("v", "A*cos(w*t) - d*v - x - (F + k*(x-1))*(1+s0)/2"), parts=128)

RELAY = {
    "sign": oscillator("relay_sign", A * cos(w * t) - d * v - sign(x), A, d),
    "when": oscillator("relay_when", A * cos(w * t) - d * v - when(x > 0, 1, -1), A, d),
}
RELAY_PIECES = Pieces("x v", ("x",), ("v", "A*cos(w*t) - d*v - s0"))

MEISSNER = oscillator("meissner", A * cos(w * t) - d * v - (a + b * sign(cos(w * t))) * x, A, a, b, d)
MEISSNER_PIECES = Pieces("x v", ("cos(w*t)",), ("v", "A*cos(w*t) - d*v - (a + b*s0)*x"))

SQUARE_WAVE = oscillator("square_wave", A * sign(cos(w * t)) - d * v - x - b * x**3, A, b, d)
SQUARE_WAVE_PIECES = Pieces("x v", ("cos(w*t)",), ("v", "A*s0 - d*v - x - b*x**3"))

# --- more states ----------------------------------------------------------------------------------------------------

X1, X2, V1, V2 = states("x1 x2 v1 v2", "1", "displacements and velocities of two masses")


def two_masses(name, between, *used, also=0):
    """Mass 1 is driven and held by the wall's spring; ``between`` acts from it on mass 2."""
    return Model(
        name=name, states=(X1, X2, V1, V2), parameters=(A, d, m, *used, w), harmonics=(w,), swing=(X1, X2),
        equations={X1: V1, X2: V2, V1: A * cos(w * t) - d * V1 - X1 - between, V2: (between - d * V2 - also) / m},
    )  # fmt: skip


FRICTION_DAMPER = two_masses("friction_damper", F * sign(V1 - V2) + k * (X1 - X2), F, k)
FRICTION_DAMPER_PIECES = Pieces(
    "x1 x2 v1 v2", ("v1 - v2",),
    ("v1", "v2", "A*cos(w*t) - d*v1 - x1 - F*s0 - k*(x1-x2)", "(F*s0 + k*(x1-x2) - d*v2)/m"),
)  # fmt: skip

GAP = two_masses("gap_between", k * Max(X1 - X2 - 1, 0), k, c, also=c * X2)
GAP_PIECES = Pieces(
    "x1 x2 v1 v2", ("x1 - x2 - 1",),
    ("v1", "v2", "A*cos(w*t) - d*v1 - x1 - k*(x1-x2-1)*(1+s0)/2", "(k*(x1-x2-1)*(1+s0)/2 - d*v2 - c*x2)/m"), parts=128,
)  # fmt: skip

Y, VX, VY = State("y", "1", "y"), State("vx", "1", "vx"), State("vy", "1", "vy")
_r = sqrt(x**2 + Y**2)
_push = when(_r > 1, k * (1 - 1 / _r))
RUB = Model(
    name="rubbing_rotor", states=(x, Y, VX, VY), parameters=(e, F, G, d, k, w), harmonics=(w,), swing=(x, Y),
    equations={
        x: VX, Y: VY,
        VX: e * w**2 * cos(w * t) - d * VX - x - _push * (x - F * Y),
        VY: e * w**2 * sin(w * t) - d * VY - Y - G - _push * (Y + F * x),
    },
)  # fmt: skip
_N = "k*(1 - 1/sqrt(x**2+y**2))*(1+s0)/2"
RUB_PIECES = Pieces(
    "x y vx vy", ("x**2 + y**2 - 1",),
    ("vx", "vy", f"e*w**2*cos(w*t) - d*vx - x - {_N}*(x - F*y)", f"e*w**2*sin(w*t) - d*vy - y - G - {_N}*(y + F*x)"),
    parts=128,
)  # fmt: skip
