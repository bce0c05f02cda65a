"""Long work behind a page: run in a thread, asked for its progress, ended when it is not wanted any more."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from http import HTTPStatus
from typing import Any

from whirlmap.errors import WhirlmapError
from whirlmap.explorer.limits import Refused

#: Jobs that run at once, those that are remembered, and seconds that the server waits for them when it ends.
AT_ONCE, KEPT, WAIT = 3, 32, 10.0


class Ended(BaseException):
    """Raised inside of a job that is to end; no `Exception`, so that nothing on the way takes it for a failure."""


@dataclass
class Job:
    """Long work.

    Attributes
    ----------
    number : int
    done, total : int
        Counted in whatever the work counts; ``total`` 0 where nobody knows.
    result : object
        What is finished so far, or in the end: JSON.
    version : int
        Rises with every new result.
    error : str
        Why it failed.
    """

    number: int
    done: int = 0
    total: int = 0
    result: Any = None
    version: int = 0
    error: str = ""
    running: bool = True
    begun: float = field(default_factory=time.monotonic)
    thread: threading.Thread | None = None
    _end: threading.Event = field(default_factory=threading.Event)

    def __call__(self, done: int) -> None:
        """Count what was done; ends the work where it is not wanted any more."""
        self.done += done
        self.check()

    def check(self) -> None:
        """End the work here where it is not wanted any more."""
        if self._end.is_set():
            raise Ended

    def put(self, result: Any) -> None:
        """Give a result, which replaces an earlier one."""
        self.result, self.version = result, self.version + 1

    def end(self) -> None:
        """Have the work end at its next step."""
        self._end.set()

    def report(self, known: int) -> dict[str, Any]:
        """What the page is told: progress, and the result where it is newer than the version that the page has."""
        facts = {
            "job": self.number, "done": self.done, "total": self.total, "running": self.running, "error": self.error,
            "version": self.version, "seconds": time.monotonic() - self.begun,
        }  # fmt: skip
        return facts | ({"result": self.result} if self.version > known else {})


class Jobs:
    """The jobs of a server, by their numbers."""

    def __init__(self) -> None:
        self._jobs: dict[int, Job] = {}
        self._lock = threading.Lock()
        self._last = 0

    def start(self, work: Callable[[Job], None]) -> Job:
        """Run work in a thread of its own.

        Raises
        ------
        Refused
            Too many run already.
        """
        with self._lock:
            if sum(job.running for job in self._jobs.values()) >= AT_ONCE:
                raise Refused(HTTPStatus.TOO_MANY_REQUESTS, f"{AT_ONCE} computations run already: wait, or cancel one")
            self._last += 1
            job = self._jobs[self._last] = Job(self._last)
            for number in [n for n, one in self._jobs.items() if not one.running][: max(len(self._jobs) - KEPT, 0)]:
                del self._jobs[number]
        job.thread = threading.Thread(target=_run, args=(job, work), daemon=True, name=f"explorer job {job.number}")
        job.thread.start()
        return job

    def job(self, number: int) -> Job:
        """Find a job by its number."""
        if number not in self._jobs:
            raise Refused(HTTPStatus.NOT_FOUND, "there is no such computation")
        return self._jobs[number]

    def end(self) -> None:
        """End all jobs, and wait for them."""
        for job in list(self._jobs.values()):
            job.end()
        until = time.monotonic() + WAIT
        for job in list(self._jobs.values()):
            if job.thread:
                job.thread.join(max(until - time.monotonic(), 0.0))


def _run(job: Job, work: Callable[[Job], None]) -> None:
    try:
        work(job)
    except Ended:
        job.error = "cancelled"
    except WhirlmapError as error:
        job.error = str(error)
    except Exception as error:  # the page says so; the server goes on
        job.error = f"{type(error).__name__}: {error}"
    finally:
        job.running = False
