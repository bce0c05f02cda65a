"""A model's right-hand side for one operating point at a time, as Numba for SciPy and as C: the same generated lines."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sympy import Expr, Function, Integer, sympify
from sympy.printing.pycode import PythonCodePrinter

from whirlmap.equations.model import Model
from whirlmap.errors import ModelError
from whirlmap.kernels.lowering.formulas import HoistedFunction
from whirlmap.kernels.lowering.lower import Hoisted, Straight, local_name, straight
from whirlmap.kernels.lowering.powers import product_of_roots, quarters_of
from whirlmap.kernels.writing.routine import FAST_MATH
from whirlmap.kernels.writing.vector import LIBRARY

Array = NDArray[np.float64]

NUMBA = '''from math import {library}, pow, sqrt

import numpy as np
from numba import njit


@njit(error_model="numpy", fastmath={{{fast}}})
def rhs(t, y, p):
    dy = np.empty({states})
{body}
    return dy
'''


#: Functions of Python's math module and of C's, which have the same names there.
CALLED = ("sin", "cos", *(name for name in LIBRARY if name != "power"))


class _Printer(PythonCodePrinter):
    """Plain arithmetic on scalars: powers as products, tables as the locals that hold them."""

    def _print_Pow(self, expr: Any, **_: Any) -> str:
        base, exponent = expr.args
        text = self.parenthesize(base, 100)
        if not isinstance(exponent, Integer) or exponent < 1:
            raise ModelError(f"power {expr} reached the printer")
        n = int(exponent)
        if n == 4 or n == 8:
            inner = f"({text}*{text})"
            return inner + "*" + inner if n == 4 else "*".join([inner] * 4)
        return "(" + "*".join([text] * n) + ")"

    def _print_power(self, expr: Any) -> str:
        quarters = quarters_of(expr.args[1])
        if quarters is not None:
            return self._print(product_of_roots(expr.args[0], quarters))
        return f"pow({self._print(expr.args[0])}, {self._print(expr.args[1])})"

    def _print_root(self, expr: Any) -> str:
        return f"sqrt({self._print(expr.args[0])})"

    def _print_inverse(self, expr: Any) -> str:
        return f"(1.0/({self._print(expr.args[0])}))"

    def _print_Integer(self, expr: Any) -> str:
        return f"{int(expr)}.0"

    def _print_Rational(self, expr: Any) -> str:
        return repr(float(expr))

    def _print_NumberSymbol(self, expr: Any) -> str:
        return repr(float(expr))

    _print_Pi = _print_NumberSymbol

    def _print_Float(self, expr: Any) -> str:
        return repr(float(expr))

    def _print_Piecewise(self, expr: Any) -> str:
        out = ""
        for value, condition in expr.args:
            if condition == True:  # noqa: E712 (SymPy's own truth)
                return f"({out}({self._print(value)}))"
            out += f"({self._print(value)}) if ({self._print(condition)}) else "
        raise ModelError(f"guarded term without a default: {expr}")

    def _print_sign(self, expr: Any) -> str:
        text = self._print(expr.args[0])
        return f"(1.0 if {text} > 0.0 else (-1.0 if {text} < 0.0 else 0.0))"

    def _print_Abs(self, expr: Any) -> str:
        return f"abs({self._print(expr.args[0])})"

    def _print_Function(self, expr: Any) -> str:
        name = type(expr).__name__
        if name not in CALLED:
            raise ModelError(f"function {name} cannot be lowered")
        return f"{name}({', '.join(self._print(a) for a in expr.args)})"


for _name in CALLED:
    setattr(_Printer, f"_print_{_name}", _Printer._print_Function)

_PRINTER = _Printer({"fully_qualified_modules": False})

#: Functions that this code knows. SymPy's printer would print others, which Numba then refuses in its own words.
KNOWN = {*CALLED, "power", "sign", "Abs", "root", "inverse", "Piecewise"}


def code(expression: Expr) -> str:
    """Print one lowered expression as Python source on floats."""
    for call in expression.atoms(Function):
        if type(call).__name__ not in KNOWN:
            raise ModelError(f"function {type(call).__name__} cannot be lowered: {call}")
    return _PRINTER.doprint(expression)


@dataclass(frozen=True, eq=False)
class ScalarCode:
    """Straight-line code of a model that reads no table.

    Attributes
    ----------
    hoisted : Hoisted
        The inputs ``p``.
    lines : Straight
    frequencies : tuple of str
        Code of each harmonic's frequency.
    """

    model: Model
    hoisted: Hoisted
    lines: Straight
    frequencies: tuple[str, ...]

    def assignments(self) -> list[tuple[str, str]]:
        """Names and code of the shared expressions, in order."""
        return [(step[0].name, code(step[1])) for step in self.lines.steps if isinstance(step, tuple)]

    def results(self) -> list[str]:
        """Code of the rate of each state."""
        return [code(result) for result in self.lines.results]

    def inputs(self, used: set[str]) -> list[tuple[str, str, int]]:
        """Name, array and row of each state and input that is read."""
        rows = [(local_name(s), "y", i) for i, s in enumerate(self.model.states)]
        rows += [(q.name, "p", i) for i, q in enumerate(self.hoisted.symbols)]
        return [row for row in rows if row[0] in used]


def evaluate_inputs(hoisted: Hoisted, values: Array) -> Array:
    """Inputs of many points, shape (input, point), from values of shape (parameter, point)."""
    return HoistedFunction.of(hoisted.parameters, hoisted.expressions).evaluate(values)


@lru_cache(maxsize=8)
def scalar_code(model: Model) -> ScalarCode:
    """Lower a model for one point at a time.

    Raises
    ------
    ModelError
        Where the model reads a table.
    """
    if model.tables:
        raise ModelError(f"{model.name} reads a table; code for one point at a time is written for closed forms only")
    hoisted = Hoisted(model.parameters)
    lines = straight(model, [model.equations[s] for s in model.states], hoisted)
    frequencies = straight(model, [sympify(w) for w in model.harmonics], hoisted)
    assert not frequencies.steps, "a frequency depends on parameters alone, so it is one input of the code, or a number"
    return ScalarCode(model, hoisted, lines, tuple(code(w) for w in frequencies.results))


@lru_cache(maxsize=8)
def numba_rhs(model: Model) -> Any:
    """Compile ``rhs(t, y, p) -> dy``; ``p`` is a column of ``evaluate_inputs``."""
    made = scalar_code(model)
    used = made.lines.names() | set(made.frequencies)
    body = [f"{name} = {array}[{i}]" for name, array, i in made.inputs(used)]
    for i, w in enumerate(made.frequencies):
        body += [f"c{i} = cos({w} * t)", f"s{i} = sin({w} * t)"]
    body += [f"{name} = {value}" for name, value in made.assignments()]
    body += [f"dy[{i}] = {value}" for i, value in enumerate(made.results())]
    text = NUMBA.format(
        library=", ".join(CALLED), fast=", ".join(repr(f) for f in FAST_MATH), states=model.dimension,
        body="\n".join(f"    {b}" for b in body),
    )  # fmt: skip
    names: dict[str, Any] = {}
    exec(compile(text, f"rhs of {model.name}", "exec"), names)
    return names["rhs"]
