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

    @property
    def homes(self) -> tuple[int, ...]:
        """Place of each stage's slopes: a place is free again once no later stage needs what lies there."""
        last = [max([i for i in range(j + 1, self.stages) if self.a[i][j]], default=j) for j in range(self.stages)]
        last = [self.stages if self.b[j] else last[j] for j in range(self.stages)]
        homes: list[int] = []
        for i in range(self.stages):
            taken = {homes[j] for j in range(i) if last[j] >= i}
            homes.append(min(set(range(self.stages)) - taken))
        return tuple(homes)
