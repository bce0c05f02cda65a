"""Onto the branch of doubled orbits at a period doubling."""

from dataclasses import replace
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.branches.corrector import Ask
from whirlmap.analysis.branches.events import Event
from whirlmap.analysis.branches.periodic_orbits import PeriodicOrbits
from whirlmap.analysis.branches.unknowns import Unknowns

Array = NDArray[np.float64]

#: Distances between the halves of the first doubled orbit that are tried, in sizes of the states.
APART = (0.03, 0.01, 0.003, 0.1)


def doubled(event: Event, apart: float) -> tuple[Ask, Array]:
    """The first orbit of the doubled branch, and the direction in which its halves differ.

    Parameters
    ----------
    event : Event
        A period doubling of a periodic orbit.
    apart : float
        Distance of the halves along the eigenvector of -1, in sizes of the states.

    Returns
    -------
    ask : Ask
        In the hyperplane across that direction, so that the orbit of single period is not found.
    halves : array, shape (state,)
        Of unit length, in sizes of the states.
    """
    c = event.at
    orbits = c.equations
    assert isinstance(orbits, PeriodicOrbits)
    count, n = c.point.x.shape
    sizes = c.linear.weights[:n]
    product = np.eye(n)
    for matrix in c.linear.matrices:
        product = matrix @ product
    vector = np.linalg.svd(product + np.eye(n))[2][-1]
    vectors = [vector]
    for matrix in c.linear.matrices[:-1]:
        vectors.append(matrix @ vectors[-1])
    away = np.array(vectors) * sizes
    twice = replace(
        orbits, periods=2 * orbits.periods, steps=orbits.steps if orbits.periods else 2 * orbits.steps
    )  # fmt: skip
    x = np.concatenate([c.point.x + apart / 2 * away, c.point.x - apart / 2 * away])
    duration = None if c.point.duration is None else 2 * c.point.duration
    guess = Unknowns(x, c.point.free, duration)
    rest = guess.vector.size - x.size
    every = np.concatenate([np.tile(c.linear.sizes[: count * n] * sqrt(2), 2), c.linear.sizes[count * n :]])
    normal = np.concatenate([away.ravel(), -away.ravel(), np.zeros(rest)]) / every
    return Ask(twice, guess, normal / np.linalg.norm(normal), every), vector
