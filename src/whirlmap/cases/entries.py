"""The form of a case file: what each entry must say, checked by pydantic, reported as one sentence."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, ValidationInfo, model_validator

from whirlmap.equations.names import CASE_KEYS
from whirlmap.errors import CaseError, nearest
from whirlmap.units import example

Text = Annotated[str, Field(min_length=1)]

#: Keys of a case file that are not entries.
RESERVED = CASE_KEYS


#: Origin of a number of a model of one's own that says none.
NO_SOURCE = "no source given"


@dataclass(frozen=True)
class Given:
    """A number as it was written.

    Attributes
    ----------
    name : str
        Symbol of a parameter or of a dimensional input.
    value : number or str
        As written; decimals of a file are not floats yet.
    unit : str or None
        As written; None where absent or part of ``value``.
    note : str
        ``"source: ..."``, ``"assumed: ..."``, ``"no source given"`` or ``"set by the user"``.
    place : str
        File and line, empty for a change that was asked for by hand.
    only : mapping of str to str
        Switches for which the entry counts.
    """

    name: str
    value: int | float | Decimal | Fraction | str
    unit: str | None = None
    note: str = "set by the user"
    place: str = ""
    only: Mapping[str, str] = field(default_factory=dict)

    @property
    def written(self) -> str:
        """The value with its unit, as written."""
        return f"{self.value} {self.unit}" if self.unit and self.unit != "1" else str(self.value)

    @property
    def where(self) -> str:
        """Beginning of a message about this entry."""
        return f"{self.place}: {self.name}" if self.place else self.name


class Entry(BaseModel):
    """One entry of a case file."""

    model_config = ConfigDict(extra="forbid", strict=True)

    value: int | Annotated[Decimal, Field(allow_inf_nan=True)] | Text
    unit: Text | None = None
    source: Text | None = None
    assumed: Text | None = None
    only: dict[str, str] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _one_origin(self, info: ValidationInfo) -> "Entry":
        if info.context and self.source is self.assumed is None:  # of a model of one's own
            return self
        if (self.source is None) == (self.assumed is None):
            both = "both" if self.source else "neither"
            raise ValueError(f"found {both} of 'source' and 'assumed', expected exactly one of them")
        return self


class Header(BaseModel):
    """What a case file says beside its entries."""

    model_config = ConfigDict(extra="forbid", strict=True)

    model: Text | None = None
    extends: Text | None = None
    description: str = ""
    start: dict[str, int | Annotated[Decimal, Field(allow_inf_nan=True)] | str] = Field(default_factory=dict)
    switches: dict[str, Text] = Field(default_factory=dict)


def header(file: str, text: str, table: Mapping[str, Any]) -> Header:
    """Check the keys of a case file that are not entries."""
    found = {key: value for key, value in table.items() if key in RESERVED}
    try:
        return Header(**found)
    except ValidationError as error:
        problem = error.errors()[0]
        key = str(problem["loc"][0])
        raise CaseError(f"{place(file, text, key)}: {key}: {_sentence(problem, found)}") from None


def given(file: str, text: str, name: str, table: Any, unit: str = "1", *, own: bool = False) -> Given:
    """Check one entry of a case file.

    Parameters
    ----------
    unit : str
        Unit of the quantity, for the example in a message.
    own : bool
        Whether the case is of a model of one's own: its numbers may stand there plainly, and need no source.

    Raises
    ------
    CaseError
        Naming file, line, key, what was found and what was expected.
    """
    where = place(file, text, name)
    if own and not isinstance(table, Mapping | list | bool):
        table = {"value": table}
    if not isinstance(table, Mapping):
        raise CaseError(
            f"{where}: {name}: found {_shown(table)}, expected {'a number, or ' if own else ''}an entry such as"
            f" {name} = {{ {_example(unit)}, assumed = \"why\" }} or with source = \"key, place\""
        )
    try:
        entry = Entry.model_validate(table, context=own)
    except ValidationError as error:
        raise CaseError(f"{where}: {name}: {_sentence(error.errors()[0], table)}") from None
    note = f"source: {entry.source}" if entry.source else f"assumed: {entry.assumed}" if entry.assumed else NO_SOURCE
    return Given(name, entry.value, entry.unit, note, where, entry.only)


def _example(unit: str) -> str:
    value, _, written = example(unit).partition(" ")
    return f'value = {value}, unit = "{written}"' if written else f"value = {value}"


def toml_fault(text: str, problem: str) -> str:
    """Say what is wrong with a text that is not TOML; a key that is given twice is named, with both lines."""
    at, lines = re.search(r"line (\d+)", problem), text.splitlines()
    if not ("overwrite" in problem or "Cannot declare" in problem):
        return f"is not valid TOML: {problem}{_toml_hint(lines[int(at[1]) - 1] if at and int(at[1]) <= len(lines) else '')}"
    again = min(int(at[1]), len(lines)) if at else len(lines)
    key, table = _key(lines[again - 1]), lines[again - 1].lstrip().startswith("[")
    for number in range(again - 1, 0, -1):
        other = lines[number - 1].lstrip().startswith("[")
        if other == table and _key(lines[number - 1]) == key:
            what = f"table [{key}]" if table else f"key {key!r}"
            return f"found the {what} twice, in lines {number} and {again}; expected it once"
        if other and not table:
            break  # above it stands another table, where the key may come too
    return f"is not valid TOML: {problem}; a switch and a table of the same name: write the switch in a table [switches]"


def _toml_hint(line: str) -> str:
    """What people write in other files, and TOML does not take."""
    if found := re.search(r"=\s*([-+]?\d+),(\d+)", line):
        return f"; numbers have a decimal point, {found[1]}.{found[2]}"
    if found := re.search(r"""=\s*([A-Za-z][\w./-]*)""", line):
        return f'; text stands in quotes, "{found[1]}"'
    if "{" in line:
        return "; what stands in { } is separated by commas, on one line"
    return ""


def _key(line: str) -> str:
    found = re.match(r"""\s*\[?\s*["']?([\w-]+)["']?\s*(?:=|\])""", line)
    return found[1] if found else ""


def place(file: str, text: str, key: str) -> str:
    """Name the file and, where the key can be found in its text, the line."""
    start = rf"""^[ \t]*(?:\[\s*)?["']?{re.escape(key)}["']?\s*(?:=|\.|\])"""
    found = re.search(start, text, re.MULTILINE)
    return f"{file}, line {text.count(chr(10), 0, found.start()) + 1}" if found else file


def _sentence(problem: Any, table: Mapping[str, Any]) -> str:
    key = str(problem["loc"][0]) if problem["loc"] else ""
    if problem["type"] == "extra_forbidden":
        known = list(Entry.model_fields)
        return f"found the unknown key {key!r}, expected one of {', '.join(known)}.{nearest(key, known)}"
    if problem["type"] == "missing":
        other = [name for name in table if name.casefold() == key]
        return f"found no {key!r}{f' but {other[0]!r}' if other else ''}, expected {key} = a number"
    if problem["type"] == "value_error":
        return str(problem["ctx"]["error"])
    expected = "a number, or text such as '50 um' or '1/4'" if key == "value" else "text that is not empty"
    if len(problem["loc"]) > 1 and key != "value":
        expected = f"{problem['loc'][1]} = a value"
    return f"found {key} = {_shown(table.get(key))}, expected {expected}"


def _shown(value: Any) -> str:
    return str(value) if isinstance(value, Decimal) else repr(value)
