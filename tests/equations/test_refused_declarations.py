"""What a declaration must not say is refused where it is declared, by a sentence that names it and the way out."""

import re
import subprocess
import sys
from dataclasses import replace

import pytest
import sympy as sp

from whirlmap import bifurcation_diagram, load
from whirlmap.analysis.steady.settling import Settling
from whirlmap.cases.entries import RESERVED
from whirlmap.equations import Journal, Model, Output, Parameter, State, cos, t, when
from whirlmap.equations.family import Family
from whirlmap.equations.groups import Bearing, Groups, Route
from whirlmap.equations.names import RESULTS
from whirlmap.equations.quantities import MEASURES
from whirlmap.errors import ModelError
from whirlmap.integrate.dimensions import WRITTEN
from whirlmap.models import FAMILIES
from whirlmap.sweep.attractors.basins import basins
from whirlmap.sweep.diagrams.waterfall import waterfall
from whirlmap.sweep.points.label_points import label_points

x, v = State("x", "1", "x"), State("v", "1", "v")
p, w = Parameter("p", "1", "damping"), Parameter("w", "1", "frequency")


def oscillator(damping=p, state=x, **more):
    used = () if damping in (x, v) or not isinstance(damping, Parameter) else (damping,)
    rates = {state: v, v: cos(w * t) - damping * v - state}
    return Model("named", (state, v), (*used, w), rates, harmonics=(w,), swing=(state,), **more)


@pytest.mark.parametrize("name", [*RESERVED, "t", "time", "mean", "period", "state", "quantity", "point", "regime", "self"])
def test_names_that_are_taken_are_refused(name):
    with pytest.raises(ModelError, match=f"parameter '{name}' .* expected another name, such as '{name}_0'"):
        oscillator(Parameter(name, "1", "damping"))
    with pytest.raises(ModelError, match=f"state '{name}'"):
        oscillator(state=State(name, "1", "x"))


@pytest.mark.parametrize("name", ["a b", "k-1", "", "2x", "δ"])
def test_names_that_files_cannot_hold_are_refused(name):
    with pytest.raises(ModelError, match="letters, digits and underscores"):
        oscillator(Parameter(name, "1", "damping"))


ODD = "lambda exp pi e E I erf sin select sqrt x0 formula q0 w0 f0 c0 s0 z0_0 v0 x_ x_t v_ call0 None is print dy rates _"


@pytest.mark.parametrize("name", ODD.split())
def test_names_of_functions_python_and_the_kernels_work(name):
    """As parameters and as states, beside the functions of the same names."""
    k, s = Parameter(name, "1", "k"), State(name, "1", "s")

    def force(q, other):
        chosen = when(sp.And(q > sp.Rational(1, 2), other < q), other)
        return sp.exp(q) * sp.sqrt(q) * sp.E + sp.erf(q) + chosen + sp.sin(q) * cos(w * t) + sp.pi

    for quantity, model, values in (
        (k, Model("odd", (x, v), (k, w), {x: v, v: force(k, x) - x}, harmonics=(w,)), {name: 0.7}),
        (s, Model("odd", (s, v), (w,), {s: v, v: force(s, v)}, harmonics=(w,)), {}),
    ):
        system = load(model, w=2.0, **values)
        at = {quantity: 0.7, t: 0.3, w: 2.0, **({x: 0.2} if quantity is k else {}), v: 0.1}
        expected = float(model.equations[v].subs(at).evalf())
        place = [0.2 if quantity is k else 0.7, 0.1]
        assert system.rhs(0.3, place)[1] == pytest.approx(expected, rel=1e-13)
        assert system.reference_rhs(0.3, place)[1] == pytest.approx(expected, rel=1e-13)


def test_reserved_names_are_those_of_results():
    """Every dimension and variable beside a varied parameter or states is reserved, and no stock model has one."""
    settling = Settling(transient=5, keep=4, most=8)
    system = load("duffing")
    made = [
        bifurcation_diagram(system, "gamma", [0.2, 0.21], follow="both", settling=settling),
        label_points(system, {"gamma": [0.2]}, settling=settling, lyapunov=0, ends=True),
        waterfall(system, "gamma", [0.2, 0.21], state="x", periods=8, transient=2),
        basins(system, {"x": [0.0, 1.0], "v": [0.0, 1.0]}, settling=settling, lyapunov=256),
    ]
    found = {str(name) for ds in made for name in (*ds.variables, *ds.dims)} - {"gamma", "x", "v"}
    assert found <= RESULTS, found - RESULTS
    for family in FAMILIES.values():
        assert not (family.symbols() | {s.name for s in family.model().states}) & (RESULTS | set(RESERVED))


def test_an_output_has_no_states_name():
    with pytest.raises(ModelError, match="output 'x' has the name of a state"):
        oscillator(outputs={"x": Output(2 * x, "1", "twice")})


