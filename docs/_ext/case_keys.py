"""Keys of case files, as Markdown, from the declarations that check the files."""

from itertools import islice, product

from markdown_tables import code, table
from whirlmap.cases.entries import Entry, Header
from whirlmap.cases.machine_keys import HEAD, KINDS, OPERATING
from whirlmap.equations.family import Family
from whirlmap.equations.quantities import Parameter
from whirlmap.errors import ModelError
from whirlmap.machines.fields import Choice, Field, Number, Station, Text
from whirlmap.machines.parts import coefficients
from whirlmap.machines.parts.rotor import ELEMENT
from whirlmap.models import FAMILIES
from whirlmap.units import example

#: What the keys beside the entries say; a key that the program reads and that is missing here stops the build.
HEADER = {
    "model": "name of the model, or a path of your own with its name, `my_model.py:MODEL`",
    "extends": "case or file that this one changes: what it says counts unless this file says otherwise",
    "description": "what the case is, in a few sentences",
    "start": "table of start values of states",
    "switches": "table of choices of the model's switches",
}
ENTRY = {
    "value": 'the number, or a text such as `"50 um"` or `"8/3"`',
    "unit": "its unit; absent for a number without one",
    "source": "key of the bibliography, or a drawing, and the place in it",
    "assumed": "why the number is assumed, where it has no source",
    "only": "table of switches for which the entry counts",
}
#: Combinations of switches of a family that are declared to find its parameters.
TRIED = 4096
#: The tables of a machine from parts, beside `[operation]`.
TITLES = {"lubricant": "`[lubricant]` or `[[lubricant]]`"}


def entry_keys() -> str:
    """Keys beside the entries, and keys of one entry."""
    heads = table(("key", "meaning"), [(code(key), HEADER[key]) for key in Header.model_fields])
    entry = table(("key", "meaning"), [(code(key), ENTRY[key]) for key in Entry.model_fields])
    return f"{heads}\nAn entry `name = {{ ... }}` has these keys:\n\n{entry}"


def machine_tables() -> str:
    """Every table of a machine from parts, and every key of it."""
    parts = ["Beside its tables such a file has the keys " + ", ".join(map(code, HEAD)) + "."]
    tables = [("`[operation]`", OPERATING), *((TITLES.get(k, f"`[[{k}]]`"), fields) for k, fields in KINDS.items())]
    at = next(n for n, (title, _) in enumerate(tables) if "shaft" in title)
    tables.insert(at + 1, ("One of the `elements` of a shaft", ELEMENT))
    bearing = next(n for n, (title, _) in enumerate(tables) if "[[bearing]]" in title)
    tables.insert(bearing + 1, ('`[[bearing]]` with `kind = "coefficients"`', coefficients.FIELDS))
    for title, fields in tables:
        parts += [f"### {title}", table(("key", "value", "meaning"), [_field(one) for one in fields])]
    return "\n\n".join(parts)


def _field(one: Field) -> tuple[str, str, str]:
    must = " (required)" if getattr(one, "required", False) else "; zero where absent" if getattr(one, "zero", False) else ""
    if isinstance(one, Number):
        limits = _limits(Parameter(one.key, one.unit, one.meaning, **one.limits))
        kind = f"number {code(example(one.unit))}{limits}" if one.unit != "1" else f"number{limits}"
    elif isinstance(one, Choice):
        kind = ", ".join(code(f'"{choice}"') for choice in one.choices) + "; the first where absent"
    elif isinstance(one, Station):
        kind = "station or distance"
    else:
        kind = "name" if isinstance(one, Text) else "see the meaning"
    return code(one.key), kind + must, one.meaning


def models() -> str:
    """Switches, parameters and inputs of every stock model."""
    return "\n\n".join(_model(family) for family in FAMILIES.values())


def _model(family: Family) -> str:
    parts = [f"## Model `{family.name}`"]
    if family.switches:
        rows = [(code(n), ", ".join(map(code, c)), family.meanings.get(n, "")) for n, c in family.switches.items()]
        parts += ["**Switches**, the default first", table(("switch", "choices", "meaning"), rows)]
    parts += ["**Parameters**", _quantities(parameters(family))]
    if family.groups and family.groups.inputs:
        parts += ["**Dimensional inputs**, from which the parameters follow", _quantities(family.groups.inputs)]
        if family.groups.shared:
            rows = [(code(name), ", ".join(map(code, of))) for name, of in family.groups.shared.items()]
            parts += ["**Keys that stand for several**", table(("key", "inputs of the same value"), rows)]
        if family.groups.routes:
            rows = [(code(r.target.name), ", ".join(code(q.name) for q in r.reads), r.rule) for r in family.groups.routes]
            parts += ["**Other ways to give an input**", table(("input", "follows from", "by"), rows)]
        if family.groups.sections:
            rows = [(code(f"[{title}]"), ", ".join(map(code, names))) for title, names in family.groups.sections.items()]
            parts += ["**Tables in which the inputs may stand**", table(("table", "inputs"), rows)]
    return "\n\n".join(parts)


def parameters(family: Family) -> list[Parameter]:
    """Parameters of all models of a family, whatever the switches, each once."""
    found = {p.name: p for p in family.model().parameters}
    for choices in islice(product(*family.switches.values()), 0 if family.vocabulary else TRIED):
        try:
            model = family.model(**dict(zip(family.switches, choices, strict=True)))
        except ModelError:  # a combination that the family refuses
            continue
        found = {p.name: p for p in model.parameters} | found
    return list(({p.name: p for p in family.vocabulary} | found).values())


def _quantities(quantities: list[Parameter] | tuple[Parameter, ...]) -> str:
    rows = [(code(q.name), q.unit if q.unit != "1" else "", _limits(q).lstrip(", "), q.meaning) for q in quantities]
    return table(("symbol", "unit", "limits", "meaning"), rows)


def _limits(q: Parameter) -> str:
    said = [
        *([f"above {q.above:g}"] if q.above is not None else []),
        *([f"at least {q.at_least:g}"] if q.at_least is not None else []),
        *([f"below {q.below:g}"] if q.below is not None else []),
        *(["a ratio of whole numbers"] if q.order else []),
    ]
    return "".join(f", {one}" for one in said)
