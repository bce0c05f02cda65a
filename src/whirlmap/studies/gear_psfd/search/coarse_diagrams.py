"""Coarse labelled diagrams of many parameter sets at once, and what the paper's claims say of them."""

import hashlib
import json
import zlib
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap import __version__
from whirlmap.analysis.steady.settling import Settling
from whirlmap.options.computed import Integration, Labelling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.results.schema import variable, with_attributes
from whirlmap.studies.gear_psfd.claims.claims import HOLDS, NEED_ORBIT, judge_all
from whirlmap.studies.gear_psfd.claims.labelled import ORBITS, PSI, S_ORBIT, Array, Labelled, Orbits, least_exponent
from whirlmap.studies.gear_psfd.reproduction.verdicts import known_regime
from whirlmap.studies.gear_psfd.search.ranges import Range, design, digest, ranges
from whirlmap.studies.gear_psfd.search.variants import VARIANTS, Variant
from whirlmap.sweep.points.label_points import label_points
from whirlmap.sweep.store.fingerprint import kernel_hash

Progress = Callable[[int], None]

#: Method of integration.
METHOD = "dop853"
#: Speeds of the coarse diagrams, the paper's s: 2 to 4 in each window of the claims, and the named 1.61 and 3.27.
SPEEDS = (0.6, 0.9, 1.1, 1.25, 1.4, 1.5, 1.56, 1.61, 1.9, 2.3, 2.8, S_ORBIT, 3.5, 3.8)


@dataclass(frozen=True)
class Settings:
    """What every number of a search depends on, but for the variant.

    Attributes
    ----------
    seed : int
        Of the design and of the refinement.
    speeds : tuple of float
        The paper's s.
    settling : Settling
    exponent_periods : int
        T of the exponent of points that do not return, at most.
    accuracy : float
        Error over one common period that steps are chosen for.
    ranges : tuple of Range
    """

    seed: int = 1
    speeds: tuple[float, ...] = SPEEDS
    settling: Settling = field(default_factory=lambda: Settling(transient=40, most=8, keep=16))
    exponent_periods: int = 512
    accuracy: float = 1e-4
    ranges: tuple[Range, ...] = field(default_factory=ranges)

    def identity(self) -> dict[str, Any]:
        """Plain data that tell one search from another: these settings, and all that decides the bits of a point."""
        systems = {v.name: v.system() for v in VARIANTS}
        kernels = "".join(kernel_hash(system, METHOD) for system in systems.values())
        drawn = {"s", "psi", *(r.name for r in self.ranges)}
        fixed = {
            name: sorted((p, str(value)) for p, value in system.values.items() if p not in drawn)
            for name, system in systems.items()
        }
        return {
            "version": __version__, "seed": self.seed, "speeds": list(self.speeds), "psi": list(PSI),
            "settling": asdict(self.settling), "exponent_periods": self.exponent_periods, "accuracy": self.accuracy,
            "method": METHOD, "ranges": digest(self.ranges), "design": "Sobol, scrambled for each variant",
            "kernels": hashlib.sha256(kernels.encode()).hexdigest()[:16],
            "readings": hashlib.sha256(json.dumps(fixed).encode()).hexdigest()[:16],
        }  # fmt: skip

    @property
    def points(self) -> int:
        """Operating points of one set."""
        return len(PSI) * len(self.speeds)


def sets_of(variant: Variant, settings: Settings, first: int, count: int) -> Array:
    """Sets number ``first`` to ``first + count`` of a variant's own design, shape (group, set)."""
    return design(settings.ranges, first, count, seed=(settings.seed, zlib.crc32(variant.name.encode())))


