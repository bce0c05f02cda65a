"""Branches and curves of bifurcations that a page asks for: they begin at the motion of the chosen point."""

import time
from typing import Any

import xarray as xr

from whirlmap.errors import RangeError
from whirlmap.explorer.branch_lines import lines
from whirlmap.explorer.control import Values, system_at
from whirlmap.explorer.exploration import Exploration
from whirlmap.explorer.jobs import Job
from whirlmap.integrate.system import System
from whirlmap.options.execution import Execution
from whirlmap.sweep.branches.branch_dataset import word
from whirlmap.sweep.branches.continue_orbit import continue_orbit
from whirlmap.sweep.branches.event_curve import KINDS, event_curve

#: Seconds between two results of a job: all points so far are gathered and sent each time.
BETWEEN = 0.7


def follow_branches(job: Job, e: Exploration, values: Values, workers: int | None) -> None:
    """Follow the branch of periodic orbits through a point of a diagram or a map.

    The job's result is a list of `branch_lines.lines`: over a diagram the branch; over a map the curves of the folds, period
    doublings and Neimark-Sacker points that the branch along its first axis meets, or else that along its second.

    Raises
    ------
    RangeError
        Over a map, branches without such a point.
    """
    options = {"labelling": e.labelling, "execution": Execution(workers, lambda _: job.check())}
    for along in e.axes:
        system, begin, ends = _begin(e, values, along)
        begun: dict[str, Any] = {"begin": _text(e, along, begin), **options}
        branch = _followed(job, e, continue_orbit.parts(system, along, ends[along], **begun), [], put=len(e.axes) == 1)
        if len(e.axes) == 1:
            return
        met = {word(branch, "event_kind", code) for code in branch["event_kind"].values}
        made: list[dict[str, Any]] = []
        for kind in (kind for kind in KINDS if kind in met):
            ds = _followed(job, e, event_curve.parts(system, ends, kind, **begun), made, put=True)
            made.append(lines(e, ds))
        if made:
            return
    axes, events = " and along ".join(e.axes), f"{', '.join(KINDS[:-1])} or {KINDS[-1]}"
    raise RangeError(f"the branches through this point, along {axes}, meet no {events} point: no curve begins there")


def _begin(e: Exploration, values: Values, along: str) -> tuple[System, float, dict[str, list[Any]]]:
    """The system at a point but for the axis along which a branch is followed, its value there, and ends of all axes."""
    at = {name: float(values.get(name, e.controls[name].value)) for name in e.axes}
    ends = {name: _ends(e, name, at[name]) for name in (along, *(name for name in at if name != along))}
    others = {name: value for name, value in {**values, **at}.items() if name != along}
    return system_at(e.system, e.controls, others), at[along], ends


def _followed(job: Job, e: Exploration, work: Any, before: list[dict[str, Any]], *, put: bool) -> xr.Dataset:
    """Do some work in parts; the job's result grows with it."""
    begun, last = job.done, time.monotonic()
    for done in work:
        job.done = begun + done
        job.check()
        if put and time.monotonic() - last > BETWEEN and work.dataset is not None:
            job.put([*before, lines(e, work.dataset)])
            last = time.monotonic()
    found: xr.Dataset = work.dataset
    if put:
        job.put([*before, lines(e, found)])
    return found


def _text(e: Exploration, name: str, value: float) -> Any:
    unit = e.axes[name][1]
    return value if unit == "1" else f"{value!r} {unit}"


def _ends(e: Exploration, name: str, value: float) -> list[Any]:
    """Ends of an axis, moved so that the value lies between them."""
    axis = e.axes[name][0]
    return [_text(e, name, min(float(axis[0]), value)), _text(e, name, max(float(axis[-1]), value))]
