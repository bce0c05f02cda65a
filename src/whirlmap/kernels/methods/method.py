"""An explicit Runge-Kutta method as the kernels need it: its coefficients, and their reference."""

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
    def nystroem(self) -> tuple[tuple[Fraction, ...], ...]:
        """Nystroem coefficients A^2: positions directly from accelerations, at every stage and at the end of the step.

        Order conditions make some of them zero; what rounded coefficients leave of those is dropped.
        """
        found = []
        for row in (*self.a, self.b):
            sums = [Fraction(0)] * len(row)
            for weight, inner in zip(row, self.a, strict=False):
                for j, coefficient in enumerate(inner):
                    sums[j] += Fraction(weight) * Fraction(coefficient)
            found.append(tuple(s if abs(s) > 1e-12 else Fraction(0) for s in sums))
        return tuple(found)

    def slope_slots(self, *, nystroem: bool) -> tuple[int, ...]:
        """Storage slot of each stage derivative, reused after its last use.

        ``nystroem`` says whether positions are integrated directly from accelerations.
        """
        tables = ((*self.a, self.b), self.nystroem) if nystroem else ((*self.a, self.b),)
        last = list(range(self.stages))
        for table in tables:
            for i, row in enumerate(table):
                last = [max(end, i) if j < len(row) and row[j] else end for j, end in enumerate(last)]
        slots: list[int] = []
        for i in range(self.stages):
            taken = {slots[j] for j in range(i) if last[j] >= i}
            slots.append(min(set(range(self.stages)) - taken))
        return tuple(slots)
