"""Random expressions over all functions that a model may use: compiled rates and Jacobian against mpmath.

The truth is the expression as SymPy holds it, evaluated node by node as a real number with its slopes (dual numbers) in 40
digits. What is complex there is NaN; conditions with NaN are not compared. Every node is also moved by a rounding or so, at
random: how far the result moves by that is the error that is allowed. ``WHIRLMAP_MODELS=500`` tries more than the suite.
"""

import os
import random

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from hypothesis import HealthCheck, Phase, assume, given, reject, settings
from hypothesis import strategies as st
from sympy.core.relational import Relational

from whirlmap.equations import Model, Parameter, State, allowed, when
from whirlmap.errors import ModelError
from whirlmap.integrate.system import System

EXPRESSIONS = 3 * int(os.environ.get("WHIRLMAP_MODELS", "6"))
DIGITS, POINTS, ROUNDINGS = 40, 12, 8

x, y = State("x", "1", "x"), State("y", "1", "y")
a, b = Parameter("a", "1", "a"), Parameter("b", "1", "b")
VALUES = {"a": 1.3, "b": -0.4}

ONE = [
    sp.sin, sp.cos, sp.tan, sp.sinh, sp.cosh, sp.tanh, sp.asin, sp.acos, sp.atan, sp.asinh, sp.acosh, sp.atanh, sp.exp,
    sp.log, sp.erf, sp.erfc, sp.Abs, sp.sign, sp.Heaviside, lambda u: sp.Heaviside(u, 0), lambda u: -u, lambda u: u**2,
    lambda u: 1 / u, sp.sqrt, sp.cbrt, lambda u: u**1.5, lambda u: u**0.7, lambda u: u ** sp.Rational(10, 9),
    lambda u: u ** sp.Rational(-5, 4), lambda u: sp.Abs(u) ** sp.Rational(5, 2), lambda u: sp.Max(u, 0) ** sp.Rational(3, 2),
    lambda u: u**a, lambda u: a**u,
]  # fmt: skip
TWO = [
    lambda u, v: u + v, lambda u, v: u * v, lambda u, v: u - 2 * v, sp.Max, sp.Min, lambda u, v: sp.Max(u, v, b),
    sp.atan2, lambda u, v: sp.Abs(u) ** v, lambda u, v: u / (2 + v**2),
    lambda u, v: when(u > v, u * v, v) + when(u > v, u), lambda u, v: when(sp.And(u > 0, v < a), u, v),
    lambda u, v: when(sp.Or(u <= b, v > 0), v) * u, lambda u, v: when(sp.Xor(u > 0, v > 0), u, 1),
    lambda u, v: when(u > 0, sp.sqrt(u), v) + when(u > 0, sp.log(u)),
]  # fmt: skip
LEAVES = [x, y, x, y, a, b, sp.Rational(1, 2), sp.Integer(2), sp.Float(0.7)]


@st.composite
def expressions(draw, depth=3):
    if depth == 0 or draw(st.integers(0, 6)) == 0:
        return draw(st.sampled_from(LEAVES))
    one = draw(st.booleans())
    make = draw(st.sampled_from(ONE if one else TWO))
    parts = [draw(expressions(depth - 1)) for _ in range(1 if one else 2)]
    try:
        return make(*parts)
    except (TypeError, ValueError):  # SymPy compares no complex numbers
        return reject()


