"""The compiled loops of a look, against the same rules said with NumPy over whole arrays, on random sections."""

import numpy as np
import pytest

from whirlmap.analysis.steady.extrapolation import DIFFERENCES, MODES, STABLE, inside, modulus
from whirlmap.analysis.steady.periodicity import return_multiple
from whirlmap.analysis.steady.return_search import SMALL, STEADY, search_windows
from whirlmap.analysis.steady.slow_approach import ends_of_approaches, room_for_approaches

RING, TOLERANCE = 64, 1e-6
WINDOWS = [8, 16, 32, 64]
TURN = 2 * np.pi


def difference(a, b, period):
    """Sizes of differences (..., state), of cyclic states the shorter way round."""
    d = a - b
    around = np.where(np.isfinite(period), period, 1.0)
    return np.abs(np.where(np.isfinite(period), d - around * np.rint(d / around), d))


def sizes(x, scale, period):
    own = np.maximum(scale, 1e-6 * np.where(np.isfinite(period), period, np.abs(x).max(axis=0)))
    own = np.maximum(own, 1e-6 * own.max())
    return np.where(own > 0, own, 1.0)


def left_of_approach(x, m, size, period):
    late = (difference(x[-1], x[-1 - m], period) / size).max()
    if late <= 1e-9:
        return late
    early = (difference(x[-1 - m], x[-1 - 2 * m], period) / size).max() if len(x) > 2 * m else 0.0
    ratio = late / early if early > 0 else 0.0
    return late * ratio / (1 - ratio) if ratio < 1 else np.inf


def shorter(x, m, size, period):
    for d in (d for d in range(1, m) if m % d == 0):
        change = (difference(x[d:], x[:-d], period) / size).max(axis=1)
        phases = np.arange(max(min(m, len(change) - m), 1))
        back = (len(change) - phases.size) // m * m
        if change[-1 - phases].max() < 0.99 * change[-1 - phases - back].max():
            return True
        varies = np.abs(change[m:] - change[:-m]).max(initial=0.0)
        if change.max() < SMALL and varies > STEADY * change.max():
            return True
    return False


