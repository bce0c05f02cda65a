"""Verdicts of signals whose motion is known: tones with and without a common period, records that change, noise."""

import numpy as np
import pytest
from scipy.signal import lfilter
from tests.analysis.maps import GOLDEN, henon, sines

from whirlmap.analysis.signals.diagnose_series import diagnose_series, series_json
from whirlmap.analysis.signals.order_names import order_name
from whirlmap.errors import RangeError


def verdict(x, rate=1.0):
    return series_json(diagnose_series(x, rate=rate))


def tone(phase):
    return np.sin(2 * np.pi * phase)


K = np.arange(4000)
F = 0.0311

PERIODIC = {
    "shaft and mesh at 23 times": (np.cos(2 * np.pi * 0.0071 * 23 * K) + 0.3 * np.cos(2 * np.pi * 0.0071 * K), 0.0071),
    "20 equal cosines": (sum(np.cos(2 * np.pi * 0.0071 * j * K + j) for j in range(1, 21)), 0.0071),
    "subharmonic at 1/9": (tone(F * K) + 0.2 * tone(F / 9 * K), F / 9),
    "3 and 7 without the first": (tone(0.03 * K) + 0.5 * tone(0.07 * K), 0.01),
    "square, between samples": (np.sign(tone(K / 20.37)), 1 / 20.37),
    "pulses": ((K % 137 < 3) * 1.0, 1 / 137),
    "three levels": (np.round(1.2 * tone(0.11 * K + 0.1)), 0.11),
    "period 2": (5.0 + 4 * (-1.0) ** K, 0.5),
    "period 2, odd number": (5.0 + 4 * (-1.0) ** K[:-1], 0.5),
    "period 3": (np.array([1.0, 5.0, 2.0])[K % 3], 1 / 3),
    "1 % of noise": (tone(F * K) + 0.01 * np.random.default_rng(0).normal(size=K.size), F),
}


@pytest.mark.parametrize("name", PERIODIC)
def test_periodic(name):
    x, frequency = PERIODIC[name]
    found = verdict(x)
    assert found["regime"] == "periodic"
    assert found["frequency"] == pytest.approx(frequency, rel=2e-5)
    assert found["lyapunov"] is None and found["indicators"]["rosenstein"]["vote"] == "neighbours-coincide"


@pytest.mark.parametrize("ratio", [GOLDEN, 2.4037, np.sqrt(2), np.pi / 3])
def test_two_tones_without_a_common_period(ratio):
    found = verdict(sines(6000, 0.021, 0.021 * ratio, amplitudes=(1, 0.6)))
    assert found["regime"] == "quasi-periodic" and found["period"] is None


