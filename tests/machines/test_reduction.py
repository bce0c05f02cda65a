"""Reduction of a free shaft: statics stay exact, whatever is kept."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from whirlmap.errors import CaseError
from whirlmap.machines.beams import MATERIALS, Element
from whirlmap.machines.reduction import mode_names, spectrum
from whirlmap.machines.shafts import Disk, Shaft, reduced_numbers

STEEL = MATERIALS["steel"]


def rotor(lengths, diameters, modes, attached=(), bearings=(0, -1)):
    elements = tuple(Element(L, d, 0.0, STEEL) for L, d in zip(lengths, diameters, strict=True))
    bearings = tuple(b % (len(elements) + 1) for b in bearings)
    return Shaft("rotor", elements, (Disk("disk", 2, 5.0, 0.02, 0.035),), modes, 0.0, attached, (), bearings)


SHAFTS = st.integers(5, 9).flatmap(
    lambda n: st.tuples(
        st.lists(st.floats(0.04, 0.3), min_size=n, max_size=n), st.lists(st.floats(0.03, 0.12), min_size=n, max_size=n)
    )
)


@settings(max_examples=40, deadline=None)
@given(shape=SHAFTS, modes=st.integers(0, 3), at=st.integers(1, 4))
def test_static_deflection_on_springs_is_exact(shape, modes, at):
    """A force at a station with teeth, springs at two bearings: modes and residual flexibility give what K gives."""
    shaft = rotor(*shape, modes, attached=(at,))
    M, _, K = shaft.matrices
    rows, place = [shaft.freedom(b) for b in shaft.bearings], shaft.freedom(at)
    springs, force = np.diag([3e7, 8e7]), np.zeros(M.shape[0])
    force[place] = 1000.0
    held = K.copy()
    held[np.ix_(rows, rows)] += springs
    expected = np.linalg.solve(held, force)
    found = shaft.reduced
    # Modes q and forces f of the springs on the shaft: u_b = Phi_b q + G f, f = -k u_b, m w^2 q = Phi^T (force + f).
    shapes, G = found.shapes, found.residual[np.ix_(rows, rows)]
    n = found.count
    system = np.block([
        [np.diag(found.mass * found.frequency**2), -shapes[rows].T],
        [springs @ shapes[rows], np.eye(2) + springs @ G],
    ])  # fmt: skip
    solved = np.linalg.solve(system, np.concatenate([shapes.T @ force, np.zeros(2)]))
    u = shapes @ solved[:n] + found.residual[:, rows] @ solved[n:]
    np.testing.assert_allclose(u[[*rows, place]], expected[[*rows, place]], rtol=1e-6)


@settings(max_examples=40, deadline=None)
@given(shape=SHAFTS, modes=st.integers(0, 4))
def test_modes_are_orthogonal_and_rigid_ones_first(shape, modes):
    shaft = rotor(*shape, modes, attached=(3,))
    M, _, K = shaft.matrices
    found = shaft.reduced
    names = mode_names(found)
    assert names[:2] == ["translation", "tilt"] and names[-1] == "attachment 1"
    for matrix, diagonal in ((M, found.mass), (K, found.mass * found.frequency**2)):
        product = found.shapes.T @ matrix @ found.shapes
        np.testing.assert_allclose(product, np.diag(diagonal), atol=1e-7 * np.abs(product).max())
    assert found.mass[0] == pytest.approx(shaft.mass) and (found.shapes[0::2, 0] == 1.0).all()
    assert np.abs(found.residual[shaft.freedom(3)]).max() == 0.0  # nothing is omitted where teeth act
    assert np.linalg.eigvalsh(found.residual)[0] > -1e-9 * np.abs(found.residual).max()


@pytest.mark.parametrize("modes", [6, 7, 8, 9, 10])
def test_where_nearly_all_modes_are_kept_attachments_are_no_rounding(modes):
    """Six stations have 12 modes across the axis, two of them rigid; forces at four cannot add more than are left."""
    shaft = rotor([0.3, 1.25, 1.25, 1.25, 1.25], [0.15] * 5, modes, attached=(0, 1, 3, 5))
    M = shaft.matrices[0]
    found, whole = shaft.reduced, shaft.spectrum
    assert found.count <= whole.frequency.size
    # An attachment mode is made of omitted ones, so that it is no slower than the slowest of these.
    slowest = whole.frequency[min(2 + modes, whole.frequency.size - 1)]
    assert (found.frequency[found.count - found.attached :] >= slowest * (1 - 1e-6)).all()
    product = found.shapes.T @ M @ found.shapes / np.sqrt(np.outer(found.mass, found.mass))
    np.testing.assert_allclose(product, np.eye(found.count), atol=1e-6)


def test_all_modes_leave_no_flexibility():
    shaft = rotor([0.1] * 5, [0.05] * 5, 10)
    with pytest.raises(CaseError, match="leave no flexibility"):
        reduced_numbers(shaft)
    everything = shaft.spectrum
    bent = everything.shapes[:, 2:] / everything.frequency[2:]
    np.testing.assert_allclose(bent @ bent.T, everything.flexibility, atol=1e-9 * np.abs(everything.flexibility).max())


def test_a_lumped_rotor_is_the_paper_s():
    """One mass on one spring: translation alone, and the spring is the residual flexibility."""
    numbers = reduced_numbers(Shaft("pinion", (), bearings=(1,), attached=(0,)))
    assert numbers.mass.tolist() == [1.0] and numbers.stiffness.tolist() == [0.0]
    assert numbers.residual.tolist() == [[1.0]] and numbers.shapes.tolist() == [[1.0], [1.0]]


def test_massless_stations_are_condensed(validate):
    """A mass between two springs to massless ends, of which one carries a second mass behind a third spring."""
    K = np.array([[2.0, -2, 0, 0], [-2, 5, -3, 0], [0, -3, 7, -4], [0, 0, -4, 4.0]])
    M = np.diag([1.0, 0.0, 0.0, 2.0])
    found = spectrum(M, K, np.ones((4, 1)))
    k = 1 / (1 / 2 + 1 / 3 + 1 / 4)
    validate("chain of masses with massless stations: natural frequencies", found.frequency, [0.0, np.sqrt(k * (1 + 1 / 2))],
             tier="exact", source="springs in series", within=1e-12)  # fmt: skip


def test_parts_that_nothing_holds_together_are_refused():
    K = np.array([[1.0, -1, 0, 0], [-1, 1, 0, 0], [0, 0, 1, -1], [0, 0, -1, 1.0]])
    with pytest.raises(CaseError, match="nothing holds"):
        spectrum(np.diag([1.0, 1, 1, 1]), K, np.ones((4, 1)))
    with pytest.raises(CaseError, match="no mass"):
        spectrum(np.zeros((2, 2)), np.array([[1.0, -1], [-1, 1]]), np.ones((2, 1)))


def test_a_stiff_slow_shaft_keeps_no_more_modes_than_statics_need():
    """No mode is below six times the speeds: teeth have their attachment, and one bending mode stands beside it."""
    shaft = replace(rotor([0.1] * 6, [0.12] * 6, None, attached=(3,), bearings=(1, 5)), fastest=300.0).settled()
    assert shaft.spectrum.frequency[2] > 6 * 300.0
    assert (shaft.modes, shaft.reduced.attached) == (1, 1)
