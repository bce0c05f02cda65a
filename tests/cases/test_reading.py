"""Reading case files: stock cases, inheritance, a user's own model, and one message for each mistake."""

import re

import pytest

from whirlmap.cases import names, read, resolve
from whirlmap.errors import CaseError
from whirlmap.references import key_of, references

GOOD = """model = "duffing"
description = "a test"
delta = { value = 0.3, assumed = "test" }
alpha = { value = -1, assumed = "test" }
beta = { value = 1, assumed = "test" }
gamma = { value = 0.5, assumed = "test" }
omega = { value = 1.2, assumed = "test" }
"""
MACHINE = 'extends = "gear-psfd/machine"\n'


@pytest.mark.parametrize("name", names())
def test_stock_cases_resolve_and_every_number_says_where_it_comes_from(name):
    case = read(name)
    assert len(case.description) > 20
    for given in case.given.values():
        kind, _, rest = given.note.partition(": ")
        assert kind in ("source", "assumed") or (case.parts and kind == "follows" and given.name.startswith("shaft."))
        if kind == "source":
            assert key_of(rest) in references(), given.where
    settled = resolve(case)
    assert set(settled.values) == {p.name for p in settled.model.parameters}
    assert all(settled.notes[p] for p in settled.values)


@pytest.mark.parametrize("name", ["gear-psfd/literal", "gear-psfd/intended", "gear-psfd/reference"])
def test_the_papers_editions_say_that_the_paper_gives_no_parameters(name):
    assert "does not give its parameters" in read(name).description


def test_every_choice_of_switches_of_a_stock_case_settles():
    assert resolve(read("jeffcott"), {"rotor": "flexible"}).values["k"] == 20
    assert resolve(read("jeffcott"), {"rotor": "flexible", "arc": "positive"}).switches["arc"] == "positive"
    for edition in ("literal", "intended", "physical"):
        assert resolve(read("gear-psfd/machine"), {"edition": edition}).switches["edition"] == edition


def test_a_stock_number_stands_once():
    """The editions extend the machine; only s and psi are their own."""
    assert set(read("gear-psfd/reference").layers[-1]) == {"s", "psi"}
    assert set(read("gear-psfd/literal").layers[-1]) == set()


def test_what_a_file_says_replaces_what_it_extends(tmp_path):
    (tmp_path / "base.toml").write_text(GOOD)
    child = tmp_path / "child.toml"
    child.write_text('extends = "base.toml"\ngamma = { value = 0.29, assumed = "4T" }\nstart = { x = 0.5 }\n')
    case = read(child)
    values = resolve(case).values
    assert (values["gamma"], values["delta"]) == (0.29, 0.3)
    assert case.start == {"x": 0.5}
    assert case.digest != read(tmp_path / "base.toml").digest


def test_the_digest_is_that_of_the_text(tmp_path):
    file = tmp_path / "case.toml"
    file.write_text(GOOD)
    before = read(file).digest
    file.write_text(GOOD.replace("0.3,", "0.30,"))
    assert read(file).digest != before
    file.write_text(GOOD)
    assert read(file).digest == before


MODEL = """
from whirlmap.equations import Family, Model, Parameter, State, cos, t

x = State("x", "m", "displacement", start=1e-3)
v = State("v", "m/s", "velocity")
k = Parameter("k", "1/s^2", "stiffness over mass", above=0)
A = Parameter("A", "m/s^2", "forcing")
w = Parameter("w", "rad/s", "forcing frequency", above=0)

MY_ROTOR = Model(
    name="my_rotor", states=(x, v), parameters=(k, A, w),
    equations={x: v, v: A * cos(w * t) - k * x}, harmonics=(w,),
)
MY_FAMILY = Family("my_family", lambda: MY_ROTOR)
NUMBER = 3
"""
MY_CASE = """model = "my_rotor.py:NAME"
k = { value = 4, unit = "1/s^2", assumed = "test" }
A = { value = 1, unit = "mm/s^2", assumed = "test" }
w = { value = 60, unit = "rpm", source = "our test stand, sheet 3" }
"""


