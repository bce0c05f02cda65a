"""The teeth of a gear pair: one spring and damper, isotropic or along the line of action.

isotropic
    The paper's mesh (20), (21): the same spring in x and y, without load, direction or play.
line
    The force W acts along the line of action alone. Its direction ``phi_m`` is the one in which the pinion pushes the
    gear: along the motion of the driving tooth, tilted by the pressure angle away from the pinion. The transmitted
    torque T_p is a preload F_0 = T_p/R_bp, carried at a tooth deflection F_0/Lambda.

Along the line of action the stiffness may vary with the mesh phase, and the teeth may have play (Kahraman and Singh
1990). The damper acts in the gap too, as in that source: the force then has kinks but never jumps, so tangent dynamics
need no saltation. Lengths are over the clearance c, forces over m_p c (clock speed)^2.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from sympy import Expr, Integer

from whirlmap.equations import Parameter, cos, pi, sin, when

F_0 = Parameter("F_0", "1", "transmitted mesh load T_p/(R_bp K_p c)", measure="force", at_least=0)
phi_m = Parameter("phi_m", "rad", "direction in which the pinion pushes the gear, from x", latex=r"\phi_m")

# stiffness = fourier: K_m (1 + sum of v_n cos(n phi + chi_n)), phi the mesh phase
v_1 = Parameter("v_1", "1", "1st harmonic of the mesh stiffness over its mean")
v_2 = Parameter("v_2", "1", "2nd harmonic of the mesh stiffness over its mean")
v_3 = Parameter("v_3", "1", "3rd harmonic of the mesh stiffness over its mean")
chi_1 = Parameter("chi_1", "rad", "phase of the 1st harmonic of the mesh stiffness", latex=r"\chi_1")
chi_2 = Parameter("chi_2", "rad", "phase of the 2nd harmonic of the mesh stiffness", latex=r"\chi_2")
chi_3 = Parameter("chi_3", "rad", "phase of the 3rd harmonic of the mesh stiffness", latex=r"\chi_3")

# stiffness = rectangular: one pair of teeth carries, or two
CR = Parameter("CR", "1", "contact ratio of spur teeth", above=1, below=2)
v_m = Parameter("v_m", "1", "step between one pair and two, over the mean mesh stiffness", at_least=0)
chi_m = Parameter("chi_m", "rad", "mesh phase at which two pairs are half through", latex=r"\chi_m")

B_m = Parameter("B_m", "1", "backlash along the line of action, over c", measure="length", above=0)

#: Terms of the rectangle's Fourier series.
TERMS = 6


@dataclass(frozen=True)
class Mesh:
    """What a choice of mesh reads, and how its force acts.

    Attributes
    ----------
    parameters : tuple of Parameter
    defaults : mapping of Parameter to Expr
    """

    parameters: tuple[Parameter, ...]
    defaults: Mapping[Parameter, Expr | int]


def reads(stiffness: str, backlash: str) -> Mesh:
    """Parameters of a mesh along the line of action."""
    varying: tuple[Parameter, ...] = ()
    defaults: dict[Parameter, Expr | int] = {}
    if stiffness == "fourier":
        varying = (v_1, v_2, v_3, chi_1, chi_2, chi_3)
        defaults = dict.fromkeys((v_2, v_3, chi_1, chi_2, chi_3), 0)
    elif stiffness == "rectangular":
        varying, defaults = (CR, v_m, chi_m), {v_m: 1 / CR, chi_m: 0}
    return Mesh((F_0, phi_m, *varying, *((B_m,) if backlash == "dead_zone" else ())), defaults)


def stiffness_over_mean(stiffness: str, phase: Expr) -> Expr:
    """Mesh stiffness over its mean, a trigonometric polynomial of the mesh phase.

    Multiples of the phase are written in its own cosine and sine, so that T stays the mesh period.
    """
    if stiffness == "fourier":
        waves = multiples(phase, 3)
        parts = ((v_1, chi_1), (v_2, chi_2), (v_3, chi_3))
        return 1 + sum(v * (c * cos(chi) - s * sin(chi)) for (c, s), (v, chi) in zip(waves, parts, strict=True))
    if stiffness == "rectangular":
        # Two pairs carry for the part CR - 1 of the mesh period. Lanczos factors take away the overshoot of the cut
        # series (9 % for ever, with them below 2 %); the force stays smooth in time, so that steps keep their order.
        series = [
            sin(pi * n / (TERMS + 1)) * (TERMS + 1) / (pi * n) * 2 / (pi * n) * sin(pi * n * (CR - 1))
            for n in range(1, TERMS + 1)
        ]
        waves = multiples(phase - chi_m, TERMS)
        return 1 + v_m * sum(a * c for a, (c, _) in zip(series, waves, strict=True))
    return Integer(1)


def multiples(phase: Expr, count: int) -> list[tuple[Expr, Expr]]:
    """Cosine and sine of 1, 2, ... times a phase, as polynomials of its own cosine and sine."""
    c, s = cos(phase), sin(phase)
    made = [(c, s)]
    while len(made) < count:
        cn, sn = made[-1]
        made.append((cn * c - sn * s, sn * c + cn * s))
    return made


def engaged(delta: Expr, backlash: str) -> Expr:
    """Deflection that loads the teeth: all of it, or what lies outside of the dead zone -B_m < delta < 0."""
    if backlash == "none":
        return delta
    return when(delta > 0, delta) + when(delta < -B_m, delta + B_m)


def faults(stiffness: str, backlash: str) -> tuple:
    """Checks of a whole set of values."""

    def carries(values: Mapping[str, float]) -> str:
        if values["Lambda"] == 0.0:
            return "Lambda = 0 with mesh = line: the transmitted load needs a mesh stiffness above 0 to be carried"
        return ""

    def loaded(values: Mapping[str, float]) -> str:
        if values["F_0"] == 0.0:
            return (
                "F_0 = 0 with backlash = dead_zone: without a transmitted torque nothing holds the teeth on one side;"
                " give T_p or F_0 above 0"
            )
        return ""

    def positive(values: Mapping[str, float]) -> str:
        varied = abs(values["v_1"]) + abs(values["v_2"]) + abs(values["v_3"])
        if varied >= 1.0:
            return f"|v_1| + |v_2| + |v_3| = {varied:g}: the mesh stiffness must stay above 0, expected a sum below 1"
        return ""

    def positive_step(values: Mapping[str, float]) -> str:
        lost = values["v_m"] * (values["CR"] - 1)
        if lost >= 1.0:
            return f"v_m (CR - 1) = {lost:g}: the stiffness of one pair must stay above 0, expected less than 1"
        return ""

    return (
        carries,
        *((loaded,) if backlash == "dead_zone" else ()),
        *((positive,) if stiffness == "fourier" else ()),
        *((positive_step,) if stiffness == "rectangular" else ()),
    )
