"""Explicit Runge-Kutta methods: a name, an order, coefficients and where they come from."""

from dataclasses import dataclass
from fractions import Fraction

from whirlmap.errors import RangeError, nearest


@dataclass(frozen=True)
class Method:
    """An explicit Runge-Kutta method.

    Attributes
    ----------
    a : tuple of tuples
        Row i holds the coefficients of stages 0..i-1 in stage i.
    b, c : tuple
        Weights of the stages, and their times in units of the step.
    """

    name: str
    order: int
    a: tuple[tuple[float | Fraction, ...], ...]
    b: tuple[float | Fraction, ...]
    c: tuple[float | Fraction, ...]
    source: str

    @property
    def stages(self) -> int:
        """Number of stages."""
        return len(self.b)


half = Fraction(1, 2)

#: The classical fourth-order method, which the paper uses.
RK4 = Method(
    name="rk4",
    order=4,
    a=((), (half,), (Fraction(0), half), (Fraction(0), Fraction(0), Fraction(1))),
    b=(Fraction(1, 6), Fraction(1, 3), Fraction(1, 3), Fraction(1, 6)),
    c=(Fraction(0), half, half, Fraction(1)),
    source="kutta1901",
)

METHODS = {method.name: method for method in (RK4,)}


def method(name: str) -> Method:
    """Return the method of that name, or raise `RangeError` with the nearest one."""
    if name not in METHODS:
        raise RangeError(f"there is no method {name!r}.{nearest(name, METHODS)}\n  methods: {', '.join(METHODS)}")
    return METHODS[name]
