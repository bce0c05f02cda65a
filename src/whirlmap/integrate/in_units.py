"""Results in engineering units, for tables, CSV files and pictures of a system whose case has dimensions."""

from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import RangeError
from whirlmap.integrate.dimensions import PURE, Dimensions, Unit
from whirlmap.integrate.system import System
from whirlmap.integrate.varied_inputs import groups_of, input_of
from whirlmap.results.findings import Findings, Variable
from whirlmap.units import factor

if TYPE_CHECKING:
    import xarray as xr

Result = TypeVar("Result", Findings, "xr.Dataset")

#: Units of a Dataset's variables that stand for the model's own time, and the measure of each.
OF_TIME = {"time": "time", "1/time": "rate"}
#: Variables of another measure than their unit, that of time, says: rates of states, whose own units differ.
OTHER = {"drift_rate": "", "min_film": "length", "max_load": "force"}
#: Variables with a number for each state or output, which the coordinate of their last such dimension names.
EACH = {
    "x": "state", "section": "state", "outputs": "output", "equilibrium": "state", "start_state": "state",
    "end_state": "state",
    **dict.fromkeys(
        ("peak_to_peak", "rms", "maximum", "minimum", "mean", "clock_amplitude", "spectrum"), "quantity"
    ),
}  # fmt: skip


def in_units(system: System, result: Result) -> Result:
    """Convert a result from the model's own units to those of its engineers: um, mm/s, N, rpm, s, 1/s and Hz.

    Parameters
    ----------
    system : System
        What the result was computed from.
    result : xr.Dataset or Findings
        Of `simulate`, `section`, `lyapunov_spectrum`, `bifurcation_diagram`, `regime_map`, `label_points`, `diagnose`,
        `attractors`, `basins`, `safe_speeds`, `campbell` or `continue_orbit`.

    Returns
    -------
    xr.Dataset or Findings
        With the same variables. Their attribute ``units`` says the unit; ``unit_of_each`` does so for every state, output
        or quantity. What the case does not give a unit, as every result of a case without dimensions, is returned as it is.

    Raises
    ------
    RangeError
        The result is one of another case, or was converted before.

    Notes
    -----
    Factors are those that the family's groups declare (`Groups.units`); where a size depends on a swept speed, as N or s
    do, each point has its own. Numbers are multiplied, nothing is computed anew, and codes, counts and shares stay.
    """
    of, done = result.attrs.get("case"), result.attrs.get("in_units")
    if of not in (None, system.case):
        raise RangeError(f"in_units: found a result of {of}, and the system of {system.case}")
    if done:
        raise RangeError("in_units: found a result that is in engineering units already")
    return shown_in(Dimensions(system), result)


def shown_in(units: Dimensions, result: Result) -> Result:
    """Convert a result from the model's own units to these; see `in_units`."""
    if not units.known:
        return result
    found = result if isinstance(result, Findings) else Findings.of(result)
    every = {**found.coordinates, **found.variables}
    varied = {name: every[name] for name in units.system.parameters if name in every}
    converted = _Converter(units.system, units, every, varied, _varied_inputs(units.system, every))
    made = Findings(
        {name: converted(name, variable) for name, variable in found.variables.items()},
        {name: converted(name, variable) for name, variable in found.coordinates.items()},
        {**found.attrs, "in_units": "um, mm/s, N, rpm, s, 1/s, Hz"},
    )  # fmt: skip
    return made if isinstance(result, Findings) else made.dataset()


def _varied_inputs(system: System, every: dict[str, Variable]) -> dict[str, Variable]:
    """Dimensional inputs that a result was swept over, in their declared units."""
    groups, found = groups_of(system), dict[str, Variable]()
    for name, (dims, values, *attrs) in every.items() if groups else ():
        declared = input_of(system, name)
        if groups and declared and dims in (name, (name,)) and name not in system.parameters and declared.unit != "degC":
            size = float(factor(attrs[0]["units"], declared.unit))
            found |= dict.fromkeys(groups.shared.get(name, (name,)), (name, np.asarray(values) * size))
    return found


