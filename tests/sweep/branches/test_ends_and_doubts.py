"""How branches end where the parameter stands still, and what the commands say of what they could not find."""

import json

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import mathieu_a
from typer.testing import CliRunner

import whirlmap
from whirlmap.cli.commands.continue_orbit import say_branches
from whirlmap.cli.main import app
from whirlmap.equations import Model, Parameter, State, cos, t, when
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.system import System

x, v = State("x", "1", "displacement", start=1.3), State("v", "1", "its rate")
a, q = Parameter("a", "1", "mean stiffness"), Parameter("q", "1", "variation of the stiffness")
z = Parameter("z", "1", "damping")
#: Mathieu's equation as far as x = 1, and stiffer beyond.
MATHIEU = Model(
    name="mathieu", states=(x, v), parameters=(a, q), harmonics=(2,),
    equations={x: v, v: -(a - 2 * q * cos(2 * t)) * x - when(x > 1, (x - 1) ** 2, 0)},
)  # fmt: skip


def test_a_branch_on_which_the_parameter_stands_still_ends_and_says_so(capsys):
    """Below x = 1 the motion is linear: at the value a_0 of Mathieu's equation there are orbits of any size."""
    value = float(mathieu_a(0, 0.5))
    system = System(MATHIEU, {"a": value - 0.02, "q": 0.5})
    ds = whirlmap.continue_orbit(
        system, "a", (value - 0.1, value + 0.4), begin=value - 0.02, orbit=(1.3, 0.0), period=1, points=400
    )
    assert "the parameter stands still" in ds.attrs["why"]
    assert ds.sizes["point"] < 200
    vertical = ds["maximum"].sel(quantity="x").values < 0.99
    np.testing.assert_allclose(ds["a"].values[vertical], value, atol=1e-11)
    assert vertical.sum() >= 10
    say_branches(system, ds, Dimensions(system), ["x"])
    assert "vertical: the parameter stands still while the orbit changes" in capsys.readouterr().out


@pytest.fixture
def kinked(tmp_path):
    """A case of a model of one's own with a kink and without a named surface."""
    (tmp_path / "own.py").write_text(
        "from whirlmap.equations import Model, Parameter, State, cos, t, when\n"
        "x, v = State('x', '1', 'x'), State('v', '1', 'v')\n"
        "g = Parameter('g', '1', 'forcing')\n"
        "rates = {x: v, v: g * cos(t) - v / 5 - x / 2 - when(x > 0, x, 0)}\n"
        "OWN = Model('own', (x, v), (g,), rates, harmonics=(1,), swing=(x,))\n"
    )
    (tmp_path / "own.toml").write_text('model = "own.py:OWN"\ng = 0.3\n')
    return str(tmp_path / "own.toml")


@pytest.mark.parametrize(
    "command", [["continue", "--vary", "g=0.3:0.31"], ["bifurcation", "--vary", "g=0.3:0.31:2", "--branches"]]
)
def test_surfaces_without_a_name_are_said_to_be_left_out(kinked, command):
    result = CliRunner().invoke(app, [command[0], kinked, *command[1:], "--quiet"])
    assert result.exit_code == 0, result.output
    assert result.stderr.count("own names no surface (switchings=), so grazing orbits are not sought") == 1


def test_a_smooth_model_and_one_that_names_its_surfaces_are_told_nothing():
    for case, name, ends in (("duffing", "gamma", (0.2, 0.201)), ("gear_backlash", "Omega", (0.5, 0.501))):
        assert "not_sought" not in whirlmap.continue_orbit(whirlmap.load(case), name, ends).attrs


def test_a_diagram_with_branches_says_their_doubts_as_the_branches_do(kinked, monkeypatch):
    from whirlmap.cli.commands import bifurcation

    made = bifurcation._branches
    monkeypatch.setattr(bifurcation, "_branches", lambda *a, **k: made(*a, **k).assign_attrs(doubts="look here"))
    asked = ["bifurcation", kinked, "--vary", "g=0.3:0.31:2", "--branches", "--quiet"]
    assert "warning: look here" in CliRunner().invoke(app, asked).stderr
    assert json.loads(CliRunner().invoke(app, [*asked, "--json"]).stdout)["doubts"] == "look here"


def test_two_period_doublings_within_one_step_do_not_cancel():
    """A damped Mathieu equation: its narrow tongue is shorter than a step. SciPy's flow says where it begins and ends."""
    damping, width = 0.0249, 0.05
    linear = Model(
        name="damped_mathieu", states=(x, v), parameters=(a, q, z), harmonics=(2,),
        equations={x: v, v: 1 + cos(2 * t) - 2 * z * v - (a - 2 * q * cos(2 * t)) * x},
    )  # fmt: skip

    def crosses(stiffness):
        """det(M + I) over one T, which vanishes where a multiplier is -1."""
        rates = lambda t, y: [y[1], -2 * damping * y[1] - (stiffness - 2 * width * np.cos(2 * t)) * y[0]]  # noqa: E731
        flow = [solve_ivp(rates, (0, np.pi), e, rtol=1e-12, atol=1e-14, method="DOP853").y[:, -1] for e in np.eye(2)]
        return np.linalg.det(np.array(flow).T + np.eye(2))

    exact = [brentq(crosses, 0.9, 1.0), brentq(crosses, 1.0, 1.1)]
    system = System(linear, {"a": 0.4, "q": width, "z": damping})
    for begin in (0.4, 0.41, 0.42):
        ds = whirlmap.continue_orbit(system, "a", (0.4, 1.9), begin=begin)
        np.testing.assert_allclose(np.sort(ds["event_a"].values), exact, atol=1e-8)
