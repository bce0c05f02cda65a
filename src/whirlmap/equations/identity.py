"""Identity of a model: a digest that changes with anything that is computed from its declaration.

Expressions of films share most of their parts, so each part is digested once, by what it is made of; writing the
expressions out (`srepr`) repeats a shared part wherever it stands, and takes thirty times as long.
"""

import hashlib
from dataclasses import fields
from functools import lru_cache
from typing import Any

from sympy import srepr, sympify

from whirlmap.equations.model import Model
from whirlmap.equations.pieces import Table

Known = dict[int, tuple[Any, str]]


def expression_digest(expression: Any, known: Known) -> str:
    """Digest of an expression; ``known`` holds the parts digested before, by their address, and keeps them alive."""
    e = sympify(expression)
    if id(e) in known:
        return known[id(e)][1]
    parts = [expression_digest(a, known) for a in e.args]
    own = f"{type(e).__module__}.{type(e).__qualname__}"
    digest = _digest(own, *(parts or [srepr(e)]))
    known[id(e)] = (e, digest)
    return digest


@lru_cache(maxsize=256)
def model_digest(model: Model) -> str:
    """Digest of a declaration: all that a kernel, a start state, an event, an output or a section is made from."""
    known: Known = {}

    def of(expression: Any) -> str:
        return expression_digest(expression, known)

    cut = model.section
    return _digest(
        model.name, repr(model.bound), model.start,
        *(f"state {s.name} {s.start!r} {s.cyclic!r} {of(model.equations[s])}" for s in model.states),
        *(f"parameter {p.name} {p.order}" for p in model.parameters),
        *(f"harmonic {of(w)}" for w in model.harmonics),
        *(f"default {p.name} {of(e)}" for p, e in model.defaults.items()),
        *(f"output {name} {of(o.expression)}" for name, o in model.outputs.items()),
        *(f"stop {name} {of(s.gap)} {of(s.reachable)}" for name, s in model.stops.items()),
        *(f"switching {name} {of(q.surface)}" for name, q in model.switchings.items()),
        *([] if model.teeth is None else [f"teeth {of(model.teeth)}"]),
        *(f"table {_shape(table)}" for table in model.tables),
        *([f"section {of(cut.surface)} {cut.direction}"] if cut else []),
        *(f"clock {name} {of(rate)}" for name, rate in model.clocks.items()),
        *(f"alike {' '.join(s.name for s in group)}" for group in model.alike),
        f"typical time {of(model.typical_time)}",
    )  # fmt: skip


def _shape(table: Table) -> str:
    """All of a table but its functions, which are called and never written into a cached answer."""
    held = ((f.name, getattr(table, f.name)) for f in fields(table))
    return " ".join(f"{name} {value!r}" for name, value in held if not callable(value))


def _digest(*parts: str) -> str:
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()
