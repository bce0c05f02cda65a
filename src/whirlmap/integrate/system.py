"""A system: a model with numbers, ready to integrate."""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from math import lcm, pi
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sympy import Expr, Rational, sympify

from whirlmap.cases import Resolved
from whirlmap.equations.model import Model
from whirlmap.equations.quantities import Parameter
from whirlmap.errors import CaseError, RangeError, nearest
from whirlmap.integrate.evaluation import Evaluator
from whirlmap.integrate.system_listing import system_listing
from whirlmap.kernels.lowering.formulas import Formula, numpy_function
from whirlmap.kernels.running.reference import reference_rates
from whirlmap.results.listing import Listed, Listing

Array = NDArray[np.float64]


#: Longest common period, in T, that returns are counted in. A longer one is none that a motion is seen to return after.
LONGEST = 128
#: Largest denominator of an order that counts as a ratio of integers, and of one that stands for any other number.
SIMPLE, FINEST = 10_000, 10**12


def exact_order(value: Any, name: str) -> Fraction | None:
    """Read the order of a harmonic exactly: an integer, a Fraction, text as "1/4", or a float that equals p/q.

    A float counts as p/q with q <= 10 000 where it agrees to 1e-12; else there is no exact order, and the result is None.
    """
    if isinstance(value, int | Fraction):
        return Fraction(value)
    if isinstance(value, str):
        try:
            return Fraction(value)
        except (ValueError, ZeroDivisionError):
            raise CaseError(f"{name}: {value!r} is not a ratio of integers such as 1/4") from None
    near = Fraction(float(value)).limit_denominator(SIMPLE)
    return near if abs(float(near) - float(value)) <= 1e-12 else None


def nearest_order(value: float) -> Fraction:
    """Order of a harmonic whose frequency ratio is any number: `exact_order`, else the nearest ratio of integers.

    Its denominator is at most `FINEST`, so that it is as near as rounding: nothing that a run of any length could show.
    """
    exact = exact_order(value, "order")
    return Fraction(value).limit_denominator(FINEST) if exact is None else exact


def common_multiple(orders: Sequence[Fraction]) -> int:
    """Number of T in the common period of harmonics with these orders over the fastest."""
    return lcm(*(order.denominator for order in orders)) if orders else 1


def strobe(orders: Sequence[Fraction]) -> int:
    """Number of T between section points that show returns: `strobe_of` their common period."""
    return strobe_of(common_multiple(orders))


def strobe_of(common: int) -> int:
    """Number of T between section points that show returns: the common period, or one T where that is above `LONGEST`."""
    return common if common <= LONGEST else 1


def repeats(orders: Sequence[Fraction]) -> bool:
    """Whether harmonics with these orders have a common period: all are ratios of integers, and it can be counted."""
    return all(order.denominator <= SIMPLE for order in orders) and common_multiple(orders) < 2**63


def common_multiple_attribute(orders: Sequence[Fraction]) -> dict[str, int]:
    """Attribute of a Dataset that says how many T the common period is; none where there is none."""
    return {"common_multiple": common_multiple(orders)} if repeats(orders) else {}


