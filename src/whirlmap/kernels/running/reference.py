"""The oracle: a model's equations in plain NumPy, tables replaced by the exact functions that they stand for."""

from collections.abc import Callable
from functools import lru_cache, partial
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sympy import Abs, Expr, Function, cos, sin, sympify

from whirlmap.equations.model import Model
from whirlmap.equations.pieces import Table, magnitude, tabulated
from whirlmap.equations.quantities import t
from whirlmap.errors import ModelError
from whirlmap.kernels.lowering.formulas import Formula, numpy_function
from whirlmap.kernels.lowering.tabulate import reading

Array = NDArray[np.float64]
Reading = Literal["exact", "samples", "read"]


@lru_cache(maxsize=64)
def reference_rates(
    model: Model, *, forced: bool = True, tables: Reading = "exact"
) -> Callable[[ArrayLike, ArrayLike, ArrayLike], Array]:
    """Return ``rates(time, x, values)`` of a model.

    ``x`` has shape (state,) or (state, point), ``values`` (parameter,) or (parameter, point); the result is as ``x``.
    Nothing of the lowering is used, so that this is a check of it. Without ``forced`` every harmonic of time is zero.
    ``tables`` says how they are evaluated: by the exact functions that they stand for, by what they are fitted to
    (``samples``, faster), or read (``read``, a hundred times faster).
    """

    def formula() -> Formula:
        expressions = [_with_functions(sympify(model.equations[s])) for s in model.states]
        if not forced:
            expressions = [e.replace(lambda a: isinstance(a, cos | sin) and a.has(t), lambda _: 0) for e in expressions]
        # Shared subexpressions only where speed matters: the oracle itself repeats every term as it stands in the model.
        return Formula([t, model.states, model.parameters], expressions, share=not forced)

    role = "rates" if forced else "rates with all forcing off"
    compiled = numpy_function(model, role, formula, _table_functions(model, tables))

    def rates(time: ArrayLike, x: ArrayLike, values: ArrayLike) -> Array:
        x = np.asarray(x, dtype=float)
        rows = compiled(time, list(x), list(np.asarray(values, dtype=float)))
        return np.stack([np.broadcast_to(np.asarray(row, dtype=float), x.shape[1:]) for row in rows])

    return rates


@lru_cache(maxsize=64)
def reference_outputs(model: Model) -> Callable[[Array, Array], Array]:
    """Return ``outputs(x, values)`` of a model: (state, point), (parameter, point) -> (output, point)."""

    def formula() -> Formula:
        expressions = [_with_functions(sympify(o.expression)) for o in model.outputs.values()]
        return Formula([model.states, model.parameters], expressions)

    compiled = numpy_function(model, "outputs", formula, _table_functions(model, "exact"))

    def outputs(x: Array, values: Array) -> Array:
        rows = [np.broadcast_to(np.asarray(row, dtype=float), x.shape[1:]) for row in compiled(list(x), list(values))]
        return np.array(rows).reshape(len(model.outputs), *x.shape[1:])

    return outputs


def _with_functions(expression: Expr) -> Expr:
    def replace(e: tabulated) -> Expr:
        if any(e.orders):
            raise ModelError("derivatives of a table have no exact function here; difference the rates instead")
        return Function(f"{e.table_name}_{e.output}")(e.parameter, *e.coordinates)

    return expression.replace(magnitude, Abs).replace(lambda e: isinstance(e, tabulated), replace)


def _table_functions(model: Model, tables: Reading) -> dict[str, Callable[..., Array]]:
    """Functions of a model's tables, by the names that `_with_functions` calls them."""
    functions: dict[str, Callable[..., Array]] = {}
    for table in model.tables:
        ways: dict[Reading, Callable[..., tuple[Array, ...]]] = {
            "exact": table.exact, "samples": table.samples, "read": partial(reading, table)
        }
        once = _once(table, ways[tables])
        functions |= {f"{table.name}_{i}": _output(once, i) for i in range(len(table.outputs))}
    return functions


def _once(table: Table, functions: Callable[..., tuple[Array, ...]]) -> Callable[..., tuple[Array, ...]]:
    """A table's functions; the last few arguments are remembered, for every output asks for the same ones."""
    known: dict[tuple, tuple[Array, ...]] = {}

    def evaluate(parameter: ArrayLike, *coordinates: ArrayLike) -> tuple[Array, ...]:
        values = np.asarray(parameter, dtype=float)
        if values.ndim and np.ptp(values) > 0:
            raise ModelError(f"table {table.name!r} is evaluated at one value of its parameter at a time")
        places = [np.asarray(c, dtype=float) for c in coordinates]
        key = (float(values.flat[0]), *((c.shape, c.tobytes()) for c in places))
        if key not in known:
            if len(known) > 7:
                known.clear()
            known[key] = functions(key[0], *places)
        return known[key]

    return evaluate


def _output(functions: Callable[..., tuple[Array, ...]], index: int) -> Callable[..., Array]:
    return lambda parameter, *coordinates: functions(parameter, *coordinates)[index]
