"""Campbell diagram: damped frequencies of the linearised system against speed, and where order lines cross them."""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import linear_sum_assignment

from whirlmap.analysis.linear.linearisation import linearised
from whirlmap.analysis.linear.mode_shapes import Shapes, shapes_of, whirl_of
from whirlmap.analysis.motion.ensembles import parameter_values
from whirlmap.errors import RangeError
from whirlmap.integrate.loading import pieces
from whirlmap.integrate.own_units import in_own_units
from whirlmap.integrate.system import System
from whirlmap.kernels.lowering.formulas import Formula, numpy_function
from whirlmap.results.provenance import provenance
from whirlmap.results.schema import status_variable, variable, with_attributes
from whirlmap.results.status import Status


def campbell(system: System, name: str, values: ArrayLike) -> xr.Dataset:
    """Damped frequencies, damping and whirl of every mode against a parameter, and the critical speeds.

    Parameters
    ----------
    system : System
        Of a model that starts at its static equilibrium.
    name : str
        Parameter to vary, as a rule the speed s; or the dimensional input that is the speed.
    values : array_like, shape (point,)
        Finite, ascending, at least two; texts with a unit, or the text of a range, ``"500 rpm:6000 rpm:50"``.

    Returns
    -------
    xr.Dataset
        ``frequency(mode, name)``, ``growth(mode, name)``: imaginary (not negative) and real part of the eigenvalues over the
        model's reference frequency (per radian of the clock, times the speed where the model declares one).
        ``damping_ratio``: -growth over the size of the eigenvalue. ``whirl``: 1 forward (in the clock's sense, from x to y),
        -1 backward, 0 no orbit. ``line(clock, name)``: once per turn of each clock. ``status(name)``: unresolved where no
        equilibrium was found, NaN in the rest. ``critical(crossing)``: values at which a line meets a frequency, with
        ``critical_clock``, ``critical_mode``, ``critical_whirl``, ``critical_damping_ratio``, ``critical_frequency``,
        ``critical_name`` and ``critical_shape``. ``shape(mode, body, name)``: how far each body moves, over the one that
        moves most, which gives the mode its name: ``mode_name(mode)``, that at most of the values. `whirlmap.in_units`
        gives rpm and Hz where the case has dimensions.

    Raises
    ------
    RangeError
        Where the values do not ascend, or no equilibrium is declared, or none is found at any value.
    InputError
        A unit that the parameter does not have, or a speed without one.

    Notes
    -----
    Modes of neighbouring values belong together where ``|l_i r_j| |l_j r_i|`` is largest (left vectors of one value with
    right vectors of the other, whatever their scale), as an assignment of all modes at once. A mode and its conjugate are
    one mode; a pair that is overdamped somewhere is two, for its two decays differ. Whirl is the sign of the orbit's area,
    summed over the centres that have mass. Crossings are interpolated linearly between neighbouring values.

    References
    ----------
    [childs1993] damped critical speeds.
    """
    name, points = in_own_units(system, name, values)
    if points.ndim != 1 or points.size < 2 or not np.isfinite(points).all() or np.any(np.diff(points) <= 0):
        raise RangeError(f"values of {name!r} must be finite and ascend, and be two or more")
    for end in (points[0], points[-1]):
        at_end: dict[str, Any] = {name: end}
        system.replace(**at_end)  # refuses an unknown name, and a value that the model cannot take
    model = system.plain_model()
    if any(p.name == name for p in system.model.plain):
        model = system.model
    table = parameter_values(system, {name: points})
    rest, jacobian, found = linearised(model, table)
    if not found.any():
        raise RangeError(f"{system.model.name}: no static equilibrium was found at any value of {name}")
    at = np.flatnonzero(found)
    speed = table[system.parameters.index(system.speed)] if system.speed else np.ones(points.size)
    eigenvalues, vectors = _followed(*np.linalg.eig(jacobian[at]))
    kept = _without_conjugates(eigenvalues)
    full = np.full((len(kept), points.size), np.nan)
    frequency, growth, whirl = full.copy(), full.copy(), np.zeros(full.shape, dtype=np.int8)
    frequency[:, at] = np.abs(eigenvalues.imag[:, kept].T) * speed[at]
    growth[:, at] = eigenvalues.real[:, kept].T * speed[at]
    whirl[:, at] = whirl_of(system, eigenvalues, vectors)[:, kept].T
    counted = np.zeros(full.shape, dtype=bool)
    counted[:, at] = ~_shadows(eigenvalues[:, kept]).T
    vector = np.full((len(kept), len(system.states), points.size), np.nan, dtype=complex)
    vector[:, :, at] = vectors[:, :, kept].transpose(2, 1, 0)
    order = np.argsort(np.nanmean(frequency, axis=1), kind="stable")
    frequency, growth, whirl, counted = frequency[order], growth[order], whirl[order], counted[order]
    shapes = shapes_of(system, vector[order], frequency, whirl)
    size = np.hypot(frequency, growth)
    damping = np.divide(-growth, size, out=np.full_like(size, np.nan), where=size > 0)
    clocks = list(model.clocks)
    turns = numpy_function(model, "clocks", lambda: Formula([model.parameters], tuple(model.clocks.values())))(list(table))
    line = np.array([np.abs(np.broadcast_to(np.asarray(w, dtype=float), points.shape)) * speed for w in turns])
    line = line.reshape(len(clocks), points.size)
    declared = system.model.parameter(name)
    data = {
        "frequency": (("mode", name), frequency, {"units": "1", "long_name": "damped frequency", "measure": "frequency"}),
        "growth": (("mode", name), growth, {"units": "1", "long_name": "growth rate", "measure": "growth"}),
        "damping_ratio": (("mode", name), damping, {"units": "1", "long_name": "damping ratio"}),
        "whirl": (("mode", name), whirl, {"units": "1", "long_name": "sense of whirl, 1 forward, -1 backward"}),
        "line": (("clock", name), line, {"units": "1", "long_name": "order line", "measure": "frequency"}),
        "equilibrium": (("state", name), np.where(found, rest, np.nan), {"units": "1", "long_name": "equilibrium"}),
        "status": status_variable(name, np.where(found, Status.ok, Status.unresolved)),
        "mode_name": variable("mode", np.array(shapes.usual(), dtype=str), "1", "body that moves most, and its sense"),
        "shape": variable(("mode", "body", name), shapes.amplitude, "1", "motion of each body over the largest"),
        **_crossings(points, line, np.where(counted, frequency, np.nan), damping, whirl, clocks, shapes),
    }
    data["critical"][2]["measure"] = declared.measure
    coords = {
        name: variable(name, points, declared.unit, declared.meaning),
        "mode": np.arange(len(kept)), "clock": clocks, "state": list(system.states),
        "body": np.array(shapes.bodies, dtype=str),
    }  # fmt: skip
    return with_attributes(xr.Dataset(data, coords), {**provenance(pieces(system)), "varied": name})


