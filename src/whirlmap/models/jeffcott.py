"""A Jeffcott rotor on two plain short journal bearings, or squeeze-film dampers; rigid or on a flexible shaft.

The clock is the shaft, lengths are in units of the clearance, s = omega sqrt(c/g), and each bearing carries half of the
weight. Gamma s = A omega/W is the film group, with A = mu R L^3/(2 c^2) and W the load of one bearing.

rigid
    The rotor moves with its journals, which carry its mass: the oil-whip problem of the textbooks. Fixed half film.
flexible
    Massless journals, as in the gear pair; k = K c/W is the shaft's stiffness at each bearing.

With ``bearing = damper`` the journals are the outer rings of rolling bearings: they do not turn, so that the film carries
nothing at rest, and a squirrel cage of stiffness k_c = K_c c/W each stands beside it. The film has the arc of positive
pressure.
"""

from sympy import Expr

from whirlmap.equations import Family, Film, Journal, Model, Output, Parameter, Stop, cos, sin, sqrt, states, t
from whirlmap.errors import ModelError
from whirlmap.films.law import film_law, plain_fixed_force
from whirlmap.models.absent import NOT_IN_ROTOR_MODELS

ux, uy = states("ux uy", "1", "journal centre relative to the bearing, over c", "length")
vx, vy = states("vx vy", "1", "rotor velocity, over c and clock radian", "velocity")
x, y = states("x y", "1", "rotor centre, over c", "length")

s = Parameter("s", "1", "speed ratio omega sqrt(c/g)", measure="rotation", above=0)
Gamma = Parameter("Gamma", "1", "film group A sqrt(g/c)/W, at s = 1", latex=r"\Gamma", above=0)
b = Parameter("b", "1", "unbalance eccentricity over c", measure="length", at_least=0)
k = Parameter("k", "1", "shaft stiffness K c/W", above=0)
k_c = Parameter("k_c", "1", "squirrel cage of one damper, K_c c/W", above=0)
xi = Parameter("xi", "1", "damping of the rotor, C/(2 M) sqrt(c/g)", latex=r"\xi", at_least=0)

FILM = Film((ux, uy), psi=0, spin=1, strength=Gamma * s)  # of one bearing; both are alike

#: A velocity per clock radian falls as the clock gains speed; the unbalance lags with its angular acceleration.
ACCELERATED = {vx: -vx + b * sin(t), vy: -vy - b * cos(t)}


def outputs(F_x: Expr, F_y: Expr) -> dict[str, Output]:
    """What is recorded beside the states; F is the force of one film over W."""
    return {
        "eps": Output(sqrt(ux**2 + uy**2), "1", "eccentricity of the journal", role="eccentricity", bearing="all"),
        "load": Output(sqrt(F_x**2 + F_y**2), "1", "force of the film of one bearing, over W", "force", "load", "all"),
    }


def rigid() -> Model:
    """Declare the rigid rotor: the film force acts on the rotor's own mass."""
    F_x, F_y = plain_fixed_force(ux, uy, vx + uy / 2, vy - ux / 2)  # velocity seen from half the spin
    return Model(
        name="jeffcott",
        states=(ux, uy, vx, vy),
        parameters=(s, Gamma, b),
        equations={
            ux: vx,
            uy: vy,
            vx: Gamma / s * F_x + b * cos(t),
            vy: Gamma / s * F_y + b * sin(t) - 1 / s**2,
        },
        harmonics=(1,),
        outputs=outputs(Gamma * s * F_x, Gamma * s * F_y),
        stops={"contact": Stop(1 - ux**2 - uy**2, "the journal touches its bearing", reachable=0 * s)},
        films={"1": FILM},
        start="equilibrium",
        start_where_none={ux: 0.1},
        switches={"rotor": "rigid", "arc": "fixed", "bearing": "journal"},
        clocks={"shaft": 1},
        swing=(uy,),
        bodies={"rotor": (ux, uy)},
        speed=s,
        angular_acceleration=ACCELERATED,
        journals={"1": Journal((ux, uy), 1)},
        unbalances={"rotor": b},
        sources=("capone1991", "childs1993"),
    )


def flexible(arc: str, bearing: str) -> Model:
    """Declare the rotor on a flexible shaft with massless journals."""
    law = film_law("porous", arc, plain=True)
    d_x, d_y = x - ux, y - uy
    damper = bearing == "damper"
    cage, spin = (k_c, 0) if damper else (0, 1)
    load_x, load_y = k * d_x - cage * ux, k * d_y - cage * uy
    w_x, w_y = law.velocity(ux, uy, load_x / (2 * Gamma * s), load_y / (2 * Gamma * s), 0, spin)
    return Model(
        name="jeffcott",
        states=(ux, uy, x, y, vx, vy),
        parameters=(s, Gamma, b, k, xi, *((k_c,) if damper else ())),
        equations={
            ux: -spin * uy / 2 + w_x,
            uy: +spin * ux / 2 + w_y,
            x: vx,
            y: vy,
            vx: -2 * xi / s * vx - k * d_x / s**2 + b * cos(t),
            vy: -2 * xi / s * vy - k * d_y / s**2 + b * sin(t) - 1 / s**2,
        },
        harmonics=(1,),
        outputs=outputs(load_x, load_y),
        stops={"contact": Stop(1 - ux**2 - uy**2, "the journal touches its bearing", reachable=0 * s)},
        films={} if damper else {"1": FILM},
        # A film that carries nothing at rest has no derivative there, so that no Newton step finds the sag in the cage.
        start="states" if damper else "equilibrium",
        equilibrium={uy: -1 / k_c, y: -1 / k_c - 1 / k} if damper else {},
        start_where_none={} if damper else {ux: 0.1},
        tables=law.tables,
        switches={"rotor": "flexible", "arc": arc, "bearing": bearing},
        clocks={"shaft": 1},
        swing=(y, uy),
        bodies={"rotor": (x, y), "journals": (ux, uy)},
        speed=s,
        angular_acceleration=ACCELERATED,
        journals={"1": Journal((ux, uy), spin)},
        unbalances={"rotor": b},
        sources=("capone1991", "childs1993"),
    )


def declare(*, rotor: str, arc: str, bearing: str) -> Model:
    """Declare the rotor for one choice of its switches."""
    if bearing == "damper" and (rotor, arc) != ("flexible", "positive"):
        raise ModelError(
            "bearing = damper needs rotor = flexible and arc = positive: the half film 0..pi follows the spin of a journal,"
            " and a damper has none"
        )
    if rotor == "flexible":
        return flexible(arc, bearing)
    if arc != "fixed":
        raise ModelError("rotor = rigid has arc = fixed only; use rotor = flexible for the arc of positive pressure")
    return rigid()


JEFFCOTT = Family(
    name="jeffcott",
    absent=NOT_IN_ROTOR_MODELS,
    declare=declare,
    switches={"rotor": ("rigid", "flexible"), "arc": ("fixed", "positive"), "bearing": ("journal", "damper")},
    meanings={
        "rotor": "rigid, its mass on the journals; or on a flexible shaft with massless journals",
        "arc": "half-Sommerfeld film, fixed at 0..pi, or Guembel film, where the pressure is positive",
        "bearing": "journals that turn in their film, or dampers that do not, with a squirrel cage",
    },
    default=lambda chosen: {"rotor": "flexible", "arc": "positive"} if chosen["bearing"] == "damper" else {},
)
