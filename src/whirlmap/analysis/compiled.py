"""Loops that Numba compiles when they are first called: importing it takes longer than most of what is asked for."""

from collections.abc import Callable
from functools import cache, wraps
from typing import Any, TypeVar, cast

Loop = TypeVar("Loop", bound=Callable[..., Any])


def compiled(**options: Any) -> Callable[[Loop], Loop]:
    """Compile a function of arrays and numbers at its first call, kept on disk; it may call nothing of its own module.

    Numba's cache on disk does not see changes of other functions or of the options, so that whoever changes the options
    changes the function's file with them.
    """

    def decorate(loop: Loop) -> Loop:
        @cache
        def made() -> Callable[..., Any]:
            from numba import njit

            return cast(Callable[..., Any], njit(cache=True, nogil=True, error_model="numpy", **options)(loop))

        @wraps(loop)
        def call(*arguments: Any) -> Any:
            return made()(*arguments)

        return cast(Loop, call)

    return decorate
