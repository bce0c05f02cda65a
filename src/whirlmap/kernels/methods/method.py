"""What an explicit Runge-Kutta method is to the kernels: numbers, and where they come from."""

from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True)
class Method:
    """An explicit Runge-Kutta method.

    Attributes
    ----------
    a : tuple of tuples
        Row i holds the coefficients of stages 0..i-1 in stage i.
    b, c : tuple
        Weights of the stages, and their times in units of the step.
    source : str
        Key of the reference.
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