CHANGES = {
    "growth by 1.3": (tone(F * K) * 1.3 ** (K / 4000), "level"),
    "growth by 1.3 over a slow line": ((tone(F * K) + 0.4 * tone(0.0031 * K)) * 1.5 ** (K / 4000), "level"),
    "decay": (tone(F * K) * np.exp(-K / 4000), "level"),
    "onset": (np.where(K > 3200, 1, 0.1) * tone(F * K), "level"),
    "onset in noise": ((K > 3600) * tone(F * K) + 0.3 * np.random.default_rng(1).normal(size=K.size), "level"),
    "stop": ((K < 3500) * tone(F * K), "level"),
    "chirp by 1 %": (tone(F * K * (1 + 0.01 * K / 8000)), "frequency"),
    "chirp by a third": (tone(F * K * (1 + 0.3 * K / 8000)), "frequency"),
    "other tone": (np.where(K < 2000, tone(F * K), tone(1.5 * F * K)), "frequency"),
    "period doubles": (tone(F * K) + np.where(K > 2000, 0.4, 0) * tone(F / 2 * K), "frequency"),
    "drift": (tone(F * K) + K / 4000, "mean"),
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_record_that_changes_is_not_steady(name):
    x, what = CHANGES[name]
    found = verdict(x)
    assert found["regime"] == "not-steady" and what in found["indicators"]["steadiness"]["changes"]
    assert found["lyapunov"] is None and found["period"] is None


def test_a_beat_is_steady():
    for beats in (5, 8, 20):
        assert verdict(tone(F * K) + 0.8 * tone((F + beats / 4000.3) * K))["indicators"]["steadiness"]["changes"] == []


def test_reasons_are_named():
    rng = np.random.default_rng(3)
    assert "17 dB" in verdict(tone(F * K) + 0.2 * rng.normal(size=K.size))["verdict"]
    slow = np.cumsum(rng.normal(size=K.size))
    assert "drift" in verdict(tone(F * K) + 0.4 * slow / slow.std())["verdict"]


@pytest.mark.parametrize("size", [1e-170, 1e160, 1.5e308])
@pytest.mark.parametrize("rate", [1e-250, 1.0, 1e200])
def test_the_verdict_has_no_scale(size, rate):
    with np.errstate(all="raise", under="ignore"):
        found = verdict(size * tone(F * K), rate)
    assert found["regime"] == "periodic" and found["frequency"] == pytest.approx(F * rate, rel=1e-6)


@pytest.mark.parametrize("rate", [0.0, -1.0, np.nan, np.inf, 1e-300, "100", None])
def test_impossible_rates_are_refused(rate):
    with pytest.raises(RangeError, match="rate"):
        diagnose_series(tone(F * K), rate=rate)


def test_orders_and_sidebands():
    names = [order_name(f, 10.0, 23, 0.1) for f in (10, 20, 5, 230, 240, 460, 200, 77, 33.3, 1000)]
    assert names == ["1x", "2x", "1/2x", "mesh", "mesh + 1x", "2 mesh", "mesh - 3x", "", "10/3x",
                     "100x"]  # fmt: skip
    assert order_name(33.33, 10.0, None, 0.1) == "10/3x" and order_name(1000, 1.0, None, 5.0) == ""


def test_chaos_stays_chaos():
    found = verdict(henon(6000)[:, 0])
    assert found["regime"] == "chaotic" and found["lyapunov"] == pytest.approx(0.419, abs=0.08)


def random_tones(rng):
    """Two or three tones of 30 to 1000 swings, and the fundamental in cycles per record, or None."""
    while True:
        count, related = int(rng.integers(2, 4)), bool(rng.integers(2))
        swings = np.exp(rng.uniform(np.log(30), np.log(1000)))
        amplitude = np.r_[1, rng.uniform(0.15, 1, count - 1)]
        if related:
            order = np.r_[rng.integers(1, 10), rng.integers(1, 25, size=count - 1)]
            order //= np.gcd.reduce(order)
            ratio = order / order[0]
        else:
            ratio = np.r_[1, rng.uniform(0.3, 4, count - 1)]
        first = swings / np.sqrt((amplitude**2 @ ratio**2) / (amplitude**2).sum())
        n = int(max(1000, swings * rng.uniform(6, 60)))
        apart = np.diff(np.sort(first * ratio))
        held = not related or first / order[0] >= 4
        if (first * ratio).max() < 0.45 * n and (first * ratio).min() > 9 and apart.min() > 5 and held:
            break
    t = np.arange(n) / n
    x = sum(a * tone(first * r * t + rng.uniform()) for a, r in zip(amplitude, ratio, strict=True))
    return x + rng.choice([0, 1e-3, 2e-2]) * rng.normal(size=n), first / order[0] if related else None


def judged_wrongly(rng):
    x, fundamental = random_tones(rng)
    try:
        found = verdict(x)
    except RangeError:  # noise of the mean frequency: fewer than 30 swings
        return False
    if fundamental is None:
        return found["regime"] not in ("quasi-periodic", "undecided")
    right = found["regime"] == "periodic" and abs(found["frequency"] * x.size / fundamental - 1) < 1e-3
    return not right and found["regime"] != "undecided"


def test_random_tones_quickly():
    rng = np.random.default_rng(11)
    assert sum(judged_wrongly(rng) for _ in range(10)) == 0


@pytest.mark.slow
def test_random_tones():
    rng = np.random.default_rng(5)
    assert sum(judged_wrongly(rng) for _ in range(200)) <= 2


def random_noise(rng, kind):
    w = rng.normal(size=int(np.exp(rng.uniform(np.log(1500), np.log(12000)))) + 3000)
    if kind == 2:
        w = lfilter([1], [1, -rng.uniform(0.3, 0.97)], w)
    elif kind == 3:
        r, angle = rng.uniform(0.9, 0.998), rng.uniform(0.2, 2.5)
        w = lfilter([1], [1, -2 * r * np.cos(angle), r * r], w)
    elif kind == 4:
        w = lfilter(np.hanning(int(rng.integers(5, 20))), [1], w)
    shaped = {1: lambda: rng.uniform(size=w.size), 5: lambda: np.sign(w), 6: lambda: w**3, 7: lambda: np.abs(w)}
    return (shaped[kind]() if kind in shaped else w)[3000:]


@pytest.mark.parametrize("kind", range(8))
def test_noise_has_no_regime(kind):
    assert verdict(random_noise(np.random.default_rng(kind), kind))["regime"] in ("undecided", "not-steady")


@pytest.mark.slow
@pytest.mark.timeout(1500)
def test_no_noise_has_a_regime():
    rng = np.random.default_rng(7)
    found = [verdict(random_noise(rng, k % 8))["regime"] for k in range(200)]
    assert set(found) <= {"undecided", "not-steady"} and found.count("not-steady") <= 4


@pytest.mark.slow
@pytest.mark.timeout(1500)
@pytest.mark.parametrize(
    ("case", "changes"),
    [
        ("duffing", {"gamma": 0.2}), ("duffing", {"gamma": 0.29}), ("gear_backlash", {}), ("van_der_pol", {}),
        ("gear-psfd/reference", {"s": 1.0}),
    ],
)  # fmt: skip
def test_columns_of_a_simulation_have_the_verdict_of_its_equations(case, changes, tmp_path):
    """A table as the command line writes it, column by column; the period too."""
    import whirlmap
    from whirlmap.analysis.diagnosis.diagnosis import diagnose
    from whirlmap.analysis.diagnosis.diagnosis_json import verdict_json
    from whirlmap.recordings.signal import read_signal
    from whirlmap.results.signals import write_series

    system = whirlmap.load(case, **changes)
    truth = verdict_json(diagnose.find(system, points=500, max_periods=400))
    ds = whirlmap.simulate(system, periods=400 * system.common_multiple, transient=300 * system.common_multiple)
    file = write_series(ds, tmp_path / "x.csv")
    for state in system.states:
        signal = read_signal(file, column=state)
        found = verdict(signal.values, signal.rate)
        assert found["regime"] == truth["regime"], state
        if truth["period"]:
            assert found["period"] / system.period == pytest.approx(truth["period"], rel=1e-4), state


def test_listed_lines_have_fitted_frequencies():
    found = verdict(sines(4000, 0.005678282, 0.0123353, amplitudes=(1, 0.8)))
    first = found["indicators"]["spectrum"]["named"][0]
    assert first["frequency"] == pytest.approx(0.005678282, rel=2e-7) and first["frequency"] == found["frequency"]


def test_a_burst_rises_and_falls_and_has_no_zero_one_test():
    found = verdict(np.exp(-(((K - 2000) / 700) ** 2)) * tone(F * K) * np.where(K > 2000, 1.2, 1))
    assert found["regime"] == "not-steady" and "it rises, then falls" in found["verdict"]
    assert "factor" not in found["verdict"] and "0-1 test" not in found["verdict"]


def test_the_frequency_of_a_changing_record_is_named():
    chirp = verdict(tone(F * K + 1e-7 * K**2))
    steps = verdict(tone(np.cumsum(np.where(K > 2000, 2.0, 1.0)) * F) + 0.1 * np.random.default_rng(0).normal(size=K.size))
    assert "The frequency of its strongest line in the three thirds" in chirp["verdict"]
    assert "The mean frequency of its whole spectrum, noise included, in the three thirds" in steps["verdict"]


def test_the_number_of_lines_is_said_in_words():
    noise = verdict(np.random.default_rng(0).normal(size=K.size))
    assert " 1 spectral line holds " in verdict(tone(F * K))["verdict"]
    assert "No spectral line stands out" in noise["verdict"]
