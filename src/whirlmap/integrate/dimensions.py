"""Engineering units of a system's numbers: the one place of conversion for tables, files and pictures."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import isfinite, nan
from typing import Any

import numpy as np
from sympy import Expr, Symbol, lambdify

from whirlmap.equations.groups import value_of
from whirlmap.integrate.system import System
from whirlmap.units import convert

#: For each measure its SI unit, and the unit in which engineers write it. `Hz` is not read as a unit, for it does not say
#: whether turns or radians are meant; here it is turns.
WRITTEN = {
    "length": ("m", "um"), "velocity": ("m/s", "mm/s"), "force": ("N", "N"), "rotation": ("rad/s", "rpm"),
    "time": ("s", "s"), "rate": ("1/s", "1/s"), "frequency": ("rad/s", "Hz"),
    "growth": ("1/s", "1/s"), "speed": ("rad/s", "Hz"),
}  # fmt: skip


@dataclass(frozen=True)
class Unit:
    """A unit, and how many of it one of the model's own units is; a pure number has the unit "1"."""

    size: Any
    unit: str


PURE = Unit(1.0, "1")


@dataclass(frozen=True)
class Dimensions:
    """Units of the states, outputs and parameters of a system, and of its time.

    Numbers of a case that does not say what its clearance is stay in the model's own units; with ``own`` all do.
    """

    system: System
    own: bool = False

    @cached_property
    def known(self) -> bool:
        """Whether numbers are converted: the case says what the model's length is."""
        return not self.own and isfinite(self.worth("length"))

    def worth(self, measure: str, **varied: Any) -> Any:
        """Size of the model's unit of a measure in SI; NaN where the case does not give it.

        Parameters
        ----------
        measure : str
            ``length`` [m], ``force`` [N], ``speed`` of the clock [rad/s], ``rotation`` (speed of the first shaft at s = 1)
            [rad/s], ``velocity`` [m/s], ``time`` [s], ``rate`` [1/s], or ``frequency`` [rad/s] and ``growth`` [1/s], both
            over the clock's speed at s = 1, as in a Campbell diagram.
        **varied : array
            Values of parameters that replace the system's own; the result has their shape.
        """
        if measure == "velocity":
            return self.worth("length", **varied) * self.worth("speed", **varied)
        if measure in ("time", "rate"):
            speed = self.worth("speed", **varied)
            return speed if measure == "rate" else 1 / speed
        if measure in ("frequency", "growth"):
            own = float(self.system.values.get(self.system.speed, 1.0))
            return self.worth("speed", **varied) / np.asarray(varied.get(self.system.speed, own))
        settled = self.system.machine
        groups = settled.groups if settled else None
        if settled is None or groups is None or measure not in groups.units:
            return nan
        expression, symbols = groups.units[measure], groups.units[measure].free_symbols
        # The groups of some cases are all given, so that their clearance says nothing; their speeds are still worth showing.
        inputs = {name: settled.given[name] for name in settled.inputs} if measure == "length" else settled.given
        known = {**inputs, **{name: float(value) for name, value in self.system.values.items()}}
        if not {q.name for q in symbols} <= known.keys():
            return nan
        changing = tuple(q for q in sorted(symbols, key=str) if q.name in varied)
        if not changing:
            return float(value_of(expression, known))
        fixed = tuple((q, known[q.name]) for q in sorted(symbols, key=str) if q.name not in varied)
        return _function(expression, changing, fixed)(*(np.asarray(varied[q.name], dtype=float) for q in changing))

    def of(self, measure: str, **varied: Any) -> Unit:
        """The unit in which numbers of a measure are written, and its size; a pure number where the case does not say."""
        if measure not in WRITTEN or not self.known:
            return PURE
        worth, (si, unit) = self.worth(measure, **varied), WRITTEN[measure]
        if not np.isfinite(worth).all():
            return PURE
        return Unit(worth * (1.0 if unit == si else convert(1.0, si, "turn/s" if unit == "Hz" else unit)), unit)

    def quantity(self, name: str, **varied: Any) -> Unit:
        """The unit of a state, an output or a parameter, by its name; the declared one where it has no measure."""
        model = self.system.model
        declared: Any = model.outputs.get(name)
        if declared is None:
            declared = next((q for q in (*model.states, *model.parameters) if q.name == name), None)
        if declared is None:
            return PURE
        found = self.of(declared.measure, **varied)
        return Unit(1.0, declared.unit) if found.unit == PURE.unit else found


@lru_cache(maxsize=64)
def _function(expression: Expr, changing: tuple[Symbol, ...], fixed: tuple[tuple[Symbol, float], ...]) -> Callable[..., Any]:
    """An expression as a function of arrays: many states of a result ask for the same one."""
    made: Callable[..., Any] = lambdify(changing, expression.subs(dict(fixed)), "numpy")
    return made
