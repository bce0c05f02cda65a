"""Loops that Numba compiles once: their machine code is kept with that of the kernels, and called without Numba.

Importing Numba takes longer than most of what is asked for.
"""

import hashlib
from collections.abc import Callable, Mapping
from functools import cache, wraps
from pathlib import Path
from typing import Any

import numpy as np

from whirlmap.kernels.cache import stored
from whirlmap.kernels.machine import Code, Function, only_function, platform
from whirlmap.kernels.routine import Kind
from whirlmap.results.provenance import package_version

#: Where Numba's functions put what they return and raise, which loops do not.
_NOTHING = np.empty(1)


def compiled(arguments: Mapping[str, Kind], **options: Any) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Compile a loop of numbers and arrays at its first call; it is called with all arguments by name.

    Parameters
    ----------
    arguments : mapping of str to kind
        Of the loop, in their order. An array is one row of numbers in it, whatever its shape. The loop returns nothing,
        raises nothing, reserves no memory and calls nothing but mathematical functions.
    **options
        Of `numba.cfunc`.
    """

    def decorate(loop: Callable[..., None]) -> Callable[..., None]:
        name = loop.__name__.strip("_")

        @cache
        def made() -> Function:
            code = Code(lambda: stored(f"loop_{name}_{_key(loop)}.o", lambda: _object_code(loop, name, arguments, options)))
            return code.function(name, {"returned": "doubles", "raised": "doubles", **arguments})

        @wraps(loop)
        def call(**values: Any) -> None:
            made()(returned=_NOTHING, raised=_NOTHING, **values)

        return call

    return decorate


def _key(loop: Callable[..., None]) -> str:
    """Hash of all that the machine code of a loop depends on: its file with its constants, and what compiles it."""
    sources = [Path(file).read_text(encoding="utf-8") for file in (loop.__code__.co_filename, __file__)]
    parts = [*sources, f"numba {package_version('numba')}", platform()]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:32]


def _object_code(loop: Callable[..., None], name: str, arguments: Mapping[str, Kind], options: Mapping[str, Any]) -> bytes:
    from numba import cfunc, types

    kinds = {"doubles": types.CPointer(types.float64), "ints": types.CPointer(types.int64), "int": types.int64}
    signature = types.void(*(kinds[kind] for kind in arguments.values()))
    made = cfunc(signature, error_model="numpy", **options)(loop)
    return only_function(made.inspect_llvm(), made.native_name, name)
