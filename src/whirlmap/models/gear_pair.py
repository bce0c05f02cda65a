"""The paper's system: a gear pair on journal bearings with porous film and nonlinear suspension, equations (30)-(41).

Read it with the paper and `studies/gear_psfd/audit.md` at hand: numbers in the comments are the paper's equations, and
every difference between the editions stands in the line that it changes.

Editions
--------
literal
    Equations (30)-(41) as printed; only meaningless subscripts are corrected (y_2 -> y_p in (30), C_om -> C_1p in (39),
    the film integrals of bearing 2 in (32) and (33)). One film group, one shaft stiffness, for both journals.
intended
    Signs, film and mass ratios as derived; the paper's clock (the mesh) and its forcing orders.
physical
    The intended equations with each shaft on its own clock and external gears turning against each other.

The intended and the physical edition are the same equations: their cases differ in the clock ratios r and j, and in the
default arc. Journals are kept in Cartesian coordinates: the paper's polar form divides by the eccentricity.

Beyond the paper, off unless asked for and not in the literal edition: a mesh along the line of action with torque, varying
stiffness and backlash (`mesh.py`), torsion (`torsion.py`), a journal that rubs (`rub.py`), centring springs, a linear
suspension.
"""

from collections.abc import Mapping

from sympy import Expr

from whirlmap.equations import Family, Model, Parameter, cos, sign, sin, sqrt, states, t
from whirlmap.equations.parts import Film, Journal, Output, Stop, Switching
from whirlmap.errors import ModelError
from whirlmap.films.law import FilmLaw, film_law, permeability_fault
from whirlmap.models import mesh, rub, torsion
from whirlmap.models.absent import NOT_IN_ROTOR_MODELS

LENGTH = "1"  # lengths are in units of the clearance c
u1x, u1y = states("u1x u1y", LENGTH, "journal 1 relative to its bearing, over c", "length")
u2x, u2y = states("u2x u2y", LENGTH, "journal 2 relative to its bearing, over c", "length")
xp, yp = states("xp yp", LENGTH, "pinion centre, over c", "length")
xg, yg = states("xg yg", LENGTH, "gear centre, over c", "length")
x1, y1 = states("x1 y1", LENGTH, "centre of bearing 1, over c", "length")
x2, y2 = states("x2 y2", LENGTH, "centre of bearing 2, over c", "length")
vxp, vyp = states("vxp vyp", "1", "pinion velocity, over c and clock radian", "velocity")
vxg, vyg = states("vxg vyg", "1", "gear velocity, over c and clock radian", "velocity")
vx1, vy1 = states("vx1 vy1", "1", "velocity of bearing 1, over c and clock radian", "velocity")
vx2, vy2 = states("vx2 vy2", "1", "velocity of bearing 2, over c and clock radian", "velocity")

