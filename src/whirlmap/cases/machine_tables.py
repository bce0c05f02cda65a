"""Tables of a machine's parts: what each may say, its numbers with their units, and where it stands in the file."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Any

from whirlmap.cases.entries import NO_SOURCE, Given
from whirlmap.cases.machine_hints import hint
from whirlmap.errors import CaseError, nearest
from whirlmap.machines.fields import Choice, Field, Number, Other, Station, Text
from whirlmap.units import example, read

#: Keys of a number that says where it comes from.
ENTRY = ("value", "unit", "source", "assumed")
#: What a part can be called: names are part of symbols.
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


@dataclass(frozen=True)
class Source:
    """A case file and its text."""

    file: str
    text: str

    def line(self, kind: str, name: str, key: str) -> tuple[int, bool] | None:
        """Line of a key in the table of a part, or of the head of that table, and whether it is that of the key."""
        found = None
        for head, lines in self._blocks():
            if head == kind and (
                not name or any(re.match(rf"""\s*name\s*=\s*["']{re.escape(name)}["']""", t) for _, t in lines)
            ):
                of_key = next((n for n, t in lines if re.match(rf"\s*{re.escape(key)}\s*[=.]", t)), None)
                found = (of_key or lines[0][0], of_key is not None)
        return found

    def _blocks(self) -> Iterable[tuple[str, list[tuple[int, str]]]]:
        """Heads of tables, and their numbered lines with that of the head."""
        head, lines = "", list[tuple[int, str]]()
        for number, text in enumerate(self.text.splitlines(), start=1):
            if opened := re.match(r"\s*\[\[?\s*([\w.]+)\s*\]", text):
                if lines:
                    yield head, lines
                head, lines = opened[1], []
            lines.append((number, text))
        if lines:
            yield head, lines


