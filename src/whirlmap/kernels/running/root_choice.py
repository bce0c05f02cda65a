"""How kernels compute roots and reciprocals, by estimates or by divisions: chosen by the model of the processor.

The two algorithms differ in the last bits of a result, so the choice follows from a table of measurements and never from a
measurement at run time: the bits would depend on what else the machine does. A store of a sweep keeps the choice that it was
begun with, and is continued with that one (`using`).
"""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Literal, NamedTuple, cast, get_args

from whirlmap.equations.model import Model
from whirlmap.errors import InputError
from whirlmap.kernels.running.machine import estimates, processor

Way = Literal["estimates", "divisions"]

#: Variable that overrides the table, for all kernels.
OVERRIDE = "WHIRLMAP_ROOTS"


class RootChoice(NamedTuple):
    """Algorithm for roots and reciprocals, by the kind of kernel.

    Attributes
    ----------
    plain : "estimates" or "divisions"
        Of kernels that read no table: films in closed form, and models without films.
    tables : "estimates" or "divisions"
        Of kernels that read tables: porous films and the positive arc. Most of their time goes into polynomials, beside
        which the divider works.
    """

    plain: Way
    tables: Way

    def __str__(self) -> str:
        return self.plain if self.plain == self.tables else f"{self.plain}, with tables {self.tables}"


class Measured(NamedTuple):
    """Processor time of a step by divisions over that by estimates, by the kind of kernel; below 1 divisions are faster."""

    plain: float
    tables: float


#: By LLVM's name of the processor: the step of the gear pair by `dop853` without tangent vectors. ``benchmarks/roots.py``
#: measures a processor that is not here.
MEASURED: Mapping[str, Measured] = {
    # Intel family 6, model 207; medians of four runs on a busy machine, which differed by up to 13 %. dop853, dop853 with a
    # tangent vector, rk4: psi = 0: 1.40, 1.26, 1.38; psi = 0.001: 1.14, 1.04, 1.10; positive arc (tables): 1.27, 1.14, 1.25.
    "emeraldrapids": Measured(plain=1.40, tables=1.14),
    # AMD Zen 4. psi = 0: divisions 3 to 6 % faster; psi = 0.001: 6 % slower. The positive arc was not measured.
    "znver4": Measured(plain=0.955, tables=1.06),
}

#: Where nothing was measured: estimates gained up to 40 % where they gained, and lost 6 % at most.
UNMEASURED = RootChoice("estimates", "estimates")

DIVISIONS = RootChoice("divisions", "divisions")

_USED: ContextVar[RootChoice | None] = ContextVar("root choice", default=None)


def own_choice() -> RootChoice:
    """Choice for the processor that code is made for: ``$WHIRLMAP_ROOTS`` where set, else by the table.

    A target without estimates (no AVX-512, or a level of ``$WHIRLMAP_CPU``, whose bits must be those of every processor)
    always divides.

    Raises
    ------
    InputError
        The variable names no way that the target has.
    """
    asked, had = os.environ.get(OVERRIDE, ""), estimates()
    if asked:
        ways = get_args(Way) if had else ("divisions",)
        if asked not in ways:
            raise InputError(f"{OVERRIDE}: found {asked!r}, expected {' or '.join(ways)} for {processor()[0]}, or nothing")
        return RootChoice(cast(Way, asked), cast(Way, asked))
    if not had:
        return DIVISIONS
    measured = MEASURED.get(processor()[0])
    if measured is None:
        return UNMEASURED
    return RootChoice(_faster(measured.plain), _faster(measured.tables))


def _faster(ratio: float) -> Way:
    return "divisions" if ratio < 1 else "estimates"


def chosen() -> RootChoice:
    """Choice in force: that of `using` where one is, else `own_choice`."""
    return _USED.get() or own_choice()


@contextmanager
def using(choice: RootChoice) -> Iterator[None]:
    """Compute with a given choice inside of the context, in this thread; other threads keep theirs.

    An ensemble is made and advanced in the same context: step retries get their kernel while it advances.
    """
    token = _USED.set(choice)
    try:
        yield
    finally:
        _USED.reset(token)


def adopt(choice: RootChoice) -> None:
    """Compute with a given choice in this thread from now on: for threads that work for one that has chosen."""
    _USED.set(choice)


def by_estimates(model: Model) -> bool:
    """Whether the kernels of a model use estimates: one answer for all of them, so that they agree on every bit."""
    choice = chosen()
    return (choice.tables if model.tables else choice.plain) == "estimates"


def possible(choice: RootChoice) -> bool:
    """Whether the processor that code is made for can compute with a choice."""
    return choice == DIVISIONS or estimates()


def reason() -> str:
    """Why `own_choice` is what it is, as words."""
    name = processor()[0]
    if os.environ.get(OVERRIDE):
        return f"{OVERRIDE} says so"
    if not estimates():
        return f"kernels for {name} have no estimates of whole vectors"
    if name not in MEASURED:
        return f"{name} has not been measured: the default where there are estimates"
    return "measured: divisions take {:g} times as long, with tables {:g} times".format(*MEASURED[name])
