"""Unforced oscillators whose cycles are known in closed form or by SciPy, and their equations as text beside them."""

from sympy import Max

from whirlmap.equations import Model, Parameter, Section, State, sign, states, when

x, y, z = states("x y z", "1", "state")
v = State("v", "1", "velocity")
_P = {n: Parameter(n, "1", n) for n in ["mu", "a", "b", "c", "d", "e", "f", "I", "r", "s", "q", "k", "m", "w", "F"]}
mu, a, b, c, d, e, f, I, r, s, q, k, m, w, F = _P.values()


def flow(name, rates, section, typical, *used, direction="rising"):
    return Model(name=name, states=tuple(rates), parameters=used, equations=rates, section=Section(section, direction),
                 typical_time=typical, swing=(next(iter(rates)),))  # fmt: skip


#: Name -> (model, states, rates as text, section as text).
FLOWS = {
    "van_der_pol": (
        flow("vdp_free", {x: v, v: mu * (1 - x**2) * v - x}, x, 6.3, mu),
        "x v", ("v", "mu*(1-x**2)*v - x"), "x",
    ),
    "rayleigh": (
        flow("rayleigh", {x: v, v: mu * (v - v**3 / 3) - x}, x, 6.3, mu),
        "x v", ("v", "mu*(v - v**3/3) - x"), "x",
    ),
    "hopf": (
        flow("hopf", {x: m * x - w * y - x * (x**2 + y**2), y: w * x + m * y - y * (x**2 + y**2)}, y, 6 / w, m, w),
        "x y", ("m*x - w*y - x*(x**2+y**2)", "w*x + m*y - y*(x**2+y**2)"), "y",
    ),
    "slaved_hopf": (
        flow("slaved_hopf", {x: x - w * y - x * (x**2 + y**2), y: w * x + y - y * (x**2 + y**2), z: -k * (z - x * y)},
             y, 2.0, w, k),
        "x y z", ("x - w*y - x*(x**2+y**2)", "w*x + y - y*(x**2+y**2)", "-k*(z - x*y)"), "y",
    ),
    "fitzhugh_nagumo": (
        flow("fitzhugh_nagumo", {x: x - x**3 / 3 - y + I, y: e * (x + a - b * y)}, x, 30.0, e, a, b, I),
        "x y", ("x - x**3/3 - y + I", "e*(x + a - b*y)"), "x",
    ),
    "brusselator": (
        flow("brusselator", {x: a + x**2 * y - (b + 1) * x, y: b * x - x**2 * y}, x - a, 7.0, a, b),
        "x y", ("a + x**2*y - (b+1)*x", "b*x - x**2*y"), "x - a",
    ),
    "oregonator": (
        flow("oregonator", {x: s * (y + x * (1 - q * x - y)), y: (z - (1 + x) * y) / s, z: w * (x - z)}, x - 100, 300.0,
             s, q, w),
        "x y z", ("s*(y + x*(1 - q*x - y))", "(z - (1+x)*y)/s", "w*(x - z)"), "x - 100",
    ),
    "predator_prey": (
        flow("predator_prey", {x: r * x * (1 - x / k) - a * x * y / (1 + x), y: a * x * y / (1 + x) - m * y}, x - 1, 15.0,
             r, k, a, m),
        "x y", ("r*x*(1 - x/k) - a*x*y/(1+x)", "a*x*y/(1+x) - m*y"), "x - 1",
    ),
    "roessler": (
        flow("roessler_free", {x: -y - z, y: x + a * y, z: b + z * (x - c)}, x, 6.0, a, b, c, direction="rising"),
        "x y z", ("-y - z", "x + a*y", "b + z*(x - c)"), "x",
    ),
    "lorenz": (
        flow("lorenz_free", {x: s * (y - x), y: x * (r - z) - y, z: x * y - b * z}, z - (r - 1), 0.5, s, r, b),
        "x y z", ("s*(y - x)", "x*(r - z) - y", "x*y - b*z"), "z - (r - 1)",
    ),
}  # fmt: skip

#: Cycles with a kink or a jump, solved by `truth_events` over the pieces between crossings.
BILINEAR_CYCLE = flow("bilinear_cycle", {x: v, v: mu * (1 - x**2) * v - when(x > 0, x, k * x)}, x, 4.0, mu, k)
STOPPED_CYCLE = flow("stopped_cycle", {x: v, v: mu * (1 - x**2) * v - x - k * Max(x - 1, 0)}, x, 4.0, mu, k)
BELT_CYCLE = flow(
    "belt_cycle", {x: v, v: -d * v - x - F * sign(v - b) / (1 + (v - b) ** 2)}, v, 6.0, F, b, d, direction="falling"
)
RELAY_CYCLE = flow("relay_cycle", {x: v, v: -d * v - sign(x - c * v)}, x, 4.0, d, c)
