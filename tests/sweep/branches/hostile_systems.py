"""Systems that branches are hard to follow in, each with a truth of its own."""

from sympy import Matrix, Rational

from whirlmap.equations import Model, Parameter, Section, State, Stop, Switching, cos, sign, sin, sqrt, t, when
from whirlmap.integrate.system import System

x, v = State("x", "1", "displacement"), State("v", "1", "its rate")
y, w = State("y", "1", "another displacement"), State("w", "1", "its rate")
Omega = Parameter("Omega", "1", "frequency of the forcing", above=0)
zeta = Parameter("zeta", "1", "damping ratio", at_least=0)
mu = Parameter("mu", "1", "control")


def stretched(**values: float) -> System:
    """Linear: two hidden states grow and decay at rates a and -b; they are mixed, so that the matrices are full."""
    a, b = Parameter("a", "1", "growth"), Parameter("b", "1", "decay")
    mix = Matrix([[1, Rational(1, 2)], [Rational(-1, 3), 1]])
    hidden = mix.inv() * Matrix([x, y])
    rates = mix * Matrix([a * hidden[0] + cos(Omega * t), -b * hidden[1] + sin(Omega * t)])
    return System(
        Model("stretched", (x, y), (a, b, Omega), {x: rates[0], y: rates[1]}, harmonics=(Omega,)), {"Omega": 1.0, **values}
    )


def one_sided_spring(**values: float) -> System:
    """x'' + 2 zeta x' + x + k max(x - 1, 0) = F cos(Omega t): linear where the amplitude is below 1."""
    k, F = Parameter("k", "1", "stiffness of the wall"), Parameter("F", "1", "forcing")
    model = Model(
        "one_sided_spring", (x, v), (zeta, k, F, Omega),
        {x: v, v: F * cos(Omega * t) - 2 * zeta * v - x - k * when(x > 1, x - 1)}, harmonics=(Omega,),
        switchings={"wall": Switching(x - 1, "touches the wall")},
    )  # fmt: skip
    return System(model, {"zeta": 0.1, "k": 3.0, "F": 0.5, "Omega": 0.5, **values})


def oscillator_with_stop(**values: float) -> System:
    """x'' + 2 zeta x' + x = F cos(Omega t) until x reaches 1."""
    F = Parameter("F", "1", "forcing")
    model = Model(
        "oscillator_with_stop", (x, v), (zeta, F, Omega), {x: v, v: F * cos(Omega * t) - 2 * zeta * v - x},
        harmonics=(Omega,), stops={"contact": Stop(1 - x, "touches the wall")},
    )  # fmt: skip
    return System(model, {"zeta": 0.1, "F": 0.5, "Omega": 0.4, **values})


def pushed_to_a_stop(**values: float) -> System:
    """x'' + x' + x = F: rests at x = F, until x reaches the stop at 1."""
    F = Parameter("F", "1", "force")
    model = Model(
        "pushed_to_a_stop", (x, v), (F,), {x: v, v: F - x - v}, section=Section(v, "rising"),
        stops={"contact": Stop(1 - x, "touches the wall")},
    )  # fmt: skip
    return System(model, {"F": 0.2, **values})


def fold_of_cycles(**values: float) -> System:
    """r' = r (mu + r^2 - r^4), turning by one: cycles 2 r^2 = 1 +- sqrt(1 + 4 mu), fold at mu = -1/4, Hopf point at 0."""
    growth = mu + (x**2 + y**2) - (x**2 + y**2) ** 2
    model = Model(
        "fold_of_cycles", (x, y), (mu,), {x: growth * x - y, y: x + growth * y}, section=Section(y, "rising"),
        typical_time=6.28,
    )  # fmt: skip
    return System(model, {"mu": 0.3, **values})


def mirrored(**values: float) -> System:
    """x' = -x + cos(Omega t), y' = (mu - x^2) y - y^3: y = 0 loses its stability where mu is the mean of x^2."""
    model = Model(
        "mirrored", (x, y), (mu, Omega), {x: -x + cos(Omega * t), y: (mu - x**2) * y - y**3}, harmonics=(Omega,)
    )
    return System(model, {"mu": 0.5, "Omega": 1.0, **values})


def dry_friction(**values: float) -> System:
    """x'' + x + f sign(x') = cos(Omega t): Den Hartog's oscillator; it slides without sticking at small f."""
    f = Parameter("f", "1", "friction over the forcing")
    model = Model(
        "dry_friction", (x, v), (f, Omega), {x: v, v: cos(Omega * t) - x - f * sign(v)}, harmonics=(Omega,),
        switchings={"slides": Switching(v, "slides to positive x", jumps=True)},
    )  # fmt: skip
    return System(model, {"f": 0.2, "Omega": 0.7, **values})


def unforced_amplitude(**values: float) -> System:
    """z'' + 2 zeta z' + (1 - i mu) z = g exp(i Omega t): at g = 0 the threshold is mu = 2 zeta."""
    g = Parameter("g", "1", "forcing")
    model = Model(
        "unforced_amplitude", (x, y, v, w), (zeta, mu, g, Omega),
        {
            x: v, y: w,
            v: g * cos(Omega * t) - 2 * zeta * v - x - mu * y,
            w: g * sin(Omega * t) - 2 * zeta * w - y + mu * x,
        },
        harmonics=(Omega,),
    )  # fmt: skip
    return System(model, {"zeta": 0.05, "mu": 0.02, "g": 0.0, "Omega": 0.7, **values})


def growing_cycle(**values: float) -> System:
    """z' = (1 + i) z - mu |z|^2 z: a cycle of radius 1/sqrt(mu) and duration 2 pi."""
    square = x**2 + y**2
    model = Model(
        "growing_cycle", (x, y), (mu,), {x: x - y - mu * square * x, y: y + x - mu * square * y},
        section=Section(y, "rising"), typical_time=6.28,
    )  # fmt: skip
    return System(model, {"mu": 1.0, **values})


def two_frequencies(**values: float) -> System:
    """x' = -x + cos(Omega t) + cos(sqrt(2) Omega t): no common period."""
    model = Model(
        "two_frequencies", (x,), (Omega,), {x: -x + cos(Omega * t) + cos(sqrt(2) * Omega * t)},
        harmonics=(Omega, sqrt(2) * Omega),
    )  # fmt: skip
    return System(model, {"Omega": 1.0, **values})