s = Parameter("s", "1", "speed ratio: clock speed over sqrt(K_p/m_p)", measure="rotation", above=0)
psi = Parameter("psi", "1", "permeability 12 Phi H/c^3", latex=r"\psi", at_least=0)
f = Parameter("f", "1", "weight m_p g/(K_p c)", at_least=0)
Lambda = Parameter("Lambda", "1", "mesh stiffness K_m/K_p", latex=r"\Lambda", at_least=0)
xi_p = Parameter("xi_p", "1", "pinion damping, xi_2 of the paper", latex=r"\xi_p", at_least=0)
xi_g = Parameter("xi_g", "1", "gear damping, xi_4 of the paper", latex=r"\xi_g", at_least=0)
xi_m = Parameter("xi_m", "1", "mesh damping on the pinion, xi_3 of the paper", latex=r"\xi_m", at_least=0)
xi_5 = Parameter("xi_5", "1", "mesh damping on the gear, free in the print", latex=r"\xi_5", at_least=0)
xi_1 = Parameter("xi_1", "1", "damping of suspension 1", latex=r"\xi_1", at_least=0)
xi_2 = Parameter("xi_2", "1", "damping of suspension 2, xi_6 of the paper", latex=r"\xi_2", at_least=0)
nu_g = Parameter("nu_g", "1", "mass of the gear over the pinion's", latex=r"\nu_g", above=0)
kappa_g = Parameter("kappa_g", "1", "shaft stiffness K_g/K_p", latex=r"\kappa_g", above=0)
nu_1 = Parameter("nu_1", "1", "mass of housing 1 over the pinion's, C_1p of the paper", latex=r"\nu_1", above=0)
nu_2 = Parameter("nu_2", "1", "mass of housing 2 over the pinion's, C_2p of the paper", latex=r"\nu_2", above=0)
S_1 = Parameter("S_1", "1", "s_1/s: housing 1 against the shaft, swept with s", above=0)
S_2 = Parameter("S_2", "1", "s_2/s: housing 2 against the shaft, swept with s", above=0)
a_1 = Parameter("a_1", "1", "cubic stiffness of suspension 1, alpha_1 of (38)", at_least=0)
a_2 = Parameter("a_2", "1", "cubic stiffness of suspension 2, alpha_2 of (40)", at_least=0)
b_p = Parameter("b_p", "1", "unbalance eccentricity of the pinion over c", measure="length", at_least=0)
b_g = Parameter("b_g", "1", "unbalance eccentricity of the gear over c", measure="length", at_least=0)
E = Parameter("E", "1", "static transmission error over c, E_p of the paper", measure="length")
Gamma_1 = Parameter("Gamma_1", "1", "film group of bearing 1 at s = 1, swept with s", latex=r"\Gamma_1", above=0)
Gamma_2 = Parameter("Gamma_2", "1", "film group of bearing 2 at s = 1, swept with s", latex=r"\Gamma_2", above=0)
r_p = Parameter("r_p", "1", "pinion speed over clock speed", order=True)
r_g = Parameter("r_g", "1", "gear speed over clock speed, negative where it turns against the pinion", order=True)
r_m = Parameter("r_m", "1", "mesh frequency over clock speed", order=True)
j_p = Parameter("j_p", "1", "spin of journal 1 in its film over clock speed")
j_g = Parameter("j_g", "1", "spin of journal 2 in its film over clock speed")
chi_p = Parameter("chi_p", "rad", "phase of the pinion's unbalance", latex=r"\chi_p")
chi_g = Parameter("chi_g", "rad", "phase of the gear's unbalance", latex=r"\chi_g")

kappa_c1 = Parameter("kappa_c1", "1", "centring spring of each bearing 1, k_c1/K_p", at_least=0)
kappa_c2 = Parameter("kappa_c2", "1", "centring spring of each bearing 2, k_c2/K_p", at_least=0)

STATES = (u1x, u1y, u2x, u2y, xp, yp, xg, yg, x1, y1, x2, y2, vxp, vyp, vxg, vyg, vx1, vy1, vx2, vy2)
BEFORE_CUBIC = (s, psi, f, Lambda, xi_p, xi_g, xi_m, xi_1, xi_2, nu_g, nu_1, nu_2, S_1, S_2)
SHARED = (*BEFORE_CUBIC, a_1, a_2, b_p, b_g, E)
CLOCKS = (r_p, r_g, r_m, j_p, j_g)

# Shaft deflections over c: rotor centre less journal centre, which is housing plus u.
d1x, d1y = xp - x1 - u1x, yp - y1 - u1y
d2x, d2y = xg - x2 - u2x, yg - y2 - u2y

