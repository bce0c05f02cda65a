"""After how many turns of its forcing a locked motion returns: sums of waves, and oscillators, whose n is known."""

from fractions import Fraction

import numpy as np
import pytest

from whirlmap.analysis.labels.forced_lines import Lines, sums_of
from whirlmap.analysis.labels.forced_parts import fold, sum_near
from whirlmap.analysis.labels.locked import _smallest, _tells, locked_multiple
from whirlmap.errors import RangeError

ONE, GOLDEN = Fraction(1), Fraction(0.6180339887498949)
HUNTING = (ONE, Fraction(1, 37), Fraction(1, 113))


def turned(line, times, phase=0.0):
    """2 pi f k, exact for orders of any denominator."""
    f = Fraction(line)
    return 2 * np.pi * np.array([f.numerator * k % f.denominator / f.denominator for k in range(times)]) + phase


def smooth(orders, times, decay=0.2):
    """A function of the forcing's phases whose lines fall by about ``decay`` per multiple."""
    phases = [turned(o, times, 1.0 + i) for i, o in enumerate(orders) if o != 1]
    return sum(np.cos(p) for p in phases) / (1.5 - decay * sum(np.cos(p + 2) for p in phases))


def judged(series, orders, **more):
    x = np.array(series).T[:, None] if np.ndim(series) > 1 else np.array(series)[:, None, None]
    return locked_multiple(x, orders, scale=np.ptp(x, axis=0), **more)


@pytest.mark.parametrize(
    "orders", [(ONE, GOLDEN), HUNTING, (ONE, GOLDEN, GOLDEN, GOLDEN * 2), (ONE, Fraction(1, 2), GOLDEN)]
)
@pytest.mark.parametrize("n", [1, 2, 3, 5])
@pytest.mark.parametrize("part", [1e-4, 0.2])
def test_n_of_a_line_added_to_a_function_of_the_forcings_phases(orders, n, part):
    x = smooth(orders, 1024)
    line = turned(Fraction(1, n), 1024, 0.5)
    found, misfit = judged(x + (n > 1) * part * np.ptp(x) * np.cos(line) * (1 + 0.3 * x), orders)
    # Half of T is a multiple of an order of 1/2: that forcing's own, twice as slow as T.
    assert found == [1 if Fraction(1, 2) in orders and n == 2 else n]
    assert misfit[0] < 1e-5


def test_parts_of_slow_forcings_and_of_sums():
    times = 1024
    for line, n in ((GOLDEN / 2, 2), ((1 + GOLDEN) / 3, 3), ((2 + GOLDEN) / 4, 4)):
        x = smooth((ONE, GOLDEN), times)
        assert judged(x + 0.1 * np.cos(turned(line, times)), (ONE, GOLDEN))[0] == [n]


def test_quarters_need_halves_first():
    times, phase = 1024, turned(Fraction(1, 4), 1024, 0.3)
    x = smooth((ONE, GOLDEN), times)
    assert judged(x + 0.2 * np.cos(2 * phase + 1) + 1e-3 * np.cos(phase), (ONE, GOLDEN))[0] == [4]


@pytest.mark.parametrize(
    ("size", "rate", "part"), [(2.14e-5, 0.00271, 0.25), (4.28e-5, 0.00558, 0.2501), (1.98e-5, 0.00156, 0.33363)]
)
def test_a_decay_is_no_subharmonic(size, rate, part):
    """What is left of a start near an n-th part of T counted as n = 4, 4 and 3."""
    k, x = np.arange(1024), smooth(HUNTING, 1024)
    found, misfit = judged(x + size * np.ptp(x) * np.exp(-rate * k) * np.cos(2 * np.pi * part * k), HUNTING)
    assert found == [0] and misfit[0] < 1e-5


def test_a_subharmonic_below_the_tolerance_of_returns_counts_as_none():
    x = smooth(HUNTING, 1024)
    found, misfit = judged(x + 5e-7 * np.ptp(x) * np.cos(turned(Fraction(1, 2), 1024)), HUNTING)
    assert found == [1] and misfit[0] > 4e-7


def test_what_the_data_do_not_decide():
    times, k = 1024, np.arange(1024)
    x = smooth((ONE, GOLDEN), times)
    undecided = [
        x + 0.01 * np.cos(turned(Fraction(0.2345), times)),  # a frequency of its own
        x + 0.01 * np.exp(-k / 200),  # not settled
        np.sign(np.cos(turned(GOLDEN, times))),  # jumps
        np.random.default_rng(1).normal(size=times),
        np.where(k == 7, np.nan, x),
    ]
    found, misfit = judged(undecided, (ONE, GOLDEN))
    assert (found == 0).all()
    assert (misfit[:4] > 1e-5).all() and np.isinf(misfit[4])


