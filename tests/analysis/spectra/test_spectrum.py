"""Spectra of series whose lines are known; Parseval, whirl directions, what is a line and what is not."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import find_peaks, get_window, lfilter, periodogram

from whirlmap.analysis.spectra import spectral_lines as spectral_module
from whirlmap.analysis.spectra.spectral_lines import LINE_STATUS, _peaks, spectral_lines
from whirlmap.analysis.spectra.spectrum import _COSINES, full_spectrum, power_spectrum
from whirlmap.errors import RangeError

N, RATE = 4096, 64.0
t = np.arange(N) / RATE
GOLDEN = (np.sqrt(5) - 1) / 2
windows = st.sampled_from(["boxcar", "hann", "hamming", "blackman", "blackmanharris", "flattop"])


def lines(x, **options):
    return spectral_lines(power_spectrum(x, rate=RATE), **options)


@given(
    amplitude=st.floats(1e-6, 1e6), line=st.integers(20, N // 2 - 20), phase=st.floats(0, 6.3), window=windows
)
@settings(max_examples=30, deadline=None)
def test_sine_shows_half_its_amplitude_squared(amplitude, line, phase, window):
    """On a bin, exactly, whatever the window."""
    s = power_spectrum(
        amplitude * np.cos(2 * np.pi * line * np.arange(N) / N + phase), rate=RATE, window=window
    )
    assert float(s.power[line]) == pytest.approx(amplitude**2 / 2, rel=1e-9)
    assert int(s.power.values.argmax()) == line
    assert float(s.frequency[line]) == pytest.approx(line * RATE / N)


def test_between_bins_hann_loses_and_flattop_does_not():
    x = 3 * np.sin(2 * np.pi * (100.5 / N) * np.arange(N))
    hann, flat = (power_spectrum(x, rate=RATE, window=w).power.values.max() for w in ("hann", "flattop"))
    assert hann == pytest.approx(0.7205 * 4.5, rel=1e-3)  # scalloping loss of 1.42 dB
    assert flat == pytest.approx(4.5, rel=3e-3)


@given(seed=st.integers(0, 1000), n=st.integers(8, 300), window=windows, rate=st.floats(1e-3, 1e3))
@settings(max_examples=40, deadline=None)
def test_parseval(seed, n, window, rate):
    x = np.random.default_rng(seed).standard_normal(n)
    s = power_spectrum(x, rate=rate, window=window, detrend=False)
    w = get_window(window, n)
    assert float(s.density.sum() * s.frequency_step) == pytest.approx(
        np.sum((w * x) ** 2) / np.sum(w**2), rel=1e-9
    )
    if window == "boxcar":
        assert float(s.density.sum() * s.frequency_step) == pytest.approx(np.mean(x**2), rel=1e-9)


def test_batches_are_their_lanes_and_means_are_dropped():
    x = np.random.default_rng(0).standard_normal((128, 3, 5)) + 100
    s = power_spectrum(x, rate=RATE, unit="T")
    assert s.power.dims == ("frequency", "state", "lane")
    alone = power_spectrum(x[:, 1, 4], rate=RATE)
    np.testing.assert_allclose(s.power[:, 1, 4], alone.power, rtol=1e-12)
    assert s.frequency.attrs["units"] == "1/T" and s.density.attrs["units"] == "T"
    assert float(s.power[0].max()) < 1 < float(power_spectrum(x, rate=RATE, detrend=False).power[0].min())
    assert all({"units", "long_name"} <= set(v.attrs) for v in s.variables.values())


# Whirl.


@given(
    forward=st.floats(0.01, 10),
    backward=st.floats(0.01, 10),
    line=st.integers(20, N // 2 - 20),
    turn=st.floats(0, 6.3),
)
@settings(max_examples=30, deadline=None)
def test_an_ellipse_is_two_circles(forward, backward, line, turn):
    angle = 2 * np.pi * line * np.arange(N) / N
    z = forward * np.exp(1j * (angle + turn)) + backward * np.exp(-1j * angle)
    s = full_spectrum(z.real, z.imag, rate=RATE)
    at = line * RATE / N
    assert float(s.forward.sel(whirl_frequency=at, method="nearest")) == pytest.approx(forward, rel=1e-9)
    assert float(s.backward.sel(whirl_frequency=at, method="nearest")) == pytest.approx(backward, rel=1e-9)
    assert float(s.amplitude.sel(frequency=-at, method="nearest")) == pytest.approx(backward, rel=1e-9)
    difference = np.exp(1j * (float(s.phase.sel(frequency=at, method="nearest")) - turn)) - 1
    assert abs(difference) < 1e-6


def test_half_axes_of_an_ellipse():
    angle = 2 * np.pi * 64 * np.arange(N) / N
    s = full_spectrum(5 * np.cos(angle), 2 * np.sin(angle), rate=RATE)
    assert float(s.forward.max()) == pytest.approx(3.5) and float(s.backward.max()) == pytest.approx(1.5)
    s = full_spectrum(5 * np.cos(angle), -5 * np.sin(angle), rate=RATE)  # clockwise circle
    assert float(s.backward.max()) == pytest.approx(5) and float(s.forward.max()) < 1e-12


@pytest.mark.parametrize("n", [31, 32])
def test_forward_and_backward_are_the_two_halves(n):
    """Odd and even lengths pair frequencies differently; Nyquist's has no twin."""
    rng = np.random.default_rng(n)
    s = full_spectrum(rng.standard_normal((n, 2)), rng.standard_normal((n, 2)), rate=1.0)
    assert (np.diff(s.frequency) > 0).all()
    for name, sign in (("forward", 1), ("backward", -1)):
        there = s.amplitude.sel(frequency=sign * s.whirl_frequency.values, method="nearest", tolerance=1e-12)
        np.testing.assert_array_equal(s[name].values, there.values)


