"""Words of messages."""

import numpy as np

from whirlmap.errors import counted


def test_one_thing_is_not_several():
    assert [counted(n, "point") for n in (0, 1, 2)] == ["0 points", "1 point", "2 points"]
    assert counted(np.int64(1), "half-written file") == "1 half-written file"
