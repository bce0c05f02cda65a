"""The site of the documentation: what its generated pages and its gallery hold. `make docs` builds and checks the pages."""

import ast
import re
from importlib import import_module
from inspect import isroutine, signature
from pathlib import Path

import pytest

import case_keys
import command_pages
import result_tables
import small_results
import whirlmap
from whirlmap import equations, errors, plot
from whirlmap.cases import names, read
from whirlmap.cli.main import COMMANDS, loaded

DOCS = Path(__file__).parents[2] / "docs"
API = re.findall(r"^   (whirlmap[\w.]+)$", (DOCS / "reference" / "api.md").read_text(encoding="utf-8"), re.MULTILINE)
GALLERY = sorted((DOCS / "gallery").glob("plot_*.py"))
#: What the page on Python says in its text, without a page of its own.
IN_TEXT = {"whirlmap.__version__", "whirlmap.plot"}


def public(module):
    """Names of a module that are whirlmap's own: classes and functions, no suggestions of names."""
    return {
        f"{module.__name__}.{name}"
        for name, value in vars(module).items()
        if name[0] != "_" and getattr(value, "__module__", "").startswith("whirlmap")
    }


def _words(text):
    """Text without the marks of code, on one line."""
    return " ".join(text.replace("`", "").replace("\\|", "|").split())


@pytest.mark.parametrize("name", API)
def test_every_name_on_the_page_can_be_imported(name):
    module, _, attribute = name.rpartition(".")
    assert getattr(import_module(module), attribute).__doc__


def test_every_public_name_is_on_the_page_once():
    assert len(API) == len(set(API))
    wanted = {f"whirlmap.{name}" for name in whirlmap.__all__} - IN_TEXT
    kinds = {f"whirlmap.errors.{n}" for n, v in vars(errors).items() if isinstance(v, type) and issubclass(v, Exception)}
    assert wanted | public(plot) | public(equations) | kinds <= set(API)


def test_the_page_of_commands_has_every_option_with_its_help():
    page = command_pages.commands()
    for name in COMMANDS:
        section = page.partition(f"## whirlmap {name}\n")[2].partition("\n## ")[0]
        for p in loaded(name).params:
            spelt = p.opts[0] if p.param_type_name == "option" else p.metavar.replace("|", "\\|")  # within a table
            assert f"`{spelt}" in section, (name, p.name)
            assert _words(p.help) in _words(section), (name, p.name)


def test_the_page_of_case_files_has_every_key_that_stock_cases_have():
    text = case_keys.entry_keys() + case_keys.models() + case_keys.machine_tables()
    for name in names():
        case = read(name)
        for key in (*case.given, *case.switches):
            assert f"`{key.rpartition('.')[2]}`" in text, (name, key)


def test_nothing_that_returns_a_dataset_or_prints_json_is_missing_in_the_reference():
    functions = {name: value for name in whirlmap.__all__ if isroutine(value := getattr(whirlmap, name))}
    returned = {name: str(signature(value).return_annotation) for name, value in functions.items()}
    found = {name for name, kind in returned.items() if kind.endswith(("Dataset'>", "Dataset"))}
    assert found == set(small_results.datasets())
    printing = {name for name in COMMANDS if any("--json" in p.opts for p in loaded(name).params)}
    assert printing - set(small_results.TOO_LONG) == {name.split()[0] for name in small_results.COMMANDS}


@pytest.mark.slow  # every command and every function that returns a Dataset, once
def test_everything_in_results_has_a_meaning():
    for command in small_results.COMMANDS:
        for key in small_results.printed(command):
            assert result_tables.meaning(command, key)
    page = result_tables.datasets()
    assert all(f"`whirlmap.{name}`" in page for name in small_results.datasets())


def test_the_gallery_is_large_enough():
    assert len(GALLERY) >= 15


@pytest.mark.parametrize("path", GALLERY, ids=lambda path: path.stem)
def test_scripts_say_what_to_look_at_and_use_public_names_alone(path):
    code = ast.parse(path.read_text(encoding="utf-8"))
    text = ast.get_docstring(code)
    assert re.match(r".+\n=+\n\n\S", text) and "**What to look at:**" in text
    imported = [n.module for n in ast.walk(code) if isinstance(n, ast.ImportFrom)]
    assert {m for m in imported if m.startswith("whirlmap")} <= {"whirlmap", "whirlmap.equations"}
    assert "_figure(" in path.read_text(encoding="utf-8") or "draw_" in path.read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("path", GALLERY, ids=lambda path: path.stem)
def test_scripts_run(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile(path.read_text(encoding="utf-8"), str(path), "exec"), {})
