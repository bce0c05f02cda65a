"""Expressions of a model as NumPy functions: printed by SymPy once, then read from the cache.

SymPy takes longer to print the expressions of a film than an orbit takes to integrate.
"""

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sympy import Abs, Expr, Symbol, erf, erfc, lambdify
from sympy.core.function import AppliedUndef
from sympy.printing.numpy import NumPyPrinter

from whirlmap.equations.identity import model_digest
from whirlmap.equations.model import Model
from whirlmap.equations.pieces import magnitude
from whirlmap.kernels import cache
from whirlmap.kernels.lowering.normal_form import normal_form

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Formula:
    """What a NumPy function computes.

    Attributes
    ----------
    arguments : sequence of Symbol, or of sequence of Symbol
        A sequence is one argument, a list of arrays.
    expressions : sequence of Expr
        One result for each.
    share : bool
        Whether subexpressions are computed once.
    """

    arguments: Sequence[Symbol | Sequence[Symbol]]
    expressions: Sequence[Any]
    share: bool = False


def numpy_function(
    model: Model, role: str, formula: Callable[[], Formula], calls: Mapping[str, Callable[..., Any]] | None = None
) -> Callable[..., Sequence[Any]]:
    """Return a formula of a model as a function of arrays.

    Parameters
    ----------
    role : str
        What the formula is to the model. Model, role and the source file of ``formula`` name the entry of the cache; the
        formula itself is only asked for where there is none.
    calls : mapping of str to callable, optional
        Functions that the expressions call by name, beside those of NumPy.
    """
    question = f"numpy function\n{model_digest(model)}\n{role}\n{cache.file_digest(inspect.getfile(formula))}"
    text = cache.remembered(question, lambda: numpy_text(formula()), _is_text)
    return _function(text, calls or {})


def numpy_text(formula: Formula) -> str:
    """Write a formula as the source of a Python function, ``formula``, of NumPy arrays."""
    expressions = [normal_form(e) for e in formula.expressions]
    functions = {type(call).__name__ for e in expressions for call in e.atoms(_called())}
    names = {q.name for a in formula.arguments for q in ([a] if isinstance(a, Symbol) else a)}
    made = lambdify(
        [a if isinstance(a, Symbol) else list(a) for a in formula.arguments],
        expressions,
        modules=[dict.fromkeys(functions, None), "numpy"],
        printer=_Printer({"fully_qualified_modules": False, "inline": True, "allow_unknown_functions": True}),
        cse=formula.share,
        dummify=not names.isdisjoint({*vars(np), *SPECIAL}) or None,  # a parameter named exp would hide the function
    )
    head, body = inspect.getsource(made).split("(", 1)
    assert head.startswith("def "), head
    return f"def formula({body}"


#: Functions that the text of a formula may call beside those of NumPy: SciPy is imported where one of them is.
SPECIAL = ("erf", "erfc")


class _Printer(NumPyPrinter):
    """SymPy's, but for conditions of which some hold for all points and others for each: its own stacks them."""

    def _print_And(self, expr: Any) -> str:
        return "(" + " & ".join(self._print(a) for a in expr.args) + ")"

    def _print_Or(self, expr: Any) -> str:
        return "(" + " | ".join(self._print(a) for a in expr.args) + ")"


@dataclass(frozen=True)
class HoistedFunction:
    """The inputs of a kernel as one function of the parameters."""

    count: int
    text: str

    @classmethod
    def of(cls, parameters: Sequence[Symbol], expressions: Sequence[Expr]) -> "HoistedFunction":
        """Write the function of these expressions."""
        return cls(len(expressions), numpy_text(Formula([list(parameters)], expressions, share=True)))

    def evaluate(self, values: Array) -> Array:
        """Compute the inputs for many operating points.

        Parameters
        ----------
        values : array, shape (parameter, point)

        Returns
        -------
        array, shape (input, point)
        """
        out = np.empty((self.count, values.shape[1]))
        for i, row in enumerate(self._compiled(list(values))):
            out[i] = row
        return out

    @cached_property
    def _compiled(self) -> Callable[..., Sequence[Any]]:
        return _function(self.text, {})


def array_function(
    arguments: Sequence[Any], expressions: Sequence[Expr], *, share: bool = False
) -> Callable[..., list[Any]]:
    """NumPy function of a few expressions, for one use; nothing of it is kept.

    Names are replaced, for a parameter named exp would hide the function; not where subexpressions are shared, which large
    expressions ask for.
    """
    plain = [e.replace(magnitude, Abs) for e in expressions]
    special = any(e.has(erf, erfc) for e in plain)  # SciPy is imported where it is needed
    modules = ["scipy", "numpy"] if special else ["numpy"]
    made: Callable[..., list[Any]] = lambdify(arguments, plain, modules, dummify=not share or None, cse=share)
    return made


def _called() -> Any:
    return AppliedUndef


def _is_text(data: Any) -> bool:
    return isinstance(data, str) and data.startswith("def formula(")


def _function(text: str, calls: Mapping[str, Callable[..., Any]]) -> Callable[..., Any]:
    namespace: dict[str, Any] = {**vars(np), **calls}
    if any(f"{name}(" in text for name in SPECIAL):
        from scipy import special

        namespace |= {name: getattr(special, name) for name in SPECIAL}
    exec(text, namespace)
    made: Callable[..., Any] = np.errstate(all="ignore")(namespace["formula"])  # branches that are not chosen may fail
    return made
