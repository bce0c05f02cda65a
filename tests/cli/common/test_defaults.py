"""What holds where nothing is said is the same in Python and on the command line."""

import inspect
from dataclasses import fields

import pytest
import typer

import whirlmap
from whirlmap.cli import main
from whirlmap.options.computed import Integration, Labelling, Settling
from whirlmap.options.execution import Execution
from whirlmap.options.storage import Storage

COMMANDS = {name: main.loaded(name).callback for name in main.COMMANDS}
#: Commands, the functions that they stand for, and options with another name there.
FUNCTIONS = {
    "simulate": ("simulate", {}), "diagnose": ("diagnose", {"exponents": "exponent_count"}),
    "bifurcation": ("bifurcation_diagram", {}), "map": ("regime_map", {}), "attractors": ("attractors", {}),
    "basins": ("basins", {}), "speeds": ("safe_speeds", {}), "improve": ("improve", {}), "campbell": ("campbell", {}),
    "continue": ("continue_orbit", {}),
}  # fmt: skip
#: Options that have nothing to do with a keyword of the same name, or whose default is text that stands for it.
APART = {("improve", "limit"), ("speeds", "limit"), ("diagnose", "time"), ("continue", "resume")}


def defaults(function):
    shown = {n: p.default for n, p in inspect.signature(function).parameters.items() if p.default is not p.empty}
    return {n: d.default if isinstance(d, typer.models.ParameterInfo) else d for n, d in shown.items()}


def python_defaults(name):
    """Keywords of a function with their defaults, parts of options with those of the values."""
    found = defaults(getattr(whirlmap, name))
    for kind in (Settling, Integration, Labelling, Execution, Storage):
        held = kind.__name__.lower()
        if held in found or (kind is Settling and "labelling" in found) or (kind is Integration and "labelling" in found):
            value = found.get(held) or kind()
            found |= {f.name: getattr(value, f.name) for f in fields(kind) if f.name not in ("settling", "integration")}
    return found


@pytest.mark.parametrize("command", FUNCTIONS)
def test_defaults_are_those_of_python(command):
    name, renamed = FUNCTIONS[command]
    ours, theirs = defaults(COMMANDS[command]), python_defaults(name)
    both = {option: (ours[option], theirs[renamed.get(option, option)]) for option in ours
            if renamed.get(option, option) in theirs and (command, option) not in APART}  # fmt: skip
    assert "workers" in both or command == "campbell"
    assert {option: pair for option, pair in both.items() if pair[0] != pair[1]} == {}


def test_every_command_that_computes_is_compared():
    """A new one stands in the list above, or computes nothing of a system."""
    others = {"cases", "recipes", "show", "new", "linear", "reproduce", "identify", "cache", "bench", "explore"}
    assert set(COMMANDS) - others == set(FUNCTIONS)


@pytest.mark.parametrize("command", [c for c in FUNCTIONS if c not in ("campbell", "simulate")])
def test_commands_that_label_have_all_options_of_it(command):
    missing = {"transient", "most", "tolerance", "lyapunov", "steps", "accuracy", "method", "workers"} - set(
        inspect.signature(COMMANDS[command]).parameters
    )
    assert not missing
