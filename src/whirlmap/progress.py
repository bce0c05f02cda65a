"""Progress of long work: a bar on a terminal and in notebooks, a line at intervals elsewhere; on standard error."""

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Any, Self

from whirlmap.forecast import Forecast
from whirlmap.notebook_bar import NotebookBar

#: Seconds between lines where standard error is neither a terminal nor a notebook, and between two drawings of a bar.
EVERY, DRAWN = 10.0, 0.1
#: Most of the work that is called done before it is: the end of what takes longer than expected is not known.
MOST = 0.99

#: Those that are shown now, which say so where kernels are compiled.
_SHOWN: "list[Progress]" = []


class Progress:
    """Progress in periods T, summed over operating points, or in points; safe to call from threads.

    Parameters
    ----------
    what : str
        A word or two, in front of the bar.
    total : float or None
        Periods expected; None where unknown.
    quiet : bool
        Show nothing.
    most : bool
        ``total`` is an upper bound: the work may well end earlier.
    unit, rate_unit : str
        What is counted.
    points : int, optional
        Operating points to be labelled: the time left then follows from how they fare (`whirlmap.forecast`), and ``total``
        is what they take at least.
    """

    def __init__(
        self,
        what: str,
        total: float | None,
        *,
        quiet: bool = False,
        most: bool = False,
        unit: str = "periods",
        rate_unit: str = "T/s",
        points: int = 0,
    ) -> None:
        self.unit, self.rate_unit = unit, rate_unit
        self.what, self.total, self.quiet, self.most = what, total, quiet, most
        self.done, self.note, self.compiling = 0, "", 0
        self.forecast = Forecast(points, (total or 0.0) / points) if points else None
        self._lock = threading.Lock()
        self._bar: Any = None
        self._idle, self._begun, self._last, self._counted = 0.0, time.monotonic(), 0.0, 0.0

    def __enter__(self) -> Self:
        """Show the bar."""
        self._begun = self._counted = time.monotonic()
        self._last = self._begun
        if not self.quiet and (bar := _bar(self.most)):
            self._bar, self._last = bar, 0.0
            self._task = bar.add_task(self.what, total=1.0, rate="", left="")
            bar.start()
        _SHOWN.append(self)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """Take the bar away; full where the work ended well."""
        _SHOWN.remove(self)
        if self._bar:
            if kind is None:
                self._bar.update(self._task, completed=1.0)
            self._bar.stop()

    def __call__(self, periods: int) -> None:
        """Count periods, or points, done."""
        with self._lock:
            self.done += periods
            if self.total is not None and self.done > self.total:
                self.total = self.done
            self._spend(periods)
            self._show()

    def expect(self, total: float, note: str = "") -> None:
        """Correct the number expected; ``note`` says how far the work is in its own words."""
        with self._lock:
            self.total, self.note = max(total, self.done), note

    def open_ended(self, note: str) -> None:
        """Say that from now on nobody knows how much is left; ``note`` says how far the work is in its own words."""
        with self._lock:
            self.total, self.forecast, self.note = None, None, note

    def settled(self, points: int, opened: int, longest: float) -> None:
        """Say that points have settled (`Forecast.settle`)."""
        self._tell(lambda forecast: forecast.settle(points, opened, longest))

    def nonperiodic_points(self, left: int, ran: float) -> None:
        """Say how far points without a return are (`Forecast.run`)."""
        self._tell(lambda forecast: forecast.run(left, ran))

    def closed(self, points: int) -> None:
        """Say that points without a return are finished (`Forecast.close`)."""
        self._tell(lambda forecast: forecast.close(points))

    def begin(self, points: int, each: float) -> None:
        """Say that so many points begin to settle, for ``each`` T at least."""
        if self.forecast is None and self.total is None:
            self.forecast = Forecast(points, each)
        self._tell(lambda forecast: forecast.come(points))

    def more_points(self, points: int) -> None:
        """Say that so many points have turned out to be left."""
        self._tell(lambda forecast: setattr(forecast, "points", forecast.settled + points))

    def later(self, points: int) -> None:
        """Say that work on so many points comes behind the present one."""
        self._tell(lambda forecast: setattr(forecast, "later", points))

    def _tell(self, change: Callable[[Forecast], None]) -> None:
        if self.forecast is None:
            return
        with self._lock:
            self._spend(0)
            change(self.forecast)

    def _spend(self, periods: float) -> None:
        now = time.monotonic() - self._idle
        if self.forecast:  # what comes before the first T is preparation
            self.forecast.spend(periods, max(now - self._counted, 0.0) if self.done > periods else 0.0)
        self._counted = now

    def _show(self) -> None:
        now = time.monotonic()
        if self.quiet or now - self._last < (DRAWN if self._bar else self.every):
            return
        self._last = now
        if not self._bar:
            sys.stderr.write(f"{self.line(now)}\n")
            sys.stderr.flush()
            return
        left = self.seconds_left(now)
        share = None if left is None else min(self.share(now), MOST)
        what = f"{self.what}: compiling kernels" if self.compiling else self.what
        self._bar.update(
            self._task, description=what, total=None if share is None else 1.0, completed=share or 0.0, rate=self._rate(now),
            left="" if left is None else clock(left),
        )  # fmt: skip

    @property
    def every(self) -> float:
        """Seconds between lines."""
        return EVERY

    def seconds_left(self, now: float) -> float | None:
        """Seconds that are left; None where nothing is known, as of work that goes on beyond the number expected."""
        if self.forecast:
            return self.forecast.seconds_left()
        spent = now - self._begun - self._idle
        return spent * (self.total / self.done - 1) if self.total and 0 < self.done < self.total else None

    def share(self, now: float) -> float:
        """Share of the work that is done: of the T expected, or of the seconds where they follow from a forecast."""
        left, spent = self.seconds_left(now), max(now - self._begun - self._idle, 1e-9)
        if self.forecast and left is not None:
            return spent / (spent + left)
        return self.done / self.total if self.total else 0.0

    @contextmanager
    def while_compiling(self) -> Iterator[None]:
        """Say that kernels are compiled; the time of it counts for no rate."""
        begun = time.monotonic()
        with self._lock:
            self.compiling += 1
            if self._bar:
                self._last = 0.0
                self._show()
        try:
            yield
        finally:
            with self._lock:
                self.compiling -= 1
                self._idle += time.monotonic() - begun
                self._last = 0.0 if self._bar else self._last

    def _rate(self, now: float) -> str:
        spent = max(now - self._begun - self._idle, 1e-9)
        return f"{self.done / spent:.3g} {self.rate_unit}" + (f", {self.note}" if self.note else "")

    def line(self, now: float) -> str:
        """Progress in one line of text."""
        spent, left = now - self._begun, self.seconds_left(now)
        parts = [f"{self.what}: {self.done:.3g} {self.unit} in {clock(spent)}", self._rate(now)]
        if left is not None:
            bound, share = "at most " if self.most else "", self.share(now)
            share = min(share, MOST) if self.forecast else share
            parts[0] = f"{self.what}: {100 * share:.0f} % in {clock(spent)}"
            parts.append(f"{bound}{clock(left)} left")
        return ", ".join(parts)


