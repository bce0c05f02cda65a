"""The value of a parameter at which the static equilibrium loses its stability."""

from typing import Any

import numpy as np

from whirlmap.analysis.linear.linearisation import linearised
from whirlmap.errors import RangeError, counted
from whirlmap.integrate.own_units import in_own_units
from whirlmap.integrate.system import System

#: Values of the parameter that one round evaluates together.
VALUES = 33


class NoThresholdError(RangeError):
    """A bracket in which no stability is lost. It is an answer, and no wrong input."""


def stability_threshold(
    system: System, name: str, bracket: tuple[float | str, float | str], *, tolerance: float = 1e-9
) -> float:
    """Lowest value in a bracket at which the largest real part of the eigenvalues turns from negative to positive.

    Each round linearises `VALUES` values of the bracket in one batch and keeps the first interval whose ends differ
    in stability. Two changes closer together than the first round's spacing are not seen.

    Parameters
    ----------
    system : System
        Of a model that starts at its static equilibrium.
    name : str
        Parameter to vary; the others are held. Or the dimensional input that is the speed.
    bracket : tuple of float or str
        Lowest and highest value; both may have a unit, ``("500 rpm", "6000 rpm")``.
    tolerance : float
        Width of the last bracket, relative to its value.

    Returns
    -------
    float
        Value of the parameter, in the model's unit, to a relative ``tolerance``.

    Raises
    ------
    RangeError
        Where the bracket is not ascending, or an equilibrium in it is not found.
    InputError
        A unit that the parameter does not have, or a speed without one.
    NoThresholdError
        Where the bracket shows no loss of stability.

    Notes
    -----
    Eigenvalues are those of `linear_analysis` at each value. The threshold is that of small motions: beyond a subcritical
    Hopf bifurcation large ones live on below it, which only runs or `attractors` show.
    """
    name, ends = in_own_units(system, name, bracket, "bracket")
    if ends.shape != (2,):
        raise RangeError(f"bracket: found {counted(ends.size, 'value')}, expected two, (low, high)")
    low, high = ends.tolist()
    if not (np.isfinite([low, high]).all() and low < high and 1e-14 <= tolerance < 1):
        raise RangeError("the bracket must be (low, high) with low < high, and the tolerance at least 1e-14 and below 1")
    for end in (low, high):
        at_end: dict[str, Any] = {name: end}
        system.replace(**at_end)  # refuses an unknown name, and a value that the model cannot take
    model, row = system.plain_model(), system.parameters.index(name)
    while high - low > tolerance * max(abs(low), abs(high)):
        grid = np.linspace(low, high, VALUES)
        values = np.repeat(system.vector[:, None], VALUES, axis=1)
        values[row] = grid
        _, jacobian, found = linearised(model, values)
        if not found.all():
            raise RangeError(f"no static equilibrium was found at {name} = {grid[~found][0]:g}; take a narrower bracket")
        unstable = np.linalg.eigvals(jacobian).real.max(axis=1) > 0
        lost = np.flatnonzero(~unstable[:-1] & unstable[1:])
        if not lost.size:
            state = "unstable" if unstable.all() else "stable" if not unstable.any() else "first unstable, then stable"
            raise NoThresholdError(f"no loss of stability for {name} from {low:g} to {high:g}: the equilibrium is {state}")
        low, high = grid[lost[0]], grid[lost[0] + 1]
    return float((low + high) / 2)
