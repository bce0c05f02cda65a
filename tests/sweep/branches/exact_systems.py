"""Systems whose orbits and bifurcation points are known in closed form."""

from sympy import Rational, pi, sqrt

from whirlmap.equations import Model, Parameter, State, cos, sin, t
from whirlmap.integrate.system import System

x, v = State("x", "1", "real part, or displacement"), State("v", "1", "its rate")
y, w = State("y", "1", "imaginary part, or displacement"), State("w", "1", "its rate")
Omega = Parameter("Omega", "1", "frequency of the forcing", above=0)


def forced_hopf(**values: float) -> System:
    """z' = (1 + i w0) z - |z|^2 z + g exp(i Omega t): orbits rho ((1 - rho)^2 + d^2) = g^2, d = Omega - w0, rho = |z|^2."""
    w0, g = Parameter("w0", "1", "own frequency"), Parameter("g", "1", "forcing")
    rho = x**2 + y**2
    model = Model(
        name="forced_hopf", states=(x, y), parameters=(w0, g, Omega), harmonics=(Omega,),
        equations={
            x: x - w0 * y - rho * x + g * cos(Omega * t),
            y: y + w0 * x - rho * y + g * sin(Omega * t),
        },
    )  # fmt: skip
    return System(model, {"w0": 2.0, "Omega": 2.1, **values})


def cubic_rotor(**values: float) -> System:
    """z'' + 2 zeta z' + (1 + gamma |z|^2) z = e Omega^2 exp(i Omega t), on a circle of constant radius."""
    zeta, gamma, e = (Parameter(name, "1", name) for name in ("zeta", "gamma", "e"))
    stiffness = 1 + gamma * (x**2 + y**2)
    model = Model(
        name="cubic_rotor", states=(x, y, v, w), parameters=(zeta, gamma, e, Omega), harmonics=(Omega,),
        equations={
            x: v, y: w,
            v: e * Omega**2 * cos(Omega * t) - 2 * zeta * v - stiffness * x,
            w: e * Omega**2 * sin(Omega * t) - 2 * zeta * w - stiffness * y,
        },
    )  # fmt: skip
    return System(model, {"zeta": 0.05, "gamma": 0.1, "e": 0.2, **values})


def squeeze_film_rotor(**values: float) -> System:
    """Rigid rotor on a centred squeeze-film damper, short, pi film; lengths over the clearance, time over 1/omega_0."""
    B, U = Parameter("B", "1", "bearing parameter"), Parameter("U", "1", "unbalance over the clearance")
    s = Parameter("s", "1", "speed over the natural frequency", above=0)
    square = x**2 + y**2
    eps = sqrt(square)
    outwards, around = (x * v + y * w) / eps, (x * w - y * v) / eps  # radial and tangential velocity
    left = 1 - square
    radial = B * (2 * eps * around / left**2 + pi * (1 + 2 * square) * outwards / (2 * left ** Rational(5, 2)))
    tangential = B * (pi * around / (2 * left ** Rational(3, 2)) + 2 * eps * outwards / left**2)
    model = Model(
        name="squeeze_film_rotor", states=(x, y, v, w), parameters=(B, U, s), harmonics=(s,),
        equations={
            x: v, y: w,
            v: U * s**2 * cos(s * t) - x - (radial * x - tangential * y) / eps,
            w: U * s**2 * sin(s * t) - y - (radial * y + tangential * x) / eps,
        },
    )  # fmt: skip
    return System(model, {"B": 0.05, "U": 0.2, "s": 0.6, **values})
