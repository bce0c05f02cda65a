"""Loops compiled by Numba once: their machine code is cached with that of the kernels, and called without importing Numba.

Importing Numba takes longer than most commands.
"""

import hashlib
from collections.abc import Callable, Mapping, Sequence
from functools import cache, wraps
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.kernels.cache import stored
from whirlmap.kernels.running.machine import Code, Function, only_function, platform
from whirlmap.kernels.writing.routine import Kind
from whirlmap.results.provenance import package_version

#: Where Numba's functions put what they return and raise, which loops do not.
_NOTHING = np.empty(1)
#: Parts that were compiled in this process.
_PARTS: dict[Callable[..., Any], Any] = {}


def compiled(
    arguments: Mapping[str, Kind], *, parts: Sequence[Callable[..., Any]] = (), **options: Any
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Compile a loop of numbers and arrays at its first call; it is called with all arguments by name.

    Parameters
    ----------
    arguments : mapping of str to kind
        Of the loop, in their order. An array is one row of numbers in it, whatever its shape. The loop returns nothing,
        raises nothing, reserves no memory and calls nothing but mathematical functions.
    parts : sequence of callables, optional
        Functions that the loop calls, written as loops are but that they return numbers; each may call those before it.
        Their annotations say what they take: int, float, and arrays of either.
    **options
        Of `numba.cfunc`.
    """

    def decorate(loop: Callable[..., None]) -> Callable[..., None]:
        name = loop.__name__.strip("_")

        @cache
        def made() -> Function:
            file = f"loop_{name}_{_key(loop, parts)}.o"
            code = Code(lambda: stored(file, lambda: _object_code(loop, name, arguments, parts, options)))
            return code.function(name, {"returned": "doubles", "raised": "doubles", **arguments})

        @wraps(loop)
        def call(**values: Any) -> None:
            made()(returned=_NOTHING, raised=_NOTHING, **values)

        return call

    return decorate


def _key(loop: Callable[..., None], parts: Sequence[Callable[..., Any]] = ()) -> str:
    """Hash of all that the machine code of a loop depends on: its files with their constants, and what compiles them."""
    files = dict.fromkeys([*(f.__code__.co_filename for f in (loop, *parts)), __file__])
    sources = [Path(file).read_text(encoding="utf-8") for file in files]
    depends = [*sources, f"numba {package_version('numba')}", platform()]
    return hashlib.sha256("\n".join(depends).encode()).hexdigest()[:32]


def _object_code(
    loop: Callable[..., None], name: str, arguments: Mapping[str, Kind], parts: Sequence[Callable[..., Any]],
    options: Mapping[str, Any],
) -> bytes:  # fmt: skip
    from numba import cfunc, njit, types

    doubles, ints = types.CPointer(types.float64), types.CPointer(types.int64)
    known: dict[str, Any] = {}

    def seeing(function: Callable[..., Any]) -> FunctionType:
        """The function, with its compiled parts under their names."""
        return FunctionType(function.__code__, {**function.__globals__, **known}, function.__name__, function.__defaults__)

    for part in parts:
        if part not in _PARTS:  # for types that are said it is compiled once, not anew for every literal it is called with
            taken = {int: types.int64, float: types.float64, NDArray[np.float64]: doubles, NDArray[np.int64]: ints}
            signature = tuple(taken[kind] for name, kind in part.__annotations__.items() if name != "return")
            _PARTS[part] = njit(signature, error_model="numpy")(seeing(part))
        known[part.__name__] = _PARTS[part]
    kinds = {"doubles": doubles, "ints": ints, "int": types.int64}
    made = cfunc(types.void(*map(kinds.__getitem__, arguments.values())), error_model="numpy", **options)(seeing(loop))
    return only_function(made.inspect_llvm(), made.native_name, name)
