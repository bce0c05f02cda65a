"""Branches as one Dataset: their points one after the other, and their events."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.analysis.branches.events import OUTSIDE, Event
from whirlmap.integrate.system import System
from whirlmap.results.schema import names_coordinate, variable
from whirlmap.sweep.branches.branch import ENDS, KINDS, Branch, arclengths
from whirlmap.sweep.branches.free_parameters import FreeParameters, Varied
from whirlmap.sweep.branches.measured_branches import Measuring
from whirlmap.sweep.points.extremes import EXTREMES, extreme_coordinates, extreme_variables

Array = NDArray[np.float64]

#: Kinds of events, in the order of their flags.
EVENTS = (
    "fold", "branch-point", "period-doubling", "neimark-sacker", "hopf", "grazing",
    "cusp", "resonance-1-1", "resonance-1-2", "resonance-1-3", "resonance-1-4",
)  # fmt: skip


def flagged(names: Sequence[str]) -> dict[str, Any]:
    """CF attributes of an integer that stands for one of these words."""
    return {
        "flag_values": np.arange(len(names), dtype=np.int8), "flag_meanings": " ".join(n.replace("-", "_") for n in names)
    }  # fmt: skip


def word(ds: xr.Dataset, name: str, value: Any) -> str:
    """The word that an integer variable's value stands for."""
    return str(str(ds[name].attrs["flag_meanings"]).split()[int(value)]).replace("_", "-")


def dataset(
    system: System, varied: Sequence[Varied], branches: Sequence[Branch], measuring: Measuring | None = None
) -> xr.Dataset:
    """All branches, over ``point``, ``event`` and ``branch``."""
    points = [p for b in branches for p in b.points()]
    events = [(k, i, e) for k, b in enumerate(branches) for i, e in b.events()]
    rows = (measuring or Measuring())([*points, *(e.at for _, _, e in events)])
    count = len(points)
    log, angle, error = (
        _ragged([getattr(row, name) for row in rows]) for name in ("log_modulus", "argument", "log_error")
    )
    extremes = {name: np.stack([row.extremes[name] for row in rows[:count]], axis=1) for name in EXTREMES}
    section = [row.section for row in rows[:count]]
    columns = FreeParameters(system, tuple(varied)).following(np.stack([p.point.free for p in points], axis=1))
    of = np.repeat(np.arange(1, len(branches) + 1), [len(b.points()) for b in branches])
    first = np.searchsorted(of, np.arange(1, len(branches) + 1))
    unstable = (log > OUTSIDE).sum(axis=1)
    period = np.array([b.seed.period for b in branches])
    data: dict[str, Any] = {
        "branch_of": variable("point", of, "1", "number of the branch"),
        "arclength": variable(
            "point", np.concatenate([arclengths(b.points()) for b in branches]), "1",
            "length along the branch, in sizes of the states and widths of the ranges",
        ),
        "section": variable(
            ("point", "period", "state"), _ragged(section), "1",
            "state once per T, first at phase zero, or on the section", unit_of_each=_units(system),
        ),
        "stable": variable("point", (unstable[:count] == 0).astype(np.int8), "1", "whether no multiplier lies outside"),
        "unstable": variable("point", unstable[:count], "1", "number of multipliers outside the unit circle"),
        **_multipliers("point", "", log[:count], angle[:count]),
        "multiplier_error": variable(
            ("point", "multiplier"), error[:count], "1", "change of log_modulus with the last doubling of steps"
        ),
        **extreme_variables("point", system, extremes, columns),
        "steps": variable("point", [row.steps for row in rows[:count]], "1", "steps per T, or per return"),
        "segments": variable("point", [len(p.point.x) for p in points], "1", "segments of the orbit"),
        "step_error": variable("point", [r.step_error for r in rows[:count]], "1", "what twice the steps change, in sizes"),
        "duration": variable("point", [row.duration for row in rows[:count]], "time", "time of one return"),
        "kind": variable("branch", [KINDS.index(b.kind) for b in branches], "1", "what its points are", **flagged(KINDS)),
        "period_T": variable("branch", period, "T", "return in T, of a cycle in crossings of its section; 0 at rest"),
        "first_point": variable("branch", first, "1", "index of its first point"),
        "end": variable(
            ("branch", "side"), [[ENDS.index(e) for e in b.ends()] for b in branches], "1", "how it ends", **flagged(ENDS)
        ),
        **_events(varied, system, events, log[count:], angle[count:]),
    }
    coords: dict[str, Any] = {
        v.name: variable("point", [p.point.free[k] for p in points], _unit(system, v), v.meaning)
        for k, v in enumerate(varied)
    }
    coords |= {
        "branch": ("branch", np.arange(1, len(branches) + 1), {"long_name": "branch"}),
        "period": np.arange(1, max(len(each) for each in section) + 1),
        "state": names_coordinate("state", system.states, "state"),
        **extreme_coordinates(system),
    }
    return xr.Dataset(data, coords)


