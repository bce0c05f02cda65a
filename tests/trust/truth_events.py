"""Piecewise smooth systems solved by SciPy with event location: the truth for models with kinks, jumps, stops and friction.

Nothing of whirlmap is used. A system is written with one symbol ``s0, s1, ...`` for the side of each of its surfaces; a side
is +1 where the surface's expression is positive and -1 where it is negative, and the rates are affine in it. Within one set
of sides they are smooth, and DOP853 integrates them with a terminal event at every surface; there it starts anew on the
other side. Where both sides push to the surface the motion slides: the side takes the value between -1 and 1 that keeps the
state on the surface (Filippov's rule with affine rates), until that value reaches -1 or 1.

Tangent vectors take the saltation matrix I + (f_after - f_before) n^T / (n . f_before + h_t) at every crossing and at the
beginning of a slide; at its end the rates do not jump.
"""

from dataclasses import dataclass, field
from functools import cached_property
from math import pi

import numpy as np
from scipy.integrate import solve_ivp
from sympy import Matrix, Symbol, cancel, lambdify, sympify

TIGHT, LOOSE = (1e-12, 1e-13), (1e-9, 1e-11)
#: Steps of the integrator per period, at least: two crossings of one surface within a step would be missed.
PARTS = 64


@dataclass(frozen=True)
class Equations:
    """Equations as text: states, surfaces, and the rate of each state; ``w`` is the forcing's frequency."""

    states: str
    surfaces: tuple[str, ...]
    rates: tuple[str, ...]
    frequency: str = "w"
    cyclic: dict[str, float] = field(default_factory=dict)
    parts: int = PARTS


@dataclass(frozen=True)
class Arc:
    """One smooth stretch of a run, with SciPy's interpolant of it."""

    sides: tuple[int, ...]
    begin: float
    end: float
    solution: object


@dataclass(frozen=True)
class Run:
    """End of a run."""

    z: np.ndarray
    tangent: np.ndarray
    arcs: list
    events: list
    ended: float | None


