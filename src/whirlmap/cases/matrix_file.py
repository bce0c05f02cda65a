"""Shafts as matrices in an `.npz` file: M, K, G of one plane, distances of the stations, and their names."""

from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from whirlmap.errors import CaseError
from whirlmap.machines.matrices import ShaftMatrices


def read_matrices(file: Path) -> tuple[ShaftMatrices, tuple[float, ...], tuple[str, ...]]:
    """Read a shaft from matrices.

    Parameters
    ----------
    file : Path
        Of `numpy.savez`, with the arrays M [kg, kg m, kg m^2] and K [N/m, N, N m], shape (2 station, 2 station), and z [m],
        shape (station,); and where they are there G, gyroscopic moments per rad/s [kg m^2], and names, texts. Degrees of
        freedom are displacement and slope of each station in turn.

    Returns
    -------
    matrices : ShaftMatrices
    z : tuple of float
        Distances from the first station [m].
    names : tuple of str
        Of the stations; empty where there are none.

    Raises
    ------
    CaseError
        No such file, an array that is missing, or one that no free shaft has; naming file and array.
    """
    try:
        with np.load(file, allow_pickle=False) as held:
            arrays = {name: held[name] for name in held.files}
    except (OSError, BadZipFile, ValueError, TypeError, AttributeError):
        raise CaseError(f"{file}: found no file that numpy.savez wrote, expected one with M, K and z") from None
    for name in ("M", "K", "z"):
        if name not in arrays:
            raise CaseError(f"{file}: found no array {name}, expected M, K and z, and G and names where they are known")
    try:
        M, K, z = (np.asarray(arrays[name], dtype=float) for name in ("M", "K", "z"))
        G = np.asarray(arrays.get("G", np.zeros_like(M)), dtype=float)
    except (ValueError, TypeError):
        raise CaseError(f"{file}: found an array that holds no numbers, expected M, K, G and z as numbers") from None
    try:
        matrices = ShaftMatrices.of(M, G, K, z)
    except CaseError as error:
        raise CaseError(f"{file}: {error}") from None
    names = tuple(str(name) for name in np.atleast_1d(arrays.get("names", ())))
    if names and (len(names) != z.size or len(set(names)) != len(names)):
        raise CaseError(f"{file}: names: found {len(names)} names, expected {z.size}, each once")
    return matrices, tuple(float(v) for v in z - z[0]), names