def expected(section, ran, looked, longest, scale, period):
    """Multiple and distance of one point, whose section points of all its periods are given."""
    multiple, distance = 0, np.nan
    for window in WINDOWS:
        due = window == WINDOWS[0] or ran >= longest or ran // window > looked // window
        if not due or ran < window or multiple:
            continue
        x = section[ran - window : ran]
        size = scale
        apart = [(difference(x[m:], x[:-m], period) / size).max() for m in range(1, window // 2 + 1)]
        returns = np.flatnonzero(np.array(apart) < TOLERANCE)
        distance = np.nan
        if returns.size:
            m, distance = int(returns[0]) + 1, apart[returns[0]]
            longer = section[ran - (2 * window if ran >= 2 * window <= RING else window) : ran]
            if left_of_approach(x, m, size, period) <= TOLERANCE and not shorter(
                longer, m, scale, period
            ):
                multiple = m
        elif ran >= longest and window == WINDOWS[-1]:
            distance = min(apart)
    return multiple, distance


def random_sections(rng, points, states, length):
    """Cycles of 1 to 12 points with a transient that turns, alternates or creeps; some are noise, some stand still."""
    k = np.arange(length)
    out = rng.normal(size=(points, length, states))
    for p in range(points):
        kind = rng.integers(8)
        if kind == 0:
            continue
        cycle = rng.normal(size=(rng.integers(1, 13), states))
        if kind == 1:
            cycle = cycle[:1] + 10.0 ** rng.uniform(-9, -4) * cycle
        out[p] = cycle[k % len(cycle)]
        for _ in range(rng.integers(0, 3)):
            z = rng.uniform(0.2, 1.0) * np.exp(1j * rng.choice([0.0, np.pi, TURN / 3 + 0.01, rng.uniform(0, np.pi)]))
            size = 10.0 ** rng.uniform(-9, -1) * (rng.normal(size=states) + 1j * rng.normal(size=states))
            out[p] += (size * z ** k[:, None]).real
        if kind == 2:
            out[p, :, 0] = 1e8 / 3
    return out


@pytest.mark.parametrize(("states", "cyclic"), [(1, False), (2, True), (5, False), (20, True)])
def test_the_search_of_all_windows(states, cyclic):
    rng, points = np.random.default_rng(states), 600
    period = np.full(states, np.inf)
    period[0] = TURN if cyclic else np.inf
    section = random_sections(rng, points, states, 100)
    scale = rng.uniform(0.5, 2, (states, points)) * np.where(rng.random((states, points)) > 0.1, 1.0, 1e-6)
    ran = rng.integers(8, 100, points) // 4 * 4
    looked, longest = np.maximum(ran - rng.integers(1, 9, points) * 4, 0), ran + rng.integers(-4, 5, points)
    slot = rng.permutation(points)
    history = np.full((points, RING, states), np.nan)
    for p in range(points):
        for i in range(ran[p]):
            history[slot[p], i % RING] = section[p, i]
    multiple, distance = np.zeros(points, dtype=np.int64), np.full(points, np.nan)
    chosen = np.sort(rng.permutation(points)[: points - 5])
    search_windows(
        points=chosen, chosen=chosen.size, slot=slot, history=history, ring=RING, states=states, n=points,
        windows=np.array(WINDOWS), lengths=len(WINDOWS), ran=ran, looked=looked, longest=longest, period=period,
        tolerance=np.array([TOLERANCE]), scale=scale, own=np.empty(states), size=np.empty(states),
        room=np.empty(RING + states), multiple=multiple, distance=distance,
    )  # fmt: skip
    wanted = [expected(section[p], ran[p], looked[p], longest[p], scale[:, p], period) for p in chosen]
    np.testing.assert_array_equal(multiple[chosen], [m for m, _ in wanted])
    np.testing.assert_array_equal(distance[chosen], [d for _, d in wanted])
    assert len(set(multiple.tolist())) > 8, "few kinds of cycles were found: the test is about nothing"
    others = np.setdiff1d(np.arange(points), chosen)
    assert not multiple[others].any() and np.isnan(distance[others]).all()


def test_the_multiple_of_a_dataset_is_the_smallest_distance():
    """`return_multiple` against all distances said at once."""
    rng = np.random.default_rng(1)
    x = random_sections(rng, 200, 3, 64).transpose(1, 2, 0)
    scale = rng.uniform(0.5, 2, (3, 200))
    x[5, 1, 7] = np.nan
    found = return_multiple(x, scale=scale, most=32, cyclic={1: TURN})
    period = np.array([np.inf, TURN, np.inf])
    for p in range(200):
        if p == 7:
            assert found.status.values[p] == 2 and np.isnan(found.distance.values[p])
            assert found.deciding_state.values[p] == -1
            continue
        size = sizes(x[:, :, p], scale[:, p], period)
        apart = np.array([(difference(x[m:, :, p], x[:-m, :, p], period) / size).max(axis=0) for m in range(1, 33)])
        returns = np.flatnonzero(apart.max(axis=1) < 1e-6)
        at = returns[0] if returns.size else apart.max(axis=1).argmin()
        assert found.multiple.values[p] == (at + 1 if returns.size else 0)
        assert found.nearest_multiple.values[p] == at + 1
        assert found.distance.values[p] == apart[at].max() and found.deciding_state.values[p] == apart[at].argmax()


# --- approaches ---------------------------------------------------------------------------------------------


def test_the_largest_modulus_of_a_polynomial():
    """Against the eigenvalues of the companion matrix; at and beyond `STABLE` it is infinite."""
    rng, room, beyond = np.random.default_rng(2), np.empty(3 * MODES), 0
    for _ in range(400):
        modes = int(rng.integers(1, MODES + 1))
        roots = rng.uniform(0.05, 1.03, modes) * np.exp(1j * rng.uniform(0, np.pi, modes))
        roots = np.concatenate([roots.real[: modes % 2], *([z, z.conj()] for z in roots[: modes // 2])])
        room[:modes] = -np.poly(roots).real[:0:-1]
        largest = np.abs(np.linalg.eigvals(np.vstack([np.eye(modes)[1:], room[:modes]]))).max()
        assert inside(modes, 0, largest * 1.001, MODES, room) and not inside(modes, 0, largest * 0.999, MODES, room)
        found = modulus(modes, 0, MODES, room)
        beyond += largest >= STABLE
        assert found == (pytest.approx(largest, rel=1e-6) if largest < STABLE else np.inf)
    assert 5 < beyond < 200


def least_squares(d, modes):
    """Coefficients and Limit's three conditions of scaled differences (DIFFERENCES, state): what is fitted, its error."""
    largest = np.abs(d).max(axis=1)
    rows = [
        (d[j : j + modes + 1] / largest[j : j + modes + 1].max()).T for j in range(DIFFERENCES - modes)
    ]  # (state, column)
    rows = np.concatenate(rows)
    c, _, rank, _ = np.linalg.lstsq(rows[:, :modes], rows[:, modes], rcond=1e-9)
    missed = [np.abs(d[j] - c @ d[j - modes : j]).max() for j in range(DIFFERENCES - 3, DIFFERENCES)]
    leading = np.abs(np.roots([1.0, *-c[::-1]])).max(initial=0.0)
    error = max(missed) / abs(1 - c.sum())
    good = rank == modes and (missed <= 0.05 * largest[-3:]).all() and leading < STABLE
    step = sum(c[i] / (1 - c.sum()) * d[DIFFERENCES - modes + i :].sum(axis=0) for i in range(modes))
    return good, error, leading, step, rank == modes


def approach(section, scale, period, needed):
    """Multiple, limit and modulus of one point's approach, or zero."""
    for m in range(1, 5):
        if len(section) < m * DIFFERENCES + 1:
            break
        x = section[-m * DIFFERENCES - 1 :: m]
        size = scale
        d = np.diff(x, axis=0)
        around = np.where(np.isfinite(period), period, 1.0)
        d = np.where(np.isfinite(period), d - around * np.rint(d / around), d) / size
        largest = np.abs(d).max(axis=1)
        first, end = largest[:4].max(), largest[-4:].max()
        if not (end < 0.1 and end < first and end > TOLERANCE):
            continue
        if not m * np.log(end / TOLERANCE) / (np.log(first / end) / 8) + 8 > 1.5 * needed[m] or not largest.all():
            continue
        for modes in range(1, min(MODES, len(period)) + 1):
            good, error, leading, step, determined = least_squares(d, modes)
            if not determined:
                break
            if good and error <= TOLERANCE / 4:
                return m, x[-1] + step * size, leading
    return 0, None, None


@pytest.mark.parametrize("states", [1, 2, 6])
def test_approaches_worth_a_trial_and_their_ends(states):
    rng, points, k = np.random.default_rng(10 + states), 400, np.arange(80)
    period = np.full(states, np.inf)
    period[0] = TURN
    section, scale = np.empty((points, 80, states)), rng.uniform(0.5, 2, (states, points))
    for p in range(points):
        cycle = rng.normal(size=(rng.integers(1, 5), states)) + 10.0 * (rng.random() < 0.3)
        section[p] = cycle[k % len(cycle)]
        for _ in range(rng.integers(1, 4)):
            z = rng.uniform(0.8, 1.005) * np.exp(1j * rng.choice([0.0, np.pi, rng.uniform(0, np.pi)]))
            size = 10.0 ** rng.uniform(-5, -1) * (rng.normal(size=states) + 1j * rng.normal(size=states))
            section[p] += (size * z ** k[:, None]).real
    ran, needed = rng.integers(13, 81, points), np.array([0, 8, 12, 16, 20])
    history = np.full((points, RING, states), np.nan)
    for p in range(points):
        for i in range(ran[p]):
            history[p, i % RING] = section[p, i]
    multiple, x, leading = ends_of_approaches(
        np.arange(points), np.arange(points), history, ran, needed, period, np.array([TOLERANCE]), scale,
        room_for_approaches(states),
    )  # fmt: skip
    differ = 0
    for p in range(points):
        m, end, largest = approach(section[p, : ran[p]], scale[:, p], period, needed)
        differ += m != multiple[p]
        if m and m == multiple[p]:
            np.testing.assert_allclose(x[p], end, atol=1e-8)
            assert leading[p] == pytest.approx(largest, abs=1e-6)
    assert differ <= points // 100  # where the error is the tolerance but for rounding
    assert (multiple > 0).sum() > points // 20 and len(set(multiple.tolist())) > 3