def housing(i: int, suspension: str = "cubic") -> tuple[Expr, Expr]:
    """Housing on a linear and a cubic spring: (38)-(41) but for the shaft's force, a half of it on each of two."""
    S, xi, a = ((S_1, xi_1, a_1), (S_2, xi_2, a_2))[i - 1]
    x, y, vx, vy = ((x1, y1, vx1, vy1), (x2, y2, vx2, vy2))[i - 1]
    cubic = 0 if suspension == "linear" else a / s**2
    return (
        -2 * xi / (S * s) * vx - x / (S * s) ** 2 - cubic * x**3,  # (38), (40)
        -2 * xi / (S * s) * vy - y / (S * s) ** 2 - cubic * y**3 - f / s**2,  # (39), (41)
    )


#: What switches add to the paper's system, and what each is where it is off.
BEYOND = {
    "mesh": "isotropic", "stiffness": "constant", "backlash": "none", "torsion": "none", "suspension": "cubic",
    "centring": "none", "contact": "stop",
}  # fmt: skip

BODIES = {
    "pinion": (xp, yp), "gear": (xg, yg), "pinion housings": (x1, y1), "gear housings": (x2, y2),
    "pinion journals": (u1x, u1y), "gear journals": (u2x, u2y),
}  # fmt: skip

VELOCITIES = {xp: vxp, yp: vyp, xg: vxg, yg: vyg, x1: vx1, y1: vy1, x2: vx2, y2: vy2}


#: A velocity per clock radian falls as the clock gains speed; unbalances lag with their angular acceleration.
ACCELERATED = {
    **{v: -v for v in VELOCITIES.values()},
    vxp: -vxp + b_p * r_p * sin(r_p * t + chi_p),
    vyp: -vyp - b_p * r_p * cos(r_p * t + chi_p),
    vxg: -vxg + b_g * r_g * sin(r_g * t + chi_g),
    vyg: -vyg - b_g * r_g * cos(r_g * t + chi_g),
}


def journal_load(i: int, ux: Expr, uy: Expr, d_x: Expr, d_y: Expr, switches: Mapping[str, str]) -> tuple[Expr, Expr]:
    """Force on the two journals of a shaft beside their films', over K_p c: shaft, centring springs, rubbing walls.

    Springs and walls stand in the housing, so that what reaches it through film, spring and wall is the shaft's force.
    """
    kappa_c, spin = ((kappa_c1, j_p), (kappa_c2, j_g))[i - 1]
    if switches["centring"] == "spring":
        d_x, d_y = d_x - 2 * kappa_c * ux, d_y - 2 * kappa_c * uy
    if switches["contact"] == "rub":
        n_x, n_y = rub.wall_force(ux, uy, sign(spin))
        d_x, d_y = d_x + 2 * n_x, d_y + 2 * n_y
    return d_x, d_y


def tooth_deflection(switches: Mapping[str, str]) -> tuple[Expr, Expr]:
    """Deflection of the teeth along the line of action over c, positive when pressed, and its rate."""
    n_x, n_y = cos(mesh.phi_m), sin(mesh.phi_m)
    delta = mesh.F_0 / Lambda + n_x * (xp - xg) + n_y * (yp - yg) - E * cos(r_m * t)
    rate = n_x * (vxp - vxg) + n_y * (vyp - vyg) + r_m * E * sin(r_m * t)
    if switches["torsion"] == "rigid_rotors":
        delta, rate = delta + torsion.qp - torsion.qg, rate + torsion.vqp - torsion.vqg
    return delta, rate


def tooth_force(switches: Mapping[str, str]) -> Expr:
    """Force W along the line of action, per m_p c (clock speed)^2."""
    delta, rate = tooth_deflection(switches)
    k = mesh.stiffness_over_mean(switches["stiffness"], r_m * t)
    return 2 * xi_m / s * rate + Lambda / s**2 * k * mesh.engaged(delta, switches["backlash"])


