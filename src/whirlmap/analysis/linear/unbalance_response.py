"""Synchronous response of the linearised machine to its unbalances, against speed: amplitude, phase, critical speeds."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from sympy import Symbol, sympify

from whirlmap.analysis.linear.amplification import LEAST_POINTS, criticals
from whirlmap.analysis.linear.linearisation import linearised
from whirlmap.analysis.linear.stations import stations_of
from whirlmap.analysis.motion.ensembles import parameter_values
from whirlmap.equations.model import Model
from whirlmap.errors import InputError, RangeError, nearest
from whirlmap.integrate.division import variants
from whirlmap.integrate.evaluation import Evaluator
from whirlmap.integrate.loading import pieces
from whirlmap.integrate.own_units import in_own_units
from whirlmap.integrate.system import System
from whirlmap.kernels.lowering.formulas import Formula, array_function, numpy_function
from whirlmap.results.provenance import provenance
from whirlmap.results.schema import names_coordinate, status_variable, variable, with_attributes
from whirlmap.results.status import Status

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

#: Times at which the forces of an unbalance are read, for each number that they determine.
READINGS = 3
#: What an unbalance does at other frequencies than its own, over what it does there: rounding.
ELSEWHERE = 1e-8
#: Golden section, whose multiples are spread evenly.
GOLDEN = (5**0.5 - 1) / 2
AXES = ("x", "y")


def unbalance_response(
    system: System, name: str, values: ArrayLike, *, stations: Sequence[str] | None = None
) -> xr.Dataset:
    """Amplitude and phase of the linear response to unbalance against the speed (Bode plots), and its critical speeds.

    Parameters
    ----------
    system : System
        Of a model that starts at its static equilibrium and declares its unbalances, its speed and its bodies or stations.
    name : str
        The speed parameter, or the dimensional input that is the speed.
    values : array_like, shape (point,)
        Finite, ascending, at least four; texts with a unit, or the text of a range, ``"500 rpm:6000 rpm:200"``.
    stations : sequence of str, optional
        Places that are probed; all that the model has where absent.

    Returns
    -------
    xr.Dataset
        ``amplitude(rotor, station, axis, name)``: amplitude (half of peak to peak) at the frequency of each rotor's
        unbalance, in the model's length; ``phase(rotor, station, axis, name)``: by which the motion lags behind cos of
        that rotor's turning [rad], unwrapped along the speed. ``major(rotor, station, name)``: semi-major axis of the
        orbit. ``total(station, axis, name)``: peak to peak of all rotors together; ``probe(station, axis)``: the state or
        output that is probed. ``stable(name)``: whether the
        equilibrium is. ``status(name)``: unresolved where no equilibrium was found. ``critical(peak)``: speeds at which
        a semi-major axis has a peak, with ``critical_rotor``, ``critical_station``, ``critical_amplitude``,
        ``critical_low``, ``critical_high`` (half-power speeds, NaN where there is none), ``amplification``.

    Raises
    ------
    InputError
        A station that the model does not have.
    RangeError
        Another parameter than the speed; too few values, or none that ascend; no unbalance; no equilibrium.

    Notes
    -----
    With the Jacobian J at the static equilibrium and the phasor F of an unbalance's part of the rates, which is read from
    the compiled kernel with that unbalance and without, the response at its frequency w is X = (i w - J)^-1 F. Teeth with a
    varying stiffness count with their mean. Where the equilibrium is unstable the response is that of the equations and no
    motion that would be seen. Rotors of different speeds add up to ``total``, which they reach at some time.

    References
    ----------
    [api617] amplification factor and separation margin; [childs1993] unbalance response.
    """
    name, points = in_own_units(system, name, values)
    if name != system.speed:
        expected = system.speed or "a model with a speed"
        raise RangeError(f"{name}: found another parameter than the speed, expected {expected}")
    if points.ndim != 1 or points.size < LEAST_POINTS or not np.isfinite(points).all() or np.any(np.diff(points) <= 0):
        raise RangeError(f"values of {name!r} must be finite and ascend, and be {LEAST_POINTS} or more")
    for end in (points[0], points[-1]):
        at_end: dict[str, Any] = {name: end}
        system.replace(**at_end)
    model, places = system.plain_model(), _asked(system, stations)
    planes = {plane: b for plane, b in model.unbalances.items() if float(system.values[b.name]) != 0.0}
    if not planes:
        lacking = "are all zero" if model.unbalances else "are not declared by its model"
        raise RangeError(f"{system.case}: no response, for unbalances {lacking}")
    table = parameter_values(system, {name: points})
    rest, jacobian, found = linearised(model, table)
    if not found.any():
        raise RangeError(f"{model.name}: no static equilibrium was found at any value of {name}")
    at = np.flatnonzero(found)
    rotors, response = _responses(model, planes, places, table[:, at], rest[:, at], jacobian[at])
    full = np.full((len(rotors), len(places), 2, points.size), np.nan, dtype=complex)
    full[..., at] = response
    stable = np.zeros(points.size, dtype=np.int8)
    stable[at] = np.linalg.eigvals(jacobian[at]).real.max(axis=1) < 0
    lag = np.full(full.shape, np.nan)
    lag[..., at] = np.unwrap(-np.angle(response), axis=-1)
    major = _semi_major(full)
    length = {"measure": "length"}
    over = ("rotor", "station", "axis", name)
    data = {
        "amplitude": variable(over, np.abs(full), "1", "amplitude of the unbalance response", **length),
        "phase": variable(over, lag, "rad", "phase lag behind the rotor's turning"),
        "major": variable(("rotor", "station", name), major, "1", "semi-major axis of the orbit", **length),
        "total": variable(
            ("station", "axis", name), 2 * np.abs(full).sum(axis=0), "1", "peak to peak of all rotors", **length
        ),
        "probe": variable(("station", "axis"), np.array(list(places.values()), dtype=str), "1", "state or output probed"),
        "stable": variable(name, stable, "1", "whether the static equilibrium is stable"),
        "status": status_variable(name, np.where(found, Status.ok, Status.unresolved)),
        **_peaks(points, major, rotors, list(places), system.model.parameter(name).measure),
    }
    declared = system.model.parameter(name)
    coords = {
        name: variable(name, points, declared.unit, declared.meaning),
        "rotor": names_coordinate("rotor", rotors, "rotor whose unbalance acts"),
        "station": names_coordinate("station", list(places), "place of the probes"),
        "axis": names_coordinate("axis", AXES, "direction of the probe"),
    }
    return with_attributes(xr.Dataset(data, coords), {**provenance(pieces(system)), "varied": name})


def _asked(system: System, stations: Sequence[str] | None) -> dict[str, tuple[str, str]]:
    known = stations_of(system.model)
    if not known:
        raise RangeError(f"{system.model.name} declares neither stations nor bodies with a centre, where a probe could be")
    for station in stations or ():
        if station not in known:
            raise InputError(
                f"found no station {station!r}, expected one of {', '.join(known)}.{nearest(station, list(known))}"
            )
    return {station: known[station] for station in dict.fromkeys(stations or known)}


def _responses(
    model: Model, planes: Mapping[str, Any], places: Mapping[str, tuple[str, str]], values: Array, rest: Array,
    jacobian: Array,
) -> tuple[list[str], Complex]:  # fmt: skip
    """Rotors, and phasors of the probed places, shape (rotor, station, axis, point)."""
    n, points = rest.shape
    frequencies = numpy_function(model, "harmonics", lambda: Formula([model.parameters], model.harmonics))(list(values))
    order = np.abs([np.broadcast_to(np.asarray(w, dtype=float), (points,)) for w in frequencies])
    probes = _probes(model, places, values, rest)
    found: dict[str, Complex] = {}
    for plane, b in planes.items():
        own, force = _force(model, values, rest, order, model.parameters.index(b))
        X = np.linalg.solve(1j * own[:, None, None] * np.eye(n) - jacobian, force.T[..., None])[..., 0]
        rotor = plane.partition(", ")[0]
        found[rotor] = found.get(rotor, 0) + np.einsum("abnp,pn->abp", probes, X)
    return list(found), np.stack(list(found.values()))


def _force(model: Model, values: Array, rest: Array, order: Array, row: int) -> tuple[Array, Complex]:
    """Frequency of an unbalance at each point, and the phasor of what it adds to the rates, shape (state, point)."""
    points = rest.shape[1]
    without = values.copy()
    without[row] = 0.0
    count = READINGS * (2 * order.shape[0] + 1)
    slowest = np.min(np.where(order > 0, order, np.inf), axis=0)
    # Uneven times, at which no two frequencies look alike.
    time = (np.arange(count) * GOLDEN % 1.0)[:, None] * 2 * np.pi / slowest
    acting = np.zeros((count, *rest.shape))
    for form, members in variants(model, values):
        column = np.repeat(np.arange(members.size), count)
        x, when = rest[:, members[column]], time.T[members].ravel()
        whole = [Evaluator.of(form, v[:, members], jacobian=False).rates(when, x, column) for v in (values, without)]
        acting[:, :, members] = (whole[0] - whole[1]).reshape(-1, members.size, count).transpose(2, 0, 1)
    own, phasor, left = np.zeros(points), np.zeros(rest.shape, dtype=complex), np.full(points, np.inf)
    size = np.abs(acting).max(axis=(0, 1))
    for w in order:  # the one harmonic at which it acts is the one that leaves nothing
        wave = np.stack([np.cos(w * time), -np.sin(w * time)], axis=-1)  # (time, point, part): Re F e^(i w t)
        parts = np.einsum("pkt,tnp->knp", np.linalg.pinv(wave.transpose(1, 0, 2)), acting)
        error = np.abs(np.einsum("tpk,knp->tnp", wave, parts) - acting).max(axis=(0, 1))
        better = error < left
        own, left = np.where(better, w, own), np.where(better, error, left)
        phasor = np.where(better, parts[0] + 1j * parts[1], phasor)
    if (left > ELSEWHERE * size).any():
        raise RangeError(f"{model.parameters[row].name} acts at several frequencies, expected that of its rotor alone")
    return own, phasor


def _probes(model: Model, places: Mapping[str, tuple[str, str]], values: Array, rest: Array) -> Array:
    """Weight of every state in each probe, shape (station, axis, state, point)."""
    made = np.zeros((len(places), 2, *rest.shape))
    names: list[Symbol] = [*model.states, *model.parameters]
    for i, pair in enumerate(places.values()):
        for j, quantity in enumerate(pair):
            output = model.outputs.get(quantity)
            e = sympify(output.expression if output else model.state(quantity))
            for k, state in enumerate(model.states):
                if state in e.free_symbols:
                    made[i, j, k] = array_function(names, [e.diff(state)])(*rest, *values)[0]
    return made


def _semi_major(response: Complex) -> Array:
    """Semi-major axis of the ellipse with phasors along x and y: its forward and backward circles together."""
    x, y = response[..., 0, :], response[..., 1, :]
    return np.asarray((np.abs(x + 1j * y) + np.abs(x - 1j * y)) / 2)


def _peaks(points: Array, major: Array, rotors: list[str], stations: list[str], measure: str) -> dict[str, Any]:
    """Peaks of all curves, ascending in speed."""
    rows = [
        (one, rotor, station)
        for i, rotor in enumerate(rotors) for j, station in enumerate(stations) for one in criticals(points, major[i, j])
    ]  # fmt: skip
    rows.sort(key=lambda row: row[0].speed)
    found = [one for one, _, _ in rows]

    def numbers(some: list[float | None]) -> Array:
        return np.array([np.nan if v is None else v for v in some], dtype=float)

    speed = {"measure": measure}
    return {
        "critical": variable("peak", numbers([c.speed for c in found]), "1", "critical speed", **speed),
        "critical_low": variable("peak", numbers([c.low for c in found]), "1", "half-power speed below it", **speed),
        "critical_high": variable("peak", numbers([c.high for c in found]), "1", "half-power speed above it", **speed),
        "critical_amplitude": variable(
            "peak", numbers([c.amplitude for c in found]), "1", "semi-major axis there", measure="length"
        ),
        "amplification": variable("peak", numbers([c.factor for c in found]), "1", "amplification factor"),
        "critical_rotor": variable("peak", np.array([r for _, r, _ in rows], dtype=str), "1", "rotor whose unbalance acts"),
        "critical_station": variable("peak", np.array([s for _, _, s in rows], dtype=str), "1", "place of the probes"),
    }
