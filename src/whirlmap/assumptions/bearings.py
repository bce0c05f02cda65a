"""Assumptions of the film laws: a short bearing, laminar flow without inertia, a journal away from the wall."""

from collections.abc import Iterator
from math import sqrt

from whirlmap.assumptions.violation import BearingNumbers, Facts, Violation

OIL_DENSITY = 870.0  # kg/m^3; assumed where a case does not give it
SHORT = 0.25  # length over diameter
USUAL = (0.0005, 0.003)  # clearance over radius of journal bearings
DEEP = 0.9  # eccentricity
TAYLOR = 41.2  # vortices between turning cylinders from Re = 41.2 sqrt(R/c)
FILM_INERTIA = 1.0  # rho omega c^2/mu


def slenderness(facts: Facts) -> Iterator[Violation]:
    """Length over diameter."""
    for bearing in facts.bearings:
        value = bearing.L / (2 * bearing.R)
        if value > SHORT * (1 + 1e-12):
            yield Violation(
                f"slenderness{bearing.name}", value, SHORT,
                f"{bearing.words} has a length of {value:.3g} diameters: the film is that of a short bearing, good"
                f" below {SHORT}, and carries too much in a longer one.",
            )  # fmt: skip


def clearance(facts: Facts) -> Iterator[Violation]:
    """Clearance over radius, which is far off where a unit or a diameter was mistaken."""
    low, high = USUAL
    for bearing in facts.bearings:
        value = bearing.c / bearing.R
        if not low * (1 - 1e-12) <= value <= high * (1 + 1e-12):
            yield Violation(
                f"clearance{bearing.name}", value, low if value < low else high,
                f"{bearing.words} has a radial clearance of {value:.3g} radii ({bearing.c * 1e6:.4g} um); usual are {low:g}"
                f" to {high:g}. Check that c is the radial clearance, and R the radius.",
            )  # fmt: skip


def at_rest(facts: Facts) -> Iterator[Violation]:
    """Eccentricities of the static equilibrium, where there is one."""
    found = facts.eccentricities()
    for journal in facts.journals:
        value = found.get(journal.output, 0.0)
        if value > DEEP:
            yield Violation(
                f"rest_eccentricity{journal.name}", value, DEEP,
                f"{journal.words} rests at an eccentricity of {value:.3g}: above {DEEP} roughness, misalignment, elastic"
                " bearings and warm oil, which the model leaves out, decide.",
            )  # fmt: skip


def flow(facts: Facts) -> Iterator[Violation]:
    """Laminar flow without inertia, with the case's density or an assumed one."""
    clock = facts.clock
    if clock is None or not facts.bearings:
        return
    for bearing in facts.bearings:
        density, said = _density(bearing)
        value = density * abs(bearing.spin) * clock * bearing.R * bearing.c / bearing.mu
        limit = TAYLOR * sqrt(bearing.R / bearing.c)
        if value > limit:
            number = bearing.name[1:]
            yield Violation(
                f"film_reynolds{bearing.name}", value, limit,
                f"{f'Film {number}' if number else 'The film'} has a Reynolds number of {value:.3g} {said} at"
                f" {facts.at}: from {limit:.3g} on the flow has vortices, and the film resists more than the model's"
                " laminar one.",
            )  # fmt: skip
    fastest = facts.fastest * clock
    value, (_, said) = max((_density(b)[0] * fastest * b.c**2 / b.mu, _density(b)) for b in facts.bearings)
    if value > FILM_INERTIA:
        yield Violation(
            "film_inertia", value, FILM_INERTIA,
            f"rho omega c^2/mu is {value:.3g} {said} at the fastest harmonic, {fastest:.4g} rad/s at"
            f" {facts.at}: above about {FILM_INERTIA:g} the oil's inertia, which the film law leaves out,"
            " is felt in the motion at that frequency.",
        )  # fmt: skip


def _density(bearing: BearingNumbers) -> tuple[float, str]:
    """Density of a bearing's oil, and in words."""
    density = OIL_DENSITY if bearing.rho is None else bearing.rho
    return density, f"(oil of {density:g} kg/m3{' assumed' if bearing.rho is None else ''})"