def film_load(i: int, switches: Mapping[str, str]) -> Expr:
    """Size of the force of the film of one bearing i on its journal, over K_p c: each shaft has two."""
    if switches["edition"] == "literal":
        l_x, l_y = ((d1x, d1y), (d2x, d2y))[i - 1]  # K_p at both journals, as printed
    elif i == 1:
        l_x, l_y = journal_load(1, u1x, u1y, d1x, d1y, switches)
    else:
        l_x, l_y = journal_load(2, u2x, u2y, kappa_g * d2x, kappa_g * d2y, switches)
    return sqrt(l_x**2 + l_y**2) / 2


def mesh_force(switches: Mapping[str, str]) -> tuple[Expr, Expr]:
    """Force of the mesh on the gear, per m_p c (clock speed)^2; the printed (34) and (36) have -E sin."""
    if switches["mesh"] == "line":
        W = tooth_force(switches)
        return W * cos(mesh.phi_m), W * sin(mesh.phi_m)
    return (
        2 * xi_m / s * (vxp - vxg + r_m * E * sin(r_m * t)) + Lambda / s**2 * (xp - xg - E * cos(r_m * t)),
        2 * xi_m / s * (vyp - vyg - r_m * E * cos(r_m * t)) + Lambda / s**2 * (yp - yg - E * sin(r_m * t)),
    )


def derived(law: FilmLaw, switches: Mapping[str, str] = BEYOND) -> dict:
    """Equations (30)-(41) as derived, with the switched physics: editions intended and physical."""
    l1x, l1y = journal_load(1, u1x, u1y, d1x, d1y, switches)
    l2x, l2y = journal_load(2, u2x, u2y, kappa_g * d2x, kappa_g * d2y, switches)
    # Force balance of a massless journal, -2 Gamma M w + load = 0, w its velocity seen from half its spin.
    w1x, w1y = law.velocity(u1x, u1y, l1x / (2 * Gamma_1 * s), l1y / (2 * Gamma_1 * s), psi, sign(j_p))
    w2x, w2y = law.velocity(u2x, u2y, l2x / (2 * Gamma_2 * s), l2y / (2 * Gamma_2 * s), psi, sign(j_g))
    w_x, w_y = mesh_force(switches)
    unbalance_p, unbalance_g = b_p * r_p**2, b_g * r_g**2  # beta and beta_g of the paper
    k_g = kappa_g / (nu_g * s**2)
    housing_1x, housing_1y = housing(1, switches["suspension"])
    housing_2x, housing_2y = housing(2, switches["suspension"])
    turning = torsion.equations(tooth_force(switches), mesh.F_0, s) if switches["torsion"] == "rigid_rotors" else {}
    return {
        u1x: -j_p * u1y / 2 + w1x,  # (30), (31)
        u1y: +j_p * u1x / 2 + w1y,
        u2x: -j_g * u2y / 2 + w2x,  # (32), (33)
        u2y: +j_g * u2x / 2 + w2y,
        **VELOCITIES,
        vxp: -2 * xi_p / s * vxp - d1x / s**2 + unbalance_p * cos(r_p * t + chi_p) - w_x,  # (34)
        vyp: -2 * xi_p / s * vyp - d1y / s**2 + unbalance_p * sin(r_p * t + chi_p) - w_y - f / s**2,  # (35)
        vxg: -2 * xi_g / s * vxg - k_g * d2x + unbalance_g * cos(r_g * t + chi_g) + w_x / nu_g,  # (36)
        vyg: -2 * xi_g / s * vyg - k_g * d2y + unbalance_g * sin(r_g * t + chi_g) + w_y / nu_g - f / s**2,  # (37)
        vx1: housing_1x + d1x / (2 * nu_1 * s**2),  # (38)
        vy1: housing_1y + d1y / (2 * nu_1 * s**2),  # (39)
        vx2: housing_2x + kappa_g * d2x / (2 * nu_2 * s**2),  # (40)
        vy2: housing_2y + kappa_g * d2y / (2 * nu_2 * s**2),  # (41)
        **turning,
    }


