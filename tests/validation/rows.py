"""What a test checks, recorded as it checks it: one row of the validation page."""

from typing import Any

import numpy as np
import pytest

#: Where a truth comes from: the strongest first.
TIERS = {
    "exact": "Closed forms and other consequences of the equations",
    "invariant": "Laws that every solution keeps",
    "published": "Values that others published",
    "independent": "Values of other codes and methods",
}


class Validation:
    """The fixture ``validate``: a call compares, records the row, and fails the test where the two do not agree."""

    def __init__(self, request: pytest.FixtureRequest):
        self._node = request.node

    def __call__(
        self, quantity: str, value: Any, truth: Any, *, tier: str, source: str, rel: Any = None, within: Any = None
    ) -> None:
        """Compare numbers, arrays of them, or words.

        Parameters
        ----------
        quantity : str
            What is compared, with the system and its parameters.
        value, truth : number, array or str
            What whirlmap says, and what is true. Of arrays the page shows the entry that is nearest to its tolerance. Words
            must be equal.
        tier : str
            One of `TIERS`.
        source : str
            Where the truth comes from.
        rel, within : float or array, optional
            Largest difference, relative to the truth or absolute; one of them for numbers.
        """
        assert tier in TIERS, tier
        if isinstance(value, str) or isinstance(truth, str):
            row = {"value": written(value), "truth": written(truth), "error": "", "tolerance": "equal", "of": 1}
            holds = value == truth
        else:
            row, holds = _compared(np.asarray(value, dtype=float), np.asarray(truth, dtype=float), rel, within)
        self._keep({"quantity": quantity, **row, "tier": tier, "source": source, "holds": bool(holds)})
        assert holds, f"{quantity}: {row['value']}, expected {row['truth']} ({row['tolerance']})"

    def claim(self, quantity: str, verdict: str, found: str, *, says: str, source: str) -> None:
        """Record the verdict on a statement of the paper; it may fail without a fault of the program."""
        self._keep({"quantity": quantity, "verdict": verdict, "found": found, "says": says, "source": source})

    def _keep(self, row: dict) -> None:
        self._node.user_properties.append(("validation", row))


def _compared(value: np.ndarray, truth: np.ndarray, rel: Any, within: Any) -> tuple[dict, bool]:
    """Row of numbers: the entry nearest to its tolerance, or farthest beyond it."""
    assert (rel is None) != (within is None), "numbers want rel or within, and not both"
    value, truth = np.broadcast_arrays(value, truth)
    allowed = np.broadcast_to(within if rel is None else rel * np.abs(truth), value.shape)
    error = np.abs(value - truth)
    share = np.where(error == 0, 0.0, error / np.where(allowed > 0, allowed, np.nan))
    share = np.where(np.isnan(share), np.inf, share)  # no number, or no tolerance
    at = np.unravel_index(int(share.argmax()), share.shape) if value.ndim else ()
    limit = np.broadcast_to(within if rel is None else rel, value.shape)[at]
    row = {
        "value": written(value[at]), "truth": written(truth[at]), "error": f"{error[at]:.1e}" if error[at] else "0",
        "tolerance": f"{limit:.2g}" + ("" if rel is None else " relative"), "of": int(value.size),
    }  # fmt: skip
    return row, bool((share <= 1).all())


def written(value: Any) -> str:
    """A number in twelve digits, words as they are."""
    return value if isinstance(value, str) else f"{float(value):.12g}"
