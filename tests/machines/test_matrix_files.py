"""Shafts as matrices: the same machine as by elements, names of stations, and files that cannot be read."""

import numpy as np
import pytest
from tests.machines.test_coefficients import CONSTANT, HEAD, TABLE, bearing, loaded

import whirlmap
from whirlmap.errors import CaseError

ELEMENTS = 'material = "steel"\nmodes = 0\nelements = [ { L = "200 mm", d = "90 mm", n = 4 } ]\n'
BEARINGS = bearing("a", 0, TABLE) + bearing("b", 4, CONSTANT)
WITHOUT_DISK = HEAD.partition("[[disk]]")[0] + "[[unbalance]]" + HEAD.partition("[[unbalance]]")[2]
NAMES = np.array(["left end", "left", "middle", "right", "right end"])


def arrays(folder, text=WITHOUT_DISK):
    (rotor,) = loaded(folder, text + BEARINGS).machine.case.parts.machine.rotors
    M, G, K = rotor.shaft.matrices
    return {"M": M, "G": G, "K": K, "z": rotor.shaft.positions + 0.3, "names": NAMES}


def test_matrices_are_the_machine_of_their_elements(tmp_path):
    """With a disk that the case adds, stations by number, name and distance."""
    np.savez(tmp_path / "shaft.npz", **arrays(tmp_path))
    by_elements = loaded(tmp_path, HEAD + BEARINGS)
    text = HEAD.replace(ELEMENTS, 'file = "shaft.npz"\nmodes = 0\n') + BEARINGS
    text = text.replace("at = 4\n", 'at = "right end"\n').replace("at = 0\n", 'at = "0 mm"\n')
    by_matrices = loaded(tmp_path, text)
    ours, theirs = (np.sort_complex(whirlmap.linear_analysis(s).eigenvalues) for s in (by_matrices, by_elements))
    assert ours == pytest.approx(theirs, rel=1e-7)
    assert by_matrices.machine.given["shaft.rotor.m"] == pytest.approx(by_elements.machine.given["shaft.rotor.m"], rel=1e-9)
    whole = arrays(tmp_path, HEAD)  # with the disk in the matrices
    np.savez(tmp_path / "shaft.npz", **whole)
    without = text.partition("[[disk]]")[0] + "[[unbalance]]" + text.partition("[[unbalance]]")[2]
    ours = np.sort_complex(whirlmap.linear_analysis(loaded(tmp_path, without)).eigenvalues)
    assert ours == pytest.approx(theirs, rel=1e-7)


def changed(name, change):
    return lambda held: {**held, name: change(held[name])}


WRONG = {
    "no stiffness": (lambda held: {k: v for k, v in held.items() if k != "K"}, "no array K"),
    "shape": (changed("M", lambda M: M[:4, :4]), "M: found the shape"),
    "not symmetric": (changed("K", lambda K: K + np.triu(np.abs(K)) * 1e-3), "K: found a matrix that is not symmetric"),
    "held": (changed("K", lambda K: K + np.eye(10) * 1e8), "K: found forces"),
    "negative mass": (changed("M", lambda M: -M), "M: found a negative mass"),
    "not finite": (changed("G", lambda G: G * np.nan), "G: found numbers that are not finite"),
    "stations that fall": (changed("z", lambda z: z[::-1]), "z: found no ascending"),
    "names": (changed("names", lambda names: names[:3]), "names: found 3 names"),
}


@pytest.mark.parametrize("fault", WRONG)
def test_wrong_matrices_name_file_table_and_array(tmp_path, fault):
    change, said = WRONG[fault]
    np.savez(tmp_path / "shaft.npz", **change(arrays(tmp_path)))
    with pytest.raises(CaseError) as error:
        loaded(tmp_path, HEAD.replace(ELEMENTS, 'file = "shaft.npz"\n') + BEARINGS)
    message = str(error.value)
    assert "[[shaft]] rotor: file" in message and "shaft.npz" in message and said in message and "\n" not in message


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ('file = "nothing.npz"\n', "nothing.npz"),
        ('file = "shaft.csv"\n', "expected a rotor of ROSS"),
        ('file = "shaft.npz"\nmaterial = "steel"\n', "beside file"),
    ],
)
def test_wrong_files_are_named(tmp_path, line, said):
    np.savez(tmp_path / "shaft.npz", **arrays(tmp_path))
    with pytest.raises(CaseError, match=said):
        loaded(tmp_path, HEAD.replace(ELEMENTS, line) + BEARINGS)


def test_a_distance_between_stations_is_refused(tmp_path):
    np.savez(tmp_path / "shaft.npz", **arrays(tmp_path))
    text = HEAD.replace(ELEMENTS, 'file = "shaft.npz"\n') + BEARINGS.replace("at = 0", 'at = "20 mm"')
    with pytest.raises(CaseError, match=r"bearing.* a: at: found 20 mm on shaft rotor, where its matrices have no station"):
        loaded(tmp_path, text)
