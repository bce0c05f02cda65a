"""Shapes and names of modes: which part of a machine moves most in each, and in which sense it whirls."""

from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.integrate.system import System

#: Words for each sense of whirl.
WHIRL = {1: "forward", -1: "backward", 0: "none"}
#: Area of an orbit over that of the circle of its size, below which the orbit is a line without a sense.
FLAT = 1e-6


def centres(system: System) -> list[tuple[int, int]]:
    """Places of the two coordinates of every body's centre that has mass: those whose rates are velocities."""
    names, heavy = system.states, system.model.velocities
    pairs = [tuple(q.name for q in body) for body in system.model.bodies.values() if len(body) == 2]
    return [(names.index(x), names.index(y)) for x, y in pairs if x in heavy and y in heavy]


def bodies(system: System) -> dict[str, list[int]]:
    """Places of the coordinates of every body that the model declares, by name."""
    return {body: [system.states.index(q.name) for q in found] for body, found in system.model.bodies.items()}


def whirl_of(
    system: System, eigenvalues: NDArray[np.complex128], vectors: NDArray[np.complex128]
) -> NDArray[np.int8]:
    """Sense of whirl of each mode, summed over the centres that have mass: 1 from x to y, -1 from y to x, 0 none.

    Parameters
    ----------
    eigenvalues : array of complex, shape (point, mode)
    vectors : array of complex, shape (point, state, mode)
    """
    area, size = np.zeros(eigenvalues.shape), np.zeros(eigenvalues.shape)
    for i, j in centres(system):
        x, y = vectors[:, i], vectors[:, j]
        area += 2 * (x * y.conj()).imag
        size += np.abs(x) ** 2 + np.abs(y) ** 2
    area *= np.sign(eigenvalues.imag)
    return (np.sign(area) * (np.abs(area) > FLAT * size)).astype(np.int8)


@dataclass(frozen=True)
class Shapes:
    """Shapes of modes at several operating points.

    Attributes
    ----------
    bodies : list of str
    amplitude : array, shape (mode, body, point)
        How far each body moves, over that of the body that moves most.
    names : array of str, shape (mode, point)
        Body that moves most and its sense: ``pinion forward``, ``gear torsion``, ``rotor overdamped``.
    """

    bodies: list[str]
    amplitude: NDArray[np.float64]
    names: NDArray[np.str_]

    def usual(self) -> list[str]:
        """Name of each mode at most of the points; empty where it is found at none."""
        counted = [Counter(name for name in row if name) for row in self.names.tolist()]
        return [one.most_common(1)[0][0] if one else "" for one in counted]


def shapes_of(
    system: System, vectors: NDArray[np.complex128], frequency: NDArray[np.float64], whirl: NDArray[np.int8]
) -> Shapes:
    """Shapes of modes from their eigenvectors.

    Parameters
    ----------
    vectors : array of complex, shape (mode, state, point)
        NaN where there is none.
    frequency, whirl : array, shape (mode, point)
        Zero frequency: overdamped. Sense of whirl: 1, -1, or 0 for none.
    """
    known = bodies(system)
    size = np.array([np.sqrt((np.abs(vectors[:, places]) ** 2).sum(axis=1)) for places in known.values()])
    size = size.reshape(len(known), *frequency.shape).transpose(1, 0, 2)
    largest = size.max(axis=1, keepdims=True, initial=0.0)
    amplitude = np.divide(size, largest, out=np.full(size.shape, np.nan), where=largest > 0)
    names = np.full(frequency.shape, "", dtype=object)
    for mode, point in np.argwhere(np.isfinite(amplitude).all(axis=1) & bool(known)):
        body = list(known)[int(amplitude[mode, :, point].argmax())]
        sense = "in a line" if whirl[mode, point] == 0 else WHIRL[int(whirl[mode, point])]
        if frequency[mode, point] == 0:
            names[mode, point] = f"{body} overdamped"
        else:
            names[mode, point] = body if len(known[body]) == 1 else f"{body} {sense}"
    return Shapes(list(known), amplitude, names.astype(str))
