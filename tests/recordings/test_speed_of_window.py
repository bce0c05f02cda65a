"""The speed beside a part of a record is the speed of that part."""

import numpy as np
import pytest

from whirlmap.cli.common.series_texts import turns_per_second
from whirlmap.errors import InputError
from whirlmap.recordings.signal import read_signal

RATE = 1000


@pytest.fixture
def run_up(tmp_path):
    """Ten seconds from 600 to 1200 rpm, with the speed and a pulse once per turn."""
    t = np.arange(10 * RATE) / RATE
    turned = 10 * t + 0.5 * t**2
    pulse = 5.0 * (turned % 1 < 0.2)
    file = tmp_path / "run_up.csv"
    rows = np.c_[t, np.sin(2 * np.pi * turned), 60 * (10 + t), pulse]
    np.savetxt(file, rows, "%.6f", ",", header="t[s],x[um],n[rpm],key[V]", comments="")
    return file


@pytest.mark.parametrize(("column", "error"), [("n", 1e-4), ("key", 0.02)])
def test_speed_is_that_of_the_window(run_up, column, error):
    part = read_signal(run_up, column="x", speed=column, window=(8.0, 9.0))
    assert part.speed == pytest.approx(18.5, rel=error)
    assert read_signal(run_up, column="x", speed=column).speed == pytest.approx(15, rel=error)


def test_a_speed_needs_its_unit(run_up):
    with pytest.raises(InputError, match="'1480 rpm' or '1480 Hz'"):
        read_signal(run_up, column="x", speed="1480")
    assert turns_per_second("1500 1/min") == (pytest.approx(25), None)
