"""Small, real Datasets that every picture is drawn from."""

import numpy as np
import pytest
import xarray as xr

from whirlmap.analysis.diagnosis.diagnosis import diagnose
from whirlmap.analysis.indicators.correlation_dimension import correlation_dimension
from whirlmap.analysis.simulation.poincare_section import section
from whirlmap.analysis.simulation.time_series import simulate
from whirlmap.analysis.steady.settling import Settling
from whirlmap.integrate.loading import load
from whirlmap.sweep.diagrams.diagram import bifurcation_diagram

QUICK = Settling(transient=100, most=8, keep=40)


@pytest.fixture(scope="session")
def chaos(diagnosed: xr.Dataset) -> dict[str, xr.Dataset]:
    """Duffing's oscillator in chaos: every part of a sheet."""
    system = load("duffing", gamma=0.5, delta=0.3, alpha=-1, beta=1, omega=1.2)
    parts = {
        "series": simulate(system, periods=128, transient=100, every=4),
        "section": section(system, points=2000, transient=100),
        "lyapunov": diagnosed,
    }
    cloud = parts["section"]["section"].values[0]
    return parts | {"dimension": correlation_dimension(cloud, theiler=2)}


@pytest.fixture(scope="session")
def periodic() -> dict[str, xr.Dataset]:
    """Duffing's oscillator with period one: section points that differ by rounding."""
    system = load("duffing", gamma=0.2, delta=0.3, alpha=-1, beta=1, omega=1.2)
    return {
        "series": simulate(system, periods=40, transient=200, every=2),
        "section": section(system, points=600, transient=200),
    }


@pytest.fixture(scope="session")
def diagram() -> xr.Dataset:
    """Duffing's oscillator from periodic to chaotic, with exponents."""
    system = load("duffing", gamma=0.5, delta=0.3, alpha=-1, beta=1, omega=1.2)
    values = [0.20, 0.22, 0.24, 0.27, 0.275, 0.28, 0.40, 0.44, 0.48]
    return bifurcation_diagram(system, "gamma", values, settling=QUICK, lyapunov=32, states=["x", "v"])


@pytest.fixture(scope="session")
def both() -> xr.Dataset:
    """A hardening spring swept up and down: two branches between the folds."""
    system = load("duffing", gamma=0.5, delta=0.1, alpha=1, beta=1, omega=1.2)
    values = [1.0, 1.4, 1.8, 2.2, 2.6]
    settling = Settling(transient=120, most=4, keep=8)
    return bifurcation_diagram(system, "omega", values, follow="both", settling=settling, states=["x", "v"])


@pytest.fixture(scope="session")
def diagnosed() -> xr.Dataset:
    """The one Dataset of a diagnosis, in chaos."""
    return diagnose(load("duffing", gamma=0.5, delta=0.3, alpha=-1, beta=1, omega=1.2), max_periods=64, points=2000)


@pytest.fixture(scope="session")
def rotor(periodic: dict[str, xr.Dataset]) -> dict[str, xr.Dataset]:
    """An oscillation dressed as a journal's orbit in its clearance: compiling a rotor takes too long here."""
    names = {"state": ["ux", "uy"]}
    series, points = (periodic[part].assign_coords(names) for part in ("series", "section"))
    eps = np.hypot(*(0.2 * series["x"].values.T))
    output = ("output", ["eps"], {"long_name": "output"})
    series = series.drop_dims("output").assign(x=0.2 * series["x"]).assign_coords(output=output)
    series.attrs["roles"] = '{"journals": {"1": ["ux", "uy"]}}'
    series["outputs"] = ("time", "output"), eps[:, None], {"units": "1", "long_name": "output"}
    return {"series": series, "section": points.assign(section=0.2 * points["section"])}


@pytest.fixture(scope="session")
def ended(diagram: xr.Dataset) -> xr.Dataset:
    """A diagram whose first three points ended in contact and whose last one was not resolved."""
    ds = diagram.copy(deep=True)
    ds["status"][:] = [1, 1, 1, 0, 0, 0, 0, 0, 3]
    ds["regime"][:] = [4, 4, 4, *ds["regime"].values[3:8], 0]
    ds["section"][[0, 1, 2, 8]] = float("nan")
    return ds
