"""Case files: finding, reading and merging them.

A case is a TOML file::

    model = "gear_pair"                      # a stock model, or "my_rotor.py:MY_ROTOR" beside this file
    extends = "gear-psfd/machine"            # optional: a stock case, or a path relative to this file
    description = "what it is"
    edition = "intended"                     # switches of the model; also in a table [switches]
    m_p = { value = 10, unit = "kg", assumed = "why" }
    psi = { value = 1e-3, source = "key of references.bib, place" }
    k   = { value = 20, assumed = "why", only = { rotor = "flexible" } }
    [bearings]                               # optional: tables that group the entries of a machine
    R = { value = 25, unit = "mm", source = "drawing" }   # R_1 and R_2, which have the same value
    start = { x = 0.1 }                      # optional start state

A case of a model of one's own may also say ``zeta = 0.05`` or ``c = "50 um"``: numbers without a source.

What a file says replaces what the file that it extends says.
"""

import hashlib
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from decimal import Decimal
from pathlib import Path
from typing import Any

from whirlmap.cases import entries, origin
from whirlmap.cases.entries import Given, place
from whirlmap.cases.machine_file import MachineCase, read_machine
from whirlmap.cases.machine_merge import merged
from whirlmap.cases.machine_tables import Source
from whirlmap.equations.family import Family
from whirlmap.errors import CaseError, nearest
from whirlmap.results.listing import Listed, Listing, Rows
from whirlmap.units import read as read_number

STOCK = Path(__file__).parent

Layer = Mapping[str, Given]


@dataclass(frozen=True, repr=False)
class Case(Listed):
    """A case as written, before units are converted.

    Attributes
    ----------
    name : str
        Name of a stock case, or the path as it was asked for.
    path : Path or None
        The file; None for a case made in memory.
    family : Family
        The models that the case's switches choose from.
    description : str
        For people.
    switches : mapping of str to str
        Switches that the case sets; the others keep the family's defaults.
    layers : tuple of mapping of str to Given
        What each file says, the file that is extended first.
    start : mapping of str to float
        Start values that the case sets.
    digest : str
        SHA-256 of the text of the files, which says more than converted floats could.
    own : bool
        Whether the model is the user's own.
    parts : MachineCase, optional
        Of a machine that is described by its parts.
    """

    name: str
    path: Path | None
    family: Family
    description: str = ""
    switches: Mapping[str, str] = field(default_factory=dict)
    layers: tuple[Layer, ...] = ()
    start: Mapping[str, float] = field(default_factory=dict)
    digest: str = ""
    own: bool = False
    parts: MachineCase | None = None

    @property
    def given(self) -> dict[str, Given]:
        """Every number that the case gives, by name."""
        return {name: given for layer in self.layers for name, given in layer.items()}

    def listing(self) -> Listing:
        """What it says, for a terminal and a notebook."""
        rows = [(name, given.written, given.note) for name, given in self.given.items()]
        return Listing(
            f"Case {self.name}: model {self.family.name}",
            [self.description],
            [Rows("Entries", ("name", "as written", "where it comes from"), rows)],
        )


def names() -> list[str]:
    """Names of the stock cases."""
    return sorted(path.relative_to(STOCK).with_suffix("").as_posix() for path in STOCK.rglob("*.toml"))


def read(name: str | Path) -> Case:
    """Read a case by its name, or by the path of a TOML file.

    Raises
    ------
    CaseError
        No such case; a file that cannot be read, is not TOML, extends itself, or holds an unknown or
        incomplete entry. The message names the file, the line where it can be found, the key, what was found
        and expected.
    """
    path, known = _locate(name, Path())
    return _read(path, known, ())


def _locate(name: str | Path, folder: Path, where: str = "") -> tuple[Path, str]:
    text = str(name)
    if text in names():
        return STOCK / f"{text}.toml", text
    path = folder / Path(text).expanduser()
    if path.suffix == ".toml":
        if not path.is_file():
            reason = "is not a file" if path.exists() else "does not exist"
            raise CaseError(f"{where}case file {path} {reason}")
        return path, text
    raise CaseError(
        f"{where}there is no case {text!r}.{_meant(text, path)}\n  cases: {', '.join(names())};"
        " or the path of a file that ends in .toml"
    )