def test_a_record_shorter_than_the_forcings_slow_period_decides_nothing():
    orders = (ONE, Fraction(1, 700))
    for times, expected in ((1024, 0), (2048, 1)):
        assert judged(np.cos(turned(orders[1], times)), orders)[0] == [expected]


def test_an_angle_that_turns_round():
    times = 1024
    x = np.mod(turned(GOLDEN, times) + 0.1 * np.cos(turned(Fraction(1, 2), times)), 2 * np.pi)
    assert judged(x, (ONE, GOLDEN), cyclic={0: 2 * np.pi})[0] == [2]


def test_common_periods_are_counted_where_there_are_any():
    times, orders = 512, (ONE, Fraction(1, 6))
    kinks = [np.abs(np.cos(np.pi * np.arange(times) / (6 * m) + 0.2)) for m in (1, 2, 5, 12)]
    assert judged(kinks, orders)[0].tolist() == [1, 2, 5, 12]
    # A motion of two T returns after the common period of six; one of four T needs two common periods.
    assert judged([np.cos(np.pi * np.arange(times)), np.cos(np.pi / 2 * np.arange(times))], orders)[0].tolist() == [1, 2]
    assert judged(np.cos(np.pi * np.arange(times)), (ONE, Fraction(2, 3)))[0] == [2]


def test_results_do_not_depend_on_company():
    times, rng = 512, np.random.default_rng(3)
    x = smooth((ONE, GOLDEN), times)
    series = [
        x + a * np.cos(turned(Fraction(1, n), times))
        for a, n in zip(10 ** rng.uniform(-5, -1, 12), [2, 3, 4] * 4, strict=True)
    ]
    together, misfit = judged(series, (ONE, GOLDEN))
    alone = [judged(s, (ONE, GOLDEN)) for s in series]
    assert together.tolist() == [n[0] for n, _ in alone]
    assert misfit.tolist() == [m[0] for _, m in alone]


def test_fold_counts_sums_exactly():
    hunting = HUNTING[1:]
    assert [fold(Fraction(1, n), hunting) for n in (2, 3, 37)] == [2, 3, 1]
    assert fold(Fraction(1, 2), (Fraction(1, 36), Fraction(1, 110))) == 1  # 18 turns of a shaft
    assert fold(GOLDEN / 3 + GOLDEN, (GOLDEN,)) == 3
    assert sum_near(0.50001, hunting, 1024) == Fraction(1, 2)
    assert sum_near(0.4321, (GOLDEN,), 8192) is None


def test_the_smallest_n_is_said_though_a_larger_one_explains_too():
    times, turns = 512, (GOLDEN,)
    lines = Lines(*sums_of((GOLDEN, Fraction(1, 6)), (1.0, 1.0), 170), times)
    forced = smooth((ONE, GOLDEN), times, 0.1)
    y = np.array([forced + a * np.cos(turned(Fraction(1, n), times)) for a, n in ((0, 1), (0.1, 2), (0.1, 3), (0.1, 6))])
    assert _smallest(y[..., None], lines, (GOLDEN, Fraction(1, 6)), turns).tolist() == [1, 2, 3, 6]


def test_lines_too_close_to_each_other_tell_nothing():
    every = np.arange(1, 400) / 800 + 1e-4
    assert _tells(Lines(np.zeros((100, 1), int), every[::4], 512))
    assert not _tells(Lines(np.zeros((399, 1), int), every, 512))


def test_lines_closer_than_the_record_tells_apart_explain_both():
    times = 512
    pair = 0.1 + np.array([0.0, 3e-4, 6e-4]) / times
    lines = Lines(np.zeros((3, 1), int), pair, times)
    y = np.cos(2 * np.pi * pair[1] * np.arange(times)) * np.linspace(-1, 1, times)
    assert np.abs(lines.fitted(y[None, :, None])[0]).max() < 3e-7


def test_a_forcing_whose_lines_fall_fast_weighs_more():
    a, b = turned(GOLDEN, 1024), turned(Fraction(1, 29), 1024)
    y = np.cos(a) / (1.2 - np.cos(a)) + 1e-4 * np.cos(b)
    lines = Lines(*sums_of((GOLDEN, Fraction(1, 29)), (1.0, 1.0), 170), 1024)
    assert lines.weights(lines.fitted(y[None, :, None])[1])[0].tolist() == [1, 4]
    assert locked_multiple(y[:, None, None], (ONE, GOLDEN, Fraction(1, 29)), scale=[np.ptp(y)])[0] == [1]


