"""Calls of machine code: what is passed for an array."""

import numpy as np
import pytest

from whirlmap.kernels.running.machine import begin


def test_the_address_of_an_array_is_that_of_its_first_number():
    """Also of what has no writable buffer; what is not in one piece is refused."""
    a = np.arange(12.0).reshape(3, 4)
    fixed = a.copy()
    fixed.flags.writeable = False
    for array in (a, a[1:], fixed, np.empty((0, 4)), np.arange(3)):
        assert begin(array) == array.ctypes.data
    with pytest.raises(AssertionError, match="gaps"):
        begin(a[:, ::2], "gaps")