class Dual:
    """Real value and slopes of a tree of SymPy's at one place, and how near to a kink or a jump it was evaluated."""

    def __init__(self, place, noise=0.0, seed=0):
        self.place, self.noise, self.random = place, noise, random.Random(seed)
        self.near = mp.inf

    def __call__(self, e):
        out = self._value(e)
        out = [mp.nan if isinstance(v, mp.mpc) and v.imag != 0 else mp.re(v) for v in out]
        if mp.isnan(out[0]):
            out = [mp.nan] * 3
            if not e.has(State):  # a constant that is complex at these values: comparisons with it are not compared
                self.near = mp.mpf(0)
        return [v * (1 + self.noise * self.random.uniform(-1, 1)) for v in out] if e.args else out

    def _chain(self, value, *parts):
        """Slopes by the chain rule: parts are (slope by the argument, the argument's slopes), 0 of which count nothing."""
        return [value, *(sum((p * d[k] for p, d in parts if d[k] != 0), mp.mpf(0)) for k in (1, 2))]

    def _value(self, e):
        if e in self.place:
            return self.place[e]
        if not e.args:
            return [mp.mpf(sp.N(e, DIGITS)._mpf_ if e.is_Float else sp.N(e, DIGITS)), mp.mpf(0), mp.mpf(0)]
        if isinstance(e, sp.Piecewise):
            return next(self(v) for v, condition in e.args if self.truth(condition))
        u = [self(arg) for arg in e.args]
        first = u[0][0]
        if any(mp.isnan(w[0]) for w in u):
            return [mp.nan] * 3
        if e.is_Add:
            return [sum(w[k] for w in u) for k in range(3)]
        if e.is_Mul:
            values = [w[0] for w in u]
            others = [mp.fprod(values[:i] + values[i + 1 :]) for i in range(len(u))]
            return self._chain(mp.fprod(values), *zip(others, u, strict=True))
        if e.is_Pow:
            return self._power(*u)
        if isinstance(e, sp.Max | sp.Min):
            ordered = sorted(u, key=lambda w: w[0], reverse=isinstance(e, sp.Max))
            self._by(ordered[0][0] - ordered[1][0])
            return ordered[0]
        if isinstance(e, sp.Abs | sp.sign | sp.Heaviside):
            self._by(first)
            if isinstance(e, sp.Abs):
                return [mp.sign(first) * w for w in u[0]]
            jump = mp.sign(first) if isinstance(e, sp.sign) else (mp.mpf(0) if first < 0 else mp.mpf(1))
            return [jump, mp.mpf(0), mp.mpf(0)]
        if isinstance(e, sp.atan2):
            v, w = first, u[1][0]
            return self._chain(mp.atan2(v, w), (w / (v**2 + w**2), u[0]), (-v / (v**2 + w**2), u[1]))
        f = getattr(mp, {"Abs": "fabs"}.get(type(e).__name__, type(e).__name__))
        rounded = 1 + self.noise * self.random.uniform(-1, 1)
        slope = 1 - rounded * mp.tanh(first) ** 2 if isinstance(e, sp.tanh) else SLOPES[type(e)](first)  # it is found so
        return self._chain(f(first), (slope, u[0]))

    def _power(self, base, exponent):
        (v, *_), (p, *_) = base, exponent
        if v == 0:
            return self._chain(v**p, (mp.mpf(p == 1) if p >= 1 else mp.inf, base))
        value = mp.power(v, p)
        return self._chain(value, (p * mp.power(v, p - 1), base), (value * mp.log(v), exponent))

    def truth(self, c):
        if c in (True, False):
            return bool(c)
        if isinstance(c, Relational):
            d = self(c.lhs)[0] - self(c.rhs)[0]
            self._by(mp.mpf(0) if mp.isnan(d) else d)  # SymPy writes "not >" as "<=", so both fail
            return bool({">": d > 0, "<": d < 0, ">=": d >= 0, "<=": d <= 0, "==": d == 0, "!=": d != 0}[c.rel_op])
        parts = [self.truth(arg) for arg in c.args]
        if isinstance(c, sp.And):
            return all(parts)
        if isinstance(c, sp.Or):
            return any(parts)
        if isinstance(c, sp.Not):
            return not parts[0]
        if isinstance(c, sp.ITE):
            return parts[1] if parts[0] else parts[2]
        assert isinstance(c, sp.Xor)
        return sum(parts) % 2 == 1

    def _by(self, distance):
        self.near = min(self.near, mp.inf if mp.isnan(distance) else abs(distance))


