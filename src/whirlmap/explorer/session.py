"""What the page may ask for, by name: each request is checked, and answered with JSON."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping
from http import HTTPStatus
from pathlib import Path
from typing import Any

from whirlmap.analysis.diagnosis.diagnosis import diagnose
from whirlmap.analysis.diagnosis.diagnosis_json import verdict_json
from whirlmap.errors import WhirlmapError
from whirlmap.explorer import exports
from whirlmap.explorer.coexisting import coexisting
from whirlmap.explorer.control import Values, system_at
from whirlmap.explorer.exploration import Exploration, read_again
from whirlmap.explorer.finer import compute, range_axes
from whirlmap.explorer.follow_branches import follow_branches
from whirlmap.explorer.jobs import Job, Jobs
from whirlmap.explorer.limits import Refused, known, range_of, values_of, whole
from whirlmap.explorer.motion import Motion, motion, motion_json
from whirlmap.explorer.page_data import page_data
from whirlmap.options.execution import Execution
from whirlmap.progress import Progress

Request = Mapping[str, Any]

#: Motions that are remembered: another quantity of the same point is shown without computing it again.
REMEMBERED = 8
#: T of the exponents of a label that the page asks for.
LONGEST = 4096


class Session:
    """An exploration, its jobs, and the answers to what a page asks.

    Parameters
    ----------
    exploration : Exploration
    workers : int, optional
        Threads.
    store : Path, optional
        Where a map that is still to be computed is kept.
    """

    def __init__(self, exploration: Exploration, *, workers: int | None = None, store: Path | None = None) -> None:
        self.exploration, self.workers, self.store = exploration, workers, store
        self.jobs = Jobs()
        self.progress = Progress("explore", None, quiet=True)  # knows when kernels are compiled
        self.filling: Job | None = None
        self._motions: OrderedDict[Any, Motion] = OrderedDict()
        self._lock = threading.Lock()
        if exploration.axes and exploration.overview is None:
            self.filling = self.jobs.start(self._fill)

    def _fill(self, job: Job) -> None:
        e = self.exploration
        compute(job, e, e.system, e.axes, workers=self.workers, store=self.store)

    @property
    def answers(self) -> dict[str, Callable[[Request], Any]]:
        """Answers by the name of the request."""
        return {
            "motion": self.motion, "votes": self.votes, "finer": self.finer, "coexisting": self.coexisting,
            "branches": self.branches, "job": self.job, "cancel": self.cancel, "export": self.export,
        }  # fmt: skip

    def data(self) -> dict[str, Any]:
        """The page's data; while a map fills, with the number of the job that fills it.

        A store that was not complete is read again: another process may fill it.
        """
        try:
            self.exploration = read_again(self.exploration)
        except WhirlmapError as error:
            raise Refused(HTTPStatus.CONFLICT, str(error)) from None
        data = page_data(self.exploration) | {"grows": self.exploration.store is not None}
        if self.filling:
            data["filling"] = self.filling.number
            if self.filling.result is not None and not self.filling.running:
                data["overview"] = self.filling.result
        return data

    def state(self) -> dict[str, Any]:
        """Whether kernels are compiled just now."""
        return {"compiling": self.progress.compiling > 0}

    def _values(self, request: Request) -> dict[str, float | str]:
        words = {name: switch.choices for name, switch in self.exploration.switches.items()}
        return values_of(request.get("values", {}), self.exploration.controls, words, "values")

    def _quantity(self, request: Request) -> str:
        model = self.exploration.system.model
        names = [*(s.name for s in model.states), *model.outputs]
        return known(request.get("quantity", names[0]), names, "quantity")

    def _motion(self, values: Values) -> Motion:
        key = tuple(sorted(values.items()))
        with self._lock:
            if key not in self._motions:
                system = system_at(self.exploration.system, self.exploration.controls, values)
                self._motions[key] = motion(system, self.exploration.labelling)
                while len(self._motions) > REMEMBERED:
                    self._motions.popitem(last=False)
            self._motions.move_to_end(key)
            return self._motions[key]

    def motion(self, request: Request) -> Any:
        """The motion at ``values``, with the spectrum of ``quantity``."""
        values, quantity = self._values(request), self._quantity(request)
        return motion_json(self._motion(values), quantity)

    def votes(self, request: Request) -> Any:
        """Begin the label with the votes of all indicators."""
        values = self._values(request)

        def work(job: Job) -> None:
            system = system_at(self.exploration.system, self.exploration.controls, values)
            found = diagnose.find(
                system, labelling=self.exploration.labelling, execution=Execution(self.workers, job), max_periods=LONGEST
            )
            job.put(verdict_json(found))

        return self.jobs.start(work).report(0)

    def finer(self, request: Request) -> Any:
        """Begin the map or diagram of a range, at ``values`` of what does not vary."""
        e = self.exploration
        if not e.axes:
            raise Refused(HTTPStatus.CONFLICT, "nothing varies here")
        given = request.get("ranges", {})
        if not isinstance(given, Mapping):
            raise Refused(HTTPStatus.UNPROCESSABLE_ENTITY, "ranges: expected two numbers by name")
        ranges = {known(name, e.axes, "ranges"): range_of(ends, f"range of {name}") for name, ends in given.items()}
        most = 4000 if len(e.axes) == 1 else 200
        count = None if request.get("count") is None else whole(request["count"], "count", 2, most)
        values = {k: v for k, v in self._values(request).items() if k not in e.axes}
        axes = e.axes if not ranges and count is None else range_axes(e, ranges, count)

        def work(job: Job) -> None:
            compute(job, e, system_at(e.system, e.controls, values), axes, workers=self.workers)

        return self.jobs.start(work).report(0)

    def coexisting(self, request: Request) -> Any:
        """Begin the motions that come to a point from below and from above along an axis."""
        values, quantity = self._values(request), self._quantity(request)
        along = known(request.get("along", next(iter(self.exploration.controls))), self.exploration.controls, "along")
        return self.jobs.start(
            lambda job: job.put(coexisting(job, self.exploration, values, along, quantity))
        ).report(0)  # fmt: skip

    def branches(self, request: Request) -> Any:
        """Begin the branch through a point of a diagram, or the curves of the bifurcations of that of a map."""
        e, values = self.exploration, self._values(request)
        if not e.axes:
            raise Refused(HTTPStatus.CONFLICT, "branches lie over a diagram or a map: nothing varies here")
        return self.jobs.start(lambda job: follow_branches(job, e, values, self.workers)).report(0)

    def job(self, request: Request) -> Any:
        """Progress of a job, and its result where it is newer than ``version``."""
        number = whole(request.get("job"), "job", 1, 10**9)
        return self.jobs.job(number).report(whole(request.get("version", 0), "version", 0, 10**9))

    def cancel(self, request: Request) -> Any:
        """End a job."""
        job = self.jobs.job(whole(request.get("job"), "job", 1, 10**9))
        job.end()
        return job.report(job.version)

    def export(self, request: Request) -> Any:
        """Script, commands or data of the motion at ``values``."""
        values = self._values(request)
        kind = known(request.get("kind"), ("script", "command", "data"), "kind")
        if kind == "command":
            return {"text": "\n".join(exports.commands(self.exploration, values)) + "\n"}
        m = self._motion(values)
        return {"text": exports.script(self.exploration, values, m) if kind == "script" else exports.data_csv(m)}

    def __enter__(self) -> "Session":
        self.progress.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self.jobs.end()
        self.progress.__exit__(None, None, None)
