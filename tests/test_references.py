"""One bibliography: complete entries, and no key anywhere that it does not have."""

import re
from itertools import product
from pathlib import Path

import pytest

import whirlmap
from whirlmap.cases import names, read
from whirlmap.errors import InputError, ModelError
from whirlmap.kernels.methods import METHODS
from whirlmap.models import FAMILIES
from whirlmap.references import key_of, reference, references

SOURCE = Path(whirlmap.__file__).parent


@pytest.mark.parametrize("key", references())
def test_every_entry_has_author_and_title_and_reads_as_one_line(key):
    entry = reference(key)
    assert entry.fields["author"] and entry.fields["title"]
    assert key == "changjian-psfd" or "year" in entry.fields
    assert "{" not in entry.text and "\n" not in entry.text and ".." not in entry.text
    assert entry.bibtex.startswith(f"@{entry.kind}{{{key},") and entry.bibtex.endswith("}")


def test_models_of_every_choice_of_switches_cite_known_keys():
    for family in FAMILIES.values():
        for choices in product(*family.switches.values()):
            try:
                model = family.model(**dict(zip(family.switches, choices, strict=True)))
            except ModelError:  # a combination that the family refuses
                continue
            assert model.sources, model.name
            assert set(model.sources) <= set(references()), model.name


def test_methods_cite_known_keys():
    assert {method.source for method in METHODS.values()} <= set(references())


def test_cases_cite_known_keys():
    for name in names():
        for given in read(name).given.values():
            if given.note.startswith("source:"):
                assert key_of(given.note) in references(), given.where


def test_docstrings_cite_known_keys():
    """Keys stand in brackets: a name, a year, perhaps a word."""
    for path in SOURCE.rglob("*.py"):
        for key in re.findall(r"\[([a-z]+(?:\d{4}[a-z]*|-psfd))\]", path.read_text(encoding="utf-8")):
            assert key in references(), f"{path}: [{key}]"


def test_an_unknown_key_gets_the_nearest_one():
    with pytest.raises(InputError, match=r"no key 'kuta1901'. Did you mean 'kutta1901'?"):
        reference("kuta1901")
