"""Linear stability of the searched sets: whether the static equilibrium is stable, and the frequency of the unstable mode.

The static equilibrium with all forcing off is the start of every run. The eigenvalues of the Jacobian there say whether a
small motion dies out, and at which frequency it grows: half of a journal's spin is the whirl of its film.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.motion.ensembles import parameter_values
from whirlmap.integrate.equilibrium import start_states
from whirlmap.integrate.system import System
from whirlmap.kernels.running.reference import reference_rates
from whirlmap.results.regime import WITHOUT_BOUND, Regime
from whirlmap.studies.gear_psfd.claims.labelled import PSI, Array
from whirlmap.studies.gear_psfd.search.coarse_diagrams import Settings
from whirlmap.studies.gear_psfd.search.variants import Variant

#: Points whose Jacobians are taken together.
PIECE = 2048
#: Step of the central differences.
STEP = 1e-6
#: Growth per clock radian above which a mode grows: below lies the error of the differences.
GROWS = 1e-7
#: A whirl is at half of a journal's spin within this share of it.
NEAR = 0.1


@dataclass(frozen=True)
class Modes:
    """The mode that grows fastest at each operating point, arrays of shape (point,); NaN where there is no equilibrium.

    Attributes
    ----------
    growth, frequency : array
        Per clock radian, and in clock turns per clock turn.
    eccentricity : array, shape (2, point)
        Static, of both journals.
    """

    growth: Array
    frequency: Array
    eccentricity: Array


def modes(system: System, values: Mapping[str, ArrayLike]) -> Modes:
    """Find the fastest mode at the static equilibria of many operating points.

    Parameters
    ----------
    values : mapping of str to array, shape (point,)
        The parameters that differ between points.

    Notes
    -----
    Jacobian by central differences of the reference kernel without forcing, which enters the equations additively. With the
    fixed arc the right-hand side has a kink at the centre of a bearing, so that an unloaded journal has no Jacobian there;
    weight keeps it away.
    """
    model = system.model
    columns = parameter_values(system, values)
    x, found = start_states(model, columns)
    growth, frequency = np.full(x.shape[1], np.nan), np.full(x.shape[1], np.nan)
    rates = reference_rates(model, forced=False, tables="read")
    n = x.shape[0]
    psi = columns[[p.name for p in model.parameters].index("psi")]
    for value in np.unique(psi):  # tables are read for one permeability at a time
        members = np.flatnonzero(found & (psi == value))
        for first in range(0, members.size, PIECE):
            at = members[first : first + PIECE]
            shift = STEP * np.eye(n)[:, :, None]
            here, p = x[:, at], np.tile(columns[:, at], n)
            moved = ((here[:, None, :] + sign * shift).reshape(n, -1) for sign in (1, -1))
            up, down = (rates(0.0, z, p).reshape(n, n, -1) for z in moved)
            jacobian = ((up - down) / (2 * STEP)).transpose(2, 0, 1)
            good = np.isfinite(jacobian).all(axis=(1, 2))
            roots = np.linalg.eigvals(jacobian[good])
            top = np.take_along_axis(roots, roots.real.argmax(axis=1)[:, None], axis=1)[:, 0]
            growth[at[good]], frequency[at[good]] = top.real, np.abs(top.imag)
    journals = np.stack([np.hypot(x[0], x[1]), np.hypot(x[2], x[3])])
    return Modes(growth, frequency, np.where(found, journals, np.nan))


def modes_of_block(variant: Variant, ds: xr.Dataset, settings: Settings, sets: int) -> Modes:
    """Fastest modes of the first sets of a block, arrays reshaped to (set, psi, speed)."""
    system = variant.system()
    values = ds["value"].values[:, :sets]
    n, speeds = values.shape[1], np.asarray(settings.speeds)
    columns = {
        r.name: np.repeat(values[k], settings.points) for k, r in enumerate(settings.ranges) if r.name in system.parameters
    }
    columns["psi"] = np.tile(np.repeat(PSI, speeds.size), n)
    columns["s"] = np.tile(speeds, len(PSI) * n)
    found = modes(system, columns)
    shape = (n, len(PSI), speeds.size)
    return Modes(found.growth.reshape(shape), found.frequency.reshape(shape), found.eccentricity.reshape(2, *shape))


def half_speed(found: Modes, variant: Variant) -> NDArray[np.bool_]:
    """Points that are unstable at half of a journal's spin."""
    spins = [abs(variant.changes[name]) for name in ("j_p", "j_g")]
    with np.errstate(invalid="ignore"):
        near = [np.abs(found.frequency - j / 2) <= NEAR * j / 2 for j in spins]
        return np.asarray((found.growth > GROWS) & np.any(near, axis=0))


#: How a point stands by linear theory, and what a simulation then finds.
STANDS = ("stable", "unstable", "no equilibrium")
FINDS = ("with the forcing", "other motion", "contact", "diverged")


def against_simulation(found: Modes, ds: xr.Dataset, forced: int) -> Array:
    """Points of each stand by linear theory and each outcome of a simulation, counted, shape (stand, outcome)."""
    sets = found.growth.shape[0]
    regime, period = ds["regime"].values[:sets], ds["period_T"].values[:sets]
    with np.errstate(invalid="ignore"):
        unstable = found.growth > GROWS
    none = np.isnan(found.growth)
    answer = (regime == Regime.periodic) & (period == forced)
    ended = [regime == Regime.contact, np.isin(regime, WITHOUT_BOUND)]
    outcomes = [answer, ~answer & ~ended[0] & ~ended[1], *ended]
    stands = (~unstable & ~none, unstable, none)
    return np.array([[(stand & out).sum() for out in outcomes] for stand in stands], dtype=float)


def permeability(found: Modes, edges: ArrayLike) -> Array:
    """What psi = 0.1 does to points of a given static eccentricity at psi = 0.

    Returns
    -------
    array, shape (bin, 6)
        Points in the bin; of those: unstable and calmed, unstable and still so, stable and still so, stable and upset,
        without an equilibrium.
    """
    deepest = found.eccentricity[:, :, 0].max(axis=0)
    before, after = found.growth[:, 0], found.growth[:, -1]
    rows = []
    bounds = np.asarray(edges, dtype=float)
    with np.errstate(invalid="ignore"):
        for low, high in pairwise(bounds):
            here = (deepest >= low) & (deepest < high) & np.isfinite(before)
            was, still = before > GROWS, after > GROWS
            gone = np.isnan(after)
            parts = [was & ~still & ~gone, was & still, ~was & ~still & ~gone, ~was & still, gone]
            rows.append([here.sum(), *((here & part).sum() for part in parts)])
    return np.array(rows, dtype=float)
