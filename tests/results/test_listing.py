"""What objects print in a terminal and show in a notebook: short tables."""

import xml.etree.ElementTree as ElementTree

import pytest
import sympy as sp

import whirlmap
from whirlmap.models import family
from whirlmap.results.findings import Findings
from whirlmap.results.listing import LEAST, WIDTH, Rows
from whirlmap.results.schema import variable

LARGE = "gear-psfd/machine"


def printed(thing, least, most):
    """Text of a thing, known to be short; its HTML is well formed."""
    text = repr(thing)
    lines = text.splitlines()
    assert least < len(text) < most and max(map(len, lines)) <= WIDTH
    assert ElementTree.fromstring(thing._repr_html_().replace("<details open>", "<details>")).tag == "div"
    return text


def test_a_system_prints_its_numbers():
    text = printed(whirlmap.load("duffing", gamma=0.29), 200, 800)
    assert "gamma  0.29   1     forcing amplitude  set by the user" in text
    assert "period T = 5.23599, common period 1 T" in text and "states: x v" in text


def test_a_system_of_a_machine_fits_on_a_page():
    system = whirlmap.load(LARGE)
    assert len(printed(system, 1000, 4000).splitlines()) < 45
    html = system._repr_html_()
    assert "25 mm" in html and "radius of bearing 1" in html  # its dimensional inputs, on a click
    assert "speed ratio" in html and "assumed: " in html


def test_systems_without_a_period_print_themselves_too():
    assert "unforced, typical time 0.75" in repr(whirlmap.load("lorenz"))
    assert "no period T" in repr(whirlmap.load("gear-psfd/machine", r_p=0, r_g=0, r_m=0, j_p=1, j_g=-1))


def test_a_model_and_what_a_case_says_print_themselves():
    model = whirlmap.load(LARGE).model
    assert "vxp    1     pinion velocity" in printed(model, 1000, 6000)
    assert "-alpha*x - beta*x**3 - delta*v + gamma*cos(omega*t)" in printed(whirlmap.load("duffing").model, 200, 1000)
    details = whirlmap.load(LARGE).machine
    assert "K_p   4E+6 N/m" in printed(details, 1000, 5000)
    assert "K_p   4E+6 N/m" in printed(details.case, 1000, 5000)
    assert "arc         fixed | positive" in printed(family("gear_pair"), 200, 2000)


def test_findings_print_their_variables():
    found = whirlmap.diagnose.find(whirlmap.load("duffing", gamma=0.2), max_periods=16)
    text = printed(found, 500, 8000)
    assert "period_T" in text and "time, state" in text
    made = Findings({"a": variable("t", [1.0, float("nan"), 3.0], "m", "length < height"),
                     "b": variable((), float("nan"), "1", "none")}, {}, {"case": "x"})  # fmt: skip
    assert "3: 1 to 3" in printed(made, 50, 500) and "length &lt; height" in made._repr_html_()


def test_linear_results_print_themselves():
    rig = whirlmap.load("machines/jeffcott-rig")
    found = whirlmap.linear_analysis(rig)
    text = printed(found, 150, 1500)
    assert text.startswith(f"Linear analysis of {found.equilibrium.size} states: {'' if found.stable else 'not '}stable")
    least = found.eigenvalues[0]
    assert f"{least.real:.5g}" in text and f"{abs(least.imag):.5g}" in text and f"{-least.real / abs(least):.4g}" in text
    for film in whirlmap.film_coefficients(rig).values():
        text = printed(film, 200, 1500)
        assert "N/m" in text and ["Kxy", f"{film.K[0, 1]:.6g}", "W/c"] in [line.split() for line in text.splitlines()]
        assert ["Cyx", f"{film.C[1, 0]:.6g}", "W/(c", "omega)"] in [line.split() for line in text.splitlines()]


def test_a_last_column_without_room_is_left_out_of_text_only():
    rows = Rows("Some", ("a", "b"), [("x" * (WIDTH - LEAST + 5), "why, and why not")])
    assert "why" not in "".join(rows.lines()) and "why" in rows.html()
    assert "why" in "".join(Rows("Some", ("a", "b"), [("x", "why")]).lines())


@pytest.mark.parametrize("thing", [whirlmap.load("duffing"), whirlmap.load("duffing").model])
def test_sympy_does_not_take_them_for_expressions(thing):
    with pytest.raises(sp.SympifyError):
        sp.sympify(thing, strict=True)
