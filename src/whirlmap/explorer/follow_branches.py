"""Branches and curves of bifurcations that a page asks for: they begin at the motion of the chosen point."""

import time
from typing import Any

import xarray as xr

from whirlmap.errors import RangeError
from whirlmap.explorer.branch_lines import lines
from whirlmap.explorer.control import Values, system_at
from whirlmap.explorer.exploration import Exploration
from whirlmap.explorer.jobs import Job
from whirlmap.options.execution import Execution
from whirlmap.sweep.branches.branch_dataset import word
from whirlmap.sweep.branches.continue_orbit import continue_orbit
from whirlmap.sweep.branches.event_curve import KINDS, event_curve

#: Seconds between two results of a job: all points so far are gathered and sent each time.
BETWEEN = 0.7


def follow_branches(job: Job, e: Exploration, values: Values, workers: int | None) -> None:
    """Follow the branch of periodic orbits through a point of a diagram or a map.

    The job's result is a list of `branch_lines.lines`: over a diagram the branch; over a map the curves of the folds, period
    doublings and Neimark-Sacker points that the branch along the first axis meets.

    Raises
    ------
    RangeError
        Over a map, a branch without such a point.
    """
    begin = {name: float(values.get(name, e.controls[name].value)) for name in e.axes}
    ends = {name: _ends(e, name, value) for name, value in begin.items()}
    first, *others = begin
    there = {name: value for name, value in values.items() if name != first} | {name: begin[name] for name in others}
    system = system_at(e.system, e.controls, there)
    options: dict[str, Any] = {
        "begin": _text(e, first, begin[first]), "labelling": e.labelling,
        "execution": Execution(workers, lambda _: job.check()),
    }  # fmt: skip
    branch = _followed(job, e, continue_orbit.parts(system, first, ends[first], **options), [], put=not others)
    if not others:
        return
    met = {word(branch, "event_kind", code) for code in branch["event_kind"].values}
    chosen = [kind for kind in KINDS if kind in met]
    if not chosen:
        events = f"{', '.join(KINDS[:-1])} or {KINDS[-1]}"
        raise RangeError(f"the branch through this point, along {first}, meets no {events} point: no curve begins there")
    made: list[dict[str, Any]] = []
    for kind in chosen:
        ds = _followed(job, e, event_curve.parts(system, ends, kind, **options), made, put=True)
        made.append(lines(e, ds))


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
