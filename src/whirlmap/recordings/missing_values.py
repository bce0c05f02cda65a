"""Missing values of a signal: which they are, and how they are filled."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import InputError
from whirlmap.recordings.table import Array

#: Missing values in a row that are filled, at most, and their largest share.
LONGEST_FILLED, MOST_FILLED = 3, 0.15


def words_are_missing(missing: Sequence[str | float]) -> bool:
    """Whether what is no number counts as missing: ``nan`` or ``empty`` is among them."""
    return bool({"nan", "empty"} & {str(m).strip().lower() for m in missing})


def is_missing(
    source: str, values: Array, missing: Sequence[str | float], notices: list[str], place: Callable[[int], str],
    refused: Callable[[int, int], InputError],
) -> NDArray[np.bool_]:
    """Which values are missing.

    Parameters
    ----------
    source : str
        Name of the file, for messages.
    values : array, shape (row,)
    missing : sequence of str or float
        Values that mean that there is none; ``nan`` for whatever is no number.
    notices : list of str
        What was found is added.
    place : callable
        Name of a row.
    refused : callable
        Error for the first value that is no number, from its row and how many there are, where ``nan`` is not missing.

    Raises
    ------
    InputError
        A value that is no number, a word of ``missing`` that is none, or nothing else than missing values.
    """
    gone = ~np.isfinite(values)
    if gone.any() and not words_are_missing(missing):
        raise refused(int(np.argmax(gone)), int(gone.sum()))
    for word in (str(m).strip().lower() for m in missing):
        if word in ("nan", "empty"):
            continue
        try:
            value = float(word.replace(",", "."))
        except ValueError:
            raise InputError(f"--missing: found {word!r}, expected a number such as -999, or nan") from None
        same = np.isclose(values, value, rtol=1e-6, atol=0.0)
        if not same.any():
            notices.append(f"--missing {word}: there is no such value")
        gone |= same
    if gone.all():
        raise InputError(f"{source}: found no value that is not missing, expected some")
    if gone.any():
        notices.append(f"{place(int(np.argmax(gone)))}: a value is missing ({int(gone.sum())} in all)")
    return gone


def filled(values: Array, index: NDArray[np.int64], notices: list[str]) -> tuple[Array, int]:
    """Values on every place of the even grid, and the place of the first; long gaps cut the record."""
    steps = np.diff(index)
    if (steps == 1).all():
        return values, int(index[0])
    lost = int((steps - 1).sum())
    if steps.max() - 1 > LONGEST_FILLED or lost > MOST_FILLED * (index[-1] - index[0] + 1):
        ends = np.r_[0, np.flatnonzero(steps > 1) + 1, index.size]
        best = int(np.argmax(np.diff(ends)))
        part = slice(ends[best], ends[best + 1])
        notices.append(
            f"only the longest part without missing values is read: {ends[best + 1] - ends[best]} of {values.size} values"
        )
        return values[part], int(index[part.start])
    from scipy.interpolate import CubicSpline

    every = np.arange(index[0], index[-1] + 1)
    if not any("filled" in text for text in notices):
        notices.append(f"{lost} missing values are filled by cubic interpolation")
    return np.asarray(CubicSpline(index.astype(float), values)(every.astype(float))), int(index[0])