def _meant(text: str, path: Path) -> str:
    """Suggest a case or a file for a name that is neither."""
    if path.with_name(f"{path.name}.toml").is_file():
        return f" Did you mean the file '{text}.toml'?"
    ends = [name for name in names() if name.rpartition("/")[2].casefold() == text.casefold()]
    begins = [name for name in names() if len(text) > 2 and text.casefold() in name.casefold()]
    same = ends or ([] if nearest(text, names()) else begins)
    return f" Did you mean {' or '.join(repr(name) for name in same[:3])}?" if same else nearest(text, names())


def _read(path: Path, name: str, above: tuple[Path, ...]) -> Case:
    if path.resolve() in above:
        raise CaseError(f"{path}: extends itself, by way of {' -> '.join(str(p) for p in above)}")
    raw, table = _parse(path)
    file = str(path)
    head = entries.header(file, raw, table)
    base = None
    if head.extends:
        where = place(file, raw, "extends")
        below, known = _locate(head.extends, path.parent, f"{where}: extends: ")
        base = _read(below, known, (*above, path.resolve()))
    if head.model == "machine" or (base and base.parts and not head.model):
        return _machine(path, name, raw, table, head, base)
    if head.model:
        family = origin.find(head.model, path.parent, place(file, raw, "model"))
        if base and base.family.name != family.name:
            raise CaseError(
                f"{place(file, raw, 'model')}: model: found {family.name!r}, expected {base.family.name!r},"
                f" the model of {base.name}, which this case extends"
            )
    elif base:
        family = base.family
    else:
        raise CaseError(f'{file}: found no model, expected model = "..." or extends = "..."')
    told = head.description
    if not told and base and base.description:
        told = f"extends {base.name}: {base.description}"  # which says the numbers of that case
    own = base.own if base else ".py" in (head.model or "")
    switches, layer = _body(file, raw, table, head.switches, family, own=own)
    digest = hashlib.sha256(raw.encode()).hexdigest()
    if not base:
        base = Case(name, path, family, digest="")
    return Case(
        name=name,
        path=path,
        family=family,
        description=" ".join(told.split()),
        switches={**base.switches, **switches},
        layers=(*base.layers, layer),
        start={**base.start, **start_values(head.start, place(file, raw, "start") + ": start")},
        digest=hashlib.sha256((base.digest + digest).encode()).hexdigest() if base.digest else digest,
        own=own,
    )


def _machine(
    path: Path, name: str, raw: str, table: Mapping[str, Any], head: entries.Header, base: Case | None
) -> Case:
    """A machine from parts; what it says of a part replaces what the file says that it extends."""
    if base and not base.parts:
        raise CaseError(
            f"{place(str(path), raw, 'extends')}: extends: found {base.name}, a case of {base.family.name}; expected"
            " a machine from"
            " parts"
        )
    sources, digest = [Source(str(path), raw)], hashlib.sha256(raw.encode()).hexdigest()
    told = head.description
    if base and base.parts:
        table, sources = merged(base.parts.raw, table), [*sources, *base.parts.sources]
        digest = hashlib.sha256((base.digest + digest).encode()).hexdigest()
        told = told or f"extends {base.name}: {base.description}"
    parts = read_machine(table, sources)
    return Case(
        name=name,
        path=path,
        family=parts.family,
        description=" ".join(told.split()),
        layers=(parts.layer,),
        start={**(base.start if base else {}), **start_values(head.start, place(str(path), raw, "start") + ": start")},
        digest=digest,
        parts=parts,
    )


def with_parts(case: Case, changes: Mapping[str, Any]) -> tuple[Case, dict[str, Any]]:
    """A machine with those changes that need another declaration, and the changes that are left.

    Raises
    ------
    CaseError
        As `read` for what is changed.
    """
    if case.parts is None:
        return case, dict(changes)
    parts, left = case.parts.changed(changes)
    if parts is case.parts:
        return case, left
    return replace(case, family=parts.family, layers=(parts.layer,), parts=parts), left


