"""A new permeability costs little: its table lies between those of a few, in bits that depend on it alone."""

import time

import numpy as np
import pytest

from whirlmap.films import porous_short, scaled, tables
from whirlmap.films.law import FIXED_ARC, POSITIVE_ARC
from whirlmap.kernels.lowering import tabulate
from whirlmap.kernels.lowering.tabulate import Shelf, entries, fill, fitted, reading

INSIDE = 10.0 ** np.array([-8.0, -6.26, -4.0, -2.9, -1.51, -0.3, 0.99])  # ends of panels and places within


@pytest.fixture
def empty():
    for shelf in (tabulate._ENTRIES, tabulate._PANELS):
        shelf.clear()


@pytest.mark.parametrize(
    "psi", [p if k in (1, 4, 6) else pytest.param(p, marks=pytest.mark.slow) for k, p in enumerate(INSIDE)]
)
def test_as_accurate_as_a_table_of_its_own(psi):
    """Up to the wall and the load's direction: 1e-10 of the load, against the solved film."""
    rng, k = np.random.default_rng(7), np.cbrt(psi)
    end = (1.0 + scaled.BEYOND * k) * (1.0 - 1e-12)
    eps = np.where(rng.random(3000) < 0.5, end * np.sqrt(rng.random(3000)), end - 10.0 ** rng.uniform(-6, 0, 3000))
    phi = np.where(rng.random(3000) < 0.5, 10.0 ** rng.uniform(-5, 0.5, 3000), rng.uniform(-np.pi, np.pi, 3000))
    xi, eta = eps * np.cos(phi), eps * np.sin(phi)
    wall = 1.0 + scaled.HAT * k
    ahead, aside = reading(POSITIVE_ARC, psi, xi, np.abs(eta) / np.sqrt((wall - xi) * (wall + xi)))
    error = np.array([ahead, -eta * aside]) - porous_short.positive_arc_velocity(xi, eta, 1.0, 0.0, psi)
    assert np.hypot(*error).max() < 1e-10


def test_nodes_enough_that_their_number_does_not_matter(monkeypatch, empty):
    """Interpolation in log psi adds nothing to the error of the fit; too few nodes do."""
    psi = 0.42
    own = fitted(POSITIVE_ARC, psi)
    apart = []
    for nodes in (5, tabulate.NODES):
        monkeypatch.setattr(tabulate, "NODES", nodes)
        monkeypatch.setattr(tabulate, "stored", lambda name, make, sound: make())
        tabulate._PANELS.clear()
        apart.append(np.abs(tabulate._between(POSITIVE_ARC, tables.positive_arc_panel(psi), psi) - own).max())
    tabulate._PANELS.clear()
    assert apart[0] > 1e-6 and apart[1] < 1e-10


def test_bits_depend_on_psi_alone(tmp_path, monkeypatch, empty):
    """Alone, among others, from a cold and a warm cache, and with the shelf too small for anything."""
    monkeypatch.setenv("WHIRLMAP_CACHE", str(tmp_path))
    cold = entries(POSITIVE_ARC, 2e-3).copy()
    (kept,) = tmp_path.iterdir()
    tabulate._ENTRIES.clear()
    tabulate._PANELS.clear()
    np.testing.assert_array_equal(entries(POSITIVE_ARC, 2e-3), cold)
    monkeypatch.setattr(tabulate, "_ENTRIES", Shelf(1))
    both, offsets = fill((POSITIVE_ARC,), (np.array([1.5e-3, 2e-3, 2.5e-3, 2e-3]),), 4)
    at = offsets[0, 1]
    assert offsets[0, 3] == at
    np.testing.assert_array_equal(both[at : at + cold.size], cold)
    sound = kept.read_bytes()
    kept.write_bytes(sound[:-8])
    tabulate._PANELS.clear()
    with pytest.warns(UserWarning, match="damaged"):
        np.testing.assert_array_equal(entries(POSITIVE_ARC, 2e-3), cold)
    assert kept.read_bytes() == sound


def test_a_new_psi_costs_a_hundredth_of_solving_it():
    """In processor time: fitting takes 0.2 s, the next of the same panel 1 to 3 ms; the fixed arc too."""
    entries(POSITIVE_ARC, 2e-3)
    clock = time.process_time()
    fitted(POSITIVE_ARC, 2.111e-3)
    own = time.process_time() - clock
    values = np.geomspace(1.2e-3, 2.9e-3, 41)
    for table, share in ((POSITIVE_ARC, 0.05), (FIXED_ARC, 0.1)):
        clock = time.process_time()
        for psi in values:
            entries(table, psi)
        assert (time.process_time() - clock) / values.size < share * own


def test_panels_follow_each_other():
    """Every psi has one panel, whose tables have one number of cells; psi = 0 stands alone."""
    assert tables.positive_arc_panel(0.0) is None
    for psi in np.geomspace(1e-12, 1e2, 57):
        low, high = tables.positive_arc_panel(psi)
        assert low <= psi * (1 + 1e-12) and psi < high * (1 + 1e-12)
        cells = {POSITIVE_ARC.edges(p)[0].size for p in np.geomspace(low * (1 + 1e-9), high * (1 - 1e-9), 9)}
        assert len(cells) == 1


def test_a_shelf_keeps_its_bound():
    shelf = Shelf(100)
    for key in range(30):
        shelf.get(key, lambda: np.zeros(4))
        assert shelf.size <= 100
    assert shelf.get(29, lambda: np.ones(4))[0] == 0.0  # at hand
    assert shelf.get(0, lambda: np.ones(4))[0] == 1.0  # made again
