"""What the gear pair's model assumes, and where a system or its results leave those assumptions.

A model answers outside of its assumptions too; this module says when it does. Limits are those of the audit,
`studies/gear_psfd/audit.md`, section 6.
"""

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from math import inf, isfinite, nan, sqrt, tanh
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from whirlmap.cases import Settled
from whirlmap.errors import CaseError
from whirlmap.integrate.equilibrium import start_states
from whirlmap.integrate.system import System

if TYPE_CHECKING:
    import xarray as xr

OIL_DENSITY = 870.0  # kg/m^3; assumed where a case does not give it
SHORT = 0.25  # length over diameter
DEEP = 0.9  # eccentricity
THICK_RING = 0.63  # pi H/L, at which tanh(x)/x = 0.886
FEWEST_TEETH = 12  # on a gear of which nothing else is known
TAYLOR = 41.2  # vortices between turning cylinders from Re = 41.2 sqrt(R/c)
FILM_INERTIA = 1.0  # rho omega c^2/mu


@dataclass(frozen=True)
class Strain:
    """One assumption of the model that does not hold.

    Attributes
    ----------
    name : str
        What is strained: ``"slenderness_1"``, ``"mesh_load"``, ...; ``"not_evaluated"`` stands for all that
        could not be looked at.
    value, limit : float
        What was found, and where the assumption ends; NaN where there is no number.
    sentence : str
        What it means, for people.
    """

    name: str
    value: float
    limit: float
    sentence: str


@dataclass(frozen=True)
class _Facts:
    """Numbers of one system, as floats."""

    values: Mapping[str, float]
    switches: Mapping[str, str]
    inputs: Mapping[str, float]
    quantities: Mapping[str, float]
    s: float  # the largest that was run

    @property
    def clock(self) -> float | None:
        """Speed of the clock in rad/s."""
        return self.s * self.quantities["omega_0"] if "omega_0" in self.quantities else None


Results = Union["xr.Dataset", Mapping[Any, "xr.Dataset"], Iterable["xr.Dataset"], None]


def strained(system: System, diagrams: Results = None) -> list[Strain]:
    """List the assumptions of the gear pair's model that do not hold.

    Parameters
    ----------
    system : System
        A gear pair, of any edition. Dimensions are those of its case; speed and permeability are its own.
    diagrams : xr.Dataset, mapping to it or iterable of it, optional
        Results of `whirlmap.bifurcation_diagram` or `whirlmap.diagnose`. The largest eccentricity is read from
        ``maximum(..., quantity)``, the largest speed from ``s``, static equilibria from ``start_found``.

    Returns
    -------
    list of Strain
        In a fixed order; one named ``not_evaluated`` comes last where something is not known.

    Raises
    ------
    CaseError
        For any other model.
    """
    if system.model.name != "gear_pair":
        raise CaseError(f"assumptions are those of the model gear_pair, not of {system.model.name!r}")
    runs = _runs(diagrams)
    facts = _facts(system, runs)
    found = [
        *_slenderness(facts),
        *_eccentricity(runs),
        *_at_rest(system),
        *_flow(facts),
        *_ring(facts),
        *_mesh_load(system, facts),
        *_fixed_arc(facts),
        *_clocks(facts),
        *_equilibrium(system, runs),
    ]
    unknown = _unknown(facts, runs)
    return [*found, unknown] if unknown else found


def _runs(diagrams: Results) -> "list[xr.Dataset]":
    if diagrams is None:
        return []
    import xarray as xr

    if isinstance(diagrams, xr.Dataset):
        return [diagrams]
    return list(diagrams.values() if isinstance(diagrams, Mapping) else diagrams or ())


def _facts(system: System, runs: "list[xr.Dataset]") -> _Facts:
    settled = system.details if isinstance(system.details, Settled) else None
    values = {name: float(value) for name, value in system.values.items()}
    speeds = [float(run["s"].max()) for run in runs if "s" in run.coords]
    return _Facts(
        values=values,
        switches=dict(system.model.switches),
        inputs={name: given.value for name, given in settled.inputs.items()} if settled else {},
        quantities={name: value for name, (value, _) in settled.quantities.items()} if settled else {},
        s=max([values["s"], *speeds]),
    )


def _slenderness(facts: _Facts) -> Iterator[Strain]:
    for i in (1, 2):
        value = facts.quantities.get(f"slenderness_{i}", 0.0)
        if value > SHORT:
            yield Strain(
                f"slenderness_{i}", value, SHORT,
                f"Bearing {i} has a length of {value:.3g} diameters: the film is that of a short bearing, good"
                f" below {SHORT}, and carries too much in a longer one.",
            )  # fmt: skip


def _eccentricity(runs: "list[xr.Dataset]") -> Iterator[Strain]:
    for i in (1, 2):
        value, place = _largest(runs, f"eps_{i}")
        if value > DEEP:
            yield Strain(
                f"eccentricity_{i}", value, DEEP,
                f"Journal {i} reaches an eccentricity of {value:.3g}{place}: above {DEEP} roughness,"
                " misalignment, elastic bearings and warm oil, which the model leaves out, decide.",
            )  # fmt: skip


