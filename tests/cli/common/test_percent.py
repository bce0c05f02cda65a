"""Shares as percentages."""

import pytest

from whirlmap.cli.common.report import percent


@pytest.mark.parametrize(
    ("share", "written"),
    [(1.0, "100 %"), (0.999999, "100 %"), (0.41, "41 %"), (0.041, "4.1 %"), (0.00041, "0.041 %"), (1.1e-7, "1.1e-05 %"),
     (0.0, "0 %")],
)  # fmt: skip
def test_a_share_of_one_is_a_hundred_percent(share, written):
    assert percent(share) == written