def test_shapes_scales_and_orders_are_checked():
    with pytest.raises(RangeError, match="shape"):
        locked_multiple(np.zeros((32, 1, 1)), (ONE,), scale=[1.0])
    with pytest.raises(RangeError, match="scale"):
        locked_multiple(np.zeros((128, 1, 1)), (ONE,), scale=[0.0])
    with pytest.raises(RangeError, match="orders"):
        locked_multiple(np.zeros((128, 1, 1)), (ONE, Fraction(0)), scale=[1.0])


# --- oscillators: name, orders of the weak forcings, their amplitude, n -------------------------------------

PAIRS = (ONE, Fraction(1, 37), Fraction(1, 113), Fraction(29, 113), Fraction(29, 8023))
DUFFING = {"c": 0.3, "k": -1.0, "cubic": 1.0, "frequency": 1.2, "start": (1.0, 0.0)}
UEDA = {"c": 0.1, "k": 0.0, "cubic": 1.0, "frequency": 1.0, "drive": 1.5, "start": (2.09614788, 0.48090102)}
MATHIEU = {"c": 0.05, "k": 0.25, "cubic": 0.3, "frequency": 1.0, "varies": 0.7, "load": 0.05, "start": (0.3, 0.3)}
OSCILLATORS = {
    "1T, golden": (DUFFING | {"drive": 0.20}, (ONE, GOLDEN), 0.01, 1),
    "2T, golden": (DUFFING | {"drive": 0.27}, (ONE, GOLDEN), 1e-3, 2),
    "2T large, golden": (DUFFING | {"drive": 0.65}, (ONE, GOLDEN), 1e-3, 2),
    "3T, golden": (UEDA, (ONE, GOLDEN), 1e-3, 3),
    "1T, hunting teeth": (DUFFING | {"drive": 0.20}, HUNTING, 0.01, 1),
    "half the mesh frequency, hunting teeth": (MATHIEU, HUNTING, 0.01, 2),
    "1T, two hunting pairs": (DUFFING | {"drive": 0.20}, PAIRS, 1e-3, 1),
    "2T, two hunting pairs": (DUFFING | {"drive": 0.27}, PAIRS, 1e-4, 2),
    "1 common period": (DUFFING | {"drive": 0.20}, (ONE, Fraction(2, 3)), 1e-3, 1),
    "2 common periods": (DUFFING | {"drive": 0.27}, (ONE, Fraction(2, 3)), 1e-3, 2),
    "4 common periods": (DUFFING | {"drive": 0.289}, (ONE, Fraction(2, 3)), 1e-5, 4),
    "chaos": (DUFFING | {"drive": 0.30}, (ONE, GOLDEN), 1e-3, 0),
}  # fmt: skip


@pytest.fixture(scope="module")
def sections(times=1024, transient=300, steps=32):
    """Section and range of each oscillator, by RK4, side by side."""
    systems = [o[0] for o in OSCILLATORS.values()]
    c, k, cubic, w, drive, varies, load = (
        np.array([s.get(name, 0.0) for s in systems]) for name in ("c", "k", "cubic", "frequency", "drive", "varies", "load")
    )
    weak = [(i, o, a) for i, (_, orders, a, _) in enumerate(OSCILLATORS.values()) for o in orders[1:]]
    at, a = np.array([i for i, *_ in weak]), np.array([a for *_, a in weak])
    turns = [[getattr(o, part) for _, o, _ in weak] for part in ("numerator", "denominator")]
    share = np.zeros((len(systems), at.size))
    share[at, np.arange(at.size)] = a

    def forcing(half):
        numerator, denominator = turns
        exact = np.array([n * half % (2 * steps * d) / d for n, d in zip(numerator, denominator, strict=True)])
        fast = np.cos(np.pi * half / steps)
        return fast * drive + load + share @ np.cos(np.pi * exact / steps), k * (1 + varies * fast)

    def rates(x, force):
        return np.array([x[1], (force[0] - c * w * x[1] - force[1] * x[0] - cubic * x[0] ** 3) / w**2])

    x, h, found = np.array([s["start"] for s in systems]).T, 2 * np.pi / steps, []
    end = forcing(0)
    for step in range(steps * (transient + times)):
        if step >= steps * transient:
            found.append(x)
        begin, middle, end = end, forcing(2 * step + 1), forcing(2 * step + 2)
        k1 = rates(x, begin)
        k2 = rates(x + h / 2 * k1, middle)
        k3 = rates(x + h / 2 * k2, middle)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + rates(x + h * k3, end))
    record = np.array(found)
    return record[::steps], np.ptp(record, axis=0)


@pytest.mark.parametrize("name", OSCILLATORS)
def test_oscillators(sections, name):
    _, orders, _, n = OSCILLATORS[name]
    i = list(OSCILLATORS).index(name)
    found, misfit = locked_multiple(sections[0][:, :, [i]], orders, scale=sections[1][:, [i]])
    assert found == [n], misfit