class Runs:
    """Runs of one operating point of a system."""

    def __init__(self, pieces, values):
        self.pieces, self.values = pieces, values
        names = pieces.states.split()
        self.n = len(names)
        self.symbols = {n: Symbol(n, real=True) for n in [*names, "t", *(f"s{i}" for i in range(len(pieces.surfaces)))]}
        self.z = [self.symbols[n] for n in names]
        local = {**self.symbols, **{k: sympify(v) for k, v in values.items()}}
        self.rates = Matrix([sympify(r, locals=local) for r in pieces.rates])
        self.surfaces = [sympify(h, locals=local) for h in pieces.surfaces]
        self.side = [self.symbols[f"s{i}"] for i in range(len(self.surfaces))]
        self.period = 2 * pi / float(sympify(pieces.frequency, locals=local)) if pieces.frequency else None
        self._fields = {}
        self.scale = 1.0

    def _function(self, expression):
        return lambdify([self.symbols["t"], *self.z], expression, modules="math", cse=True)

    @cached_property
    def heights(self):
        return [self._function(h) for h in self.surfaces]

    @cached_property
    def normals(self):
        """Gradient of each surface, and its derivative by time."""
        return [self._function([*(h.diff(s) for s in self.z), h.diff(self.symbols["t"])]) for h in self.surfaces]

    def field(self, sides):
        """Rates, their Jacobian, and for a slide the value of the side: functions of t and the states."""
        if sides not in self._fields:
            put, slide = {}, None
            for i, s in enumerate(sides):
                if s:
                    put[self.side[i]] = s
                else:
                    slide = i
            rates = self.rates.subs(put)
            value = None
            if slide is not None:
                h = self.surfaces[slide]
                speed = (Matrix([h]).jacobian(self.z) * rates)[0] + h.diff(self.symbols["t"])
                up, down = speed.subs(self.side[slide], 1), speed.subs(self.side[slide], -1)
                value = cancel(-(up + down) / (up - down))
                rates = rates.subs(self.side[slide], value)
            self._fields[sides] = (
                self._function(list(rates)), self._function(list(rates.jacobian(self.z))),
                None if value is None else self._function(value),
            )  # fmt: skip
        return self._fields[sides]

    def speed(self, i, sides, t, z):
        """Rate at which the height over surface i changes."""
        normal = self.normals[i](t, *z)
        return float(np.dot(normal[:-1], self.field(sides)[0](t, *z)) + normal[-1])

    def sides_at(self, t, z):
        """Sides of a state; on a surface that one to which the motion goes, 0 where it slides."""
        sides = [int(np.sign(h(t, *z))) for h in self.heights]
        for i, s in enumerate(sides):
            if s == 0:
                up, down = (self.speed(i, tuple(x if j != i else k for j, x in enumerate(sides)), t, z) for k in (1, -1))
                sides[i] = 1 if up > 0 else -1 if down < 0 else 0
        return tuple(sides)

    def run(self, t, z, end, *, tangent=False, keep=False, tolerance=TIGHT, sides=None, stop=None):
        """State at ``end`` from one at ``t``; with the tangent matrix, the arcs and the events (time, surface, kind).

        ``stop(t, z)`` ends the run where it falls to zero; then ``end`` is None in the result.
        """
        z, n = np.array(z, dtype=float), self.n
        phi = np.eye(n)
        arcs, events = [], []
        sides = sides or self.sides_at(t, z)
        limit = (self.period or self.pieces.parts) / self.pieces.parts
        ended = None
        while t < end:
            rates, jacobian, value = self.field(sides)

            def right(time, y, rates=rates, jacobian=jacobian):
                if not tangent:
                    return rates(time, *y)
                j = np.array(jacobian(time, *y[:n])).reshape(n, n)
                return np.concatenate([rates(time, *y[:n]), (j @ y[n:].reshape(n, n)).ravel()])

            stops, what = [], []
            for i, s in enumerate(sides):
                if s:
                    stops.append(lambda time, y, i=i, s=s: s * self.heights[i](time, *y[:n]))
                    what.append((i, "cross"))
                else:
                    for k in (1, -1):
                        stops.append(lambda time, y, k=k, value=value: 1 - k * value(time, *y[:n]))
                        what.append((i, k))
            if stop is not None:
                stops.append(lambda time, y: stop(time, y[:n]))
                what.append((None, "stop"))
            for event in stops:
                event.terminal, event.direction = True, -1
            y = np.concatenate([z, phi.ravel()]) if tangent else z
            made = solve_ivp(right, (t, end), y, method="DOP853", rtol=tolerance[0], atol=tolerance[1] * self.scale,
                             events=stops, dense_output=keep, max_step=limit)  # fmt: skip
            if not made.success:
                raise RuntimeError(made.message)
            if keep:
                arcs.append(Arc(sides, t, float(made.t[-1]), made.sol))
            t, y = float(made.t[-1]), made.y[:, -1]
            z, phi = y[:n].copy(), y[n:].reshape(n, n).copy() if tangent else phi
            if made.status != 1:
                break
            hit = next(k for k, times in enumerate(made.t_events) if times.size)
            i, kind = what[hit]
            if kind == "stop":
                ended = t
                break
            if kind == "cross":
                before, s = sides, sides[i]
                other = tuple(x if j != i else -s for j, x in enumerate(sides))
                after = other if -s * self.speed(i, other, t, z) >= 0 else tuple(
                    x if j != i else 0 for j, x in enumerate(sides)
                )  # fmt: skip
                normal = np.array(self.normals[i](t, *z))
                if tangent:
                    jump = np.subtract(self.field(after)[0](t, *z), self.field(before)[0](t, *z))
                    phi = phi + np.outer(jump, normal[:-1] @ phi) / self.speed(i, before, t, z)
                if after[i] == 0 and normal[:-1].any():  # onto the surface, exactly
                    z = z - normal[:-1] * self.heights[i](t, *z) / (normal[:-1] @ normal[:-1])
                sides = after
                events.append((t, i, "slides" if after[i] == 0 else "crosses"))
            else:
                sides = tuple(x if j != i else kind for j, x in enumerate(sides))
                events.append((t, i, "leaves"))
        self.last_sides = sides
        return Run(z, phi, arcs, events, ended)
