"""Worker threads that stop soon after an interrupt: Ctrl-C reaches the main thread alone."""

from concurrent.futures import ThreadPoolExecutor
from contextvars import ContextVar
from threading import Event
from types import TracebackType

from whirlmap.kernels.running.root_choice import RootChoice, adopt, chosen

#: Events that cancel the work of this thread: of its own pool, and of the pools around it.
_GIVEN_UP: ContextVar[tuple[Event, ...]] = ContextVar("given up", default=())


class Workers:
    """A pool of threads that take over the choice of roots, and stop when the ``with`` block ends by an exception.

    Parameters
    ----------
    count : int
        Threads.
    """

    def __init__(self, count: int) -> None:
        self.given_up = Event()
        events = (*_GIVEN_UP.get(), self.given_up)
        self.pool = ThreadPoolExecutor(count, initializer=_begin, initargs=(chosen(), events))

    def __enter__(self) -> ThreadPoolExecutor:
        """Return the pool."""
        return self.pool

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """Wait for the threads; where the block ended by an exception, have them stop first."""
        if kind is not None:
            self.given_up.set()
        self.pool.shutdown(cancel_futures=True)


def _begin(choice: RootChoice, events: tuple[Event, ...]) -> None:
    adopt(choice)
    _GIVEN_UP.set(events)


def stop_if_given_up() -> None:
    """Raise `KeyboardInterrupt` in a thread of `Workers` whose work was cancelled."""
    if any(event.is_set() for event in _GIVEN_UP.get()):
        raise KeyboardInterrupt
