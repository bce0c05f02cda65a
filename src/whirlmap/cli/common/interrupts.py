"""Ctrl-C: the first ends the work and keeps what is finished; one before there is any work, and a second one, end at once.

The signal by which other programs ask one to end (SIGTERM: ``kill``, the end of a job's time) is answered alike.
Nothing is imported here that takes time: Ctrl-C may come while the program itself is still being read.
"""

import os
import signal
import sys
from typing import Any, NoReturn

#: Exit code of a program that was interrupted.
INTERRUPTED = 130
#: Signals that are answered.
SIGNALS = (signal.SIGINT, signal.SIGTERM)


def begin() -> None:
    """Have Ctrl-C end the program at once, until `keep` is called; where it is ignored (``nohup``, ``&``) it stays so."""
    for number in SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, end_at_once)


def keep() -> None:
    """From now on have the first Ctrl-C raise `KeyboardInterrupt`, which commands answer."""
    _replace(end_at_once, first)


def first(signum: int, frame: Any) -> NoReturn:  # noqa: ARG001 (a signal's handler)
    """Raise `KeyboardInterrupt`; the next Ctrl-C ends the program."""
    _replace(first, end_at_once)
    raise KeyboardInterrupt


def _replace(handler: Any, other: Any) -> None:
    for number in SIGNALS:
        if signal.getsignal(number) is handler:
            signal.signal(number, other)


def end_at_once(signum: int, frame: Any) -> NoReturn:  # noqa: ARG001 (a signal's handler)
    """Say what was written, leave no half-written file and no process, and end the program."""
    writing = sys.modules.get("whirlmap.results.files")
    written = [str(path) for path in getattr(writing, "WRITTEN", ())]
    if writing is not None:
        for trial in tuple(writing.UNFINISHED):
            writing.drop(trial)
    if "multiprocessing" in sys.modules:
        for process in sys.modules["multiprocessing"].active_children():
            process.kill()
    if sys.stderr.isatty():
        sys.stderr.write("\x1b[?25h")  # a progress bar hides the cursor
    kept = f"written before: {' '.join(written)}" if written else "nothing was written"
    sys.stderr.write(f"\ninterrupted, and ended at once: {kept}\n")
    sys.stderr.flush()
    os._exit(INTERRUPTED)
