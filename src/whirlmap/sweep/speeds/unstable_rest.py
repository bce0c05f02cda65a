"""Speeds at which the static equilibrium is unstable: motion excites itself there, whatever the unbalance."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from sympy import sympify

from whirlmap.analysis.linear.linearisation import linearised
from whirlmap.analysis.motion.ensembles import parameter_values
from whirlmap.errors import RangeError
from whirlmap.integrate.system import System

#: Speeds that are looked at, spread over those of interest: two blocks of lanes.
POINTS = 16


def unstable_rest(system: System, speeds: ArrayLike) -> dict[str, Any] | None:
    """Judge the static equilibrium, with all forcing off, at some of these speeds.

    Parameters
    ----------
    system : System
        Of a model with a speed.
    speeds : array_like, shape (speed,)
        Values of the speed parameter; of more than `POINTS`, that many are looked at.

    Returns
    -------
    dict or None
        ``looked_at``, the speeds with an equilibrium that were looked at; ``unstable``, those at which a small motion
        grows; and of the motion that grows fastest at each of the latter ``journal``, in which bearing the journal moves
        most, and ``ratio``, its frequency over the speed of that journal (0 of a motion that does not oscillate, NaN of a
        journal that does not turn). None for a model without journals, a static equilibrium, or a linear system there.

    Notes
    -----
    Eigenvalues are those of `linear_analysis`. Those of a film that carries its journal are oil whirl where the ratio is
    a little below one half, and oil whip where the frequency stays that of a bending mode [childs1993].
    """
    at = np.asarray(speeds, dtype=float)
    if not system.model.journals or not at.size:
        return None
    if at.size > POINTS:
        at = at[np.linspace(0, at.size - 1, POINTS).round().astype(int)]
    table = parameter_values(system, {str(system.speed): at})
    try:
        _, jacobian, found = linearised(system.plain_model(), table)
    except RangeError:  # no equilibrium is declared, or no linear system describes small motions about it
        return None
    at, jacobian, table = at[found], jacobian[found], table[:, found]
    if not at.size:
        return None
    eigenvalues, vectors = np.linalg.eig(jacobian)
    fastest = eigenvalues.real.argmax(axis=1)
    every = np.arange(at.size)
    growing, mode = eigenvalues[every, fastest], vectors[every, :, fastest]
    model, states = system.model, list(system.states)
    rows = np.array([[states.index(q.name) for q in journal.u] for journal in model.journals.values()])
    moved = np.linalg.norm(mode[:, rows], axis=2)  # (speed, journal)
    which, names, unstable = moved.argmax(axis=1), list(model.journals), growing.real > 0
    spins = [sympify(journal.spin) for journal in model.journals.values()]
    ratios = []
    for i in np.flatnonzero(unstable):
        values = {p: table[k, i] for k, p in enumerate(model.parameters)}
        spin = abs(float(spins[which[i]].subs(values)))
        ratios.append(float(abs(growing[i].imag)) / spin if spin else float("nan"))
    return {
        "looked_at": at.tolist(), "unstable": at[unstable].tolist(),
        "journal": [names[k] for k in which[unstable]], "ratio": ratios,
    }  # fmt: skip