# Lines.


def test_harmonics_are_all_found_with_their_power():
    """An 8T motion: 59 lines at eighths of the forcing frequency, amplitudes over five decades of power."""
    x = sum(np.sin(2 * np.pi * k * t / 2 + k) / k**1.5 for k in range(1, 60))
    found = lines(x, floor_width=200)
    assert int(found["count"]) == 59
    np.testing.assert_allclose(np.sort(found.line_frequency), np.arange(1, 60) / 2, atol=1e-9)
    np.testing.assert_allclose(found.line_power, 0.5 * np.arange(1, 60) ** -3.0, rtol=1e-6)
    assert float(found.line_fraction) == pytest.approx(1, abs=1e-9)


def test_two_incommensurate_lines_and_their_combinations():
    z = np.cos(2 * np.pi * 5 * t) + 0.5 * np.cos(2 * np.pi * 5 * GOLDEN * t)
    found = lines(z + 0.2 * z**2)
    expected = [5, 5 * GOLDEN, 5 * (1 - GOLDEN), 5 * (1 + GOLDEN), 10, 10 * GOLDEN]
    assert int(found["count"]) == 6
    np.testing.assert_allclose(np.sort(found.line_frequency), np.sort(expected), atol=0.02 * RATE / N)
    assert float(found.line_fraction) == pytest.approx(1, abs=2e-3)


@given(
    frequency=st.floats(1.0, 31.0), phase=st.floats(0, 6.3), window=windows.filter(lambda w: w != "boxcar")
)
@settings(max_examples=40, deadline=None)
def test_a_pure_sine_is_one_line_wherever_it_falls(frequency, phase, window):
    """Also between bins, where its leakage is largest; its power is not scalloped."""
    found = spectral_lines(
        power_spectrum(np.sin(2 * np.pi * frequency * t + phase), rate=RATE, window=window)
    )
    assert int(found["count"]) == 1
    assert float(found.line_power[0]) == pytest.approx(0.5, rel=2e-3)
    assert float(found.line_frequency[0]) == pytest.approx(frequency, abs=0.5 * RATE / N)


def test_line_in_noise():
    """Amplitude 0.5 in unit white noise: 1/9 of the power; the noise has density 2 / rate."""
    noise = np.random.default_rng(1).standard_normal(8 * N)
    time = np.arange(8 * N) / RATE
    found = lines(noise + 0.5 * np.sin(2 * np.pi * 3.1 * time))
    assert int(found["count"]) == 1
    assert float(found.line_frequency[0]) == pytest.approx(3.1, abs=1e-3)
    assert float(found.line_fraction) == pytest.approx(1 / 9, rel=0.12)  # the noise adds to the line with 3 %
    assert float(found.floor.median()) == pytest.approx(2 / RATE, rel=0.35)  # largest of three medians: above


def test_noise_has_no_lines():
    """200 spectra with false_alarm 1e-3: 0.2 lines expected, more than 3 has probability 6e-5."""
    noise = np.random.default_rng(2).standard_normal((1024, 200))
    found = lines(noise)
    assert int(found["count"].sum()) <= 3
    assert float(found.broadband_fraction.mean()) > 0.99


def test_coloured_noise_and_chaos_have_no_lines():
    rng = np.random.default_rng(3)
    brown = np.cumsum(rng.standard_normal((N, 8)), axis=0)
    x, y, z = 1.0, 1.0, 20.0
    chaos = []
    for i in range(8 * 4 * N):  # Lorenz by Euler with small steps: any chaotic series will do
        x, y, z = x + 0.004 * 10 * (y - x), y + 0.004 * (x * (28 - z) - y), z + 0.004 * (x * y - 8 / 3 * z)
        if i % 4 == 0:
            chaos.append(x)
    assert int(lines(brown)["count"].sum()) <= 1
    assert int(lines(np.array(chaos))["count"]) == 0


