"""States, parameters and time: the symbols that models are written in.

A quantity is a SymPy symbol that also carries its unit, its meaning and its limits, so that a declaration reads like
the paper and still says everything that `show`, a Dataset and an error message need.
"""

import re
from math import isfinite
from typing import Any

from sympy import Symbol

from whirlmap.errors import ModelError, nearest

#: What a dimensionless number may be a number of, so that it can be shown in engineering units.
MEASURES = ("length", "velocity", "force", "rotation", "time", "rate", "frequency", "growth", "speed")
#: Beyond any machine; products of a few numbers below it are still floats.
LARGEST = 1e30


#: What is said about a state that is asked for at another time.
DELAYS = (
    "a state at the present time is its name alone, {name}, and one of an earlier time cannot be had: whirlmap solves"
    " ordinary differential equations; expected a chain of states that lag one after the other, or a Pade approximation of"
    " the delay"
)


def refuse_measure(name: str, measure: str) -> None:
    """Refuse a measure that there is not: the quantity would never be shown in engineering units."""
    if measure and measure not in MEASURES:
        expected = f"expected one of {' | '.join(MEASURES)}, or none.{nearest(measure, MEASURES)}"
        raise ModelError(f"{name!r} has the measure {measure!r}, {expected}")


class Quantity(Symbol):
    """A real symbol with unit and meaning.

    Parameters
    ----------
    name : str
        ASCII name, as it is written in files and on the command line.
    unit : str
        Unit as pint writes it; "1" where the quantity is dimensionless.
    meaning : str
        A few words for people.
    latex : str, optional
        How pictures write it; where absent, they write its name as a symbol.
    measure : str, optional
        What a dimensionless quantity is a number of, so that a case with dimensions can be shown in engineering units:
        ``length``, ``velocity``, ``force`` or ``rotation``, whose sizes follow from `Groups.units`.
    """

    unit: str
    meaning: str
    latex: str
    measure: str
    #: What subclasses carry beside these.
    _more: tuple[str, ...] = ()

    def __new__(
        cls, name: str, unit: str, meaning: str, *, latex: str = "", measure: str = "", **_: Any
    ) -> "Quantity":
        """Create the symbol without SymPy's cache of symbols: equal names in two models must not share units."""
        refuse_measure(name, measure)
        made = Symbol.__xnew__(cls, name, real=True)
        made.unit, made.meaning, made.latex, made.measure = unit, meaning, latex, measure
        return made

    def __call__(self, *arguments: Any) -> Any:
        """Refuse ``x(t - tau)``: a symbol is no function of time."""
        shown = f"{self.name}({', '.join(map(str, arguments))})"
        raise ModelError(f"{shown}: {DELAYS.format(name=self.name)}")

    def says(self, word: str) -> bool:
        """Whether its meaning holds a word."""
        return bool(re.search(rf"\b{re.escape(word)}\b", self.meaning.casefold()))

    def __getnewargs_ex__(self) -> tuple[tuple[str, str, str], dict[str, Any]]:
        """Arguments that rebuild the quantity (copying and pickling), limits and all."""
        more = {name: getattr(self, name) for name in self._more}
        return (self.name, self.unit, self.meaning), {"latex": self.latex, "measure": self.measure, **more}


class State(Quantity):
    """A state variable.

    Parameters
    ----------
    start : float
        Value at time zero, where the model does not start from its static equilibrium.
    cyclic : float, optional
        Period of the state where it is an angle: sections, distances and the divergence test take it modulo this.
    """

    start: float
    cyclic: float | None
    _more = ("start", "cyclic")

    def __new__(
        cls,
        name: str,
        unit: str,
        meaning: str,
        *,
        latex: str = "",
        measure: str = "",
        start: float = 0.0,
        cyclic: float | None = None,
    ) -> "State":
        """Create the state."""
        made = Quantity.__new__(cls, name, unit, meaning, latex=latex, measure=measure)
        made.start, made.cyclic = float(start), None if cyclic is None else float(cyclic)
        return made


class Parameter(Quantity):
    """A parameter: a run-time input of the compiled kernel.

    Parameters
    ----------
    above, at_least, below : float, optional
        Limits that a value must keep: strictly above, not less than, strictly below.
    order : bool
        The parameter is the order of a harmonic, an exact ratio of integers. Orders fix the common period, so they
        are constants of a run and never swept.
    """

    above: float | None
    at_least: float | None
    below: float | None
    order: bool
    _more = ("above", "at_least", "below", "order")

    def __new__(
        cls,
        name: str,
        unit: str,
        meaning: str,
        *,
        latex: str = "",
        measure: str = "",
        above: float | None = None,
        at_least: float | None = None,
        below: float | None = None,
        order: bool = False,
    ) -> "Parameter":
        """Create the parameter."""
        made = Quantity.__new__(cls, name, unit, meaning, latex=latex, measure=measure)
        made.above, made.at_least, made.below, made.order = above, at_least, below, order
        return made

    def fault(self, value: float) -> str:
        """Say what a value of this parameter breaks: ``"must be above 0"``; empty where it is allowed."""
        if not isfinite(value):
            return "must be a finite number"
        if abs(value) > LARGEST:
            return f"must be at most {LARGEST:g} in size"
        if self.above is not None and not value > self.above:
            return f"must be above {self.above:g}"
        if self.at_least is not None and not value >= self.at_least:
            return f"must be at least {self.at_least:g}"
        if self.below is not None and not value < self.below:
            return f"must be below {self.below:g}"
        return ""


#: Time, in the model's own unit: clock radians for the gear pair, the equation's time elsewhere.
t = Symbol("t", real=True)


def states(text: str, unit: str, meaning: str, measure: str = "") -> tuple[State, ...]:
    """Declare several states that differ in name only: ``states("x y", "1", "displacement")``."""
    names = text.split()
    if not names:
        raise ModelError("states(...) needs at least one name")
    return tuple(State(name, unit, meaning, measure=measure) for name in names)
