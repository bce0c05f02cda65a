"""Former name of `violations`, for one release."""

import warnings
from typing import Any

from whirlmap.assumptions import violations


def __getattr__(name: str) -> Any:
    """Give what has another name now, with a warning."""
    if name != "strained":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    new = "whirlmap.assumptions.violations.violations"
    warnings.warn(f"whirlmap.assumptions.strained.strained is now {new}", DeprecationWarning, stacklevel=2)
    return violations.violations
