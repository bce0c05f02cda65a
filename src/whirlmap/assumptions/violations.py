"""Check of the assumptions of a machine's model against the machine and its results: the one place that decides.

A model gives results outside of its assumptions too. Limits are those of the audit, `studies/gear_psfd/audit.md`, section 6.
"""

import json
from collections.abc import Iterable, Iterator, Mapping
from math import inf, isfinite, nan
from typing import TYPE_CHECKING, Any

import numpy as np

from whirlmap.assumptions import bearings, gear_pair, oil_heat, operation
from whirlmap.assumptions.violation import Facts, Results, Violation
from whirlmap.errors import CaseError
from whirlmap.integrate.system import System

if TYPE_CHECKING:
    import xarray as xr

#: What `Model.assumptions` names: assumptions beside those of bearings.
BESIDE = {"": lambda _: (), "gear_pair": gear_pair.violations}
#: What a command does not repeat: said in other words, or of a result.
NOT_REPEATED = ("static_equilibrium", "not_evaluated")


def violations(system: System, diagrams: Results = None) -> list[Violation]:
    """List the assumptions of a machine's model that do not hold.

    Parameters
    ----------
    system : System
        Of a model that declares the eccentricity of its journals, such as a gear pair of any edition or a Jeffcott rotor.
        Dimensions are those of its case; speed and permeability its own.
    diagrams : xr.Dataset, mapping to it or iterable of it, optional
        Results of `whirlmap.bifurcation_diagram` or `whirlmap.diagnose`. The largest eccentricity is read from
        ``maximum(..., quantity)``, the largest speed from ``s``, static equilibria from ``start_found``.

    Returns
    -------
    list of Violation
        In a fixed order; one named ``not_evaluated`` comes last where something is not known.

    Raises
    ------
    CaseError
        For any other model.
    """
    if not judged(system):
        raise CaseError(
            f"assumptions are those of journals in films, and {system.model.name!r} declares none: expected an output with"
            ' role="eccentricity", as gear_pair and jeffcott have'
        )
    runs = _runs(diagrams)
    facts = Facts.of(system, runs)
    found = [
        *bearings.slenderness(facts),
        *bearings.clearance(facts),
        *_eccentricity(facts, runs),
        *bearings.at_rest(facts),
        *bearings.flow(facts),
        *oil_heat.violations(facts),
        *operation.unbalance(facts),
        *operation.speeds(facts),
        *BESIDE[system.model.assumptions](facts),
        *_equilibrium(facts, runs),
    ]
    unknown = _unknown(facts, runs)
    return [*found, unknown] if unknown else found


def judged(system: System) -> bool:
    """Whether assumptions of a system's model are known: it has journals."""
    return bool(system.model.outputs_of("eccentricity"))


def repeated(systems: Iterable[System]) -> list[str]:
    """Strains of one system, or of the ends of a sweep, as commands say them: one text each.

    Of a model without journals in films the speeds are looked at alone.

    A violation that several systems have is said once, of the one where it goes furthest beyond its limit.
    """
    found: dict[str, Violation] = {}
    for system in systems:
        for violation in violations(system) if judged(system) else operation.speeds(Facts.of(system, [])):
            known = found.get(violation.name)
            if known is None or abs(violation.value - violation.limit) > abs(known.value - known.limit):
                found[violation.name] = violation
    return [violation.text for name, violation in found.items() if name not in NOT_REPEATED]


def _runs(diagrams: Results) -> "list[xr.Dataset]":
    if diagrams is None:
        return []
    import xarray as xr

    if isinstance(diagrams, xr.Dataset):
        return [diagrams]
    return list(diagrams.values() if isinstance(diagrams, Mapping) else diagrams or ())


def _eccentricity(facts: Facts, runs: "list[xr.Dataset]") -> Iterator[Violation]:
    """Eccentricities of results."""
    for journal in facts.journals:
        value, place = _largest(runs, journal.output)
        if value > bearings.DEEP:
            yield Violation(
                f"eccentricity{journal.name}", value, bearings.DEEP,
                f"{journal.words} reaches an eccentricity of {value:.3g}{place}: above {bearings.DEEP} roughness,"
                " misalignment, elastic bearings and warm oil, which the model leaves out, decide.",
            )  # fmt: skip


def _largest(runs: "list[xr.Dataset]", output: str) -> tuple[float, str]:
    """Largest finite value of an output, and where along the diagrams it was found."""
    best, place = -inf, ""
    for run in runs:
        if "maximum" not in run or output not in run["quantity"].values:
            continue
        found = run["maximum"].sel(quantity=output, drop=True)
        numbers = np.where(np.isfinite(found.values), found.values, -inf)
        if numbers.max() > best:
            index = np.unravel_index(int(numbers.argmax()), numbers.shape)
            best, place = float(numbers[index]), _place(run, dict(zip(found.dims, index, strict=True)))
    return best, place


def _place(run: "xr.Dataset", index: Mapping[Any, Any]) -> str:
    """Name one point of a diagram: ``" at s = 1.3, up, psi = 0.001"``."""
    along = {str(dim): run[dim].values[k] for dim, k in index.items() if dim in run.coords}
    fixed = json.loads(run.attrs.get("parameters", "{}")).get("psi")
    if fixed and "psi" not in along:
        along["psi"] = float(fixed["value"])
    words = [str(v) if isinstance(v, str) else f"{name} = {float(v):.4g}" for name, v in along.items()]
    return f" at {', '.join(words)}" if words else ""


def _equilibrium(facts: Facts, runs: "list[xr.Dataset]") -> Iterator[Violation]:
    """Static equilibria of the operating points that were run, or of the system itself."""
    flags = [np.ravel(run["start_found"].values) for run in runs if "start_found" in run]
    if not flags and facts.system.model.start == "equilibrium":
        flags = [np.array([facts.rest is not None])]
    if not flags:
        return
    found = np.concatenate(flags).astype(bool)
    if not found.all():
        where = f" at {(~found).sum()} of {found.size} operating points" if found.size > 1 else ""
        yield Violation(
            "static_equilibrium", float(found.mean()), 1.0,
            f"No static equilibrium was found{where} with all forcing off: the films cannot carry the weight"
            " inside their clearances, and a run begins beside the clearance centre instead.",
        )  # fmt: skip


def _unknown(facts: Facts, runs: "list[xr.Dataset]") -> Violation | None:
    journals = facts.journals
    parts = []
    dimensions = len(facts.bearings) >= len(journals)
    lacking = [
        words
        for words, there in (
            ("length over diameter", dimensions),
            ("the film's Reynolds number and inertia", dimensions and facts.clock is not None),
            ("the thickness of the porous ring", facts.plain or len(facts.results("ring")) >= len(journals)),
        )
        if not there
    ]
    if lacking:
        parts.append(f"The case does not give the dimensions for {', '.join(lacking)}.")
    if not all(isfinite(_largest(runs, journal.output)[0]) for journal in journals):
        parts.append("No result with the largest eccentricity was given.")
    return Violation("not_evaluated", nan, nan, " ".join(parts)) if parts else None