@dataclass(frozen=True, eq=False, repr=False)
class System(Listed):
    """One operating point of a model.

    Attributes
    ----------
    model : Model
    values : mapping of str to float or Fraction
        A value for every parameter; orders of harmonics as exact fractions where they are exact.
    start : mapping of str to float
        Start values that replace the model's own.
    case : str
        Name of the case that the values come from, for provenance.
    notes : mapping of str to str
        Where each value comes from.
    machine : Resolved, optional
        The case as it was read, with its dimensional inputs; None for a system made of a model and numbers.

    Raises
    ------
    CaseError
        A parameter has no value, or one that the model cannot take.
    RangeError
        A start value of an unknown state, or one that is no finite number.
    """

    model: Model
    values: Mapping[str, Any]
    start: Mapping[str, float] = field(default_factory=dict)
    case: str = ""
    notes: Mapping[str, str] = field(default_factory=dict)
    machine: Resolved | None = None

    def __post_init__(self) -> None:
        """Refuse values that the model cannot take, naming the symbol."""
        for name in self.start:
            if name not in self.states:
                raise RangeError(
                    f"{self.model.name} has no state {name!r}.{nearest(name, self.states)}"
                    f"\n  states: {' '.join(self.states)}"
                )
            if not _finite(self.start[name]):
                raise RangeError(f"start value of {name!r} must be a finite number, not {self.start[name]!r}")
        for p in self.model.parameters:
            if p.name not in self.values:
                raise CaseError(f"{self.model.name}: no value for {p.name!r} ({p.meaning})")
            value = _number(p, self.values[p.name])
            fault = p.fault(value)
            if fault:
                raise CaseError(f"{p.name} = {value:g} {fault} ({p.meaning})")
        for check in self.model.checks:
            fault = check({name: float(value) for name, value in self.values.items()})
            if fault:
                raise CaseError(fault)

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states, in declared order."""
        return tuple(s.name for s in self.model.states)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters, in declared order."""
        return tuple(p.name for p in self.model.parameters)

    @property
    def speed(self) -> str:
        """Name of the parameter that is the speed; empty where the model declares none."""
        return self.model.speed.name if self.model.speed else ""

    @property
    def vector(self) -> Array:
        """Values of the parameters in declared order, shape (parameter,)."""
        return np.array([float(self.values[name]) for name in self.parameters])

    def replace(self, *, start: Mapping[str, float] | None = None, **changes: Any) -> "System":
        """Return the system with other parameter values or start values.

        Parameters
        ----------
        start : mapping of str to float, optional
            Start values that replace those there are, state by state.
        **changes : number or str
            Values of parameters in the model's own units; an order of a harmonic as ``"1/4"``.

        Returns
        -------
        System
            A new one; this one stays.

        Raises
        ------
        CaseError
            A name that is no parameter, or a value that the model cannot take.
        RangeError
            A start value of an unknown state.
        """
        for name in changes:
            if name not in self.parameters:
                input_too = self.machine is not None and name in self.machine.inputs
                hint = f" {name} is a dimensional input of the case, which whirlmap.load takes." if input_too else ""
                raise CaseError(
                    f"{self.model.name} has no parameter {name!r}.{hint or nearest(name, self.parameters)}"
                    f"\n  parameters: {' '.join(self.parameters)}"
                )
        made = {name: _exact(self.model.parameter(name), value) for name, value in changes.items()}
        begin = self.start if start is None else {**self.start, **start}
        return replace(self, values={**self.values, **made}, start=begin)

    @property
    def details(self) -> Resolved | None:
        """Former name of ``machine``."""
        warnings.warn("System.details is System.machine now", DeprecationWarning, stacklevel=2)
        return self.machine

    def at_speed(self, value: float) -> "System":
        """Return the system with another value of its speed parameter.

        Parameters
        ----------
        value : float
            In the parameter's unit.

        Returns
        -------
        System

        Raises
        ------
        RangeError
            The model declares no speed.
        """
        if not self.speed:
            raise RangeError(f"{self.model.name} declares no speed")
        return self.replace(**dict[str, Any]({self.speed: value}))

    @cached_property
    def orders(self) -> tuple[Fraction, ...]:
        """Orders of the harmonics over the fastest: exact, or the nearest ratio of integers (`nearest_order`)."""
        return harmonic_orders(self.model, self.values)

    @property
    def period(self) -> float:
        """Period T of the fastest declared harmonic; for an unforced model its typical time."""
        return float(periods(self.model, self.vector[:, None])[0])

    @property
    def repeats(self) -> bool:
        """Whether the forcing has a common period: all orders are ratios of integers."""
        return repeats(self.orders)

    @property
    def common_multiple(self) -> int:
        """Number of T in the common period of all harmonics; beyond any time where the orders have none."""
        return common_multiple(self.orders)

    @property
    def strobe(self) -> int:
        """Number of T between section points that show returns: the common period, or one T where that is too long."""
        return strobe(self.orders)

    @property
    def common_period(self) -> float:
        """Shortest time after which all declared harmonics repeat."""
        return self.period * self.common_multiple

    def plain_model(self) -> Model:
        """The model's closed form where a parameter is zero and one exists, else the model itself.

        Returns
        -------
        Model
            With the same states and parameters.
        """
        for parameter in self.model.plain:
            if float(self.values[parameter.name]) == 0.0:
                return _plain(self.model, parameter)
        return self.model

    def listing(self) -> Listing:
        """Its numbers, for a terminal and a notebook.

        Returns
        -------
        Listing
            Printed as a table; a notebook shows it as one.
        """
        try:
            period = f"{self.period:.6g}"
            together = f"common period {self.common_multiple} T" if self.repeats else "no common period"
            times = f"period T = {period}, {together}" if self.model.forced else f"unforced, typical time {period}"
        except RangeError as error:  # all frequencies are zero: such a system can be had, and is to be seen too
            times = str(error)
        inputs = self.machine.listing().tables if self.machine else ()
        return system_listing(self.case, self.model, self.values, self.notes, self.start, times, inputs)

    def rhs(self, time: float, x: ArrayLike) -> Array:
        """Rates of the states from the compiled kernel; ``x`` has shape (state,) or (state, lane), so has the result.

        Parameters
        ----------
        time : float
            Model's time; the phase of every harmonic is its order times it.
        x : array, shape (state,) or (state, lane)
            States, in the model's units.

        Returns
        -------
        array, shape of ``x``
            Rates, per unit of the model's time.

        Raises
        ------
        RangeError
            ``x`` has another shape.
        """
        return self._evaluate(time, x, jacobian=False)[0]

    def jacobian(self, time: float, x: ArrayLike) -> Array:
        """Jacobian of the rates from the compiled kernel, shape (state, state) or (state, state, lane).

        Parameters
        ----------
        time : float
            Model's time; the phase of every harmonic is its order times it.
        x : array, shape (state,) or (state, lane)
            States, in the model's units.

        Returns
        -------
        array, shape (state, state) or (state, state, lane)
            Derivative of rate i by state j, per unit of the model's time.

        Raises
        ------
        RangeError
            ``x`` has another shape.
        """
        return self._evaluate(time, x, jacobian=True)[1]

    def reference_rhs(self, time: float, x: ArrayLike) -> Array:
        """Rates of the states from the reference kernel (plain NumPy, exact film).

        Parameters
        ----------
        time : float
            Model's time; the phase of every harmonic is its order times it.
        x : array, shape (state,) or (state, lane)
            States, in the model's units.

        Returns
        -------
        array, shape of ``x``
            Rates, per unit of the model's time: what the compiled ones are tested against.
        """
        values = self.vector if np.ndim(x) == 1 else self.vector[:, None]
        return reference_rates(self.plain_model())(time, x, values)

    def _evaluate(self, time: float, x: ArrayLike, *, jacobian: bool) -> tuple[Array, Array]:
        x = np.asarray(x, dtype=float)
        n = self.model.dimension
        if x.ndim not in (1, 2) or x.shape[0] != n:
            raise RangeError(f"{self.model.name} has {n} states; x has shape {x.shape}, not ({n},) or ({n}, lane)")
        many = x.reshape(n, -1)
        points = np.arange(many.shape[1])
        values = np.repeat(self.vector[:, None], points.size, axis=1)
        rates, dense = Evaluator.of(self.plain_model(), values, jacobian=jacobian)(time, many, points)
        return rates.reshape(x.shape), dense.reshape(n, *x.shape)