class _Converter:
    """Converts one variable after another of a result."""

    def __init__(
        self, system: System, units: Dimensions, every: dict[str, Variable], varied: dict[str, Variable],
        inputs: dict[str, Variable],
    ) -> None:  # fmt: skip
        self.system, self.units, self.every, self.varied, self.inputs = system, units, every, varied | inputs, inputs
        self.dims: dict[str, tuple[str, ...]] = {name: _dims(variable) for name, variable in self.varied.items()}

    def __call__(self, name: str, variable: Variable) -> Variable:
        """Return a variable in its engineering unit."""
        dims, values, attrs = _dims(variable), np.asarray(variable[1]), dict(variable[2]) if len(variable) > 2 else {}
        along = EACH.get(name)
        if along in dims and along in self.every:
            return self._each(dims, values, attrs, along)
        own = name.removeprefix("event_")  # the varied parameter at events of branches
        if own in self.system.parameters or (name in dims and name in (*self.system.states, *self.system.model.outputs)):
            found = self._quantity(own, dims)
        else:
            measure = OTHER.get(name, attrs.get("measure") or OF_TIME.get(attrs.get("units", ""), ""))
            found = self._measure(measure, dims)
        if found.unit == PURE.unit:
            return variable
        words = {"long_name": "speed of the first shaft"} if own == self.system.speed else {}
        return dims, values * found.size, {**attrs, **words, "units": found.unit}

    def _each(self, dims: tuple[str, ...], values: NDArray[Any], attrs: dict[str, Any], along: str) -> Variable:
        place = dims.index(along)
        rest = tuple(d for d in dims if d != along)
        out, said = np.array(values, dtype=float), []
        for i, name in enumerate(np.asarray(self.every[along][1]).tolist()):
            found = self._quantity(str(name), rest)
            part = (slice(None),) * place + (i,)
            out[part] *= found.size
            said.append(found.unit)
        return dims, out, {**attrs, "unit_of_each": " ".join(said)}

    def _quantity(self, name: str, dims: tuple[str, ...]) -> Unit:
        if name == self.system.speed:
            others = {n: np.asarray(v[1]) for n, v in self.inputs.items() if not set(self.dims[n]) <= set(dims)}
            if any(np.ptp(self.units.worth("rotation", **{n: v})) > 0 for n, v in others.items()):
                return PURE  # another speed at each value of an input that it is not over
            # Speeds are proportional to it.
            return self._spread(dims, lambda values: self.units.quantity(name, **{**values, name: 1.0}))
        return self._spread(dims, lambda values: self.units.quantity(name, **values))

    def _measure(self, measure: str, dims: tuple[str, ...]) -> Unit:
        return self._spread(dims, lambda values: self.units.of(measure, **values))

    def _spread(self, dims: tuple[str, ...], measured: Any) -> Unit:
        """A unit whose size may differ from point to point, laid out along the dimensions of a variable."""
        values = {
            name: _laid_out(np.asarray(variable[1], dtype=float), self.dims[name], dims)
            for name, variable in self.varied.items() if set(self.dims[name]) <= set(dims)
        }  # fmt: skip
        found = measured(values)
        assert isinstance(found, Unit)
        return found


def _dims(variable: Variable) -> tuple[str, ...]:
    return (variable[0],) if isinstance(variable[0], str) else tuple(variable[0])


def _laid_out(values: NDArray[np.float64], own: tuple[str, ...], dims: tuple[str, ...]) -> NDArray[np.float64]:
    """Values over their own dimensions, ready to be multiplied with an array of others."""
    order = [own.index(d) for d in dims if d in own]
    sizes = dict(zip(own, values.shape, strict=True))
    return values.transpose(order).reshape([sizes.get(d, 1) for d in dims])
