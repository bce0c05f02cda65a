"""whirlmap: labelled regime maps for geared rotors on fluid films.

Names are imported when they are first used, so that importing the package costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from whirlmap.version import __version__ as __version__

if TYPE_CHECKING:
    from whirlmap import plot as plot
    from whirlmap.analysis.campbell import campbell as campbell
    from whirlmap.analysis.diagnosis import diagnose as diagnose
    from whirlmap.analysis.dimension import correlation_dimension as correlation_dimension
    from whirlmap.analysis.film_coefficients import film_coefficients as film_coefficients
    from whirlmap.analysis.floquet import floquet_multipliers as floquet_multipliers
    from whirlmap.analysis.linear import linear_analysis as linear_analysis
    from whirlmap.analysis.lyapunov import lyapunov_spectrum as lyapunov_spectrum
    from whirlmap.analysis.ross import ross_bearing as ross_bearing
    from whirlmap.analysis.series import diagnose_series as diagnose_series
    from whirlmap.analysis.settling import Settling as Settling
    from whirlmap.analysis.spectrum import full_spectrum as full_spectrum
    from whirlmap.analysis.spectrum import power_spectrum as power_spectrum
    from whirlmap.analysis.switching import switchings as switchings
    from whirlmap.analysis.threshold import stability_threshold as stability_threshold
    from whirlmap.analysis.trajectory import section as section
    from whirlmap.analysis.trajectory import simulate as simulate
    from whirlmap.integrate.in_units import in_units as in_units
    from whirlmap.integrate.loading import load as load
    from whirlmap.integrate.system import System as System
    from whirlmap.results.labels import labels as labels
    from whirlmap.sweep.attractors import attractors as attractors
    from whirlmap.sweep.basins import basins as basins
    from whirlmap.sweep.diagram import bifurcation_diagram as bifurcation_diagram
    from whirlmap.sweep.improve import improve as improve
    from whirlmap.sweep.map import regime_map as regime_map
    from whirlmap.sweep.map import tolerance_sweep as tolerance_sweep
    from whirlmap.sweep.points import label_points as label_points
    from whirlmap.sweep.speeds import safe_speeds as safe_speeds
    from whirlmap.sweep.waterfall import waterfall as waterfall


_HOMES = {
    "ross_bearing": "whirlmap.analysis.ross",
    "campbell": "whirlmap.analysis.campbell",
    "diagnose": "whirlmap.analysis.diagnosis",
    "correlation_dimension": "whirlmap.analysis.dimension",
    "linear_analysis": "whirlmap.analysis.linear",
    "stability_threshold": "whirlmap.analysis.threshold",
    "lyapunov_spectrum": "whirlmap.analysis.lyapunov",
    "Settling": "whirlmap.analysis.settling",
    "diagnose_series": "whirlmap.analysis.series",
    "film_coefficients": "whirlmap.analysis.film_coefficients",
    "floquet_multipliers": "whirlmap.analysis.floquet",
    "full_spectrum": "whirlmap.analysis.spectrum",
    "power_spectrum": "whirlmap.analysis.spectrum",
    "switchings": "whirlmap.analysis.switching",
    "section": "whirlmap.analysis.trajectory",
    "simulate": "whirlmap.analysis.trajectory",
    "in_units": "whirlmap.integrate.in_units",
    "load": "whirlmap.integrate.loading",
    "System": "whirlmap.integrate.system",
    "labels": "whirlmap.results.labels",
    "attractors": "whirlmap.sweep.attractors",
    "basins": "whirlmap.sweep.basins",
    "bifurcation_diagram": "whirlmap.sweep.diagram",
    "label_points": "whirlmap.sweep.points",
    "safe_speeds": "whirlmap.sweep.speeds",
    "improve": "whirlmap.sweep.improve",
    "regime_map": "whirlmap.sweep.map",
    "tolerance_sweep": "whirlmap.sweep.map",
    "waterfall": "whirlmap.sweep.waterfall",
}

__all__ = ["__version__", "plot", *_HOMES]


def __getattr__(name: str) -> Any:
    """Import a public name from its home."""
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    if name == "plot":
        return import_module("whirlmap.plot")
    raise AttributeError(f"module 'whirlmap' has no attribute {name!r}")


def __dir__() -> list[str]:
    """Public names."""
    return sorted(__all__)