def _at_rest(system: System) -> Iterator[Strain]:
    """Eccentricities of the static equilibrium, where there is one."""
    x, found = start_states(system.plain_model(), system.vector[:, None])
    for i in (1, 2):
        value = float(np.hypot(*(x[system.states.index(f"u{i}{axis}"), 0] for axis in "xy")))
        if found[0] and value > DEEP:
            yield Strain(
                f"rest_eccentricity_{i}", value, DEEP,
                f"Journal {i} rests at an eccentricity of {value:.3g}: above {DEEP} roughness, misalignment, elastic"
                " bearings and warm oil, which the model leaves out, decide.",
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


def _flow(facts: _Facts) -> Iterator[Strain]:
    """Laminar flow without inertia, with the case's density or an assumed one."""
    mu, c, clock = facts.inputs.get("mu"), facts.inputs.get("c"), facts.clock
    if mu is None or c is None or clock is None:
        return
    density = facts.inputs.get("rho", OIL_DENSITY)
    said = f"(oil of {density:g} kg/m3{'' if 'rho' in facts.inputs else ' assumed'})"
    for i, spin in ((1, "j_p"), (2, "j_g")):
        R = facts.inputs.get(f"R_{i}")
        if R is None:
            continue
        value = density * abs(facts.values[spin]) * clock * R * c / mu
        limit = TAYLOR * sqrt(R / c)
        if value > limit:
            yield Strain(
                f"film_reynolds_{i}", value, limit,
                f"Film {i} has a Reynolds number of {value:.3g} {said} at s = {facts.s:.4g}: from {limit:.3g} on"
                " the flow has vortices, and the film resists more than the model's laminar one.",
            )  # fmt: skip
    fastest = max(abs(facts.values[r]) for r in ("r_p", "r_g", "r_m")) * clock
    value = density * fastest * c**2 / mu
    if value > FILM_INERTIA:
        yield Strain(
            "film_inertia", value, FILM_INERTIA,
            f"rho omega c^2/mu is {value:.3g} {said} at the fastest harmonic, {fastest:.4g} rad/s at"
            f" s = {facts.s:.4g}: above about {FILM_INERTIA:g} the oil's inertia, which the film law leaves out,"
            " is felt in the motion at that frequency.",
        )  # fmt: skip


def _ring(facts: _Facts) -> Iterator[Strain]:
    if facts.values["psi"] == 0.0:
        return
    for i in (1, 2):
        x = facts.quantities.get(f"ring_{i}", 0.0)
        if x > THICK_RING:
            factor = tanh(x) / x
            yield Strain(
                f"ring_{i}", x, THICK_RING,
                f"The porous ring of bearing {i} is thick, x = pi H/L = {x:.3g}: less oil flows along it than along"
                f" a thin one, as if psi were smaller by about tanh(x)/x = {factor:.3g},"
                f" {factor * facts.values['psi']:.3g} instead of {facts.values['psi']:.3g}.",
            )  # fmt: skip


def _mesh_load(system: System, facts: _Facts) -> Iterator[Strain]:
    """Compare what presses the teeth together at rest with what the transmission error pulls at them."""
    unit = facts.inputs["K_p"] * facts.inputs["c"] if {"K_p", "c"} <= facts.inputs.keys() else None
    force = facts.values["Lambda"] * abs(facts.values["E"])
    limit = force if unit is None else force * unit
    name = "K_p c" if unit is None else "N"
    written = f"{limit:.3g} {name}"
    if facts.switches.get("mesh") == "line":
        load = _tooth_load_at_rest(system) * (1.0 if unit is None else unit)
        if load <= limit:
            beside = "" if facts.switches["torsion"] == "rigid_rotors" else (
                " Without torsion the rotors turn uniformly, so that a film that gives way unloads the teeth; torsion ="
                " rigid_rotors lets them follow."
            )  # fmt: skip
            yield Strain(
                "mesh_load", load, limit,
                f"The teeth carry {load:.3g} {name} at rest, and the transmission error alone pulls at them with {written}"
                f" with both gears held: they part.{beside}",
            )  # fmt: skip
        return
    yield Strain(
        "mesh_load", 0.0, limit,
        "The isotropic mesh transmits no torque, so no load holds the teeth together, and its spring pulls as well"
        " as pushes: real teeth stay in contact only under a load above the dynamic mesh force, which is"
        f" {written} from the transmission error alone with both gears held.",
    )  # fmt: skip


def _tooth_load_at_rest(system: System) -> float:
    """Static force along the line of action over K_p c; the transmitted one where no equilibrium is found."""
    values = {name: float(value) for name, value in system.values.items()}
    x, found = start_states(system.plain_model(), system.vector[:, None])
    if not found[0]:
        return values["F_0"]
    q = dict(zip(system.states, x[:, 0], strict=True))
    away = np.cos(values["phi_m"]) * (q["xp"] - q["xg"]) + np.sin(values["phi_m"]) * (q["yp"] - q["yg"])
    away += q.get("qp", 0.0) - q.get("qg", 0.0)
    return float(values["F_0"] + values["Lambda"] * away)


def _fixed_arc(facts: _Facts) -> Iterator[Strain]:
    """Compare forward whirl with half the spin, beyond which the half film 0..pi has negative pressure."""
    if facts.switches.get("arc") != "fixed":
        return
    v = facts.values
    porous = facts.switches.get("film") == "porous"  # the printed film has no radial force without radial motion
    outwards = ", and the film pushes the journal outwards where a real one holds it" if porous else ""
    acting = [r for r, amplitude in (("r_p", "b_p"), ("r_g", "b_g"), ("r_m", "E")) if v[amplitude] != 0.0]
    for i, spin in ((1, "j_p"), (2, "j_g")):
        if v[spin] == 0.0 or not acting:
            continue
        value = max(2 * v[r] / v[spin] for r in acting)
        if value > 1.0:
            yield Strain(
                f"fixed_arc_{i}", value, 1.0,
                f"The half film of journal {i} is fixed to its spin, but the forcing whirls it forward at up to"
                f" {value:.3g} times half that spin: there the pressure on that half is negative, which oil does"
                f" not sustain{outwards}. The arc of positive pressure has no such limit.",
            )  # fmt: skip


def _clocks(facts: _Facts) -> Iterator[Strain]:
    """Mesh, shafts and journals of one machine have speeds that follow from each other."""
    v = facts.values
    for i, gear, rate, teeth in ((1, "pinion", "r_p", "z_p"), (2, "gear", "r_g", "z_g")):
        if v[rate] == 0.0:
            continue
        value = abs(v["r_m"] / v[rate])
        given = facts.inputs.get(teeth)
        if given is not None and given < FEWEST_TEETH:
            yield Strain(
                f"few_teeth_{i}", given, float(FEWEST_TEETH),
                f"Gears with fewer than {FEWEST_TEETH} teeth or so are undercut, and lose the contact ratio that keeps one"
                f" pair or two in mesh; the {gear} has {given:g}.",
            )  # fmt: skip
        limit = FEWEST_TEETH if given is None else given
        if value < limit if given is None else abs(value - limit) > 1e-9 * limit:
            beside = f"but it has {given:g}" if given is not None else f"and gears have at least {limit} or so"
            yield Strain(
                f"teeth_{i}", value, float(limit),
                f"The clock gives the {gear} {value:.4g} teeth (mesh frequency over shaft speed, {v['r_m']:g}"
                f" over {abs(v[rate]):g}), {beside}: its unbalance and the mesh belong to different machines.",
            )  # fmt: skip
    for i, rate, spin in ((1, "r_p", "j_p"), (2, "r_g", "j_g")):
        if v[rate] == 0.0 or v[spin] == 0.0:
            continue
        value = v[spin] / v[rate]
        if abs(value - 1.0) > 1e-9:
            yield Strain(
                f"spin_{i}", value, 1.0,
                f"Journal {i} spins in its film at {value:.4g} times the speed of its own shaft's unbalance.",
            )  # fmt: skip
    if v["r_p"] * v["r_g"] > 0.0:
        yield Strain(
            "gear_sense", v["r_g"] / v["r_p"], 0.0,
            "The gear turns the same way as the pinion; two external gears turn against each other.",
        )  # fmt: skip


def _equilibrium(system: System, runs: "list[xr.Dataset]") -> Iterator[Strain]:
    """Static equilibria of the operating points that were run, or of the system itself."""
    flags = [np.ravel(run["start_found"].values) for run in runs if "start_found" in run]
    if not flags:
        flags = [start_states(system.plain_model(), system.vector[:, None])[1]]
    found = np.concatenate(flags).astype(bool)
    if not found.all():
        where = f" at {(~found).sum()} of {found.size} operating points" if found.size > 1 else ""
        yield Strain(
            "static_equilibrium", float(found.mean()), 1.0,
            f"No static equilibrium was found{where} with all forcing off: the films cannot carry the weight"
            " inside their clearances, and a run begins beside the clearance centre instead.",
        )  # fmt: skip


def _unknown(facts: _Facts, runs: "list[xr.Dataset]") -> Strain | None:
    known, plain = facts.quantities, facts.values["psi"] == 0.0
    parts = []
    lacking = [
        words
        for words, there in (
            ("length over diameter", {"slenderness_1", "slenderness_2"} <= known.keys()),
            ("the film's Reynolds number and inertia", _flow_known(facts)),
            ("the thickness of the porous ring", plain or {"ring_1", "ring_2"} <= known.keys()),
        )
        if not there
    ]
    if lacking:
        parts.append(f"The case does not give the dimensions for {', '.join(lacking)}.")
    if not all(isfinite(_largest(runs, f"eps_{i}")[0]) for i in (1, 2)):
        parts.append("No result with the largest eccentricity was given.")
    return Strain("not_evaluated", nan, nan, " ".join(parts)) if parts else None


def _flow_known(facts: _Facts) -> bool:
    return facts.clock is not None and {"mu", "c", "R_1", "R_2"} <= facts.inputs.keys()