@pytest.mark.parametrize("name", ["MY_ROTOR", "MY_FAMILY"])
def test_a_users_own_model_in_their_own_file(tmp_path, name):
    (tmp_path / "my_rotor.py").write_text(MODEL)
    file = tmp_path / "my_case.toml"
    file.write_text(MY_CASE.replace("NAME", name))
    settled = resolve(read(file), {"k": "9 1/s^2"})
    assert settled.values == {"k": 9.0, "A": 1e-3, "w": pytest.approx(6.283185307179586, rel=1e-15)}
    assert (
        resolve(read(file)).model is settled.model
    )  # the same text is the same model, so its kernel is found again


def bad_user_model(tmp_path, model_line, code=MODEL):
    (tmp_path / "my_rotor.py").write_text(code)
    file = tmp_path / "my_case.toml"
    file.write_text(MY_CASE.replace('"my_rotor.py:NAME"', f'"{model_line}"'))
    with pytest.raises(CaseError) as caught:
        read(file)
    return str(caught.value)


def test_mistakes_in_a_users_model_name_the_file_and_the_line(tmp_path):
    assert "Did you mean 'MY_ROTOR'?" in bad_user_model(tmp_path, "my_rotor.py:MY_ROTR")
    assert "it is a int, expected a Family or a Model" in bad_user_model(tmp_path, "my_rotor.py:NUMBER")
    assert "cannot be read (No such file" in bad_user_model(tmp_path, "no_rotor.py:MY_ROTOR")
    assert "expected file and name: 'my_rotor.py:MY_ROTOR'" in bad_user_model(tmp_path, "my_rotor.py")
    assert "my_rotor.py, line 2: NameError" in bad_user_model(tmp_path, "my_rotor.py:X", "\nx = y\n")
    assert "my_rotor.py, line 1: SyntaxError" in bad_user_model(tmp_path, "my_rotor.py:X", "x = (\n")


