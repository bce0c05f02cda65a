"""The bibliography: one file, whose keys models, cases, methods and results use."""

import re
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from whirlmap.errors import InputError, nearest

BIBLIOGRAPHY = Path(__file__).with_name("references.bib")

_FIELD = re.compile(r"^\s*(\w+)\s*=\s*\{(.*)\},?\s*$")
_ACCENTS = {
    r"{\o}": "ø", r'{\"a}': "ä", r'{\"o}': "ö", r'{\"u}': "ü", r'{\"O}': "Ö", "--": "–", r"\&": "&",
    "{": "", "}": "",
}  # fmt: skip


@dataclass(frozen=True)
class Reference:
    """One entry of the bibliography.

    Attributes
    ----------
    key : str
    kind : str
        BibTeX's kind: ``article``, ``book``, ``misc``.
    fields : mapping of str to str
        As written.
    bibtex : str
        The entry as it stands in the file.
    """

    key: str
    kind: str
    fields: dict[str, str]
    bibtex: str

    @property
    def text(self) -> str:
        """The reference in one line for people: authors, title, place, year."""
        f = {name: _plain(value) for name, value in self.fields.items()}
        place = f.get("journal") or f.get("booktitle") or f.get("publisher") or f.get("howpublished") or ""
        if "volume" in f:
            place += f" {f['volume']}"
        if "pages" in f:
            place += f", {f['pages']}"
        parts = [f["author"].replace(" and ", "; ").removesuffix("."), f["title"], place, f.get("year", "")]
        return ". ".join(part for part in parts if part) + "."


@lru_cache(maxsize=1)
def references() -> dict[str, Reference]:
    """Every entry of the bibliography, by key.

    The file keeps to one field per line, so that no BibTeX parser is needed.
    """
    found: dict[str, Reference] = {}
    text = BIBLIOGRAPHY.read_text(encoding="utf-8")
    for block in re.split(r"(?m)^(?=@)", text):
        head = re.match(r"@(\w+)\{([^,\s]+),", block)
        if not head:
            continue
        if head[2] in found:
            raise InputError(f"{BIBLIOGRAPHY.name} has the key {head[2]!r} twice")
        fields = {m[1].lower(): m[2] for line in block.splitlines()[1:] if (m := _FIELD.match(line))}
        found[head[2]] = Reference(head[2], head[1].lower(), fields, block.strip())
    return found


def reference(key: str) -> Reference:
    """Return the entry of that key, or raise `InputError` with the nearest one."""
    if key not in references():
        raise InputError(f"the bibliography has no key {key!r}.{nearest(key, references())}")
    return references()[key]


def key_of(source: str) -> str:
    """Key at the beginning of a source, ``"changjian-psfd, Figure 6"``."""
    return source.removeprefix("source:").split(",")[0].strip()


def _plain(value: str) -> str:
    for written, shown in _ACCENTS.items():
        value = value.replace(written, shown)
    return value
