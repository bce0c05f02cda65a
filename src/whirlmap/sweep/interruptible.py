"""Long work in batches, so that Ctrl-C keeps the batches that are finished."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import xarray as xr

#: Seconds that a batch should take: so much work is lost by an interrupt at most, where the points of a batch are alike.
SECONDS = 5.0
#: How many times as large a batch may be as the one before.
GROWTH = 8

#: ``on_batch(done, total)`` after each batch.
OnBatch = Callable[[int, int], None]


@dataclass(frozen=True)
class Work:
    """What was done of a piece of work: all of it, or what was finished when Ctrl-C came.

    Attributes
    ----------
    dataset : xr.Dataset or None
        None where nothing was finished. Carries the attribute ``incomplete`` where something is missing.
    done, total : int
        Points, or T.
    """

    dataset: xr.Dataset | None
    done: int
    total: int

    @property
    def complete(self) -> bool:
        """Whether all was done."""
        return self.done == self.total


def batches(count: int, *, first: int, most: int, seconds: float = SECONDS) -> Iterator[slice]:
    """Batches of so many points, in order: the first is small, the others as large as take some seconds.

    The time of a batch is that until the next one is asked for. The numbers of points do not depend on their batches.

    Parameters
    ----------
    first, most : int
        Points in the first batch, and in any batch at most; no later batch is smaller than the first.
    seconds : float
        That a batch should take.
    """
    at, size = 0, min(first, most)
    while at < count:
        begun = time.monotonic()
        yield slice(at, min(at + size, count))
        at += size
        wanted = size * min(seconds / max(time.monotonic() - begun, 1e-3), GROWTH)
        size = int(min(max(wanted, first), most))
