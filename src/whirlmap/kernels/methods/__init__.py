"""Explicit Runge-Kutta methods, each a file of coefficients with its reference."""

from whirlmap.kernels.methods.dop853 import DOP853
from whirlmap.kernels.methods.method import Method
from whirlmap.kernels.methods.rk4 import RK4
from whirlmap.kernels.methods.tsit5 import TSIT5
from whirlmap.options.refused import refuse_method

METHODS = {method.name: method for method in (RK4, TSIT5, DOP853)}

__all__ = ["DOP853", "METHODS", "RK4", "TSIT5", "Method", "method"]


def method(name: str) -> Method:
    """Return the method of that name, or raise `RangeError` with the nearest one."""
    refuse_method(name)
    return METHODS[name]
