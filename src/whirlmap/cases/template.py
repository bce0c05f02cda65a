"""A commented case file to start a machine of one's own from, written from what a model and a case declare."""

from collections.abc import Iterable, Mapping
from typing import Any

from whirlmap.cases.case import Case
from whirlmap.cases.entries import Given
from whirlmap.cases.resolve import resolve
from whirlmap.cases.resolved import Resolved
from whirlmap.equations.quantities import Parameter
from whirlmap.errors import CaseError
from whirlmap.units import convert, example


def template(case: Case) -> str:
    """Write a machine as a case file that loads as it is.

    Every dimensional input of the model stands in its table, with its unit and meaning: with the value of the case where
    it has one, else as a comment to be filled in. Values keep their sources; those of a stock machine are assumptions in
    another one, and the text says so.

    Raises
    ------
    CaseError
        The case's model has no dimensional inputs or is the user's own, or the case gives none from which a speed follows.
    """
    if case.parts is not None:
        return _of_parts(case)
    groups = case.family.groups
    if groups is None or not groups.inputs:
        raise CaseError(f"{case.name}: {case.family.name} has no dimensional inputs, so there is no machine to describe")
    if case.own:
        raise CaseError(f"{case.name}: its model is your own; copy the case file instead")
    settled = resolve(case)
    inputs = {q.name: q for q in groups.inputs}
    given = {name: one for name, one in case.given.items() if name not in inputs or name in settled.inputs}
    given = _at_a_speed(given, settled)
    shared = {name: shared for shared, names in groups.shared.items() for name in names}
    lines = [
        f"# A machine after {case.name}. Replace the numbers by yours, and say for each where it comes from:",
        '#   name = { value = 1.5, unit = "mm", source = "drawing 4711" }   or   assumed = "why"',
        "# Switches behind a # stand there as they are in force. Inputs behind a # and three spaces are not given: fill in",
        "# what you know, and take the # away. `whirlmap show` prints what follows.",
        f'model = "{case.family.name}"',
        f'description = """\n{case.description.strip()}\n"""',
        "",
        *(f"{_entry(name, one)}" for name, one in given.items() if name not in inputs),
        "",
        "[switches]",
        *_switches(case),
    ]
    for title, names in groups.sections.items():
        head = f"[{title}]" if any(name in given for name in names) else f"#   [{title}]"  # an empty table is no entry
        lines += ["", head, *(_line(name, inputs[name], given, shared) for name in names if name in inputs)]
    return "\n".join(lines) + "\n"


def _of_parts(case: Case) -> str:
    """A machine from parts is its own template: the file, which says what each table may hold."""
    assert case.path is not None
    text = case.path.read_text(encoding="utf-8-sig")
    if case.parts and len(case.parts.sources) > 1:
        raise CaseError(f"{case.name}: extends another file; copy both, or begin with machines/two-shaft-gearbox")
    return text


def _at_a_speed(given: Mapping[str, Given], settled: Resolved) -> dict[str, Given]:
    """Say the speed of a machine in rpm, to four digits, in place of the ratio that a case may give instead."""
    groups, ratio = settled.groups, settled.model.speed
    if groups is None or groups.speed is None or ratio is None:
        return dict(given)
    s, name = ratio.name, groups.speed.name
    if s not in given or name in settled.inputs:
        return dict(given)
    known = {name: one.value for name, one in settled.inputs.items()} | {name: 1.0}
    if groups.missing(s, settled.switches, frozenset(known)):
        raise CaseError(
            f"{settled.case.name}: found numbers without dimensions, from which no speed in rpm follows; expected a machine"
            " to begin with, such as machines/turbo-gearbox or machines/jeffcott-rig"
        )
    of_one, _ = groups.evaluate(s, settled.switches, known)
    rpm = float(f"{convert(float(settled.values[s]) / float(of_one), 'rad/s', 'rpm'):.4g}")
    why = f"assumed: {s} = {given[s].written} of {settled.case.name}"
    speed = Given(name, int(rpm) if rpm == int(rpm) else rpm, "rpm", why)
    return {key: one for key, one in given.items() if key != s} | {name: speed}


def _switches(case: Case) -> Iterable[str]:
    in_force = resolve(case).switches
    for name, choices in case.family.switches.items():
        chosen = case.switches.get(name)
        meaning = case.family.meanings.get(name, "")
        text = f'{name} = "{chosen}"' if chosen else f'# {name} = "{in_force[name]}"'
        yield f"{text}  # {' | '.join(choices)}: {meaning}"


def _line(name: str, q: Parameter, given: Mapping[str, Given], shared: Mapping[str, str]) -> str:
    if name in given:
        return f"{_entry(name, given[name])}  # {q.meaning}"
    unit = "" if q.unit == "1" else f', unit = "{example(q.unit).partition(" ")[2] or q.unit}"'
    both = f" (or {shared[name]} for all of its kind)" if name in shared else ""
    return f'#   {name} = {{ value = "?"{unit}, assumed = "?" }}  # {q.meaning}{both}'


def _entry(name: str, one: Given) -> str:
    kind, _, text = one.note.partition(": ")
    value: Any = one.value if not isinstance(one.value, str) else f'"{one.value}"'
    unit = f', unit = "{one.unit}"' if one.unit else ""
    only = ", only = {{ {} }}".format(", ".join(f'{k} = "{v}"' for k, v in one.only.items())) if one.only else ""
    return f'{name} = {{ value = {value}{unit}, {kind} = "{_escaped(text)}"{only} }}'


def _escaped(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"')