@pytest.mark.parametrize(
    ("term", "words"),
    [
        (sp.Function("x")(t - 2), ("x(t - 2)", "chain of states")),
        (sp.Function("g")(x), ("g(x)", "no function that is known", "Table")),
        (sp.floor(x), ("floor(x)", "endlessly many", "parameters alone", "when(")),
        (sp.Mod(x, 2), ("Mod(x, 2)", "endlessly many")),
        (sp.gamma(x), ("gamma(x)", "sin, cos", "when")),
        (sp.sec(x), ("sec(x)", "cos")),
        (sp.DiracDelta(x), ("DiracDelta(x)", "force over a short time")),
        (sp.Derivative(x**2, x, evaluate=False), ("Derivative", "state of its own")),
        (sp.sqrt(-2) * x, ("complex",)),
        (sp.asin(2) * x, ("asin(2)", "complex")),
        (sp.oo * x, ("not finite",)),
        (sp.Piecewise((x, x > 1)), ("without a default", "otherwise")),
        (x > 1, ("x > 1", "no number", "when(")),
    ],
    ids=str,
)
def test_what_cannot_be_computed_is_refused_with_a_way_out(term, words):
    with pytest.raises(ModelError) as error:
        Model("refused", (x,), (), {x: term if isinstance(term, sp.logic.boolalg.Boolean) else term - x})
    assert all(word in str(error.value) for word in ("'refused'", *words)), error.value


def test_floor_and_remainder_of_parameters_are_numbers():
    model = Model("stepped", (x,), (p,), {x: sp.floor(p) * x + sp.Mod(p, 2) + sp.ceiling(p / 3) + sp.erf(p)})
    assert load(model, p=2.7).rhs(0.0, [0.5])[0] == pytest.approx(1.0 + 0.7 + 1.0 + float(sp.erf(2.7)), rel=1e-14)


def test_a_state_of_another_time_is_refused():
    with pytest.raises(ModelError, match=r"x\(t - 1\): .*chain of states"):
        x(t - 1)


def test_parameters_that_nothing_reads_are_refused():
    """They could neither be given, which "has no effect", nor left out, for lack of a value."""
    with pytest.raises(ModelError, match=r"declares p, but reads it nowhere"):
        Model("idle", (x,), (p,), {x: -x})
    assert load(Model("read", (x,), (p,), {x: -x}, outputs={"o": Output(p * x, "1", "o")}), p=1.0).parameters == ("p",)


def test_a_case_names_file_and_line_and_the_command_ends_with_2(tmp_path):
    (tmp_path / "own.py").write_text(
        "from whirlmap.equations import Model, Parameter, State\n"
        "x = State('x', '1', 'x')\nmean = Parameter('mean', '1', 'm')\n"
        "MODEL = Model('own', (x,), (mean,), {x: -mean * x})\n"
    )
    (tmp_path / "own.toml").write_text('model = "own.py:MODEL"\nmean = { value = 1, assumed = "x" }\n')
    command = [sys.executable, "-c", "from whirlmap.cli.main import run; run()", "show", str(tmp_path / "own.toml")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "Traceback" not in done.stderr
    assert "own.py, line 4: model 'own': the parameter 'mean'" in " ".join(done.stderr.split())


def turning(**roles):
    return Output(x, "1", "how far", **roles)


@pytest.mark.parametrize(
    ("roles", "message"),
    [
        ({"outputs": {"far": turning(role="thickness", bearing="1")}}, "role 'thickness', expected one of eccentricity | "),
        ({"outputs": {"far": turning(role="shaft_speed", bearing="1")}}, "role 'shaft_speed', expected one of"),
        ({"outputs": {"far": turning(bearing="1")}}, "has the role '', expected one of"),
        ({"outputs": {"far": turning(role="load")}}, "'far' is the load of no bearing: add bearing="),
        ({"outputs": {n: turning(role="load", bearing="1") for n in ("a", "b")}}, "'a' and 'b' are both the load of"),
        ({"speed": Parameter("z", "1", "z")}, "the roles use 'z', which is neither"),
        ({"unbalances": {"rotor": Parameter("z", "1", "z")}}, "the roles use 'z'"),
        ({"journals": {"1": Journal((x, v), Parameter("z", "1", "z"))}}, "the roles use 'z'"),
        ({"journals": {"1": Journal((x, State("y", "1", "y")), 1)}}, "the coordinates use 'y'"),
        ({"bodies": {"disc": (x, State("y", "1", "y"))}}, "the coordinates use 'y'"),
    ],
)
def test_roles_of_what_is_not_there_are_refused(roles, message):
    with pytest.raises(ModelError, match=re.escape(message)):
        oscillator(**roles)


def test_a_role_alone_does_not_read_a_parameter():
    """A speed that no equation reads would have no effect, declared as the speed or not."""
    with pytest.raises(ModelError, match="declares z, but reads it nowhere"):
        z = Parameter("z", "1", "z")
        Model("idle", (x, v), (w, z), {x: v, v: cos(w * t) - x}, harmonics=(w,), speed=z)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"journals": {"a": (x, v)}}, r"journals\['a'\] is .* expected Journal"),
        ({"journals": {"a": Journal((x,), 1)}}, r"journals\['a'\]"),
        ({"journals": {"a": Journal((x + 1, v), 1)}}, r"journals\['a'\]"),
        ({"speed": x}, "speed is x, expected one of its parameters"),
        ({"bodies": {"disc": (x, x)}}, r"bodies\['disc'\] is .* states, each once"),
        ({"bodies": {"disc": (x, v)}, "unbalances": {"disk": p}}, "unbalances names 'disk', expected a body: disc"),
    ],
)
def test_roles_of_what_the_model_does_not_have_are_refused(more, said):
    with pytest.raises(ModelError, match=said):
        oscillator(**more)


