"""Docstrings of the public functions: their sections, the names in them, and the references that they cite."""

import ast
import builtins
import inspect
import re
import textwrap
import typing

import pytest

import whirlmap
from whirlmap import errors, plot
from whirlmap.references import references

SECTION = re.compile(r"^(\w+)\n-{3,}$", re.MULTILINE)
FUNCTIONS = {n: getattr(whirlmap, n) for n in whirlmap.__all__ if inspect.isfunction(getattr(whirlmap, n))}
PICTURES = {f"plot.{n}": f for n, f in vars(plot).items() if inspect.isfunction(f)}
CLASSES = {"System": whirlmap.System, "Settling": whirlmap.Settling}
METHODS = {f"{c}.{n}": f for c in CLASSES for n, f in vars(CLASSES[c]).items() if inspect.isfunction(f) and n[0] != "_"}
ALL = FUNCTIONS | PICTURES | METHODS
#: What is no algorithm needs no Notes.
PLAIN = {"labels"}
#: Functions that use a method with a name of its own, and who is to be cited.
CITED = {
    "correlation_dimension": {"grassberger1983", "theiler1986"}, "lyapunov_spectrum": {"benettin1980"},
    "floquet_multipliers": {"lust2001", "prince1981"}, "film_coefficients": {"lund1966"}, "ross_bearing": {"lund1966"},
    "campbell": {"childs1993"}, "unbalance_response": {"api617", "childs1993"}, "label_points": {"benettin1980"},
    "simulate": {"prince1981", "tsitouras2011", "kutta1901"},
    "diagnose": {"benettin1980", "gottwald2009", "das2017", "grassberger1983", "kaplan1979", "lust2001"},
    "diagnose_series": {"takens1981", "rosenstein1993", "kantz1994", "gottwald2009", "fraser1986", "kennel1992"},
    "section": {"parker1989"}, "attractors": {"parker1989"}, "power_spectrum": {"welch1967"},
}  # fmt: skip
#: Options of runs, which are described together, and those that a docstring hands on by `Those of ...`.
RUNS = {"settling", "lyapunov", "steps", "accuracy", "method", "workers", "progress"}
RUNS |= {"labelling", "integration", "execution", "storage"}
HANDED_ON = {"tolerance_sweep": {"on_chunk"}}


def parts(function):
    """Head of a docstring, and its sections by name."""
    doc = inspect.getdoc(function)
    found = SECTION.split(doc)
    return found[0].strip(), dict(zip(found[1::2], (text.strip("\n") for text in found[2::2]), strict=True))


def headers(text):
    """First lines of the entries of a section."""
    return [line for line in text.splitlines() if line and not line.startswith(" ")]


def signature(function):
    """Names of the parameters, and of those that ``**_given: Unpack[TypedDict]`` stands for."""
    plain, unpacked = [], set()
    for name, p in inspect.signature(inspect.unwrap(function)).parameters.items():
        of = typing.get_args(p.annotation)
        if p.kind is p.VAR_KEYWORD and of and typing.is_typeddict(of[0]):
            unpacked |= set(of[0].__annotations__)
        elif name != "self":
            plain.append(name)
    return plain, unpacked


@pytest.mark.parametrize("name", ALL)
def test_sections_parameters_and_errors(name):
    head, sections = parts(ALL[name])
    assert head.splitlines()[0].endswith("."), "the first line is a sentence"
    plain, unpacked = signature(ALL[name])
    entries = headers(sections.get("Parameters", ""))
    named = {n.strip().lstrip("*") for line in entries for n in line.split(" : ")[0].split(",")}
    assert {*plain} - RUNS - HANDED_ON.get(name, set()) <= named <= {*plain, *unpacked}
    assert inspect.signature(ALL[name]).return_annotation in (None, "None") or sections.get("Returns"), "no Returns"
    raised = {line.split(" ")[0] for line in headers(sections.get("Raises", ""))}
    home = vars(inspect.getmodule(inspect.unwrap(ALL[name])))
    for error in raised:
        kind = home.get(error) or getattr(errors, error, None) or getattr(builtins, error, None)
        assert isinstance(kind, type) and issubclass(kind, Exception), f"{error} is no error"
    code = ast.parse(textwrap.dedent(inspect.getsource(inspect.unwrap(ALL[name]))))
    calls = [n.exc.func for n in ast.walk(code) if isinstance(n, ast.Raise) and isinstance(n.exc, ast.Call)]
    assert {f.id for f in calls if isinstance(f, ast.Name)} <= raised


@pytest.mark.parametrize("name", FUNCTIONS)
def test_algorithms_say_how_and_whose_they_are(name):
    _, sections = parts(FUNCTIONS[name])
    assert sections.get("Raises"), "what a wrong argument leads to"
    assert sections.get("Notes") or name in PLAIN, "how it works and where it ends"
    keys = set(re.findall(r"\[([a-z][a-z-]*\d{2,4})\]", inspect.getdoc(FUNCTIONS[name])))
    assert keys <= set(references()), "keys of references.bib"
    assert CITED.get(name, set()) <= set(re.findall(r"\[([\w-]+)\]", sections.get("References", "")))


@pytest.mark.parametrize("name", CLASSES)
def test_classes_document_every_field_and_every_property(name):
    head, sections = parts(CLASSES[name])
    named = {n.strip() for line in headers(sections["Attributes"]) for n in line.split(" : ")[0].split(",")}
    assert head.splitlines()[0].endswith(".") and sections.get("Raises")
    assert named == set(CLASSES[name].__dataclass_fields__)
    for attribute, value in vars(CLASSES[name]).items():
        if attribute[0] != "_" and not isinstance(value, str | int | float | type(None)):
            assert (inspect.getdoc(value) or "").split("\n")[0].endswith("."), attribute
