"""Alternative inputs: a viscosity by its grade, an unbalance by its balance quality, a torque by its power."""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from whirlmap.cases.case import Layer
from whirlmap.cases.entries import Given
from whirlmap.equations.groups import Route
from whirlmap.errors import CaseError

#: Value and writing of an input.
Held = tuple[Fraction, Given]


@dataclass(frozen=True)
class Followed:
    """How an input follows from others.

    Attributes
    ----------
    route : Route
    reads : tuple of str
        The inputs that it follows from here.
    held : mapping of str to Fraction
        Those of them that keep a value of their own.
    """

    route: Route
    reads: tuple[str, ...]
    held: Mapping[str, Fraction]

    def value(self, inputs: Mapping[str, Fraction]) -> Fraction:
        """The input that follows from these.

        Raises
        ------
        CaseError
            One of them does not suit the rule.
        """
        read = (self.held[name] if name in self.held else inputs[name] for name in self.reads)
        return Fraction(self.route.follow(*read))


def chosen(routes: tuple[Route, ...], layer: Layer) -> dict[str, Route | None]:
    """For each input with alternative definitions, the one used in this layer; None where the input itself is given.

    Raises
    ------
    CaseError
        Where a layer gives two alternatives of one input, naming both.
    """
    found: dict[str, Route | None] = {}
    for target in dict.fromkeys(r.target.name for r in routes):
        options: dict[str, Route | None] = {target: None} | {r.key: r for r in routes if r.target.name == target}
        given = [name for name in options if name in layer]
        if len(given) > 1:
            meaning = next(r.target.meaning for r in routes if r.target.name == target)
            raise CaseError(
                f"{layer[given[1]].where}: found {' and '.join(given)} given together, but each of them says what {target}"
                f" is ({meaning}); expected one of them"
            )
        if given:
            found[target] = options[given[0]]
    return found


def follow(
    routes: Mapping[str, Route],
    inputs: Mapping[str, Fraction],
    written: Mapping[str, Given],
    held: Mapping[str, Mapping[str, Held]],
    case: str,
) -> dict[str, tuple[Fraction, Given, Followed]]:
    """Evaluate the inputs that follow from others: value, what stands for what was written, and how it follows.

    ``held`` are, by target, the inputs that keep the value which they had where the alternative was chosen.

    Raises
    ------
    CaseError
        Where an input is missing, or does not suit the rule.
    """
    made: dict[str, tuple[Fraction, Given, Followed]] = {}
    for target, route in routes.items():
        where = written[route.key].where
        instead = {q: by for q, by in route.held.items() if by.name in inputs}
        reads = [instead.get(q, q) for q in route.reads]
        known = {name: (inputs[name], written[name]) for name in inputs} | dict(held.get(target, {}))
        missing = [f"{route.held[q].name} or {q.name}" if q in route.held else q.name for q in reads if q.name not in known]
        if missing:
            raise CaseError(
                f"{where}: {target} is to follow from {route.key} by {route.rule}, which also needs {', '.join(missing)};"
                f" {case} does not give {'it' if len(missing) == 1 else 'them'}"
            )
        kept = {name: value for name, (value, _) in held.get(target, {}).items()}
        followed = Followed(route, tuple(q.name for q in reads), kept)
        try:
            value = followed.value(inputs)
        except CaseError as error:
            raise CaseError(f"{where}: {error}") from None
        origin = ", ".join(f"{q.name} = {known[q.name][1].written}" for q in reads)
        older = [q.name for q in reads if q.name in inputs and known[q.name][0] != inputs[q.name]]
        beside = f" ({', '.join(older)} where {route.key} is given)" if older else ""
        note = f"follows: {origin}{beside}; {route.rule}"
        made[target] = value, Given(target, f"{float(value):.6g}", route.target.unit, note), followed
    return made
