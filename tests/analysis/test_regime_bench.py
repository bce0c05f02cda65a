"""Labels of operating points whose regime is known: none may be wrong, at most one in twenty undecided.

`python -m tests.analysis.regime_bench` prints the table of all.
"""

import pytest
from tests.analysis.regime_bench import GEAR_PAIRS, MAPS, OSCILLATORS, PERIODIC, label_of_map, label_of_system


def check(point, label, n):
    assert label in (point.regime, "undecided"), f"{point.known}"
    if label == PERIODIC and point.n is not None:
        assert n == point.n
    return label == "undecided"


def test_maps():
    undecided = [check(point, *label_of_map(point)[:2]) for point in MAPS]
    assert sum(undecided) <= len(MAPS) / 20


#: One of each kind from every oscillator is quick enough for every run.
QUICK = [
    point for point in OSCILLATORS
    if point.name in ("duffing gamma=0.37", "pendulum g=1.47", "van_der_pol omega=2.1", "gear_backlash F_ah=0.2 Omega=1.2")
]  # fmt: skip


@pytest.mark.parametrize("point", QUICK, ids=lambda point: point.name)
def test_oscillators(point):
    label, n, _ = label_of_system(point)
    assert not check(point, label, n)


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_all_oscillators_and_gear_pairs():
    points = [*OSCILLATORS, *GEAR_PAIRS]
    undecided = [point.name for point in points if check(point, *label_of_system(point)[:2])]
    assert len(undecided) <= len(points) / 20, undecided
