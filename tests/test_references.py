"""One bibliography: complete entries, and no key anywhere that it does not have."""

import re
from itertools import combinations, product
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


def with_every_pair(switches):
    """The first and the last choices of all switches, and those with each pair of other choices: not all products."""
    yield {}
    for at in (0, -1):
        base = {name: choices[at] for name, choices in switches.items()}
        for one, other in combinations(switches, 2):
            yield from (base | {one: a, other: b} for a, b in product(switches[one], switches[other]))


def test_models_of_every_pair_of_choices_cite_known_keys():
    for family in FAMILIES.values():
        for choices in {tuple(c.items()): c for c in with_every_pair(family.switches)}.values():
            try:
                model = family.model(**choices)
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
