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
    names = list(known)
    close = get_close_matches(name, names, n=1, cutoff=0.5)
    if not close:
        folded = {known_name.lower(): known_name for known_name in names}
        close = [folded[name.lower()]] if name.lower() in folded else []
    return f" Did you mean {close[0]!r}?" if close else ""
