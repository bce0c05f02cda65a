"""The classical fourth-order method, which the paper uses."""

from fractions import Fraction

from whirlmap.kernels.methods.method import Method

half = Fraction(1, 2)

RK4 = Method(
    name="rk4",
    order=4,
    a=((), (half,), (Fraction(0), half), (Fraction(0), Fraction(0), Fraction(1))),
    b=(Fraction(1, 6), Fraction(1, 3), Fraction(1, 3), Fraction(1, 6)),
    c=(Fraction(0), half, half, Fraction(1)),
    source="kutta1901",
)
