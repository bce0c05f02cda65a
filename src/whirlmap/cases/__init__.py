"""Cases: named, readable files of parameters, each number with its unit and its source."""

import warnings
from typing import Any

from whirlmap.cases.case import Case as Case
from whirlmap.cases.case import Given as Given
from whirlmap.cases.case import names as names
from whirlmap.cases.case import read as read
from whirlmap.cases.resolve import resolve as resolve
from whirlmap.cases.resolved import Resolved as Resolved


def __getattr__(name: str) -> Any:
    """Former names, for one release."""
    renamed: Any = {"settle": resolve, "Settled": Resolved}.get(name)
    if renamed is None:
        raise AttributeError(f"module 'whirlmap.cases' has no attribute {name!r}")
    warnings.warn(f"whirlmap.cases.{name} is now whirlmap.cases.{renamed.__name__}", DeprecationWarning, stacklevel=2)
    return renamed
