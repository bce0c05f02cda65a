"""Regime labels, as they stand in Datasets."""

from enum import IntEnum


class Regime(IntEnum):
    """What the motion of one operating point is."""

    undecided = 0
    periodic = 1
    quasi_periodic = 2
    chaotic = 3
    contact = 4
    diverged = 5
    at_rest = 6
    drifting = 7
    growing = 8
    locked = 9
    not_settled = 10
    not_steady = 11

    @property
    def label(self) -> str:
        """Name as it is printed: ``quasi-periodic``."""
        return self.name.replace("_", "-")


#: Motions that leave every bound, seen there or on their way.
WITHOUT_BOUND = (Regime.diverged, Regime.drifting, Regime.growing)
