"""What the stock models say: their equations typed again, their clocks, and what they refuse."""

from fractions import Fraction

import numpy as np
import pytest
from sympy import sympify
from tests.independent.newton import Machine, film_force, journal_velocity

from whirlmap.equations import Model, Parameter, State, Stop
from whirlmap.errors import CaseError, ModelError, RangeError
from whirlmap.integrate.system import System
from whirlmap.models import FAMILIES, family

RNG = np.random.default_rng(7)
ORDERS = {"r_p": Fraction(1), "r_g": Fraction(-1, 2), "r_m": Fraction(20), "j_p": 1.0, "j_g": -0.5}


def pair(model, **changes):
    groups = {**Machine().groups(1.3, **{**ORDERS, **{k: v for k, v in changes.items() if k in ORDERS}}), "xi_5": 0.1}
    groups |= changes
    return System(model, {p.name: groups[p.name] for p in model.parameters})


# --- textbook models, typed again --------------------------------------------------------------------------


def zone(x):
    return np.where(x > 1, x - 1, np.where(x < -1, x + 1, 0.0))


TEXTBOOK = {
    "duffing": lambda t, x, p: [
        x[1],
        p["gamma"] * np.cos(p["omega"] * t) - p["delta"] * x[1] - p["alpha"] * x[0] - p["beta"] * x[0] ** 3,
    ],
    "pendulum": lambda t, x, p: [x[1], p["g"] * np.cos(p["omega"] * t) - p["q"] * x[1] - np.sin(x[0])],
    "van_der_pol": lambda t, x, p: [
        x[1], p["mu"] * (1 - x[0] ** 2) * x[1] - x[0] + p["A"] * np.cos(p["omega"] * t)
    ],
    "lorenz": lambda t, x, p: [
        p["sigma"] * (x[1] - x[0]), x[0] * (p["rho"] - x[2]) - x[1], x[0] * x[1] - p["beta"] * x[2]
    ],
    "roessler": lambda t, x, p: [-x[1] - x[2], x[0] + p["a"] * x[1], p["b"] + x[2] * (x[0] - p["c"])],
    "gear_backlash": lambda t, x, p: [
        x[1],
        p["F_m"] + p["F_ah"] * p["Omega"] ** 2 * np.cos(p["Omega"] * t) - 2 * p["zeta"] * x[1] - zone(x[0]),
    ],
}  # fmt: skip


@pytest.mark.parametrize("name", TEXTBOOK)
def test_textbook_model_says_its_textbook_equations(name):
    model = family(name).model()
    values = {p.name: RNG.uniform(0.5, 2) for p in model.parameters}
    x = RNG.uniform(-3, 3, (model.dimension, 50))
    got = System(model, values).reference_rhs(0.8, x)
    np.testing.assert_allclose(got, TEXTBOOK[name](0.8, x, values), rtol=1e-14, atol=1e-13)


# --- the Jeffcott rotor, from forces in newtons ------------------------------------------------------------

FILM = {"R": 0.025, "L": 0.012, "c": 50e-6, "mu": 0.02, "seepage": 0.0}
A = FILM["mu"] * FILM["R"] * FILM["L"] ** 3 / (2 * FILM["c"] ** 2)
G = 9.81


def bearing(mass, omega):
    """One bearing's share of a rotor: dimensionless s and Gamma of the model."""
    return omega * np.sqrt(FILM["c"] / G), A * np.sqrt(G / FILM["c"]) / (mass * G)


