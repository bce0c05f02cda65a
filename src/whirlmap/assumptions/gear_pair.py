"""Assumptions of the gear pair's model beside its films: teeth in contact, positive pressure, the clocks of one machine."""

from collections.abc import Iterator
from math import cos, sin, tanh

from whirlmap.assumptions.violation import Facts, Violation

THICK_RING = 0.63  # pi H/L, at which tanh(x)/x = 0.886
FEWEST_TEETH = 12  # on a gear of which nothing else is known


def violations(facts: Facts) -> Iterator[Violation]:
    """Strains of the gear pair alone, in a fixed order."""
    for part in (ring, mesh_load, fixed_arc, clocks, standing_films):
        yield from part(facts)


def ring(facts: Facts) -> Iterator[Violation]:
    """Thickness of the porous ring."""
    if facts.values["psi"] == 0.0:
        return
    for i in (1, 2):
        x = facts.quantities.get(f"ring_{i}", 0.0)
        if x > THICK_RING:
            factor = tanh(x) / x
            yield Violation(
                f"ring_{i}", x, THICK_RING,
                f"The porous ring of bearing {i} is thick, x = pi H/L = {x:.3g}: less oil flows along it than along"
                f" a thin one, as if psi were smaller by about tanh(x)/x = {factor:.3g},"
                f" {factor * facts.values['psi']:.3g} instead of {facts.values['psi']:.3g}.",
            )  # fmt: skip


def mesh_load(facts: Facts) -> Iterator[Violation]:
    """Compare what presses the teeth together at rest with what the transmission error pulls at them."""
    unit = facts.inputs["K_p"] * facts.inputs["c"] if {"K_p", "c"} <= facts.inputs.keys() else None
    force = facts.values["Lambda"] * abs(facts.values["E"])
    limit = force if unit is None else force * unit
    name = "K_p c" if unit is None else "N"
    written = f"{limit:.3g} {name}"
    if facts.switches.get("mesh") == "line":
        load = _tooth_load_at_rest(facts) * (1.0 if unit is None else unit)
        if load <= limit:
            beside = "" if facts.switches["torsion"] == "rigid_rotors" else (
                " Without torsion the rotors turn uniformly, so that a film that gives way unloads the teeth; torsion ="
                " rigid_rotors lets them follow."
            )  # fmt: skip
            yield Violation(
                "mesh_load", load, limit,
                f"The teeth carry {load:.3g} {name} at rest, and the transmission error alone pulls at them with {written}"
                f" with both gears held: they part.{beside}",
            )  # fmt: skip
        return
    yield Violation(
        "mesh_load", 0.0, limit,
        "The isotropic mesh transmits no torque, so no load holds the teeth together, and its spring pulls as well"
        " as pushes: real teeth stay in contact only under a load above the dynamic mesh force, which is"
        f" {written} from the transmission error alone with both gears held.",
    )  # fmt: skip


def _tooth_load_at_rest(facts: Facts) -> float:
    """Static force along the line of action over K_p c; the transmitted one where no equilibrium is found."""
    values, q = facts.values, facts.rest
    if q is None:
        return values["F_0"]
    away = cos(values["phi_m"]) * (q["xp"] - q["xg"]) + sin(values["phi_m"]) * (q["yp"] - q["yg"])
    away += q.get("qp", 0.0) - q.get("qg", 0.0)
    return float(values["F_0"] + values["Lambda"] * away)


def fixed_arc(facts: Facts) -> Iterator[Violation]:
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
            yield Violation(
                f"fixed_arc_{i}", value, 1.0,
                f"The half film of journal {i} is fixed to its spin, but the forcing whirls it forward at up to"
                f" {value:.3g} times half that spin: there the pressure on that half is negative, which oil does"
                f" not sustain{outwards}. The arc of positive pressure has no such limit.",
            )  # fmt: skip


def clocks(facts: Facts) -> Iterator[Violation]:
    """Mesh, shafts and journals of one machine have speeds that follow from each other."""
    v = facts.values
    for i, gear, rate, teeth in ((1, "pinion", "r_p", "z_p"), (2, "gear", "r_g", "z_g")):
        if v[rate] == 0.0:
            continue
        value = abs(v["r_m"] / v[rate])
        given = facts.inputs.get(teeth)
        if given is not None and given < FEWEST_TEETH:
            yield Violation(
                f"few_teeth_{i}", given, float(FEWEST_TEETH),
                f"Gears with fewer than {FEWEST_TEETH} teeth or so are undercut, and lose the contact ratio that keeps one"
                f" pair or two in mesh; the {gear} has {given:g}.",
            )  # fmt: skip
        limit = FEWEST_TEETH if given is None else given
        if value < limit if given is None else abs(value - limit) > 1e-9 * limit:
            beside = f"but it has {given:g}" if given is not None else f"and gears have at least {limit} or so"
            yield Violation(
                f"teeth_{i}", value, float(limit),
                f"The clock gives the {gear} {value:.4g} teeth (mesh frequency over shaft speed, {v['r_m']:g}"
                f" over {abs(v[rate]):g}), {beside}: its unbalance and the mesh belong to different machines.",
            )  # fmt: skip
    for i, rate, spin in ((1, "r_p", "j_p"), (2, "r_g", "j_g")):
        if v[rate] == 0.0 or v[spin] == 0.0:
            continue
        value = v[spin] / v[rate]
        if abs(value - 1.0) > 1e-9:
            yield Violation(
                f"spin_{i}", value, 1.0,
                f"Journal {i} spins in its film at {value:.4g} times the speed of its own shaft's unbalance.",
            )  # fmt: skip
    if v["r_p"] * v["r_g"] > 0.0:
        yield Violation(
            "gear_sense", v["r_g"] / v["r_p"], 0.0,
            "The gear turns the same way as the pinion; two external gears turn against each other.",
        )  # fmt: skip


def standing_films(facts: Facts) -> Iterator[Violation]:
    """Dampers that do not rotate, and have nothing else to carry the weight."""
    still = [name for name in ("j_p", "j_g") if facts.values[name] == 0.0]
    if still and facts.switches.get("arc") == "positive" and facts.switches.get("centring") != "spring":
        yield Violation(
            "standing_film", 0.0, 0.0,
            f"{' and '.join(still)} = 0: a damper that does not rotate carries no weight; without a centring"
            " spring (centring = spring) gravity drives the journal to the wall.",
        )  # fmt: skip
