"""The exceptions of whirlmap.

::

    WhirlmapError
    ├── InputError(ValueError)      something the user wrote is wrong
    │   ├── CaseError               a case file, a symbol, a unit or a value in it
    │   ├── RangeError              a sweep range, a count, a start state
    │   └── OutputError             a place that cannot be written, or must not be overwritten
    ├── ModelError(ValueError)      a model declaration contradicts itself
    ├── IntegrationError            one single run did not reach its end (a sweep records a status instead)
    └── CacheError                  the folder of compiled kernels cannot be used

Every message says what was found, where, what was expected and the nearest right answer. The command line prints
`WhirlmapError` in one piece and exits with 2; anything else is a defect of whirlmap and keeps its traceback.
"""

from collections.abc import Iterable
from difflib import get_close_matches

#: Share of letters in common from which a name counts as a misspelling of another: `rk5` of `rk4` (0.67) does; what is
#: another word (`preload` beside `speed`, 0.5) must not be suggested.
CLOSE = 0.65


class WhirlmapError(Exception):
    """Whatever whirlmap raises on purpose."""


class InputError(WhirlmapError, ValueError):
    """Something that the user wrote is wrong."""


class CaseError(InputError):
    """A case file, a symbol, a unit or a value in it is wrong."""


class RangeError(InputError):
    """A sweep range, a count or a start state is wrong."""


class OutputError(InputError):
    """A place cannot be written, or must not be overwritten."""


class ModelError(WhirlmapError, ValueError):
    """A model declaration contradicts itself."""


class IntegrationError(WhirlmapError):
    """One single run did not reach its end."""


class CacheError(WhirlmapError):
    """The folder of compiled kernels cannot be used."""


def nearest(name: str, known: Iterable[str]) -> str:
    """Suggest the known name nearest to ``name``: `` Did you mean 'psi'?``, or nothing where none is near."""
    same = closest(name, known)
    return f" Did you mean {same!r}?" if same is not None else ""


def counted(number: int, noun: str) -> str:
    """Write a number of things: ``1 point``, ``2 points``."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def closest(name: str, known: Iterable[str]) -> str | None:
    """Find the known name nearest to ``name``: the same in another case, else one that is spelt nearly so."""
    names = list(known)
    folded: dict[str, str] = {}
    for known_name in names:
        folded.setdefault(known_name.casefold(), known_name)
    same = folded.get(name.casefold())  # a name in another case, before one that differs by more
    if same is None:
        close = get_close_matches(name, names, n=1, cutoff=CLOSE)
        close = close or [folded[k] for k in get_close_matches(name.casefold(), folded, n=1, cutoff=CLOSE)]
        same = close[0] if close else None
    return same