def printed(law: FilmLaw) -> dict:
    """Equations (30)-(41) as printed: edition literal."""
    q1x, q1y = d1x / (2 * Gamma_1 * s), d1y / (2 * Gamma_1 * s)
    q2x, q2y = d2x / (2 * Gamma_1 * s), d2y / (2 * Gamma_1 * s)  # alpha_1 and K_p in (32), (33) too
    w1x, w1y = law.velocity(u1x, u1y, q1x, q1y, psi, 1)
    w2x, w2y = law.velocity(u2x, u2y, q2x, q2y, psi, 1)
    # The last term of (31) and the last two of (33) are wrong as printed; without h^3 (beta_1 = 0) they vanish.
    e1x, e1y = law.misprint_31(u1x, u1y, q1x, q1y, psi)
    e2x, e2y = law.misprint_33(u2x, u2y, q2x, q2y, psi)
    cos_m, sin_m = cos(r_m * t), sin(r_m * t)  # cos(phi), sin(phi)
    beta, beta_g = b_p * r_p**2, b_g * r_g**2
    housing_1x, housing_1y = housing(1)
    housing_2x, housing_2y = housing(2)
    return {
        u1x: -j_p * u1y / 2 + w1x + e1x,  # (30), (31); y_2 read as y_p
        u1y: +j_p * u1x / 2 + w1y + e1y,
        u2x: -j_g * u2y / 2 + w2x + e2x,  # (32), (33)
        u2y: +j_g * u2x / 2 + w2y + e2y,
        **VELOCITIES,
        vxp: -2 * xi_p / s * vxp - d1x / s**2 + beta * cos(r_p * t)
        - 2 * xi_m / s * (vxp - vxg - E * sin_m) - Lambda / s**2 * (xp - xg - E * cos_m),  # (34)
        vyp: -2 * xi_p / s * vyp - d1y / s**2 + beta * sin(r_p * t) - f / s**2
        - 2 * xi_m / s * (vyp - vyg - E * cos_m) - Lambda / s**2 * (yp - yg - E * sin_m),  # (35)
        vxg: -2 * xi_g / s * vxg - d2x / s**2 + beta_g * cos(r_g * t)
        + 2 * xi_5 / s * (vxp - vxg - E * sin_m) - Lambda / s**2 * (xp - xg - E * cos_m),  # (36)
        vyg: -2 * xi_g / s * vyg - d2y / s**2 + beta_g * sin(r_g * t)
        + 2 * xi_5 / s * (vyp - vyg - E * cos_m) + Lambda / s**2 * (yp - yg - E * sin_m) - f / s**2,  # (37)
        vx1: housing_1x + d1x / (2 * nu_1 * s**2),  # (38)
        vy1: housing_1y + d1y / (2 * nu_1 * s**2),  # (39); C_om read as C_1p
        vx2: housing_2x + d2x / (2 * nu_2 * s**2),  # (40)
        vy2: housing_2y + d2y / (2 * nu_2 * s**2),  # (41)
    }  # fmt: skip


def spin_suits_arc(values: Mapping[str, float]) -> str:
    """Refuse a half film fixed to the spin of a journal that does not spin."""
    still = [name for name in ("j_p", "j_g") if values.get(name, 1.0) == 0.0]
    if still:
        return (
            f"{' and '.join(still)} = 0 with arc = fixed: the fixed half film follows the journal's spin, so a"
            " non-rotating damper needs arc = positive"
        )
    return ""