def test_a_narrow_resonance_is_not_a_line():
    """White noise through an oscillator with a bandwidth of 30 bins: narrow, but with flanks."""
    n, bandwidth = 8 * N, 30 * RATE / (8 * N)
    radius = np.exp(-np.pi * bandwidth / RATE)
    noise = np.random.default_rng(4).standard_normal((n, 8))
    ringing = lfilter([1.0], [1.0, -2 * radius * np.cos(2 * np.pi * 5 / RATE), radius**2], noise, axis=0)
    s = power_spectrum(ringing, rate=RATE)
    assert (
        s.density.sel(frequency=slice(4.9, 5.1)).sum("frequency") > 0.7 * s.density.sum("frequency")
    ).all()
    assert int(spectral_lines(s)["count"].sum()) <= 1


def test_lanes_are_padded_and_said():
    x = np.stack(
        [np.sin(2 * np.pi * 4 * t), np.sin(2 * np.pi * 4 * t) + 2 * np.sin(2 * np.pi * 9 * t), 0 * t], axis=1
    )
    found = lines(x)
    assert found["count"].values.tolist() == [1, 2, 0]
    assert found.line_present.values.tolist() == [[1, 1, 0], [0, 1, 0]]
    assert np.isnan(found.line_power.values[found.line_present.values == 0]).all()
    assert found.line_frequency.values[:, 1] == pytest.approx([9, 4])  # strongest first
    assert [LINE_STATUS[k] for k in found.status.values] == ["ok", "ok", "no-power"]
    assert all({"units", "long_name"} <= set(v.attrs) for v in found.variables.values())


def test_wrong_input_is_refused():
    with pytest.raises(RangeError, match="rate"):
        power_spectrum(t, rate=0.0)
    with pytest.raises(RangeError, match="window"):
        power_spectrum(t, rate=1.0, window="kaiser")
    with pytest.raises(RangeError, match="finite"):
        power_spectrum(np.where(t > 1, np.nan, t), rate=1.0)
    with pytest.raises(RangeError, match="8 samples"):
        power_spectrum(t[:5], rate=1.0)
    with pytest.raises(RangeError, match="x has shape"):
        full_spectrum(t, t[:-1], rate=1.0)
    with pytest.raises(RangeError, match="boxcar"):
        spectral_lines(power_spectrum(t, rate=1.0, window="boxcar"))
    with pytest.raises(RangeError, match="power_spectrum"):
        spectral_lines(full_spectrum(t, t, rate=1.0))
    with pytest.raises(RangeError, match="floor_width"):
        spectral_lines(power_spectrum(t, rate=1.0), floor_width=3)


@pytest.mark.parametrize("window", list(_COSINES))
@pytest.mark.parametrize("length", [64, 81])
def test_spectra_are_those_of_scipy(window, length):
    """SciPy's own take a second to import, so they are written out; even and odd lengths end differently."""
    x = np.random.default_rng(5).normal(size=(length, 2, 3))
    ds = power_spectrum(x, rate=4.0, window=window)
    weights = get_window(window, length)
    frequency, density = periodogram(x, fs=4.0, window=weights, detrend="constant", axis=0)
    assert np.array_equal(ds["frequency"], frequency)
    np.testing.assert_allclose(ds["density"][1:], density[1:], rtol=1e-11)  # both round; the mean is subtracted alike


def test_peaks_are_those_of_scipy_with_equal_neighbours_too():
    values = np.random.default_rng(6).integers(0, 4, size=500).astype(float)
    peaks = _peaks(values)
    assert np.any(values[peaks] == values[peaks + 1]), "the record has no flat top: the test has lost its case"
    assert np.array_equal(peaks, find_peaks(values)[0])
    assert _peaks(np.ones(9)).size == 0


@pytest.mark.parametrize("length", [1000, 1001])
def test_a_line_at_the_nyquist_frequency_is_seen(length):
    lines = spectral_lines(power_spectrum(3.0 + 2.0 * (-1.0) ** np.arange(length), rate=10.0))
    assert int(lines["count"]) == 1 and float(lines["line_frequency"][0]) == pytest.approx(5.0, abs=1e-9)
    assert float(lines["line_power"][0]) == pytest.approx(4.0, rel=1e-2)


def test_medians_of_long_spectra_are_those_of_short_ones(monkeypatch):
    x = np.random.default_rng(3).normal(size=5000)
    for width in (15, 16, 156):
        short = spectral_module._running_median(x, width)
        monkeypatch.setattr(spectral_module, "LONG", 0)
        np.testing.assert_array_equal(spectral_module._running_median(x, width), short)
        monkeypatch.undo()
