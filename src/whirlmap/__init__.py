"""whirlmap: labelled regime maps for geared rotors on fluid films.

Names are imported when they are first used, so that importing the package costs nothing.
"""

import warnings
from importlib import import_module
from typing import TYPE_CHECKING, Any

from whirlmap.version import __version__ as __version__

if TYPE_CHECKING:
    from whirlmap import plot as plot
    from whirlmap.analysis.diagnosis.diagnosis import diagnose as diagnose
    from whirlmap.analysis.indicators.correlation_dimension import correlation_dimension as correlation_dimension
    from whirlmap.analysis.linear.campbell import campbell as campbell
    from whirlmap.analysis.linear.film_coefficients import film_coefficients as film_coefficients
    from whirlmap.analysis.linear.linearisation import linear_analysis as linear_analysis
    from whirlmap.analysis.linear.ross_bearing import ross_bearing as ross_bearing
    from whirlmap.analysis.linear.stability_threshold import stability_threshold as stability_threshold
    from whirlmap.analysis.linear.unbalance_response import unbalance_response as unbalance_response
    from whirlmap.analysis.signals.diagnose_series import diagnose_series as diagnose_series
    from whirlmap.analysis.simulation.poincare_section import section as section
    from whirlmap.analysis.simulation.run_up import run_up as run_up
    from whirlmap.analysis.simulation.surface_crossings import surface_crossings as surface_crossings
    from whirlmap.analysis.simulation.time_series import simulate as simulate
    from whirlmap.analysis.spectra.spectrum import full_spectrum as full_spectrum
    from whirlmap.analysis.spectra.spectrum import power_spectrum as power_spectrum
    from whirlmap.analysis.variational.floquet import floquet_multipliers as floquet_multipliers
    from whirlmap.analysis.variational.lyapunov import lyapunov_spectrum as lyapunov_spectrum
    from whirlmap.explorer.saved.inline import explore as explore
    from whirlmap.integrate.in_units import in_units as in_units
    from whirlmap.integrate.loading import load as load
    from whirlmap.integrate.system import System as System
    from whirlmap.options.computed import Integration as Integration
    from whirlmap.options.computed import Labelling as Labelling
    from whirlmap.options.computed import Settling as Settling
    from whirlmap.options.execution import Execution as Execution
    from whirlmap.options.storage import Storage as Storage
    from whirlmap.recordings.signal import read_signal as read_signal
    from whirlmap.results.labels import labels as labels
    from whirlmap.sweep.attractors.attractors import attractors as attractors
    from whirlmap.sweep.attractors.basins import basins as basins
    from whirlmap.sweep.branches.continue_orbit import continue_orbit as continue_orbit
    from whirlmap.sweep.branches.event_curve import event_curve as event_curve
    from whirlmap.sweep.diagrams.diagram import bifurcation_diagram as bifurcation_diagram
    from whirlmap.sweep.diagrams.waterfall import waterfall as waterfall
    from whirlmap.sweep.maps.regime_map import regime_map as regime_map
    from whirlmap.sweep.maps.regime_map import tolerance_sweep as tolerance_sweep
    from whirlmap.sweep.points.label_points import label_points as label_points
    from whirlmap.sweep.speeds.improve import improve as improve
    from whirlmap.sweep.speeds.safe_speeds import safe_speeds as safe_speeds


_HOMES = {
    "ross_bearing": "whirlmap.analysis.linear.ross_bearing",
    "campbell": "whirlmap.analysis.linear.campbell",
    "diagnose": "whirlmap.analysis.diagnosis.diagnosis",
    "correlation_dimension": "whirlmap.analysis.indicators.correlation_dimension",
    "linear_analysis": "whirlmap.analysis.linear.linearisation",
    "stability_threshold": "whirlmap.analysis.linear.stability_threshold",
    "unbalance_response": "whirlmap.analysis.linear.unbalance_response",
    "lyapunov_spectrum": "whirlmap.analysis.variational.lyapunov",
    "Settling": "whirlmap.options.computed",
    "Integration": "whirlmap.options.computed",
    "Labelling": "whirlmap.options.computed",
    "Execution": "whirlmap.options.execution",
    "Storage": "whirlmap.options.storage",
    "diagnose_series": "whirlmap.analysis.signals.diagnose_series",
    "film_coefficients": "whirlmap.analysis.linear.film_coefficients",
    "floquet_multipliers": "whirlmap.analysis.variational.floquet",
    "full_spectrum": "whirlmap.analysis.spectra.spectrum",
    "power_spectrum": "whirlmap.analysis.spectra.spectrum",
    "surface_crossings": "whirlmap.analysis.simulation.surface_crossings",
    "section": "whirlmap.analysis.simulation.poincare_section",
    "simulate": "whirlmap.analysis.simulation.time_series",
    "run_up": "whirlmap.analysis.simulation.run_up",
    "explore": "whirlmap.explorer.saved.inline",
    "in_units": "whirlmap.integrate.in_units",
    "load": "whirlmap.integrate.loading",
    "System": "whirlmap.integrate.system",
    "read_signal": "whirlmap.recordings.signal",
    "labels": "whirlmap.results.labels",
    "attractors": "whirlmap.sweep.attractors.attractors",
    "basins": "whirlmap.sweep.attractors.basins",
    "bifurcation_diagram": "whirlmap.sweep.diagrams.diagram",
    "label_points": "whirlmap.sweep.points.label_points",
    "safe_speeds": "whirlmap.sweep.speeds.safe_speeds",
    "improve": "whirlmap.sweep.speeds.improve",
    "regime_map": "whirlmap.sweep.maps.regime_map",
    "tolerance_sweep": "whirlmap.sweep.maps.regime_map",
    "waterfall": "whirlmap.sweep.diagrams.waterfall",
    "event_curve": "whirlmap.sweep.branches.event_curve",
    "continue_orbit": "whirlmap.sweep.branches.continue_orbit",
}

#: Former names, for one release.
_FORMER = {"switchings": "surface_crossings"}

__all__ = ["__version__", "plot", *_HOMES]


def __getattr__(name: str) -> Any:
    """Import a public name from its home."""
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    if name in _FORMER:
        warnings.warn(f"whirlmap.{name} is now whirlmap.{_FORMER[name]}", DeprecationWarning, stacklevel=2)
        return __getattr__(_FORMER[name])
    if name == "plot":
        return import_module("whirlmap.plot")
    raise AttributeError(f"module 'whirlmap' has no attribute {name!r}")


def __dir__() -> list[str]:
    """Public names."""
    return sorted(__all__)
