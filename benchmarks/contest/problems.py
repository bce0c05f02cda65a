"""What is integrated: one model at many operating points, from given start states, over some periods T."""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.equations.model import Model
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.loading import load
from whirlmap.integrate.system import System
from whirlmap.kernels.methods import METHODS

Array = NDArray[np.float64]

#: An orbit that comes closer to a bearing's centre than this [clearance] meets the kink of the fixed half film there.
CENTRE = 0.02

#: Steps per T of the run that finds how far the journals travel, which needs no accuracy.
SCOUT_STEPS = 400


@dataclass(frozen=True, eq=False)
class Problem:
    """Operating points to integrate.

    Attributes
    ----------
    name : str
    system : System
        One of the points; the others differ by the varied parameter.
    values : array, shape (parameter, point)
    x0 : array, shape (state, point)
    periods : int
        Length of a run in T; a whole number of common periods.
    """

    name: str
    system: System
    values: Array
    x0: Array
    periods: int

    @property
    def psi(self) -> float:
        """Permeability, zero for a model without."""
        return float(self.system.values.get("psi", 0.0))

    @property
    def model(self) -> Model:
        """The model in the form that holds for these points (the closed form of the film at psi = 0)."""
        return self.system.plain_model()

    @property
    def orders(self) -> tuple[Fraction, ...]:
        """Orders of the harmonics."""
        return self.system.orders

    @property
    def points(self) -> int:
        """Number of operating points."""
        return self.x0.shape[1]

    @cached_property
    def period(self) -> Array:
        """Period T of each point, shape (point,)."""
        return self.ensemble("rk4", SCOUT_STEPS).period

    @cached_property
    def eccentricity(self) -> tuple[Array, Array]:
        """Smallest and largest eccentricity of any journal over the run, shape (point,) each; ones without journals."""
        run = self.ensemble("rk4", SCOUT_STEPS)
        rows = [self.x0.shape[0] + i for i, name in enumerate(self.system.model.outputs) if name.startswith("eps")]
        if not rows:
            return np.ones(self.points), np.ones(self.points)
        extremes = run.advance(self.periods, extremes=True).extremes
        assert extremes is not None
        return extremes["minimum"][rows].min(axis=0), extremes["maximum"][rows].max(axis=0)

    @property
    def through_centre(self) -> NDArray[np.bool_]:
        """Points whose orbit passes a bearing's centre, where the fixed half film is not smooth, shape (point,)."""
        return self.eccentricity[0] < CENTRE

    def ensemble(self, method: str, steps: int | NDArray[np.int64], workers: int = 1) -> Ensemble:
        """Build whirlmap's ensemble at the start states. The benchmarks make ensembles here and nowhere else."""
        return Ensemble(
            self.system.model, self.values, self.x0, orders=self.orders, steps=steps, method=METHODS[method],
            workers=workers,
        )  # fmt: skip


def gear_pair(psi: float, points: int, periods: int = 8) -> Problem:
    """The paper's system as derived, at speed ratios from 0.3 to 4, from its static equilibrium."""
    return _swept(f"gear pair, psi = {psi:g}", load("gear-psfd/reference", psi=psi, s=2.0), "s", 0.3, 4.0, points, periods)


def duffing(points: int, periods: int = 8) -> Problem:
    """Duffing's oscillator at forcing amplitudes from 0.2 to 0.29, before and in its period doublings."""
    return _swept("Duffing", load("duffing"), "gamma", 0.2, 0.29, points, periods)


def jeffcott(points: int, periods: int = 8) -> Problem:
    """A rigid Jeffcott rotor on plain short bearings, at speed ratios from 1 to 2.5, below the threshold of oil whip."""
    return _swept("rigid Jeffcott rotor", load("jeffcott"), "s", 1.0, 2.5, points, periods)


def _swept(name: str, system: System, parameter: str, low: float, high: float, points: int, periods: int) -> Problem:
    ensemble, _ = make_ensemble(system, {parameter: np.linspace(low, high, points)}, workers=1)
    return Problem(name, system, ensemble.values, ensemble.x.copy(), periods)
