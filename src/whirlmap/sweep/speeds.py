"""Safe speed windows: where a machine runs periodically and within a limit of vibration, and why it does not elsewhere.

1. Every speed of a grid is labelled from a cold start (`label_points`); with ``follow`` the state is also carried up and
   down through the grid, and a safe speed at which one of the two sweeps is not safe has coexisting motions.
2. A speed is safe where its motion is periodic, its largest peak-to-peak displacement is within the limit, and nothing
   coexists with it that was met.
3. The edges of the windows are refined: `PARTS` speeds between a safe one and its neighbour that is not, `ROUNDS` times.
4. Draws over tolerances, where asked for: the share of drawn machines that are safe at each speed (`safe_probability`).
"""

import json
from collections.abc import Callable, Mapping, Sequence
from enum import IntEnum
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.settling import Settling
from whirlmap.errors import RangeError, nearest
from whirlmap.integrate.system import System
from whirlmap.results.regime import Regime
from whirlmap.results.schema import variable
from whirlmap.results.status import flags
from whirlmap.sweep.diagram import bifurcation_diagram
from whirlmap.sweep.points import label_points

Array = NDArray[np.float64]
Progress = Callable[[int], None]

#: Parameter that is the speed.
SPEED = "s"
#: Quantities of a case that are the speed of its first shaft [rad/s].
SHAFT = ("pinion_speed", "shaft_speed")
#: Speeds between the two ends of an edge of a window, and how often they are drawn closer.
PARTS, ROUNDS = 7, 3


class Verdict(IntEnum):
    """Whether a speed is safe, else the first reason why not."""

    safe = 0
    amplitude = 1
    coexisting = 2
    quasi_periodic = 3
    chaotic = 4
    contact = 5
    diverged = 6
    undecided = 7


REASONS = {
    Regime.quasi_periodic: Verdict.quasi_periodic, Regime.chaotic: Verdict.chaotic, Regime.contact: Verdict.contact,
    Regime.diverged: Verdict.diverged, Regime.undecided: Verdict.undecided,
}  # fmt: skip


def shaft_speed(system: System) -> float:
    """Speed of the first shaft at ``s = 1`` [rad/s], or NaN for a system without dimensions."""
    known = getattr(system.details, "quantities", None) or {}
    found = [known[name][0] for name in SHAFT if name in known]
    return found[0] / float(system.values[SPEED]) if found else np.nan


def clearance(system: System) -> float:
    """The length [m] that the model's lengths are in units of, or NaN for a system without dimensions."""
    found = (getattr(system.details, "inputs", None) or {}).get("c")
    return np.nan if found is None else float(found.value)