def clock(seconds: float) -> str:
    """Seconds as people read them: ``0:42``, ``1:02:07``."""
    minutes, s = divmod(round(seconds), 60)
    hours, m = divmod(minutes, 60)
    return f"{hours}:{m:02d}:{s:02d}" if hours else f"{m}:{s:02d}"


@contextmanager
def compiling() -> Iterator[None]:
    """Have what is shown say that kernels are compiled."""
    shown = _SHOWN[-1:]
    if not shown:
        yield
        return
    with shown[0].while_compiling():
        yield


def tell(progress: Any, what: str, *numbers: float) -> None:
    """Tell a `Progress` how operating points fare; a plain callable is not told."""
    if isinstance(progress, Progress):
        getattr(progress, what)(*numbers)


def _bar(most: bool) -> Any:
    """Bar where there is a terminal (rich's) or a notebook to show it in, else None."""
    if not sys.stderr.isatty() and "IPython" not in sys.modules:
        return None
    from rich import console, progress

    to, left = console.Console(stderr=True), "left, at most" if most else "left"
    if to.is_jupyter:
        return NotebookBar(left)
    if not to.is_terminal:
        return None
    return progress.Progress(
        progress.TextColumn("{task.description}"), progress.BarColumn(), progress.TaskProgressColumn(),
        progress.TextColumn("{task.fields[rate]}"), progress.TimeElapsedColumn(),
        progress.TextColumn(left), progress.TextColumn("{task.fields[left]}"),
        console=to, transient=True,
    )  # fmt: skip
