"""Computations by which the paper's claims are judged: diagrams over the speed, and one operating point at s = 3.27."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.analysis.diagnosis.diagnosis import diagnose
from whirlmap.analysis.indicators.correlation_dimension import STATUS as DIMENSION_STATUS
from whirlmap.analysis.indicators.correlation_dimension import correlation_dimension
from whirlmap.analysis.signals.embedding import delay_embedding, false_neighbours, mutual_information
from whirlmap.analysis.steady.settling import Settling
from whirlmap.errors import CaseError, RangeError
from whirlmap.integrate.division import cores
from whirlmap.integrate.loading import load
from whirlmap.integrate.system import System
from whirlmap.integrate.workers import Workers
from whirlmap.studies.gear_psfd.claims.labelled import ORBITS, PSI, S_ORBIT
from whirlmap.sweep.diagrams.diagram import bifurcation_diagram

Array = NDArray[np.float64]

#: Speeds drawn; the paper names speeds from 1.18 to 3.27 and shows at least those.
S_RANGE = (0.3, 4.0)
#: Speeds that a claim names by themselves, always among those computed.
S_NAMED = (1.60, 1.61, 1.62)
#: Fourth-order Runge-Kutta, as in the paper, which does not say its steps.
PAPERS_METHOD: Any = {"method": "rk4", "steps": 100}


@dataclass(frozen=True)
class Edition:
    """One reading of the paper's system.

    Attributes
    ----------
    case : str
        Its case.
    scale : float
        The paper's s over the case's s at equal pinion speed: the machine's clock is the pinion, which makes a quarter of
        a turn per clock turn in the paper.
    """

    name: str
    case: str
    scale: float
    says: str


EDITIONS = (
    Edition("literal", "gear-psfd/literal", 1.0, "equations (30)-(41) as printed"),
    Edition("intended", "gear-psfd/intended", 1.0, "equations as derived, numbers chosen by the paper's claims"),
    Edition("machine", "gear-psfd/machine", 4.0, "each shaft on its own clock, film with positive pressure"),
)


@dataclass(frozen=True)
class Quality:
    """How much is computed.

    Attributes
    ----------
    speeds : int
        Speeds for each permeability, before those that claims name.
    settling : Settling
        Of the diagrams.
    exponent_periods : int
        T of the exponent of each point that does not return, at most.
    orbit_settling : Settling
        Of the operating point at s = 3.27.
    points : int
        Section points of its dimension.
    most_periods : int
        T after which its exponent stops.
    """

    speeds: int
    settling: Settling
    exponent_periods: int
    orbit_settling: Settling
    points: int
    most_periods: int


QUALITIES = {
    "quick": Quality(32, Settling(transient=20, most=8, keep=16), 16384, Settling(transient=30, most=16), 4000, 800),
    "full": Quality(600, Settling(transient=80, most=16, keep=64), 16384, Settling(transient=200, most=64), 20480, 12800),
}


def edition_of(case: str) -> Edition:
    """Return one of `EDITIONS` by its case, or another case of the gear pair as an edition of its own.

    Raises
    ------
    CaseError
        Where the case is not one of the gear pair.
    """
    for edition in EDITIONS:
        if edition.case == case:
            return edition
    system = load(case)
    if system.model.name != "gear_pair":
        raise CaseError(f"{case}: found the model {system.model.name}, expected a case of the gear pair")
    switches = ", ".join(f"{k} {v}" for k, v in system.model.switches.items())
    name = Path(case).stem
    return Edition(name, case, float(4 * system.values["r_p"]), f"the case {name} ({switches})")


def quality_named(name: str) -> Quality:
    """Return the quality of that name, or raise `RangeError`."""
    if name not in QUALITIES:
        raise RangeError(f"quality is {' or '.join(QUALITIES)}, not {name!r}")
    return QUALITIES[name]


@dataclass(frozen=True)
class EditionData:
    """All that was computed for one edition; speeds are the paper's.

    Attributes
    ----------
    diagrams : mapping of psi to xr.Dataset
        `bifurcation_diagram` against the case's s, with ``paper_s(s)``.
    orbits : mapping of psi to xr.Dataset
        `diagnose` at s = 3.27.
    dimensions : mapping of (psi, coordinate) to mapping of str to xr.Dataset
        ``plane``, ``states`` and ``embedded``: `correlation_dimension` of each; empty where the motion returns or ended.
    """

    edition: Edition
    system: System
    quality: Quality
    diagrams: Mapping[float, xr.Dataset]
    orbits: Mapping[float, xr.Dataset]
    dimensions: Mapping[tuple[float, str], Mapping[str, xr.Dataset]]


def speeds(quality: Quality) -> Array:
    """Return the paper's speeds that are computed, ascending."""
    even = np.linspace(*S_RANGE, quality.speeds)
    return np.unique(np.concatenate([even, S_NAMED, [S_ORBIT]]))