def _parse(path: Path) -> tuple[str, dict[str, Any]]:
    try:
        text = path.read_bytes().decode("utf-8-sig")  # editors of Windows begin a file with a mark
        return text, tomllib.loads(text, parse_float=Decimal)
    except OSError as error:
        raise CaseError(f"{path}: cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise CaseError(f"{path}: is not text in UTF-8, expected a TOML file") from None
    except tomllib.TOMLDecodeError as error:
        raise CaseError(f"{path}: {entries.toml_fault(text, str(error))}") from None
    except (ValueError, RecursionError, ArithmeticError) as error:  # endless numbers or nesting
        raise CaseError(f"{path}: cannot be read as TOML: {error}") from None


def _body(
    file: str, raw: str, table: Mapping[str, Any], chosen: Mapping[str, str], family: Family, *, own: bool
) -> tuple[dict[str, str], dict[str, Given]]:
    """Switches and entries of a file. Which entries the model reads depends on the switches: see `resolve`."""
    switches: dict[str, str] = {}
    layer: dict[str, Given] = {}
    for key, value in (*table.items(), *chosen.items()):
        if key in entries.RESERVED:
            continue
        sections = family.groups.sections if family.groups else {}
        grouped = isinstance(value, Mapping) and value and all(isinstance(v, Mapping) for v in value.values())
        if grouped or (key in sections and isinstance(value, Mapping)):
            for name, entry in _section(file, raw, key, value, family).items():
                _put(layer, entries.given(file, raw, name, entry, _unit(family, name), own=own), family)
            continue
        if key in family.switches:
            if value not in family.switches[key]:
                raise CaseError(
                    f"{place(file, raw, key)}: {key}: found {value!r}, expected one of"
                    f" {' | '.join(family.switches[key])}.{family.hint_of_choice(key, value)}"
                )
            switches[key] = value
            continue
        if isinstance(value, str) and not own:  # text is a switch or a heading; a number without braces is a short entry
            known = [*entries.RESERVED, *family.switches]
            raise CaseError(
                f"{place(file, raw, key)}: found the unknown key {key!r} = {value!r}, expected one of"
                f" {', '.join(known)}, or an entry.{family.hint(key, known, value)}"
            )
        _put(layer, entries.given(file, raw, key, value, _unit(family, key), own=own), family)
    return switches, layer


def _unit(family: Family, name: str) -> str:
    """Unit of a dimensional input of a family, also under the name that several share; 1 for anything else."""
    groups = family.groups
    found = groups.input(groups.shared.get(name, (name,))[0]) if groups else None
    return found.unit if found else "1"


def _section(file: str, raw: str, section: str, table: Mapping[str, Any], family: Family) -> Mapping[str, Any]:
    """Entries of one table of a case file, each in the table where it belongs."""
    known = family.groups.sections if family.groups else {}
    if section not in known:
        allowed = f"one of {', '.join(known)}" if known else f"none: the model {family.name} has no dimensional inputs"
        raise CaseError(
            f"{place(file, raw, section)}: found the unknown table [{section}], expected {allowed}."
            f"{family.hint(section, known)}"
        )
    for name in table:
        tables = [t for t, names in known.items() if name in names]
        if tables and section not in tables:
            raise CaseError(f"{place(file, raw, name)}: found {name} in [{section}], expected it in [{tables[0]}]")
    return table


def _put(layer: dict[str, Given], given: Given, family: Family) -> None:
    """Add an entry, or the several that a shared name stands for."""
    _refuse_unknown_switch(given, family)
    for made in spread(given, family):
        if made.name in layer:
            both = given.name if given.name != made.name else layer[made.name].name
            raise CaseError(f"{given.where}: found {made.name} given twice, once by {both}; expected it once")
        layer[made.name] = made


def spread(given: Given, family: Family) -> tuple[Given, ...]:
    """An entry under each of the names that it stands for."""
    names = family.groups.shared.get(given.name) if family.groups else None
    return tuple(replace(given, name=name) for name in names) if names else (given,)


def _refuse_unknown_switch(given: Given, family: Family) -> None:
    for switch, choice in given.only.items():
        known = family.switches.get(switch)
        if known is None:
            allowed = ", ".join(family.switches) or "no switch at all"
            hint = nearest(switch, family.switches)
            raise CaseError(f"{given.where}: only: found the switch {switch!r}, expected {allowed}.{hint}")
        if choice not in known:
            expected = f"{' | '.join(known)}.{nearest(choice, known)}"
            raise CaseError(f"{given.where}: only: found {switch} = {choice!r}, expected {expected}")


def start_values(start: Mapping[str, Any], where: str = "start") -> dict[str, float]:
    """Read start values, which are finite and have the states' own units."""
    values: dict[str, float] = {}
    for name, value in start.items():
        try:
            values[name] = float(read_number(value, "1"))
        except CaseError as error:
            raise CaseError(f"{where}: {name}: {error}") from None
    return values
