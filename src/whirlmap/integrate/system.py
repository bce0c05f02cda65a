"""A system: a model with numbers, ready to integrate."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.cases import Resolved
from whirlmap.equations.model import Model
from whirlmap.equations.quantities import Parameter
from whirlmap.errors import CaseError, RangeError, nearest
from whirlmap.integrate.evaluation import Evaluator
from whirlmap.integrate.harmonics import common_multiple, exact_order, harmonic_orders, periods, repeats, strobe
from whirlmap.integrate.plain_models import plain_model
from whirlmap.integrate.system_listing import system_listing
from whirlmap.kernels.running.reference import reference_rates
from whirlmap.results.listing import Listed, Listing

Array = NDArray[np.float64]


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
                return plain_model(self.model, parameter)
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