def _exact(parameter: Parameter, value: Any) -> Any:
    if parameter.order and isinstance(value, str):
        return exact_order(value, parameter.name)
    number = _number(parameter, value)
    exact = exact_order(value, parameter.name) if parameter.order else None
    return number if exact is None else exact


def _number(parameter: Parameter, value: Any) -> float:
    """A value of a parameter as a float; `CaseError` where it is no number."""
    try:
        return float(value)
    except (TypeError, ValueError):
        raise CaseError(
            f"{parameter.name}: found {value!r}, expected a number ({parameter.meaning}, unit {parameter.unit});"
            " values with units are taken by whirlmap.load"
        ) from None


def _finite(value: Any) -> bool:
    """Whether a value is a finite number; a text is none."""
    return isinstance(value, Real) and bool(np.isfinite(float(value)))


@lru_cache(maxsize=64)
def _plain(model: Model, parameter: Parameter) -> Model:
    return model.plain[parameter]()


@lru_cache(maxsize=64)
def _frequencies(model: Model) -> Callable[..., Any]:
    """Frequency of every harmonic; for an unforced model its typical time."""
    times = model.harmonics if model.forced else (model.typical_time,)
    return numpy_function(model, "frequencies or typical time", lambda: Formula([model.parameters], times))


def frequencies(model: Model, values: Array) -> Array:
    """Angular frequency of every harmonic, shape (harmonic, point); typical time of an unforced model."""
    n = values.shape[1]
    return np.stack([np.broadcast_to(np.asarray(w, dtype=float), (n,)) for w in _frequencies(model)(list(values))])


def periods(model: Model, values: Array) -> Array:
    """Period T of every operating point (values of shape (parameter, point)); typical time of an unforced model."""
    rates = frequencies(model, values)
    if not model.forced:
        return np.asarray(rates[0])
    fastest = np.abs(rates).max(axis=0)
    if not np.all(fastest > 0):
        raise RangeError(f"{model.name}: every declared harmonic has frequency zero, so there is no period T")
    return 2 * pi / fastest


def harmonic_orders(model: Model, values: Mapping[str, Any]) -> tuple[Fraction, ...]:
    """Orders of a model's harmonics over the fastest one, as fractions (`nearest_order`)."""
    if not model.forced:
        return ()
    exact = {}
    for p in model.parameters:
        if p.order:
            order = exact_order(values[p.name], p.name)
            if order is None:
                order = nearest_order(float(values[p.name]))
            exact[p] = Rational(order.numerator, order.denominator)
    harmonics = [sympify(w).xreplace(exact) for w in model.harmonics]
    numbers = {p: float(values[p.name]) for p in model.parameters}
    sizes = [abs(float(w.subs(numbers))) for w in harmonics]
    fastest = harmonics[sizes.index(max(sizes))]
    return _ratios(harmonics, fastest if float(fastest.subs(numbers)) > 0 else -fastest, numbers)


def _ratios(harmonics: list[Expr], fastest: Expr, numbers: Mapping[Any, float]) -> tuple[Fraction, ...]:
    out = []
    for harmonic in harmonics:
        ratio = (harmonic / fastest).simplify()
        if isinstance(ratio, Rational) and ratio.q <= FINEST:  # the quotient of two other numbers' orders is finer
            out.append(Fraction(int(ratio.p), int(ratio.q)))
        else:
            out.append(nearest_order(float(ratio.subs(numbers))))
    return tuple(out)
