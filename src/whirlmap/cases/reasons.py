"""Reasons beside the numbers of a case, and whether they still apply: a changed number may be named in another's reason.

A case says why each number is what it is. Where a file that extends it, or a change by hand, gives another number, the
reasons that name that number were written for the old one.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from whirlmap.cases.entries import Given
from whirlmap.units import COMMON

#: Names that reasons use and no case gives, and the input that they are of: L/D is said of a bearing's radius.
OTHER_NAMES = {"D": "R"}
#: Letters from which on a name is also a word of the language, and meant where "=" follows alone.
WORD = 4
#: What written reasons begin with; all others say how a number came about and are always new.
WRITTEN = ("source: ", "assumed: ")


@dataclass(frozen=True)
class Mark:
    """What has changed since a number or its reason was written.

    Attributes
    ----------
    instead_of : str
        What the layers below say where a number has been changed by hand; empty otherwise.
    written_for : mapping of str to str
        Numbers that its reason names and that are others now: by name, as they were written then.
    """

    instead_of: str = ""
    written_for: Mapping[str, str] = field(default_factory=dict)


class History:
    """Every number that the layers of a case have given, in their order."""

    def __init__(self, shared: Mapping[str, Sequence[str]]) -> None:
        self.shared, self.given = shared, dict[str, list[tuple[int, Fraction | float, Given]]]()

    def add(self, layer: int, name: str, value: Fraction | float, given: Given) -> None:
        """Note what a layer gives."""
        self.given.setdefault(name, []).append((layer, value, given))

    def marks(self, gone: Iterable[str]) -> dict[str, Mark]:
        """Marks of the numbers that need one, by name; ``gone`` are those that a later layer replaced by something else."""
        gone, found = set(gone), {}
        for name, entries in self.given.items():
            layer, value, last = entries[-1]
            below = [given for _, old, given in entries[:-1] if old != value]
            by_hand = not last.note.startswith(WRITTEN)
            mark = Mark(
                below[-1].written if by_hand and below else "",
                {} if by_hand else {n: old for n in self._named(name, last.note) if (old := self._then(n, layer, gone))},
            )
            if mark != Mark():
                found[name] = mark
        return found

    def _then(self, name: str, layer: int, gone: set[str]) -> str:
        """What a number was in a layer, where it is another now; empty where it is the same, or was not given then."""
        entries = self.given[name]
        then = [(value, given) for number, value, given in entries if number <= layer]
        if not then:
            return ""
        value, given = then[-1]
        return given.written if name in gone or entries[-1][1] != value else ""

    def _named(self, name: str, text: str) -> list[str]:
        """Numbers of the case, other than ``name``, that a reason names."""
        found: dict[str, None] = {}
        for word, equals in re.findall(r"([A-Za-z]\w*)(\s*=)?", _without_units(text.partition(": ")[2])):
            if len(word) >= WORD and word.isalpha() and word.islower() and not equals:
                continue  # the rated speed, a limit: words of the language
            word = OTHER_NAMES.get(word, word)
            several = self.shared.get(word, ())
            place = next((i for names in self.shared.values() for i, n in enumerate(names) if n == name), None)
            if len(several) > 1 and place is not None and place < len(several):
                several = several[place : place + 1]  # the radius of bearing 2 in what is said of bearing 2
            found |= dict.fromkeys(n for n in (word, *several) if n in self.given and n != name)
        return list(found)


def _without_units(text: str) -> str:
    """A text without the units behind its numbers: the s of ``632.5 rad/s`` is no speed ratio."""
    return re.sub(r"(?<=\d)\s+([^\s,;:()]+)", lambda found: "" if found[1] in COMMON else found[0], text)