def test_displacements_are_states():
    with pytest.raises(ModelError, match="swing names p, which is no state"):
        Model("named", (x, v), (p, w), {x: v, v: cos(w * t) - p * v - x}, harmonics=(w,), swing=(p,))


size, oil = Parameter("size", "m", "size"), Parameter("oil", "Pa*s", "oil")
STRAY = Parameter("stray", "1", "of no model")
BEARING = Bearing(size, size, size, oil, oil, 1, "far")


def of_groups(**more):
    """A family with dimensional inputs, declared with this beside them."""
    outputs = {"far": turning(role="eccentricity", bearing="1")}
    groups = Groups((size, oil), lambda _: {p: size}, **more)
    return Family("own", lambda: oscillator(outputs=outputs), groups=groups).model()


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"units": {"rot": size}}, "units has 'rot', expected force | length | speed | rotation."),
        ({"units": {"lenght": size}}, "units has 'lenght', expected force | length | speed | rotation. Did"),
        ({"units": {"length": STRAY}}, "the unit of 'length' of its groups reads 'stray', which is neither"),
        ({"shared": {"both": ("size", "oli")}}, "shared['both'] names 'oli', which is no input. Did you mean 'oil'?"),
        ({"sections": {"bearings": ("sise",)}}, "sections['bearings'] names 'sise', which is no input"),
        ({"operation": ("speed",)}, "operation names 'speed', which is no input"),
        ({"speed": STRAY}, "speed names 'stray', which is no input"),
        ({"routes": (Route(size, (STRAY,), float, "a rule"),)}, "the route to size names 'stray'"),
        ({"quantities": lambda _: {"n": Output(size, "m", "n", role="sped")}}, "has the role 'sped', expected one of"),
        ({"quantities": lambda _: {"n": Output(size, "m", "n", role="load")}}, "has the role 'load', expected one of"),
        ({"quantities": lambda _: {"n": Output(size, "m", "n", role="ring", bearing="2")}}, "of bearing '2', expected none"),
        ({"quantities": lambda _: {"n": Output(STRAY, "m", "n")}}, "the result 'n' of its groups reads 'stray'"),
        ({"bearings": lambda _: {"1": replace(BEARING, c=STRAY)}}, "has c = 'stray', which is no input"),
        ({"bearings": lambda _: {"1": replace(BEARING, eccentricity="fa")}}, "the eccentricity 'fa', which is no output"),
    ],
)
def test_groups_of_what_is_not_there_are_refused(more, said):
    with pytest.raises(ModelError, match=re.escape(said)):
        of_groups(**more)


def test_groups_of_what_is_there_are_taken():
    results = {"n": Output(size, "m", "n", role="ring", bearing="1")}
    assert of_groups(
        units={"length": size * w}, shared={"both": ("size", "oil")}, sections={"bearings": ("size", "both")},
        operation=("oil",), speed=oil, quantities=lambda _: results, bearings=lambda _: {"1": BEARING},
    ).name == "named"  # fmt: skip


def test_measures_that_there_are_not_are_refused():
    for declare in (State, Parameter, lambda *words, **more: Output(x, *words[1:], **more)):
        with pytest.raises(ModelError, match=r"has the measure 'lenght', expected one of .*Did you mean 'length'\?"):
            declare("far", "1", "how far", measure="lenght")
    assert set(WRITTEN) == set(MEASURES)


@pytest.mark.parametrize("name", ["states", "parameters", "harmonics", "swing"])
def test_one_symbol_in_place_of_a_list_is_refused_with_the_list(name):
    given = {"states": (x,), "parameters": (w,), "harmonics": (w,), "swing": (x,)}
    (alone,) = given[name]
    with pytest.raises(ModelError, match=re.escape(f"expected a list: write {name}=({alone},)")):
        Model("named", equations={x: cos(w * t)}, **given | {name: alone})


def test_time_where_it_may_not_stand_is_no_parameter_that_was_forgotten():
    with pytest.raises(ModelError, match=r"outputs use the time t, expected functions of states and parameters\. Make the"):
        oscillator(outputs={"force": Output(x * cos(w * t), "1", "force")})
    with pytest.raises(ModelError, match="the clocks use the time t, expected functions of parameters only"):
        oscillator(clocks={"shaft": w * t})