@dataclass
class PartTable:
    """One table of a machine file.

    Attributes
    ----------
    kind, name : str
        ``bearing`` and ``drive_end``; a table that stands once has no name.
    values : mapping
        As TOML has them.
    sources : sequence of Source
        The file, and those that it extends, the nearest first.
    """

    kind: str
    name: str
    values: Mapping[str, Any]
    sources: Sequence[Source]
    single: bool = False
    numbers: dict[str, Given] = field(default_factory=dict)
    fixed: dict[str, float] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)

    def where(self, key: str = "") -> str:
        """File, line, table and key, for a message."""
        found = [(one, line) for one in self.sources if (line := one.line(self.kind, self.name, key or "name")) is not None]
        found.sort(key=lambda pair: not pair[1][1])  # the nearest file that has the key, before one that has its table
        at = f"{found[0][0].file}, line {found[0][1][0]}" if found else self.sources[0].file
        table = f"[{self.kind}]" if self.single else f"[[{self.kind}]]"
        return f"{at}: {table}{f' {self.name}' if self.name else ''}{f': {key}' if key else ''}"

    def fault(self, key: str, message: str) -> CaseError:
        """An error at a key of this table."""
        return CaseError(f"{self.where(key)}: {message}")

    def take(self, fields: Sequence[Field], both: Mapping[str, Sequence[str]] | None = None) -> None:
        """Read all keys by their fields; ``both`` are keys that stand for several.

        Raises
        ------
        CaseError
            An unknown key, a missing one, one that is given twice, a number without its unit or beyond its limits, a word
            that is no choice.
        """
        known = {one.key: one for one in fields}
        for key, value in self.values.items():
            for real in (both or {}).get(key, (key,)):
                if real not in known:
                    raise self.fault(key, f"found the unknown key {key!r}, expected one of"
                                          f" {', '.join(self._keys(known, both))}."
                                     f"{hint(key, fields, self._keys(known, both))}")  # fmt: skip
                if real != key and real in self.values:
                    raise self.fault(key, f"found {real} given twice, once by {key}; expected it once")
                self._one(key, known[real], value)
        for one in fields:
            if getattr(one, "required", False) and not self.has(one.key):
                short = next((k for k, many in (both or {}).items() if one.key in many), one.key)
                meaning = one.meaning.removesuffix(" along x").removesuffix(" along y")
                raise self.fault("", f"found no {short}, expected {_example(short, one)} ({meaning})")

    @staticmethod
    def _keys(known: Iterable[str], both: Mapping[str, Sequence[str]] | None) -> list[str]:
        hidden = {k for many in (both or {}).values() for k in many}
        return [*(k for k in known if k not in hidden), *(both or {})]

    def has(self, key: str) -> bool:
        """Whether a key is given."""
        return key in self.numbers or key in self.fixed or key in self.texts or key in self.values

    def _one(self, key: str, one: Field, value: Any) -> None:
        if isinstance(one, Number):
            given = self.number(key, one, value)
            if one.fixed:
                self.fixed[one.key] = float(read(given.value, one.unit, given=given.unit))
            else:
                self.numbers[one.key] = given
        elif isinstance(one, Choice):
            if value not in one.choices:
                raise self.fault(
                    key, f"found {value!r}, expected one of {' | '.join(one.choices)}.{nearest(str(value), one.choices)}"
                )
            self.texts[one.key] = value
        elif isinstance(one, Text):
            if not isinstance(value, str) or not value:
                raise self.fault(key, f"found {value!r}, expected a name in quotes ({one.meaning})")
            self.texts[one.key] = value
        else:
            assert isinstance(one, Station | Other)  # read by a rule of its own

    def number(self, key: str, one: Number, value: Any) -> Given:
        """Read a number with its unit: ``"70 um"``, or a table with value, unit and where it comes from."""
        unit, note = None, NO_SOURCE
        if isinstance(value, Mapping):
            for name in value:
                if name not in ENTRY:
                    raise self.fault(
                        key, f"found the unknown key {name!r}, expected one of {', '.join(ENTRY)}.{nearest(name, ENTRY)}"
                    )
            if "value" not in value:
                raise self.fault(key, f"found no 'value', expected {_example(one.key, one)}")
            if "source" in value and "assumed" in value:
                raise self.fault(key, "found both 'source' and 'assumed', expected one of them")
            unit = value.get("unit")
            note = next((f"{name}: {value[name]}" for name in ("source", "assumed") if name in value), NO_SOURCE)
            value = value["value"]
        if isinstance(value, bool) or not isinstance(value, str | int | float | Decimal):
            raise self.fault(key, f"found {value!r}, expected {_example(one.key, one)}")
        if not isinstance(value, str) and unit is None and one.unit not in ("1",):
            raise self.fault(
                key, f"found {value} without a unit, expected one, as in {_example(one.key, one)} ({one.meaning})"
            )
        try:
            exact = read(value, one.unit, given=unit)
        except CaseError as error:
            raise self.fault(key, f"{error} ({one.meaning})") from None
        declared = one.parameter(f"{self.kind}.{self.name}" if self.name else self.kind)
        fault = declared.fault(float(exact))
        if not fault and declared.order and exact.denominator != 1:
            fault = "must be a whole number"
        if fault:
            raise self.fault(key, f"found {value}{f' {unit}' if unit else ''}, which {fault} ({one.meaning})")
        return Given(declared.name, value, unit, note, self.where(key))

    def needs(self, keys: Iterable[str], why: str, fields: Sequence[Field]) -> None:
        """Refuse a table that lacks what a choice needs."""
        known = {one.key: one for one in fields}
        for key in keys:
            if not self.has(key):
                raise self.fault(
                    "", f"found no {key}, expected {_example(key, known[key])} ({known[key].meaning}) with {why}"
                )

    def whole(self, key: str, least: int, default: int) -> int:
        """A count."""
        value = self.values.get(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or value < least:
            raise self.fault(key, f"found {value!r}, expected a whole number, at least {least}")
        return value


def _example(key: str, one: Any) -> str:
    unit = getattr(one, "unit", None)
    if unit is None:
        return f'{key} = "..."'
    text = example(unit)
    return f'{key} = "{text}"' if unit != "1" else f"{key} = {text}"


def defaults(fields: Sequence[Field]) -> dict[str, str]:
    """Choices of a table that says none."""
    return {one.key: one.choices[0] for one in fields if isinstance(one, Choice)}