def safe_speeds(
    system: System,
    speeds: ArrayLike,
    limit: float,
    *,
    quantity: str | None = None,
    follow: bool = False,
    settling: Settling | None = None,
    lyapunov: int = 256,
    accuracy: float | None = None,
    method: str | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Judge the speeds of a machine.

    Parameters
    ----------
    speeds : array_like, shape (s,)
        Values of ``s``, positive and ascending, two or more.
    limit : float
        Largest peak-to-peak displacement that is allowed, in the model's length (clearances, for the machines).
    quantity : str, optional
        State or output whose peak-to-peak counts; where absent the largest of the model's displacements.
    follow : bool
        Carry the state up and down through the speeds as well: slower, and shows hysteresis.

    Returns
    -------
    xr.Dataset
        Over ``s``: ``verdict`` with CF flags, ``regime``, ``period_T``, ``amplitude``, ``lyapunov``, and ``min_film`` of
        each bearing. Over ``window``: ``window_start``, ``window_end``, ``margin_start`` and ``margin_end`` (distance to the
        nearest judged speed that is not safe; zero at an end of the range), ``window_amplitude``. ``attrs["windows"]`` is
        the same as JSON with the reasons at both ends. Where the case has dimensions, ``rpm(s)``.

    Raises
    ------
    RangeError
        The model has no ``s``; speeds that do not ascend or are not positive; a limit that is not positive.
    """
    at = np.atleast_1d(np.asarray(speeds, dtype=float))
    if SPEED not in system.parameters:
        raise RangeError(f"{system.model.name} has no parameter 's': safe speeds are those of a machine with one")
    if at.size < 2 or not np.isfinite(at).all() or at[0] <= 0 or np.any(np.diff(at) <= 0):
        raise RangeError("speeds must be positive and ascend, and be two or more")
    if not 0 < limit < np.inf:
        raise RangeError(f"the limit must be a positive length, not {limit:g}")
    options: dict[str, Any] = {
        "settling": settling, "lyapunov": lyapunov, "accuracy": accuracy, "method": method, "workers": workers,
        "progress": progress,
    }  # fmt: skip
    rows = _rows(system, quantity)
    points = label_points(system, {SPEED: at}, **options)
    amplitude = points["peak_to_peak"].sel(quantity=rows).max("quantity").values
    verdict = verdicts(points["regime"].values, amplitude, limit)
    if follow:
        both = bifurcation_diagram(system, SPEED, at, follow="both", **options)
        swings = (both["maximum"] - both["minimum"]).sel(quantity=rows).max("quantity").transpose("direction", SPEED)
        other = np.array([verdicts(r, a, limit) for r, a in zip(both["regime"].values, swings.values, strict=True)])
        differs = (other != Verdict.safe).any(axis=0) & (verdict == Verdict.safe)
        verdict = np.where(differs, Verdict.coexisting, verdict).astype(np.int8)
    edges = _refined(system, at, verdict, limit, rows, options)
    found = _windows(at, verdict, amplitude, edges)
    ds = points.swap_dims(point=SPEED)[["regime", "status", "period_T", "lyapunov", "lyapunov_error"]]
    if "min_film" in points:
        ds["min_film"] = points["min_film"].swap_dims(point=SPEED)
    ds["verdict"] = verdict_variable(SPEED, verdict)
    ds["amplitude"] = amplitude_variable(SPEED, amplitude, rows)
    for name, meaning in (
        ("window_start", "first safe speed ratio"), ("window_end", "last safe speed ratio"),
        ("margin_start", "distance to the nearest speed below that is not safe"),
        ("margin_end", "distance to the nearest speed above that is not safe"),
        ("window_amplitude", "largest peak to peak in the window"),
    ):  # fmt: skip
        ds[name] = variable("window", [w[name] for w in found], "1", meaning)
    scale = shaft_speed(system) * 30 / np.pi
    if np.isfinite(scale):
        ds["rpm"] = variable(SPEED, at * scale, "rpm", "speed of the first shaft")
    return ds.assign_attrs(
        points.attrs, limit=limit, quantities=" ".join(rows), followed=int(follow), windows=json.dumps(found)
    )


def verdicts(regime: ArrayLike, amplitude: ArrayLike, limit: float) -> NDArray[np.int8]:
    """Verdict of every point from its regime and its amplitude."""
    labels, swing = np.asarray(regime), np.asarray(amplitude)
    out = np.where(swing <= limit, Verdict.safe, Verdict.amplitude)
    for label, why in REASONS.items():
        out = np.where(labels == label, why, out)
    return out.astype(np.int8)


def safe_probability(
    system: System,
    draws: Sequence[System],
    speeds: ArrayLike,
    limits: ArrayLike,
    *,
    quantity: str | None = None,
    **options: Any,
) -> xr.Dataset:
    """Share of drawn machines that are safe at each speed, with its 95 % interval (Wilson).

    Parameters
    ----------
    system : System
        The machine as it was meant, whose ``s`` counts the speeds.
    draws : sequence of System
        Machines of the same model.
    speeds, limits, quantity, **options
        As in `judge_machines`.
    """
    at = np.asarray(speeds, dtype=float)
    judged = judge_machines(system, draws, at, limits, quantity=quantity, **options)
    low, share, high = _wilson((judged["verdict"].values == Verdict.safe).sum(axis=0), len(draws))
    meaning = "share of the drawn machines that are safe"
    return xr.Dataset(
        {
            "probability": variable(SPEED, share, "1", meaning),
            "probability_low": variable(SPEED, low, "1", f"{meaning}: lower end of its 95 % interval"),
            "probability_high": variable(SPEED, high, "1", f"{meaning}: upper end of its 95 % interval"),
        },
        {SPEED: at},
        judged.attrs,
    )


def judge_machines(
    system: System,
    machines: Sequence[System],
    speeds: ArrayLike,
    limits: ArrayLike,
    *,
    quantity: str | None = None,
    **options: Any,
) -> xr.Dataset:
    """Judge several machines of one model at the same speeds, all of them together, from cold starts.

    Parameters
    ----------
    system : System
        The machine whose ``s`` counts the speeds.
    machines : sequence of System
        They run at the same speed of the first shaft [rad/s] where the cases have dimensions, else at the same ``s``.
    speeds : array_like, shape (s,)
        Values of ``s`` of `system`.
    limits : array_like, shape (machine,)
        Largest peak-to-peak displacement that is allowed to each, in its own length.
    quantity : str, optional
        As in `safe_speeds`.
    **options
        Those of `label_points`.

    Returns
    -------
    xr.Dataset
        ``verdict(machine, s)`` and ``amplitude(machine, s)``, in each machine's own length.

    Raises
    ------
    RangeError
        No machine; machines of different models or orders of harmonics; a shaft at rest.
    """
    at, allowed = np.asarray(speeds, dtype=float), np.asarray(limits, dtype=float)
    if not machines:
        raise RangeError("found no machine, expected at least one")
    names = [n for n in system.parameters if n != SPEED]
    differing = {n for m in machines for n in names if m.values.get(n) != system.values[n]}
    for machine in machines:
        if machine.model.states != system.model.states or dict(machine.model.switches) != dict(system.model.switches):
            raise RangeError(f"{machine.case} with these changes is another model than {system.case}: compare one model")
    scales = np.array([shaft_speed(machine) for machine in machines]) / shaft_speed(system)
    scales = np.where(np.isfinite(scales), scales, 1.0)
    if not np.all(scales > 0):
        raise RangeError("the first shaft of a machine stands still at every s: its speeds cannot be compared")
    values = {n: np.repeat([float(m.values[n]) for m in machines], at.size) for n in names if n in differing}
    values[SPEED] = (at / scales[:, None]).ravel()
    points = label_points(system, values, **options)
    rows = _rows(system, quantity)
    swing = points["peak_to_peak"].sel(quantity=rows).max("quantity").values.reshape(-1, at.size)
    verdict = verdicts(points["regime"].values.reshape(swing.shape), swing / allowed[:, None], 1.0)
    over = ("machine", SPEED)
    return xr.Dataset(
        {"verdict": verdict_variable(over, verdict), "amplitude": amplitude_variable(over, swing, rows)},
        {SPEED: variable(SPEED, at, "1", "speed ratio of the machine that was meant")}, points.attrs,
    )  # fmt: skip


def verdict_variable(dims: Any, values: ArrayLike) -> tuple[Any, ...]:
    """Verdicts, with CF flags."""
    codes = np.asarray(values, dtype=np.int8)
    return variable(dims, codes, "1", "whether the speed is safe, else why not", **flags(Verdict))


def amplitude_variable(dims: Any, values: ArrayLike, rows: Sequence[str]) -> tuple[Any, ...]:
    """Peak to peak of the judged quantities."""
    return variable(dims, values, "1", f"peak to peak of {', '.join(rows)}, the largest")


def _wilson(hits: Array, count: int) -> tuple[Array, Array, Array]:
    z, share = 1.959964, hits / count
    centre = (share + z**2 / (2 * count)) / (1 + z**2 / count)
    half = z * np.sqrt(share * (1 - share) / count + z**2 / (4 * count**2)) / (1 + z**2 / count)
    return centre - half, share, centre + half


def _rows(system: System, quantity: str | None) -> list[str]:
    known = [*system.states, *system.model.outputs]
    if quantity is None:
        return [s.name for s in system.model.swing]
    if quantity not in known:
        raise RangeError(
            f"{system.model.name} has no state or output {quantity!r}.{nearest(quantity, known)}\n  known: {' '.join(known)}"
        )
    return [quantity]


def _refined(
    system: System, at: Array, verdict: NDArray[np.int8], limit: float, rows: list[str], options: Mapping[str, Any]
) -> dict[int, tuple[float, float, int]]:
    """Ends of windows between grid speeds i and i + 1: last safe speed, first that is not, and why not."""
    safe = verdict == Verdict.safe
    cells = np.flatnonzero(safe[1:] != safe[:-1])
    good = np.where(safe[cells], at[cells], at[cells + 1])
    bad = np.where(safe[cells], at[cells + 1], at[cells])
    why = np.where(safe[cells], verdict[cells + 1], verdict[cells]).astype(np.int8)
    shares = np.arange(1, PARTS + 1) / (PARTS + 1)
    for _ in range(ROUNDS if cells.size else 0):
        trial = good[:, None] + (bad - good)[:, None] * shares
        points = label_points(system, {SPEED: trial.ravel()}, **options)
        swing = points["peak_to_peak"].sel(quantity=rows).max("quantity").values
        found = verdicts(points["regime"].values, swing, limit).reshape(trial.shape)
        unsafe = found != Verdict.safe
        first = np.where(unsafe.any(axis=1), unsafe.argmax(axis=1), PARTS)
        every = np.arange(cells.size)
        whole = np.concatenate([good[:, None], trial, bad[:, None]], axis=1)
        why = np.where(first < PARTS, found[every, np.minimum(first, PARTS - 1)], why)
        good, bad = whole[every, first], whole[every, first + 1]
    return {int(c): (float(g), float(b), int(w)) for c, g, b, w in zip(cells, good, bad, why, strict=True)}


def _windows(
    at: Array, verdict: NDArray[np.int8], amplitude: Array, edges: Mapping[int, tuple[float, float, int]]
) -> list[dict[str, Any]]:
    safe = np.concatenate([[False], verdict == Verdict.safe, [False]])
    starts, ends = np.flatnonzero(safe[1:] & ~safe[:-1]), np.flatnonzero(safe[:-1] & ~safe[1:]) - 1
    out = []
    for a, b in zip(starts, ends, strict=True):
        low, below, why_below = edges.get(int(a) - 1, (float(at[a]), float(at[a]), -1))
        high, above, why_above = edges.get(int(b), (float(at[b]), float(at[b]), -1))
        out.append({
            "window_start": low, "window_end": high, "margin_start": low - below, "margin_end": above - high,
            "window_amplitude": float(amplitude[a : b + 1].max()),
            "below": "end of the range" if why_below < 0 else Verdict(why_below).name,
            "above": "end of the range" if why_above < 0 else Verdict(why_above).name,
        })  # fmt: skip
    return out
