"""Progress of long work, on standard error: a bar on a terminal, a line every now and then elsewhere."""

import sys
import threading
import time
from types import TracebackType
from typing import Any

#: Seconds between lines where standard error is no terminal.
EVERY = 10.0


class Progress:
    """Progress in periods T, summed over operating points, or in points; safe to call from threads.

    Parameters
    ----------
    what : str
        A word or two, in front of the bar.
    total : float or None
        Periods expected; None where nobody knows.
    quiet : bool
        Show nothing.
    most : bool
        ``total`` is an upper bound: the work may well end earlier.
    unit, rate_unit : str
        What is counted.
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
    ) -> None:
        self.unit, self.rate_unit = unit, rate_unit
        self.what, self.total, self.quiet, self.most = what, total, quiet, most
        self.done, self.note = 0, ""
        self._lock = threading.Lock()
        self._bar: Any = None

    def __enter__(self) -> "Progress":
        """Show the bar."""
        self._begun = self._last = time.monotonic()
        if not self.quiet and sys.stderr.isatty():
            self._bar = _bar(self.most)
            self._task = self._bar.add_task(self.what, total=self.total, rate="")
            self._bar.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """Take the bar away; full where the work ended well."""
        if self._bar:
            if kind is None:
                self._bar.update(self._task, total=max(self.done, 1), completed=max(self.done, 1))
            self._bar.stop()

    def __call__(self, periods: int) -> None:
        """Count periods, or points, done."""
        with self._lock:
            self.done += periods
            if self.total is not None and self.done > self.total:
                self.total = self.done
            now = time.monotonic()
            if self._bar:
                self._bar.update(self._task, completed=self.done, total=self.total, rate=self._rate(now))
            elif not self.quiet and now - self._last >= EVERY:
                self._last = now
                sys.stderr.write(f"{self.line(now)}\n")
                sys.stderr.flush()

    def expect(self, total: float, note: str = "") -> None:
        """Correct the number expected; ``note`` says how far the work is in its own words."""
        with self._lock:
            self.total, self.note = max(total, self.done), note

    def _rate(self, now: float) -> str:
        return f"{self.done / max(now - self._begun, 1e-9):.3g} {self.rate_unit}" + (f", {self.note}" if self.note else "")

    def line(self, now: float) -> str:
        """Progress in one line of text."""
        spent = now - self._begun
        parts = [f"{self.what}: {self.done:.3g} {self.unit} in {clock(spent)}", self._rate(now)]
        if self.total and self.done:
            bound = "at most " if self.most else ""
            parts[0] = f"{self.what}: {100 * self.done / self.total:.0f} % in {clock(spent)}"
            parts.append(f"{bound}{clock(spent * (self.total / self.done - 1))} left")
        return ", ".join(parts)


def clock(seconds: float) -> str:
    """Seconds as people read them: ``0:42``, ``1:02:07``."""
    minutes, s = divmod(round(seconds), 60)
    hours, m = divmod(minutes, 60)
    return f"{hours}:{m:02d}:{s:02d}" if hours else f"{m}:{s:02d}"


def _bar(most: bool) -> Any:
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )
    from rich.progress import Progress as Bar

    return Bar(
        TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(),
        TextColumn("{task.fields[rate]}"), TimeElapsedColumn(),
        TextColumn("left, at most" if most else "left"), TimeRemainingColumn(),
        console=Console(stderr=True), transient=True,
    )  # fmt: skip