def events_of(ds: xr.Dataset) -> xr.Dataset:
    """The events of branches as a Dataset of their own.

    Parameters
    ----------
    ds : xr.Dataset
        Of `continue_orbit`.

    Returns
    -------
    xr.Dataset
        Over ``event``: ``kind``, ``branch``, ``after``, ``surface``, ``contacts``, ``section``, ``log_modulus``
        and ``argument``, and the varied parameters as coordinates.
    """
    kept = ds[[str(name) for name in ds.data_vars if str(name).startswith("event_")]]
    made = kept.rename({name: str(name).removeprefix("event_") for name in kept.data_vars})
    coordinates = [name for name in made.data_vars if name in ds.coords]
    return made.drop_vars([c for c in made.coords if c != "state"]).set_coords(coordinates).assign_attrs(ds.attrs)


def _unit(system: System, varied: Varied) -> str:
    known = {p.name: p.unit for p in system.model.parameters}
    return known.get(varied.name, varied.unit) or "1"


def _units(system: System) -> str:
    return " ".join(s.unit for s in system.model.states)


def _ragged(rows: Sequence[Array]) -> Array:
    """Rows of all points, NaN beyond the shorter ones."""
    out = np.full((len(rows), max(len(r) for r in rows), *rows[0].shape[1:]), np.nan)
    for k, row in enumerate(rows):
        out[k, : len(row)] = row
    return out


def _multipliers(dim: str, before: str, log: Array, angle: Array) -> dict[str, Any]:
    over = (dim, "multiplier")
    return {
        f"{before}log_modulus": variable(
            over, log, "1", "logarithm of each multiplier's modulus; at rest growth in one typical time"
        ),
        f"{before}argument": variable(over, angle, "rad", "its argument; at rest the turn in one typical time"),
    }


def _events(
    varied: Sequence[Varied], system: System, events: Sequence[tuple[int, int, Event]], log: Array, angle: Array
) -> dict[str, Any]:
    at = [e.at for _, _, e in events]
    numbers, after = [k + 1 for k, _, _ in events], [i for _, i, _ in events]
    kinds = [EVENTS.index(e.kind) for *_, e in events]
    values = {
        f"event_{v.name}": variable(
            "event", [c.point.free[k] for c in at], _unit(system, v), f"{v.meaning}, at the event"
        )
        for k, v in enumerate(varied)
    }
    return {
        "event_kind": variable("event", np.array(kinds, dtype=np.int8), "1", "what it is", **flagged(EVENTS)),
        "event_branch": variable("event", np.array(numbers, dtype=np.int64), "1", "branch that it lies on"),
        "event_after": variable("event", np.array(after, dtype=np.int64), "1", "index, along it, of the point before it"),
        "event_surface": variable("event", np.array([e.surface for _, _, e in events], dtype=str), "1", "switching grazed"),
        "event_contacts": variable(
            "event", np.array([e.contacts for _, _, e in events], dtype=np.int64), "1",
            "contacts of a grazing orbit that begin or end within the step",
        ),
        "event_section": variable(
            ("event", "state"), np.array([c.point.x[0] for c in at]).reshape(len(at), system.model.dimension), "1",
            "state at phase zero, or on the section", unit_of_each=_units(system),
        ),
        **values,
        **_multipliers("event", "event_", log, angle),
    }  # fmt: skip