def gather(
    edition: Edition, quality: Quality, *, workers: int | None = None, progress: Callable[[int], None] | None = None,
    keep: Callable[[str, float, xr.Dataset], object] = lambda _kind, _psi, _ds: None,
) -> EditionData:  # fmt: skip
    """Compute everything for one edition; ``keep(kind, psi, ds)`` takes each diagram and orbit as it is finished."""
    system = load(edition.case)
    here = system.replace(s=S_ORBIT / edition.scale)

    def diagram(psi: float) -> xr.Dataset:
        return diagram_of(edition, system.replace(psi=psi), quality, progress)

    def orbit(psi: float) -> xr.Dataset:
        return diagnose(
            here.replace(psi=psi), settling=quality.orbit_settling, exponent_count=1, points=quality.points,
            max_periods=quality.most_periods, workers=1, progress=progress, **PAPERS_METHOD,
        )  # fmt: skip

    # A thread for each permeability: while one solves for start states in Python, another is in its kernels.
    with Workers(workers or cores()) as pool:
        made: dict[str, dict[float, xr.Dataset]] = {"diagram": {}, "orbit": {}}
        for kind, compute in (("diagram", diagram), ("orbit", orbit)):
            for psi, ds in zip(PSI, pool.map(compute, PSI), strict=True):
                made[kind][psi] = ds
                keep(kind, psi, ds)
        diagrams, orbits = made["diagram"], made["orbit"]
    dimensions = {(psi, y): _dimensions(orbits[psi], y, workers or cores()) for psi in PSI for y in ORBITS}
    return EditionData(edition, system, quality, diagrams, orbits, dimensions)


def diagram_of(
    edition: Edition, system: System, quality: Quality, progress: Callable[[int], None] | None = None
) -> xr.Dataset:  # fmt: skip
    """The diagram of a system, the edition's at some permeability, with the paper's speeds beside its own."""
    ds = bifurcation_diagram(
        system, "s", speeds(quality) / edition.scale, settling=quality.settling, lyapunov=quality.exponent_periods,
        workers=1, progress=progress, **PAPERS_METHOD,
    )  # fmt: skip
    attributes = {"units": "1", "long_name": "speed ratio of the paper"}
    return ds.assign_coords(paper_s=("s", ds["s"].values * edition.scale, attributes))


def _dimensions(ds: xr.Dataset, coordinate: str, workers: int) -> dict[str, xr.Dataset]:
    """Correlation dimensions of one coordinate: its plane (y, y') as in the paper, all states, delay embedding."""
    if "dimension_status" not in ds:
        return {}
    section = ds["section"].transpose("run", "period", "state")
    good = section.values[np.isfinite(section.values).all(axis=(1, 2))]
    runs = np.repeat(np.arange(good.shape[0]), good.shape[1])
    flat = good.reshape(-1, good.shape[2])
    columns = [list(section["state"].values).index(name) for name in (coordinate, f"v{coordinate}")]
    out = {
        "plane": correlation_dimension(flat[:, columns], theiler=10, trajectories=runs, workers=workers),
        "states": correlation_dimension(flat, theiler=10, trajectories=runs, workers=workers),
    }
    embedded = _embedded(ds["x"].sel(state=coordinate).values)
    if embedded is not None:
        out["embedded"] = correlation_dimension(embedded[0], theiler=10 * embedded[1], workers=workers)
    return out


def _embedded(series: Array, most: int = 20_000) -> tuple[Array, int] | None:
    """Delay embedding of a time series and its lag; None where no lag or dimension is found."""
    thin = series[:: max(series.size // most, 1)]
    if not np.isfinite(thin).all():
        return None
    found = mutual_information(thin, min(200, thin.size // 20))
    lag = int(found["first_minimum"]) if int(found["status"]) == 0 else 0
    if lag < 1:
        return None
    neighbours = false_neighbours(thin[:4000], lag=lag, theiler=lag)
    if int(neighbours["status"]) != 0:
        return None
    return delay_embedding(thin, dimension=int(neighbours["dimension_found"]), lag=lag), lag


def dimension_text(ds: xr.Dataset) -> str:
    """Number and error of a correlation dimension, or why there is none."""
    status = DIMENSION_STATUS[int(ds["status"])]
    return f"{float(ds['D2']):.2f} ± {float(ds['D2_error']):.2f}" if status == "ok" else status
