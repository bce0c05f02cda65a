"""Systems and SciPy solutions that several files of this folder use."""

from fractions import Fraction

import numpy as np
from scipy.integrate import solve_ivp
from tests.independent.newton import Machine

from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.equilibrium import start_states
from whirlmap.integrate.system import System
from whirlmap.models import family

CLOCKS = {
    "pinion": {"r_p": Fraction(1), "r_g": Fraction(-1, 2), "r_m": Fraction(20), "j_p": 1.0, "j_g": -0.5},
    "mesh": {"r_p": Fraction(1, 4), "r_g": Fraction(-1, 8), "r_m": Fraction(1), "j_p": 0.25, "j_g": -0.125},
}


def gear_pair(s, psi=0.0, *, clock="pinion", arc="fixed", machine=None, **changes):
    """The audit's reference machine."""
    edition = "physical" if clock == "pinion" else "intended"
    model = family("gear_pair").model(edition=edition, film="porous", arc=arc)
    groups = {**(machine or Machine()).groups(s, **CLOCKS[clock]), "psi": psi, **changes}
    return System(model, {p.name: groups[p.name] for p in model.parameters})


def jeffcott(arc="fixed", **changes):
    values = {"s": 2.0, "Gamma": 0.7, "b": 0.3, "k": 3.0, "xi": 0.05, **changes}
    return System(family("jeffcott").model(rotor="flexible", arc=arc), values)


def at_rest(system):
    x, found = start_states(system.model, system.vector[:, None])
    assert found.all()
    return x[:, 0]


def ensemble(system, x, steps, **more):
    """Lanes of one operating point; ``x`` has shape (state,) or (state, lane)."""
    x = np.asarray(x, dtype=float).reshape(system.model.dimension, -1)
    values = np.repeat(system.vector[:, None], x.shape[1], axis=1)
    return Ensemble(system.model, values, x, orders=system.orders, steps=steps, **more)


def solved(system, span, x, *, rtol=1e-11, atol=1e-12, **more):
    """DOP853 on the reference kernel."""
    return solve_ivp(system.reference_rhs, span, x, method="DOP853", rtol=rtol, atol=atol, **more)