def diagrams(
    variant: Variant, sets: Array, settings: Settings, execution: Execution = EXECUTION
) -> xr.Dataset:
    """Compute the coarse labelled diagrams of many parameter sets in one call.

    Parameters
    ----------
    sets : array, shape (group, set)
        Values in the order of ``settings.ranges``; those that the edition does not read change nothing.

    Returns
    -------
    xr.Dataset
        Over (set, psi, s): ``regime``, ``status``, ``period_T``, ``lyapunov``, ``lyapunov_error``, ``amplitude`` (of y_p),
        ``max_eccentricity``, ``settled_after``, ``start_found``, ``steps``, ``step_verdict``, ``end_time``; and
        ``value(group, set)``.
    """
    system = variant.system()
    n, speeds = sets.shape[1], np.asarray(settings.speeds)
    read = [k for k, r in enumerate(settings.ranges) if r.name in system.parameters]
    columns: dict[str, Array] = {settings.ranges[k].name: np.repeat(sets[k], settings.points) for k in read}
    columns["psi"] = np.tile(np.repeat(PSI, speeds.size), n)
    columns["s"] = np.tile(speeds, len(PSI) * n)
    ds = label_points(
        system, columns, execution=execution,
        labelling=Labelling(settings.settling, settings.exponent_periods, Integration(METHOD, accuracy=settings.accuracy)),
    )  # fmt: skip
    over = ("set", "psi", "s")

    def shaped(values: NDArray[Any]) -> NDArray[Any]:
        return values.reshape(n, len(PSI), speeds.size)

    kept = ("regime", "status", "period_T", "lyapunov", "lyapunov_error", "settled_after", "start_found", "steps",
            "step_verdict", "end_time")  # fmt: skip
    data = {name: (over, shaped(ds[name].values), ds[name].attrs) for name in kept}
    span = ds["peak_to_peak"].sel(quantity="yp").values
    data["amplitude"] = variable(over, shaped(span), "1", "peak-to-peak of y_p")
    deepest = ds["max_eccentricity"].max("bearing", skipna=False).values
    data["max_eccentricity"] = variable(over, shaped(deepest), "1", "largest eccentricity of either journal")
    data["value"] = variable(("group", "set"), sets, "1", "parameter set")
    made = xr.Dataset(
        data,
        {
            "psi": variable("psi", PSI, "1", "permeability"), "s": variable("s", speeds, "1", "speed ratio of the paper"),
            "group": ("group", [r.name for r in settings.ranges], {"long_name": "group"}),
        },
    )  # fmt: skip
    kept_attributes = {k: v for k, v in ds.attrs.items() if k not in ("date", "command")}
    facts = {"variant": variant.name, "seed": settings.seed, "common_period": system.common_period}
    return with_attributes(made, kept_attributes | facts)


def labelled(ds: xr.Dataset, settings: Settings, orbits: Mapping[str, Array] | None = None) -> Labelled:
    """Arrange coarse diagrams as the claims read them; without ``orbits`` nothing is known of spectra and dimensions."""
    regime = known_regime(ds["regime"].values, ds["status"].values)
    at = settings.speeds.index(S_ORBIT)
    exponent, error = ds["lyapunov"].values, ds["lyapunov_error"].values
    nothing = np.full(regime.shape[:2], np.nan)
    known = orbits or {}
    least = least_exponent(settings.exponent_periods, ds.attrs["common_period"] / ds.attrs["common_multiple"])
    return Labelled(
        s=ds["s"].values, regime=regime, period=ds["period_T"].values, exponent=exponent, error=error,
        amplitude=ds["amplitude"].values,
        slowness=np.clip(ds["settled_after"].values / settings.settling.longest, 0.0, 1.0),
        forced=int(ds.attrs["common_multiple"]), least=least,
        orbits=Orbits(
            regime[:, :, at], exponent[:, :, at], error[:, :, at], known.get("lines", nothing),
            known.get("broadband", nothing),
            {y: (known.get(f"D2_{y}", nothing), known.get(f"D2_error_{y}", nothing)) for y in ORBITS}, least,
        ),
    )  # fmt: skip


@dataclass(frozen=True)
class Judged:
    """Sets of one variant and what the claims say of them; arrays over (claim, set)."""

    variant: Variant
    claims: tuple[str, ...]
    values: Array
    word: NDArray[np.int8]
    score: Array
    labelled: Labelled

    @property
    def holds(self) -> NDArray[np.bool_]:
        """Which claims hold, shape (claim, set)."""
        return self.word == HOLDS

    @property
    def diagram_claims(self) -> NDArray[np.bool_]:
        """Claims that a labelled diagram decides."""
        return ~np.isin(self.claims, NEED_ORBIT)

    @property
    def total(self) -> Array:
        """Mean score of each set over the claims that a labelled diagram decides."""
        return np.asarray(self.score[self.diagram_claims].mean(axis=0))

    @property
    def order(self) -> NDArray[np.intp]:
        """Sets, best first: by the number of claims that hold, then by score, then as they come."""
        met = self.holds[self.diagram_claims].sum(axis=0)
        return np.lexsort((-self.total, -met))


def judge_sets(variant: Variant, ds: xr.Dataset, settings: Settings) -> Judged:
    """Ask every claim of every set of some diagrams."""
    d = labelled(ds, settings)
    found = judge_all(d)
    word = np.stack([j.word for j in found.values()])
    score = np.stack([j.score for j in found.values()])
    return Judged(variant, tuple(found), ds["value"].values, word, score, d)
