"""What a machine's numbers are counted in: one rule for the dimensionless groups of every part.

Lengths are over the radial clearance c_0 of the first film of the reference shaft, or of the machine (a machine without
films counts in 0.1 mm), masses over the mass m_0 of that
shaft, stiffnesses over its stiffness K_0 on rigid bearings, so that forces are over K_0 c_0. Time is counted in radians of
the clock, the reference shaft; s is its speed over omega_0 = sqrt(K_0/m_0). For the paper's pinion these are its groups.
"""

from dataclasses import dataclass

from sympy import Expr, Float, Integer, Symbol, sqrt

from whirlmap.equations.quantities import Parameter

#: The speed, and the weight of a mass m_0, which every part shares.
s = Parameter("s", "1", "speed ratio: speed of the reference shaft over omega_0", measure="rotation", above=0)
f = Parameter("f", "1", "weight g/(omega_0^2 c_0) of a mass m_0 over K_0 c_0", at_least=0)

#: Unit of states that are lengths, and of their rates: the model's own.
LENGTH, RATE = "1", "1"


@dataclass(frozen=True)
class Scale:
    """Inputs that say what the model's units are worth: clearance [m], mass [kg] and stiffness [N/m]."""

    c_0: Expr
    m_0: Parameter
    K_0: Parameter

    @property
    def omega_0(self) -> Expr:
        """Speed at which s = 1 [rad/s]."""
        return sqrt(self.K_0 / self.m_0)

    @property
    def force(self) -> Expr:
        """Unit of forces [N]."""
        return self.K_0 * self.c_0


def number(value: float) -> Expr:
    """A number of the equations: exact where it is whole."""
    return Integer(int(value)) if float(value).is_integer() else Float(float(value))


def linear_form(weights: "list[float]", terms: "list[Expr]") -> Expr:
    """Sum of terms with numbers for weights, without those of weight zero."""
    return sum((number(w) * e for w, e in zip(weights, terms, strict=True) if w != 0.0), Integer(0))


def is_zero(e: "Expr | Symbol") -> bool:
    """Whether nothing stands there."""
    return bool(e == 0)