def refuse_combination(switches: Mapping[str, str]) -> None:
    """Refuse switches that contradict each other."""
    on = [name for name, off in BEYOND.items() if switches[name] not in (off, "ignore")]  # the print has no wall either
    if switches["edition"] == "literal":
        if switches["arc"] == "positive":
            raise ModelError(
                "edition = literal has no arc = positive: equations (30)-(33) as printed are written for the half film"
                " fixed at 0..pi; use edition = intended"
            )
        if on:
            asked = ", ".join(f"{name} = {switches[name]}" for name in on)
            raise ModelError(
                f"edition = literal has no {asked}: it is equations (30)-(41) as printed and nothing else; use edition ="
                " intended or physical"
            )
    if switches["contact"] == "ignore" and switches["film"] != "printed":
        raise ModelError(
            "contact = ignore needs film = printed: only the film without h^3 goes on beyond an eccentricity of one;"
            " use contact = stop"
        )
    for name in ("stiffness", "backlash", "torsion"):
        if name in on and switches["mesh"] != "line":
            raise ModelError(
                f"{name} = {switches[name]} needs mesh = line: the isotropic mesh has no line of action to act along"
            )


def declare(*, plain: bool = False, **switches: str) -> Model:
    """Declare the gear pair for one choice of its switches.

    ``plain`` replaces the film's tables by the closed forms that hold at psi = 0.
    """
    refuse_combination(switches)
    film, arc = switches["film"], switches["arc"]
    law = film_law(film, arc, plain=plain)
    literal = switches["edition"] == "literal"
    line, turning = switches["mesh"] == "line", switches["torsion"] == "rigid_rotors"
    rubs, sprung = switches["contact"] == "rub", switches["centring"] == "spring"
    teeth = mesh.reads(switches["stiffness"], switches["backlash"]) if line else mesh.Mesh((), {})
    shared = SHARED if switches["suspension"] == "cubic" else (*BEFORE_CUBIC, b_p, b_g, E)
    wall = "the journal touches its bearing" if not rubs else "the journal is pressed through to its bearing"
    reachable = psi if film == "porous" else 1  # a plain film never lets the journal through; the printed one always
    return Model(
        name="gear_pair",
        states=(*STATES, *(torsion.STATES if turning else ())),
        parameters=(*shared, xi_5, Gamma_1, *CLOCKS)
        if literal
        else (
            *shared, kappa_g, Gamma_1, Gamma_2, *CLOCKS, chi_p, chi_g, *teeth.parameters,
            *(torsion.PARAMETERS if turning else ()),
            *(rub.PARAMETERS if rubs else ()),
            *((kappa_c1, kappa_c2) if sprung else ()),
        ),
        equations=printed(law) if literal else derived(law, switches),
        harmonics=(r_p, r_g, r_m),
        defaults={xi_5: xi_m / nu_g} if literal else {chi_p: 0, chi_g: 0, **teeth.defaults},
        outputs={
            "eps_1": Output(sqrt(u1x**2 + u1y**2), "1", "eccentricity of journal 1", role="eccentricity", bearing="1"),
            "eps_2": Output(sqrt(u2x**2 + u2y**2), "1", "eccentricity of journal 2", role="eccentricity", bearing="2"),
            **{
                f"load_{i}": Output(
                    film_load(i, switches), "1", f"force of the film of one bearing {i}, over K_p c", "force", "load", str(i)
                )
                for i in (1, 2)
            },
        },
        stops={
            "contact_1": Stop(1 - u1x**2 - u1y**2, f"journal 1: {wall}", reachable),
            "contact_2": Stop(1 - u2x**2 - u2y**2, f"journal 2: {wall}", reachable),
        }
        if switches["contact"] != "ignore"
        else {},
        switchings=switchings(switches),
        films={} if literal or film == "printed" else FILMS,  # a printed law is no short bearing's
        teeth=tooth_deflection(switches)[0] if line else None,
        start="equilibrium",
        start_where_none={u1x: 0.1, u2x: 0.1},
        bound=1e6,
        tables=law.tables,
        plain={psi: lambda: declare(**switches, plain=True)} if law.tables and arc == "fixed" else {},
        checks=(
            *((spin_suits_arc,) if arc == "fixed" and film == "porous" else ()),
            *((permeability_fault,) if film == "porous" else ()),
            *(mesh.faults(switches["stiffness"], switches["backlash"]) if line else ()),
            *((torsion.held,) if turning else ()),
            *((rub.slides,) if rubs else ()),
        ),
        switches=switches,
        clocks={"mesh": r_m, "pinion": r_p, "gear": r_g},
        swing=(yp, yg, y1, y2),
        bodies={**BODIES, **(torsion.BODIES if turning else {})},
        speed=s,
        angular_acceleration=None if literal or turning else ACCELERATED,
        journals=JOURNALS,
        unbalances={"pinion": b_p, "gear": b_g},
        assumptions="gear_pair",
        sources=(
            "changjian-psfd", "capone1991", "morgan1957",
            *(("kahraman1990",) if line else ()), *(("chu1998",) if rubs else ()),
        ),
    )  # fmt: skip


