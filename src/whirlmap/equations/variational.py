"""Tangent dynamics of a model: the Jacobian of its equations, derived from the declaration."""

from sympy import Expr, sympify

from whirlmap.equations.model import Model


def jacobian(model: Model) -> dict[tuple[int, int], Expr]:
    """Non-zero entries of the Jacobian of the equations by the states.

    Returns
    -------
    dict
        ``{(row, column): expression}`` in states, parameters and time. Rows and columns follow the declared order of
        states. At the switch of a guarded term the entry is that of the side that the kernel takes.
    """
    entries: dict[tuple[int, int], Expr] = {}
    for i, row in enumerate(model.states):
        rate = sympify(model.equations[row])
        for j, column in enumerate(model.states):
            if rate.has(column):
                entry = rate.diff(column)
                if entry != 0:
                    entries[i, j] = entry
    return entries


def divergence(model: Model) -> Expr:
    """Trace of the Jacobian: the rate at which phase-space volume grows; the exponents of a run sum to its mean."""
    return sympify(sum(sympify(model.equations[s]).diff(s) for s in model.states))
