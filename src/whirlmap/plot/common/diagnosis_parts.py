"""Parts of a diagnosis: the one Dataset divided into the Datasets that the drawing functions read."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import xarray as xr

from whirlmap.analysis.spectra.spectral_lines import spectral_lines
from whirlmap.analysis.spectra.spectrum import power_spectrum
from whirlmap.plot.common.labels import roles_of, unit_of
from whirlmap.results.status import Status


@dataclass(frozen=True)
class Parts:
    """The parts of a Dataset for a sheet of panels, and why the others are absent.

    Attributes
    ----------
    series, spectrum, lines, section, lyapunov, dimension : xr.Dataset or None
    orders : dict of str to float
        Turns of each named clock in one T, with the sign of its spin.
    reasons : dict of str to str
        By the names above.
    """

    series: xr.Dataset | None
    spectrum: xr.Dataset | None
    lines: xr.Dataset | None
    section: xr.Dataset | None
    lyapunov: xr.Dataset | None
    dimension: xr.Dataset | None
    orders: dict[str, float]
    reasons: dict[str, str]


def parts_of(ds: xr.Dataset, coordinate: str) -> Parts:
    """Take apart the Dataset of a diagnosis (or of a simulation, which has fewer parts)."""
    series = ds if "x" in ds else None
    spectrum, lines = spectrum_of(ds, coordinate) if series is not None else (None, None)
    old = [str(n) for n in ds.variables if str(n).startswith("dimension_")]
    dimension = _renamed(ds, old) if "dimension_status" in ds else None
    status = Status(int(np.max(ds["status"].values))) if "status" in ds else Status.ok
    why = status.sentence if status else "not computed"
    reasons = dict.fromkeys(("series", "spectrum", "section", "lyapunov", "dimension"), why)
    if not status and "period_T" in ds and int(ds["period_T"]) > 0:
        reasons["dimension"] = f"periodic({int(ds['period_T'])}T):\na finite set of points"
    return Parts(
        series,
        spectrum,
        lines,
        ds if "section" in ds else None,
        ds if "running" in ds else None,
        dimension,
        {str(k): float(v) for k, v in json.loads(str(ds.attrs.get("clocks", "{}"))).items()},
        reasons,
    )


def spectrum_of(ds: xr.Dataset, coordinate: str) -> tuple[xr.Dataset | None, xr.Dataset | None]:
    """Measure the power spectrum and lines of a state, over multiples of 1/T; None where the run ended."""
    x = ds["x"].sel(state=coordinate).values
    if x.size < 256 or not np.isfinite(x).all():
        return None, None
    turn = ds["turn"].values
    rate = (turn.size - 1) / float(turn[-1] - turn[0])
    # A record that holds its first and its last point would count one sample of the period twice.
    whole = x[:-1] if abs(turn[0] - np.rint(turn[0])) < 1e-9 and abs(turn[-1] - np.rint(turn[-1])) < 1e-9 else x
    spectrum = power_spectrum(whole, rate=rate, unit="T").assign_attrs({k: v for k, v in ds.attrs.items() if k == "roles"})
    if (unit := unit_of(ds, coordinate)) != "1":
        spectrum["power"].attrs["units"] = f"{unit}^2"
    return spectrum, spectral_lines(spectrum)


def journal_of(ds: xr.Dataset) -> tuple[str, str] | None:
    """Find the states of the first journal that the model declares; lengths are over the clearance."""
    known = [str(s) for s in ds["state"].values] if "state" in ds else []
    declared = roles_of(ds).get("journals", {}).values()
    return next(((x, y) for x, y in declared if x in known and y in known), None)


def clock_name(orders: Mapping[str, Fraction | float]) -> str:
    """Name of the clock that turns once in T, which frequencies are multiples of."""
    return next((name for name, order in orders.items() if abs(abs(float(order)) - 1) < 1e-9), "")


def marked_shaft(orders: Mapping[str, Fraction | float]) -> tuple[str, Fraction | float]:
    """Choose the shaft whose turns are marked on orbits: the fastest that is slower than 1/T, else T."""
    slower = {name: order for name, order in orders.items() if 0 < abs(float(order)) < 1 - 1e-9}
    if slower:
        return max(slower.items(), key=lambda item: abs(float(item[1])))
    return clock_name(orders) if orders else "", 1


def _renamed(ds: xr.Dataset, names: list[str]) -> xr.Dataset:
    """Give the variables of the dimension their own names, with the radii."""
    out = xr.Dataset(
        {n.removeprefix("dimension_"): ds[n].drop_vars([c for c in ds[n].coords if c != "radius"]) for n in names}
    )
    return out if "radius" in out.coords or "radius" not in ds else out.assign_coords(radius=ds["radius"])