def switchings(switches: Mapping[str, str]) -> dict[str, Switching]:
    """Where the equations have kinks; none of them jumps."""
    found = {}
    if switches["backlash"] == "dead_zone":
        delta, _ = tooth_deflection(switches)
        found["drive_side"] = Switching(delta, "the driving flanks touch")
        found["back_side"] = Switching(-delta - mesh.B_m, "the back flanks touch")
    if switches["contact"] == "rub":
        for i, (ux, uy) in enumerate(((u1x, u1y), (u2x, u2y)), start=1):
            found[f"rub_{i}"] = Switching(sqrt(ux**2 + uy**2) - rub.eps_r, f"journal {i} rubs its bearing")
    return found


JOURNALS = {"1": Journal((u1x, u1y), j_p), "2": Journal((u2x, u2y), j_g)}
#: Films of one bearing each.
FILMS = {
    "1": Film((u1x, u1y), psi, j_p, Gamma_1 * s / 2),  # A = mu R L^3/(2 c^2) in each of the two bearings of a shaft
    "2": Film((u2x, u2y), psi, j_g, Gamma_2 * s / 2),
}

GEAR_PAIR = Family(
    name="gear_pair",
    absent=NOT_IN_ROTOR_MODELS,
    declare=declare,
    switches={
        "edition": ("intended", "literal", "physical"),
        "film": ("porous", "printed"),
        "arc": ("fixed", "positive"),
        "contact": ("stop", "rub", "ignore"),
        "mesh": ("isotropic", "line"),
        "stiffness": ("constant", "fourier", "rectangular"),
        "backlash": ("none", "dead_zone"),
        "torsion": ("none", "rigid_rotors"),
        "suspension": ("cubic", "linear"),
        "centring": ("none", "spring"),
    },
    meanings={
        "edition": "equations as printed, as derived, or as derived with each shaft on its own clock",
        "film": "with h^3 + 12 Phi H, or as printed with h^3 dropped",
        "arc": "half-Sommerfeld film, fixed at 0..pi, or Guembel film, where the pressure is positive",
        "contact": "whether a journal that reaches its bearing ends the run, rubs from its roughness on, or goes on",
        "mesh": "teeth without direction or load, or along the line of action with a transmitted torque",
        "stiffness": "mesh stiffness that is constant, a Fourier series, or that of one pair of teeth and two",
        "backlash": "teeth without play, or that leave each other inside a dead zone",
        "torsion": "rotors that turn uniformly, or that oscillate about uniform rotation",
        "suspension": "bearing supports with a linear and a cubic spring, or with the linear one alone",
        "centring": "journals without or with a centring spring (squirrel cage) beside the film",
    },
    vocabulary=(
        xi_5, kappa_g, Gamma_2, chi_p, chi_g, a_1, a_2, kappa_c1, kappa_c2, *torsion.PARAMETERS, *rub.PARAMETERS,
        *(p for k in ("fourier", "rectangular") for p in mesh.reads(k, "dead_zone").parameters),
    ),
    default=lambda chosen: {
        "arc": "positive" if chosen["edition"] == "physical" else "fixed",
        "film": "printed" if chosen["edition"] == "literal" else "porous",
    },
)
