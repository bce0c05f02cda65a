"""Numbers of many operating points as one block of bytes with a list of contents, small where points share them."""

import base64
import gzip

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: A row of numbers over a grid: where it begins in the numbers, and how far apart neighbours along each axis are; zero along
#: an axis on which it does not depend.
PackedRow = list[int]


class Packing:
    """Collects arrays and bytes; `packed` is all of it, and every other method says where its part is.

    Numbers of rows count from the beginning of all numbers, in doubles; of tables and modules they are bytes and a length.
    """

    def __init__(self) -> None:
        self._numbers: list[Array] = []
        self._bytes: list[bytes] = []
        self._count = self._at = 0

    def rows(self, values: Array) -> list[PackedRow]:
        """Add rows over the grid, shape (row, axis...): each is kept along the axes on which it depends alone."""
        return [self._row(row) for row in values]

    def _row(self, row: Array) -> PackedRow:
        at, kept = self._count, row
        for axis in range(row.ndim):
            first = np.take(kept, [0], axis=axis)
            if np.array_equal(np.broadcast_to(first, kept.shape), kept):
                kept = first
        self._numbers.append(np.ascontiguousarray(kept).ravel())
        self._count += kept.size
        strides = np.array(np.empty(kept.shape, dtype=np.int8).strides)
        return [at, *(int(s) if n > 1 else 0 for s, n in zip(strides, kept.shape, strict=True))]

    def add(self, data: bytes) -> list[int]:
        """Add bytes, at a multiple of eight: where they begin, and how many they are."""
        at = self._at
        padded = data + b"\0" * (-len(data) % 8)
        self._bytes.append(padded)
        self._at += len(padded)
        return [at, len(data)]

    def doubles(self, values: Array) -> list[int]:
        """Add an array: the byte where it begins, and its length."""
        return [self.add(np.ascontiguousarray(values, dtype="<f8").tobytes())[0], values.size]

    def packed(self) -> tuple[bytes, list[int]]:
        """All bytes, and where the numbers of the rows are among them (byte, length)."""
        numbers = np.concatenate([np.zeros(0), *self._numbers]).astype("<f8")
        return b"".join([*self._bytes, numbers.tobytes()]), [self._at, numbers.size]


def text_of(data: bytes) -> str:
    """Bytes as text that a page can hold: gzip, then base64. The same bytes give the same text."""
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode()