#: What is written, and what the one message must say (file and line are checked for all).
BAD_FILES = {
    "malformed": ('model = "duffing\n', "is not valid TOML: ", 0),
    "unknown model": ('model = "dufing"\n', "there is no model 'dufing'. Did you mean 'duffing'?", 1),
    "no model": ('description = "x"\n', "found no model, expected", 0),
    "unknown symbol": (GOOD.replace("gamma", "gama"), "has no symbol 'gama'. Did you mean 'gamma'?", 6),
    "missing symbol": (
        GOOD.replace("gamma", "# gamma"),
        "no value for 'gamma', expected one (forcing amplitude)",
        0,
    ),
    "no source": (
        GOOD.replace(', assumed = "test" }\nalpha', " }\nalpha"),
        "found neither of 'source' and 'assumed'",
        3,
    ),
    "two sources": (
        GOOD.replace('0.3, assumed = "test"', '0.3, assumed = "t", source = "t"'),
        "found both of 'source' and",
        3,
    ),
    "unknown key": (
        GOOD.replace("value = 0.3", "valeu = 0.3"),
        "found no 'value', expected value = a number",
        3,
    ),
    "unknown key beside": (
        GOOD.replace("value = 0.3", 'value = 0.3, unti = "1"'),
        "unknown key 'unti', expected one of value, unit",
        3,
    ),
    "bare number": (
        GOOD.replace('{ value = 0.3, assumed = "test" }', "0.3"),
        "found 0.3, expected an entry such as",
        3,
    ),
    "value of another kind": (
        GOOD.replace("value = 0.3", "value = [1]"),
        "found value = [1], expected a number",
        3,
    ),
    "boolean value": (
        GOOD.replace("value = 0.3", "value = true"),
        "found value = True, expected a number",
        3,
    ),
    "not a number": (
        GOOD.replace("value = 0.3", "value = nan"),
        "delta: found NaN, expected a finite number",
        3,
    ),
    "unit of another dimension": (
        GOOD.replace("value = 0.3", 'value = 0.3, unit = "kg"'),
        "found the unit 'kg', expected no unit (damping)",
        3,
    ),
    "value out of limits": (
        GOOD.replace("value = 1.2", "value = -1.2"),
        "omega: found -1.2, which must be above 0",
        7,
    ),
    "misspelt heading": (
        GOOD.replace("description", "descripton"),
        "'descripton' = 'a test', expected one of model",
        2,
    ),
    "start": (GOOD + 'start = { x = "fast" }\n', "start: x: found 'fast', expected a number", 8),
    "start state without value": (GOOD + "start = 3\n", "start: found start = 3, expected", 8),
    "extends nothing": (
        'extends = "gear-psfd/machin"\n',
        "there is no case 'gear-psfd/machin'. Did you mean",
        1,
    ),
    "extends no file": ('extends = "none.toml"\n', "none.toml does not exist", 1),
    "extends itself": ('extends = "case.toml"\n', "extends itself", 0),
    "extends another model": (MACHINE + 'model = "duffing"\n', "found 'duffing', expected 'gear_pair'", 2),
    "unknown switch": (
        MACHINE + 'edition = "litteral"\n',
        "found 'litteral', expected one of intended | literal",
        2,
    ),
    "unknown switch name": (MACHINE + 'editon = "literal"\n', "Did you mean 'edition'?", 2),
    "negative mass": (
        MACHINE + 'm_p = { value = -10, unit = "kg", assumed = "t" }\n',
        "m_p: found -10 kg, which must be above 0",
        2,
    ),
    "teeth 0": (
        MACHINE + 'z_p = { value = 0, assumed = "t" }\n',
        "z_p: found 0, which must be above 0 (teeth",
        2,
    ),
    "teeth 20.5": (
        MACHINE + 'z_p = { value = 20.5, assumed = "t" }\n',
        "found 20.5, which must be a whole number",
        2,
    ),
    "missing unit": (
        MACHINE + 'mu = { value = 0.02, assumed = "t" }\n',
        "mu: found 0.02 without a unit, expected a unit such as Pa*s",
        2,
    ),
    "unknown unit": (
        MACHINE + 'c = { value = 50, unit = "umm", assumed = "t" }\n',
        "unknown unit 'umm', expected one such as m",
        2,
    ),
    "unit twice": (
        MACHINE + 'c = { value = "50 um", unit = "um", assumed = "t" }\n',
        "found the unit twice",
        2,
    ),
    "speed and s": (
        MACHINE + 's = { value = 1, assumed = "t" }\nspeed = { value = 1500, unit = "rpm", assumed = "t" }\n',
        "found speed and s given together",
        3,
    ),
    "psi and Phi": (
        MACHINE + 'psi = { value = 0, assumed = "t" }\nPhi = { value = 0, unit = "m^2", assumed = "t" }\n',
        "found Phi and psi given together",
        3,
    ),
    "symbol of another edition": (
        MACHINE + 'edition = "literal"\nkappa_g = { value = 2, assumed = "t" }\n',
        "does not read 'kappa_g'",
        3,
    ),
    "only": (
        MACHINE + 's = { value = 1, assumed = "t", only = { edition = "phys" } }\n',
        "found edition = 'phys', expected",
        2,
    ),
    "only of no switch": (
        MACHINE + 's = { value = 1, assumed = "t", only = { rotor = "x" } }\n',
        "found the switch 'rotor', expected",
        2,
    ),
    "absurd number": (GOOD.replace("value = 0.3", f"value = {'9' * 5000}"), "cannot be read as TOML", 0),
    "beyond floats": (
        GOOD.replace("value = 0.3", "value = 1e999"),
        "delta: found 1E+999, expected one between",
        3,
    ),
}


@pytest.mark.parametrize("fault", BAD_FILES)
def test_one_message_names_file_line_key_found_and_expected(tmp_path, fault):
    text, message, line = BAD_FILES[fault]
    file = tmp_path / "case.toml"
    file.write_text(text)
    with pytest.raises(CaseError, match=re.escape(message)) as caught:
        resolve(read(file))
    assert str(file) in str(caught.value)
    if line:
        assert f"{file}, line {line}: " in str(caught.value)


def test_a_file_that_is_not_text(tmp_path):
    file = tmp_path / "case.toml"
    file.write_bytes(b"\xff\xfe\x00model")
    with pytest.raises(CaseError, match="is not text in UTF-8"):
        read(file)


def test_a_folder_and_a_missing_file(tmp_path):
    (tmp_path / "folder.toml").mkdir()
    with pytest.raises(CaseError, match=r"folder\.toml is not a file"):
        read(tmp_path / "folder.toml")
    with pytest.raises(CaseError, match="does not exist"):
        read(tmp_path / "none.toml")


def test_an_unknown_name_gets_the_nearest_one():
    with pytest.raises(CaseError, match=r"no case 'dufing'\. Did you mean 'duffing'?"):
        read("dufing")