SLOPES = {
    sp.sin: mp.cos, sp.cos: lambda v: -mp.sin(v), sp.tan: lambda v: 1 / mp.cos(v) ** 2, sp.sinh: mp.cosh, sp.cosh: mp.sinh,
    sp.asin: lambda v: 1 / mp.sqrt(1 - v**2), sp.acos: lambda v: -1 / mp.sqrt(1 - v**2),
    sp.atan: lambda v: 1 / (1 + v**2), sp.asinh: lambda v: 1 / mp.sqrt(1 + v**2), sp.acosh: lambda v: 1 / mp.sqrt(v**2 - 1),
    sp.atanh: lambda v: 1 / (1 - v**2), sp.exp: mp.exp, sp.log: lambda v: 1 / v,
    sp.erf: lambda v: 2 / mp.sqrt(mp.pi) * mp.exp(-(v**2)), sp.erfc: lambda v: -2 / mp.sqrt(mp.pi) * mp.exp(-(v**2)),
}  # fmt: skip


def evaluated(rates, X, Y, noise=0.0, seed=0):
    """Values and slopes of the rates at one place, shape (rate, 3), and the distance to the nearest kink."""
    place = {s: [mp.mpf(v), mp.mpf(i == 0), mp.mpf(i == 1)] for i, (s, v) in enumerate(((x, X), (y, Y)))}
    place |= {p: [mp.mpf(VALUES[p.name]), mp.mpf(0), mp.mpf(0)] for p in (a, b)}
    dual = Dual(place, noise, seed)
    return np.array([[float(v) for v in dual(e)] for e in rates]), float(dual.near)


def check(rates, places):
    clocks = {"a": a, "b": b}  # reads both, whichever the expressions do
    system = System(Model("random", (x, y), (a, b), dict(zip((x, y), rates, strict=True)), clocks=clocks), VALUES)
    with np.errstate(all="ignore"):
        got = np.concatenate([system.rhs(0.0, places)[:, None], system.jacobian(0.0, places)], axis=1)
        reference = system.reference_rhs(0.0, places)
    compared = 0
    for k in range(places.shape[1]):
        try:
            true, near = evaluated(rates, *places[:, k])
            noisy = [evaluated(rates, *places[:, k], 2.0**-52, seed)[0] for seed in range(ROUNDINGS)]
        except (ZeroDivisionError, OverflowError, ValueError):
            continue
        with np.errstate(all="ignore"):
            allowed = 20 * np.abs(np.array(noisy) - true).max(axis=0) + 1e-14 * np.abs(true) + 1e-290
        for i in range(2):
            if np.isnan(true[i, 0]) and near >= 1e-9:
                assert not np.isfinite(got[i, 0, k]), (rates[i], places[:, k])
            sure = np.isfinite(true[i]) & (np.abs(true[i]) < 1e100) & (allowed[i] < 1e-6 * np.abs(true[i]) + 1e-9)
            if near < 1e-9 or not sure[0]:
                continue
            apart = np.abs(got[i, :, k] - true[i])
            assert np.all(apart[sure] <= allowed[i][sure]), (rates[i], places[:, k], got[i, :, k], true[i])
            assert abs(reference[i, k] - true[i, 0]) <= allowed[i, 0], (rates[i], places[:, k])
            compared += int(sure.sum())
    return compared


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(DIGITS):
        yield


@settings(
    max_examples=EXPRESSIONS, deadline=None, derandomize=EXPRESSIONS < 100, suppress_health_check=list(HealthCheck),
    phases=(Phase.generate,),
)  # fmt: skip
@given(expressions(), expressions(), st.integers(0, 2**32 - 1))
def test_rates_and_jacobian_of_any_expression(first, second, seed):
    rates = [sp.sympify(e) + s for e, s in ((first * second, y), (first + second, x))]
    assume(not allowed.fault(rates))  # complex constants such as asin(2) are refused where a model is declared
    places = np.random.default_rng(seed).uniform(-2, 2, (2, POINTS))
    try:
        check(rates, places)
    except ModelError as error:  # acos(Max(2, x)) > 0 compares what is real nowhere
        assume("non-real" not in str(error))
        raise