def _followed(
    eigenvalues: NDArray[np.complex128], vectors: NDArray[np.complex128]
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Reorder modes so that each keeps its place from point to point: (point, mode) and (point, state, mode)."""
    left = np.linalg.pinv(vectors)
    near = np.abs(left[:-1] @ vectors[1:]) * np.abs(left[1:] @ vectors[:-1]).transpose(0, 2, 1)
    orders = [np.argsort(-eigenvalues[0].real, kind="stable")]
    for likeness in near:  # a chain by its nature: where a mode stands depends on where it stood before
        orders.append(linear_sum_assignment(likeness, maximize=True)[1][orders[-1]])
    places = np.array(orders)
    return np.take_along_axis(eigenvalues, places, 1), np.take_along_axis(vectors, places[:, None, :], 2)


def _without_conjugates(eigenvalues: NDArray[np.complex128]) -> list[int]:
    """Places of modes, one of each pair that is conjugate at every point."""
    kept: list[int] = []
    scale = np.abs(eigenvalues).max(axis=1)
    moving = np.abs(eigenvalues.imag).max(axis=0) > 1e-9 * scale.max()
    paired: set[int] = set()
    for j in range(eigenvalues.shape[1]):
        if j in paired:
            continue
        kept.append(j)
        rest = [i for i in range(j + 1, eigenvalues.shape[1]) if i not in paired and moving[i]]
        same = [i for i in rest if (np.abs(eigenvalues[:, i] - eigenvalues[:, j].conj()) < 1e-9 * scale).all()]
        paired.update(same[:1] if moving[j] else [])
    return kept


def _shadows(eigenvalues: NDArray[np.complex128]) -> NDArray[np.bool_]:
    """Where the conjugate of a mode is kept too (point, mode): both have one frequency, which is counted once."""
    apart = np.abs(eigenvalues[:, :, None] - eigenvalues[:, None, :].conj())
    same = (apart < 1e-9 * np.abs(eigenvalues).max(axis=1)[:, None, None]).any(axis=2)
    return np.asarray(same & (eigenvalues.imag < 0))


def _crossings(
    points: NDArray[np.float64],
    line: NDArray[np.float64],
    frequency: NDArray[np.float64],
    damping: NDArray[np.float64],
    whirl: NDArray[np.int8],
    clocks: list[str],
    shapes: Shapes,
) -> dict[str, tuple[Any, ...]]:
    """Find where lines meet frequencies, ascending."""
    gap = frequency[None] - line[:, None]  # (clock, mode, point)
    a, b = gap[..., :-1], gap[..., 1:]
    turning = (frequency[:, :-1] > 0) & (frequency[:, 1:] > 0)
    clock, mode, left = np.nonzero(((a > 0) != (b > 0)) & np.isfinite(a) & np.isfinite(b) & turning)
    part = a[clock, mode, left] / (a - b)[clock, mode, left]
    where = points[left] + part * (points[left + 1] - points[left])
    ratio = damping[mode, left] + part * (damping[mode, left + 1] - damping[mode, left])
    order, nearest = np.argsort(where, kind="stable"), left + (part > 0.5)
    height = line[clock, left] + part * (line[clock, left + 1] - line[clock, left])
    found = {
        "critical": (where, "critical value"),
        "critical_clock": (np.array(clocks, dtype=str)[clock], "clock of the order line"),
        "critical_mode": (mode, "mode"),
        "critical_whirl": (whirl[mode, nearest], "sense of whirl, 1 forward, -1 backward"),
        "critical_damping_ratio": (ratio, "damping ratio"),
        "critical_name": (shapes.names[mode, nearest], "body that moves most, and its sense"),
    }
    made = {key: variable("crossing", np.asarray(value)[order], "1", words) for key, (value, words) in found.items()}
    made["critical_frequency"] = variable("crossing", height[order], "1", "frequency", measure="frequency")
    made["critical_shape"] = variable(
        ("crossing", "body"), shapes.amplitude[mode, :, nearest][order], "1", "motion of each body over the largest"
    )
    return made
