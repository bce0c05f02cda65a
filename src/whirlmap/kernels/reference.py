"""The oracle: a model's equations in plain NumPy, tables replaced by the exact functions that they stand for."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sympy import Expr, Function, cos, lambdify, sin, sympify

from whirlmap.equations.model import Model
from whirlmap.equations.pieces import Table, tabulated
from whirlmap.equations.quantities import t
from whirlmap.errors import ModelError

Array = NDArray[np.float64]


@lru_cache(maxsize=64)
def reference_rates(model: Model, *, forced: bool = True) -> Callable[[ArrayLike, ArrayLike, ArrayLike], Array]:
    """Return ``rates(time, x, values)`` of a model.

    ``x`` has shape (state,) or (state, point), ``values`` (parameter,) or (parameter, point); the result is as ``x``.
    Nothing of the lowering is used, so that this is a check of it. Without ``forced`` every harmonic of time is zero, and
    tables are replaced by what they are fitted to: equilibria are searched with it, at many points.
    """
    functions: dict[str, Callable[..., Array]] = {}
    expressions = [_without_tables(sympify(model.equations[s]), model, functions, exact=forced) for s in model.states]
    if not forced:
        expressions = [e.replace(lambda a: isinstance(a, cos | sin) and a.has(t), lambda _: 0) for e in expressions]
    # Shared subexpressions only where speed matters: the oracle itself repeats every term as it stands in the model.
    compiled = lambdify(
        [t, list(model.states), list(model.parameters)], expressions, modules=[functions, "numpy"], cse=not forced
    )

    def rates(time: ArrayLike, x: ArrayLike, values: ArrayLike) -> Array:
        x = np.asarray(x, dtype=float)
        rows = compiled(time, list(x), list(np.asarray(values, dtype=float)))
        return np.stack([np.broadcast_to(np.asarray(row, dtype=float), x.shape[1:]) for row in rows])

    return rates


@lru_cache(maxsize=64)
def reference_outputs(model: Model) -> Callable[[Array, Array], Array]:
    """Return ``outputs(x, values)`` of a model: (state, point), (parameter, point) -> (output, point)."""
    functions: dict[str, Callable[..., Array]] = {}
    expressions = [_without_tables(sympify(o.expression), model, functions, exact=True) for o in model.outputs.values()]
    compiled = lambdify([list(model.states), list(model.parameters)], expressions, modules=[functions, "numpy"])

    def outputs(x: Array, values: Array) -> Array:
        rows = [np.broadcast_to(np.asarray(row, dtype=float), x.shape[1:]) for row in compiled(list(x), list(values))]
        return np.array(rows).reshape(len(expressions), *x.shape[1:])

    return outputs


def _without_tables(
    expression: Expr, model: Model, functions: dict[str, Callable[..., Array]], *, exact: bool
) -> Expr:
    tables = {table.name: _once(table, table.exact if exact else table.samples) for table in model.tables}

    def replace(e: tabulated) -> Expr:
        if any(e.orders):
            raise ModelError("derivatives of a table have no exact function here; difference the rates instead")
        name = f"{e.table_name}_{e.output}"
        functions[name] = _output(tables[e.table_name], e.output)
        return Function(name)(e.parameter, *e.coordinates)

    return expression.replace(lambda e: isinstance(e, tabulated), replace)


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
