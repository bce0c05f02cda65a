"""Options of a diagnosis of a signal: rate in words, orders of a shaft, windows with their reasons, missing values."""

import json

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.signals.diagnose_series import diagnose_series, series_json
from whirlmap.errors import InputError, RangeError
from whirlmap.results.regime import Regime

RATE = 2000.0
T = np.arange(8000) / RATE
#: 25 turns per second, a half order and the mesh of 23 teeth.
SHAFT = np.cos(2 * np.pi * 25 * T) + 0.5 * np.cos(np.pi * 25 * T + 0.4) + 0.3 * np.cos(2 * np.pi * 575 * T)


def names(ds):
    return [line["order_name"] for line in json.loads(ds.attrs["indicators"])["spectrum"]["named"]]


def test_a_rate_in_words_is_per_second():
    assert diagnose_series(SHAFT, rate="2 kHz").equals(diagnose_series(SHAFT, rate=RATE))
    for rate, unit in (("2000", "s"), ("fast", "s"), ("0 Hz", "s"), ("2 kHz", "ms")):
        with pytest.raises(RangeError, match="rate"):
            diagnose_series(SHAFT, rate=rate, unit=unit)


@pytest.mark.parametrize("speed", [25.0, "1500 rpm", "1500 1/min", np.full(T.size, 25.0)])
def test_lines_are_orders_of_the_shaft(speed):
    ds = diagnose_series(SHAFT, rate=RATE, speed=speed, teeth=23)
    assert names(ds) == ["1x", "1/2x", "mesh"] and ds.attrs["speed"] == pytest.approx(25)


def test_impossible_speeds_are_refused():
    for speed in ("1500", "column n", 0.0, np.nan, np.ones(5)):
        with pytest.raises(RangeError, match="speed"):
            diagnose_series(SHAFT, rate=RATE, speed=speed)
    with pytest.raises(RangeError, match="teeth"):
        diagnose_series(SHAFT, rate=RATE, teeth=23)


def test_lines_of_the_dataset_are_fitted():
    """The peak of the spectrum lies a hundred times further from the true frequency."""
    for frequency in (11.356564, 24.6713):
        x = np.cos(2 * np.pi * frequency * T) + 0.3 * np.cos(2 * np.pi * 2.137 * frequency * T + 1)
        found = diagnose_series(x, rate=RATE)
        assert found["line_frequency"].values[0] == pytest.approx(frequency, rel=1e-7)


def run_up():
    """From 20 to 40 turns per second in eight seconds, a line at 1x."""
    t = np.arange(16000) / RATE
    speed = 20 + 2.5 * t
    return np.cos(2 * np.pi * np.cumsum(speed) / RATE), speed


def test_each_window_has_its_own_speed():
    x, speed = run_up()
    ds = diagnose_series(x, rate=RATE, speed=speed, window=0.9, start=100.0)
    middle = ds["window_start"].values - 100 + 0.45
    np.testing.assert_allclose(ds["window_speed"], 20 + 2.5 * middle, rtol=1e-3)
    known = np.isfinite(ds["window_frequency"].values)
    assert ds["window_start"].values[0] == 100 and ds["window_order"].attrs["units"] == "1"
    assert not known.any() or np.allclose(ds["window_order"].values[known], 1, rtol=0.05)


def test_a_window_says_why_it_has_no_regime():
    short = diagnose_series(np.cos(2 * np.pi * 25 * T), rate=RATE, window=0.6)  # 15 oscillations
    assert set(short["window_reason"].values) == {"too short: 15 oscillations, 30 needed"}
    assert set(short["window_regime"].values) == {int(Regime.undecided)}
    still = diagnose_series(np.where(T < 2, np.cos(2 * np.pi * 100 * T), 0.0), rate=RATE, window=1.0)
    assert still["window_reason"].values.tolist()[-1] == "constant" and still["window_reason"].values[0] == ""
    rng = np.random.default_rng(3)
    noisy = diagnose_series(np.sin(0.2 * np.arange(8000)) + 0.2 * rng.normal(size=8000), rate=1.0, window=4000)
    assert "dB above the rest, 17 needed" in str(noisy["window_reason"].values[0])


def test_a_part_is_that_part():
    x, speed = run_up()
    part = diagnose_series(x, rate=RATE, speed=speed, window=(4.0, 6.0))
    assert part.attrs["start"] == 4 and part.attrs["samples"] == 4000
    assert part.attrs["speed"] == pytest.approx(32.5, rel=1e-3)
    with pytest.raises(RangeError, match="goes from"):
        diagnose_series(x, rate=RATE, window=(40.0, 60.0))


def test_missing_values_are_filled_or_end_the_record():
    x = SHAFT.copy()
    x[[100, 500, 501]] = np.nan
    with pytest.raises(RangeError, match="sample 101"):
        diagnose_series(x, rate=RATE)
    with pytest.warns(UserWarning, match="3 missing values are filled"):
        ds = diagnose_series(x, rate=RATE, missing=["nan"])
    assert "3 missing values" in ds.attrs["warnings"] and Regime(int(ds["regime"])) == Regime.periodic
    x[1500:1600] = -999
    with pytest.warns(UserWarning, match="longest part"):
        ds = diagnose_series(x, rate=RATE, missing=[np.nan, -999], speed=np.linspace(20, 30, x.size))
    assert ds.attrs["start"] == pytest.approx(0.8) and ds.attrs["samples"] == 6400
    assert ds.attrs["speed"] == pytest.approx(26, rel=1e-3)
    x[:] = np.nan
    with pytest.raises(InputError, match="no value"):
        diagnose_series(x, rate=RATE, missing=["nan"])


def test_what_is_not_steady_has_no_zero_one_test():
    found = series_json(diagnose_series(SHAFT * np.exp(-T), rate=RATE))
    assert found["regime"] == "not-steady" and found["indicators"]["zero_one"] == {"vote": "not-steady", "value": None}
    assert "0-1" not in found["verdict"]


def test_a_recording_is_diagnosed_as_it_was_read(tmp_path):
    file = tmp_path / "a.csv"
    np.savetxt(file, np.c_[T, SHAFT, np.full(T.size, 1500)], "%.6f", ",", header="t[s],x[um],n[rpm]", comments="")
    signal = whirlmap.read_signal(file, column="x", speed="n")
    ds = whirlmap.diagnose_series(signal, teeth=23)
    assert names(ds) == ["1x", "1/2x", "mesh"] and ds.attrs["quantity"] == "x" and ds["series"].attrs["units"] == "um"
    figure = whirlmap.plot.series_figure(ds, title="a.csv")
    labels = {text for axes in figure.axes for text in (axes.get_xlabel(), axes.get_ylabel())}
    assert {"x [um]", "frequency [Hz], 1x = 25", "power, $a^2/2$ [um²]"} <= labels
    assert figure.get_suptitle().startswith("a.csv, x: periodic (confidence 1)")
    marks = {text.get_text() for text in figure.axes[2].texts}
    assert marks == {"1x", "1/2x", "mesh"}
