"""Long work in batches, so that Ctrl-C keeps the batches that are finished."""

import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import wraps
from inspect import signature
from typing import Any, ParamSpec, Protocol, Self, cast

import xarray as xr

from whirlmap.options.taking import takes_options

P = ParamSpec("P")

#: Seconds that a batch should take: so much work is lost by an interrupt at most, where the points of a batch are alike.
SECONDS = 5.0
#: How many times as large a batch may be as the one before.
GROWTH = 8

#: ``on_batch(done, total)`` after each batch.
OnBatch = Callable[[int, int], None]


class Work:
    """Long work in parts: iterating does one part after the other, and whoever iterates may stop after any of them.

    What is finished is in `dataset` at any time, also where Ctrl-C (`KeyboardInterrupt`) ended a part.

    Parameters
    ----------
    total : int
        Points, T or whatever is counted, as far as is known.
    parts : callable
        ``parts(work)``, a generator that does the work and gives how much is done after each part.
    gather : callable
        ``gather(work)``: the Dataset of what is finished, with the attribute ``incomplete`` where something is missing; None
        where nothing is finished.
    """

    def __init__(
        self, total: int, parts: "Callable[[Work], Iterator[int]]", gather: "Callable[[Work], xr.Dataset | None]"
    ) -> None:
        self.done, self.total = 0, total
        self._parts, self._gather = parts(self), gather
        self._made: list[xr.Dataset | None] = []

    def __iter__(self) -> Iterator[int]:
        """Do the next parts."""
        self._made.clear()
        for done in self._parts:
            self.done = done
            yield done
            self._made.clear()

    def run(self, on_batch: OnBatch | None = None) -> Self:
        """Do all of it, or what is finished when Ctrl-C comes; ``on_batch(done, total)`` after each part."""
        with suppress(KeyboardInterrupt):
            for done in self:
                if on_batch:
                    on_batch(done, self.total)
        return self

    def whole(self) -> xr.Dataset:
        """Do all of it; Ctrl-C ends it without a result."""
        for _ in self:
            pass
        assert self.dataset is not None
        return self.dataset

    @property
    def complete(self) -> bool:
        """Whether all was done."""
        return self.done == self.total

    @property
    def dataset(self) -> xr.Dataset | None:
        """What is finished."""
        if not self._made:
            self._made.append(self._gather(self))
        return self._made[0]


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


class InParts(Protocol[P]):
    """A function that gives a Dataset; ``parts``, with the same arguments, gives the `Work` that makes it."""

    parts: Callable[P, Work]

    def __call__(self, *arguments: P.args, **options: P.kwargs) -> xr.Dataset:
        """Do all of it."""


def in_parts(bar: str) -> Callable[[Callable[P, Work]], InParts[P]]:
    """Have a function that makes `Work` give its Dataset to those who call it; options as of `takes_options`."""

    def decorate(function: Callable[P, Work]) -> InParts[P]:
        @takes_options(bar)
        @wraps(function)
        def whole(*arguments: P.args, **options: P.kwargs) -> xr.Dataset:
            return function(*arguments, **options).whole()

        made: Any = whole
        made.parts, made.__signature__ = takes_options()(function), signature(made).replace(return_annotation=xr.Dataset)
        return cast(InParts[P], made)

    return decorate