def test_rigid_jeffcott_is_newtons_law():
    model = family("jeffcott").model(rotor="rigid")
    for _ in range(10):
        mass, omega, unbalance, time = RNG.uniform(3, 9), RNG.uniform(300, 900), RNG.uniform(0, 0.3), RNG.uniform(0, 9)
        s, Gamma = bearing(mass, omega)
        u, v = RNG.uniform(-0.6, 0.6, 2), RNG.uniform(-0.5, 0.5, 2)
        c = FILM["c"]
        force = film_force(c * u, c * omega * v, omega, arc="fixed", **FILM)
        turn = np.array([np.cos(time), np.sin(time)])
        a = force / mass + unbalance * c * omega**2 * turn - np.array([0, G])
        system = System(model, {"s": s, "Gamma": Gamma, "b": unbalance})
        expected = [*v, *(a / (c * omega**2))]
        np.testing.assert_allclose(system.reference_rhs(time, [*u, *v]), expected, rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("arc", ["fixed", "positive"])
def test_flexible_jeffcott_is_newtons_law(arc):
    model = family("jeffcott").model(rotor="flexible", arc=arc)
    for _ in range(6):
        mass, omega, unbalance, time = RNG.uniform(3, 9), RNG.uniform(300, 900), RNG.uniform(0, 0.3), RNG.uniform(0, 9)
        K, C, c = RNG.uniform(1e6, 6e6), RNG.uniform(10, 300), FILM["c"]
        s, Gamma = bearing(mass, omega)
        u, x, v = RNG.uniform(-0.6, 0.6, 2), RNG.uniform(-1, 1, 2), RNG.uniform(-0.5, 0.5, 2)
        shaft = K * c * (x - u)
        journal = journal_velocity(c * u, shaft, omega, speed=c * omega, arc=arc, **FILM)
        turn = np.array([np.cos(time), np.sin(time)])
        a = (-shaft - C * c * omega * v) / mass + unbalance * c * omega**2 * turn - np.array([0, G])
        values = {"s": s, "Gamma": Gamma, "b": unbalance, "k": K * c / (mass * G), "xi": C / (2 * mass) * np.sqrt(c / G)}
        expected = [*(journal / (c * omega)), *v, *(a / (c * omega**2))]
        got = System(model, values).reference_rhs(time, [*u, *x, *v])
        limit = 1e-12 if arc == "fixed" else 5e-12  # the reference of the positive arc at psi = 0: 6e-13 per unit load
        np.testing.assert_allclose(got, expected, rtol=1e-11, atol=limit)


# --- clocks ------------------------------------------------------------------------------------------------


def test_the_papers_clock_repeats_after_eight_periods():
    model = family("gear_pair").model(edition="intended")
    system = pair(model, r_p=Fraction(1, 4), r_g=Fraction(-1, 8), r_m=Fraction(1))
    assert system.period == pytest.approx(2 * np.pi, rel=1e-15)
    assert system.common_multiple == 8
    assert system.common_period == pytest.approx(16 * np.pi, rel=1e-15)


def test_the_pinions_clock_repeats_after_the_hunting_of_the_teeth():
    """20 and 40 teeth: the gear turns once in 40 mesh periods."""
    system = pair(family("gear_pair").model(edition="physical", arc="fixed"))
    assert system.common_multiple == 40
    assert system.common_period == pytest.approx(4 * np.pi, rel=1e-15)
    x = np.linspace(-0.3, 0.3, 20)
    np.testing.assert_allclose(
        system.reference_rhs(0.4, x), system.reference_rhs(0.4 + system.common_period, x), rtol=0, atol=1e-12
    )
    assert np.max(np.abs(system.reference_rhs(0.4, x) - system.reference_rhs(0.4 + 20 * system.period, x))) > 1e-3


def test_a_harmonic_counts_even_without_amplitude():
    system = pair(family("gear_pair").model(edition="physical", arc="fixed"), E=0.0, b_p=0.0, b_g=0.0)
    assert system.common_multiple == 40


# --- switches and refusals ---------------------------------------------------------------------------------


def test_editions_have_their_own_default_film_and_arc():
    defaults = {e: family("gear_pair").model(edition=e).switches for e in ("literal", "intended", "physical")}
    assert (defaults["literal"]["film"], defaults["literal"]["arc"]) == ("printed", "fixed")
    assert (defaults["intended"]["film"], defaults["intended"]["arc"]) == ("porous", "fixed")
    assert (defaults["physical"]["film"], defaults["physical"]["arc"]) == ("porous", "positive")


def test_equal_switches_are_one_model():
    make = family("gear_pair").model
    assert make(edition="intended") is make(edition="intended", film="porous", arc="fixed")


@pytest.mark.parametrize(
    ("switches", "word"),
    [
        ({"edition": "litteral"}, "literal"), ({"film": "prous"}, "porous"), ({"ark": "fixed"}, "arc"),
        ({"edition": "literal", "arc": "positive"}, "intended"),
    ],
)  # fmt: skip
def test_unknown_choices_are_named_with_the_nearest(switches, word):
    with pytest.raises(ModelError, match=word):
        family("gear_pair").model(**switches)


def test_a_still_journal_needs_the_positive_arc():
    with pytest.raises(CaseError, match="arc = positive"):
        pair(family("gear_pair").model(edition="intended", arc="fixed"), j_g=0.0)
    pair(family("gear_pair").model(edition="intended", arc="positive"), j_g=0.0)


@pytest.mark.parametrize(("name", "value"), [("s", 0.0), ("psi", -1e-9), ("nu_g", -1.0), ("f", float("nan"))])
def test_values_outside_of_their_limits_are_refused(name, value):
    with pytest.raises(CaseError, match=name):
        pair(family("gear_pair").model(edition="intended"), **{name: value})


def test_every_quantity_has_a_unit_and_a_meaning():
    for name, made in FAMILIES.items():
        model = made.model()
        for quantity in (*model.states, *model.parameters):
            assert quantity.unit, (name, quantity)
            assert quantity.meaning, (name, quantity)
        assert model.read() == set(model.parameters), f"{name} declares parameters that nothing reads"


@pytest.mark.parametrize(
    ("film", "psi", "expected"), [("porous", 0.0, False), ("porous", 1e-9, True), ("printed", 0.0, True)]
)
def test_which_films_let_the_journal_through(film, psi, expected):
    """A plain film never does (audit 3.4); a porous one does, and the printed one has no wall at all."""
    model = family("gear_pair").model(edition="intended", film=film, arc="fixed")
    for stop in model.stops.values():
        assert bool(sympify(stop.reachable).subs({model.parameter("psi"): psi}) > 0) is expected


x, y = State("x", "1", "x"), State("y", "1", "y")
k = Parameter("k", "1", "k")


def test_declarations_that_contradict_themselves_are_refused():
    with pytest.raises(ModelError, match="more than once"):
        Model("m", (x, State("x", "1", "again")), (k,), {x: k})
    with pytest.raises(ModelError, match="one equation for each"):
        Model("m", (x, y), (k,), {x: k})
    with pytest.raises(ModelError, match="neither a state nor"):
        Model("m", (x,), (), {x: -k * x})
    with pytest.raises(ModelError, match="the stops"):
        Model("m", (x,), (), {x: -x}, stops={"contact": Stop(k - x, "wall")})


def test_start_values_must_be_states_and_numbers():
    values = {"k": 1.0}
    model = Model("m", (x,), (k,), {x: -k * x})
    with pytest.raises(RangeError, match="no state 'z'"):
        System(model, values, start={"z": 1.0})
    with pytest.raises(RangeError, match="finite"):
        System(model, values, start={"x": float("inf")})
    with pytest.raises(CaseError, match="no value for 'k'"):
        System(model, {})
