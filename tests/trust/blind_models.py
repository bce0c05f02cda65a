"""Eight systems of the blind test of labels, declared as users would; what is known of them exactly stands in `blind_exact`.

The parameter named first is no frequency, so that a diagram over it keeps the orders of the forcing.
"""

import math

from sympy import Rational

from whirlmap.equations import Model, Parameter, State, cos, sin, states, t

x, v = State("x", "1", "displacement"), State("v", "1", "velocity")
y = State("y", "1", "displacement")
vx, vy = states("vx vy", "1", "velocity")
NAMES = "c mu k h q2 q3 s D A w1 B w2 C w3 E w4 b a w0 F eps w q"
P = {n: Parameter(n, "1", n) for n in NAMES.split()}


def _of(names):
    return tuple(P[n] for n in names.split())


def _oscillator(name, names, force, harmonics, cyclic=None):
    c, mu, k, h, q2, q3, s, D = (P[n] if n in names.split() else 0 for n in NAMES.split()[:8])
    w1 = P["w1"]
    at = State("x", "1", "angle", cyclic=cyclic) if cyclic else x
    acceleration = (
        force + D - (c - mu * (1 - at**2)) * v - (k + h * cos(w1 * t)) * at - q2 * at**2 - q3 * at**3 - s * sin(at)
    )  # fmt: skip
    return Model(name=name, states=(at, v), parameters=_of(names), equations={at: v, v: acceleration},
                 harmonics=harmonics, swing=(at,))  # fmt: skip


A, B, C, E, w1, w2, w3, w4 = _of("A B C E w1 w2 w3 w4")
DUFFING = _oscillator("blind_duffing", "A c k q2 q3 D w1", A * cos(w1 * t), (w1,))
PENDULUM = _oscillator("blind_pendulum", "A c s D w1", A * cos(w1 * t), (w1,), cyclic=2 * math.pi)
VAN_DER_POL = _oscillator("blind_van_der_pol", "A mu k w1", A * cos(w1 * t), (w1,))
TONES = _oscillator(
    "blind_tones", "A c mu k h q3 B C E w1 w2 w3 w4",
    A * cos(w1 * t) + B * cos(w2 * t) + C * cos(w3 * t) + E * cos(w4 * t), (w1, w2, w3, w4),
)  # fmt: skip
TWO_TONES = _oscillator("blind_two_tones", "A c mu k h q3 B w1 w2", A * cos(w1 * t) + B * cos(w2 * t), (w1, w2))

c, k, b, w, mu, w0, F, eps, a, q = _of("c k b w mu w0 F eps a q")
LINEAR = Model(
    name="blind_linear", states=(x, v, y), parameters=(c, k, b, A, w), harmonics=(w,), swing=(x, y),
    equations={x: v, v: A * cos(w * t) - c * v - k * x, y: x + A - b * y},
)  # fmt: skip

# z' = (mu + i w0) z - (1 + i b) |z|^2 z + F exp(i w t), z = x + i y.
_r2 = x**2 + y**2
HOPF = Model(
    name="blind_hopf", states=(x, y), parameters=(mu, b, F, w0, w), harmonics=(w,), swing=(x,),
    equations={x: mu * x - w0 * y - _r2 * (x - b * y) + F * cos(w * t),
               y: mu * y + w0 * x - _r2 * (y + b * x) + F * sin(w * t)},
)  # fmt: skip

# In axes that turn by half the angle of the forcing u' = (eps - u^2 - v^2) u, v' = (-1 - u^2 - v^2) v, and around that
# the circle a exp(i w t); x is then bent by q y^2, so that nothing is a circle.
_X = x - q * y**2
_X, _Y = _X - a * cos(w * t), y - a * sin(w * t)
_mean, _half = (eps - 1) / 2, (eps + 1) / 2
_rx = (_mean + _half * cos(w * t) - _X**2 - _Y**2) * _X + (_half * sin(w * t) - w * Rational(1, 2)) * _Y
_ry = (_mean - _half * cos(w * t) - _X**2 - _Y**2) * _Y + (_half * sin(w * t) + w * Rational(1, 2)) * _X
_rx, _ry = _rx - a * w * sin(w * t), _ry + a * w * cos(w * t)
FLIP = Model(
    name="blind_flip", states=(x, y), parameters=(eps, a, q, w), harmonics=(w,), swing=(x,),
    equations={x: _rx + 2 * q * y * _ry, y: _ry},
)  # fmt: skip

ROTOR = Model(
    name="blind_rotor", states=(x, y, vx, vy), parameters=(k, c, a, w), harmonics=(w,), swing=(x, y),
    equations={x: vx, y: vy, vx: a * w**2 * cos(w * t) - c * vx - x - k * y,
               vy: a * w**2 * sin(w * t) - c * vy - y + k * x},
)  # fmt: skip

MODELS = {m.name[6:]: m for m in (DUFFING, PENDULUM, VAN_DER_POL, TONES, TWO_TONES, LINEAR, HOPF, FLIP, ROTOR)}
