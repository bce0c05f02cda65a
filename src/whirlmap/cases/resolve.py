"""Resolution of a case: from written entries to the parameters of the model.

Units are converted, groups are evaluated, and contradictions are refused.

Files and changes are layers, later ones on top. Two rules decide between a dimensionless symbol and the
dimensional inputs of its group:

1. A symbol that is given wins over its group, whatever the layer.
2. An input that would then change nothing takes precedence over the symbols that it feeds where they stand in
a lower
   layer (``speed`` over the case's ``s``); in the same layer the two contradict each other and are refused.
"""

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Any

from sympy import sympify

from whirlmap.cases import alternatives
from whirlmap.cases.case import Case, Layer, spread, with_parts
from whirlmap.cases.entries import Given
from whirlmap.cases.reasons import History
from whirlmap.cases.resolved import Input, Resolved
from whirlmap.equations import hints
from whirlmap.equations.family import Family
from whirlmap.equations.groups import Route, value_of
from whirlmap.equations.model import Model
from whirlmap.equations.parts import Output
from whirlmap.equations.quantities import Parameter
from whirlmap.errors import CaseError, ModelError
from whirlmap.units import read


def resolve(case: Case, changes: Mapping[str, Any] | None = None) -> Resolved:
    """Resolve a case, with changes on top.

    Parameters
    ----------
    changes : mapping of str to value, optional
        Dimensionless symbols, dimensional inputs with their units, ``"0.03 Pa*s"``, and switches.

    Raises
    ------
    CaseError
        For anything that is wrong with a name, a unit or a value; see `read`.
    """
    asked_for = dict(changes or {})
    case, changes = with_parts(case, asked_for)
    family = case.family
    picked = {name: changes.pop(name) for name in list(changes) if name in family.switches}
    model = _model(family, case.switches, picked)
    switches = dict(model.switches) or {**case.switches, **picked}
    if family.groups:
        switches = {**{name: choices[0] for name, choices in family.switches.items()}, **switches}
    asked: dict[str, Given] = {}
    for name, value in changes.items():
        for given in spread(value if isinstance(value, Given) else Given(name, value), family):
            if given.name in asked:
                raise CaseError(f"found {given.name} given twice, as {asked[given.name].written} and {given.written}")
            asked[given.name] = given
    work = _Work(family, model, switches)
    for number, layer in enumerate(case.layers, start=1):
        suits = {n: g for n, g in layer.items() if all(switches.get(k) == v for k, v in g.only.items())}
        work.add(suits, by_hand=False, strict=number == len(case.layers) and not picked)
    work.add(asked, by_hand=True, strict=True)
    return replace(work.resolved(case), changes=asked_for)


def _model(family: Family, switches: Mapping[str, str], picked: Mapping[str, Any]) -> Model:
    try:
        return family.model(**{**switches, **picked})
    except ModelError as error:
        if picked:
            raise CaseError(str(error)) from None
        raise


class _Work:
    """Inputs and explicit symbols while the layers are put on top of each other."""

    def __init__(self, family: Family, model: Model, switches: Mapping[str, str]) -> None:
        self.family, self.model, self.switches = family, model, switches
        self.groups = family.groups
        self.read = {p.name for p in model.read()}
        self.explicit: dict[str, Given] = {}
        self.given_inputs: dict[str, Given] = {}
        self.values: dict[str, float | Fraction] = {}
        self.inputs: dict[str, Fraction] = {}
        self.routes: dict[str, Route] = {}
        self.held: dict[str, dict[str, alternatives.Held]] = {}
        self.layers = 0
        self.history = History(family.groups.shared if family.groups else {})

    def add(self, layer: Layer, *, by_hand: bool, strict: bool) -> None:
        """Put a layer on top.

        What is asked for by hand must have an effect. Symbols of a strict layer must be read; in others they
        may belong to switches that have been replaced since.
        """
        self.layers += 1
        symbols = {name: given for name, given in layer.items() if not self._input(name)}
        for name, given in symbols.items():
            self._refuse_unread(given, strict=strict)
            if name in self.read:
                self.explicit[name] = given
                self.values[name] = self._number(given, self.model.parameter(name))
                self.history.add(self.layers, name, self.values[name], given)
        if self.groups:
            self._choose_ways(self.groups.routes, layer)
        for name, given in layer.items():
            parameter = self._input(name)
            if parameter:
                self.inputs[name] = Fraction(self._number(given, parameter))
                self.given_inputs[name] = given
                self.history.add(self.layers, name, self.inputs[name], given)
                self._give_way(given, frozenset(symbols), by_hand=by_hand)
        for target, route in self.routes.items():
            if route.key in layer:
                self.held[target] = {
                    q.name: (self.inputs[q.name], self.given_inputs[q.name]) for q in route.held if q.name in self.inputs
                }

    def _choose_ways(self, routes: tuple[Route, ...], layer: Layer) -> None:
        """Take over the alternative by which a layer gives an input, and forget those of the layers below."""
        for target, route in alternatives.chosen(routes, layer).items():
            for name in (target, *(r.key for r in routes if r.target.name == target)):
                self.inputs.pop(name, None)
                self.given_inputs.pop(name, None)
            self.routes.pop(target, None)
            if route:
                self.routes[target] = route

    def _effective(self, name: str) -> bool:
        """Whether an input says something though it need not change any parameter: its operation, its oil's density."""
        assert self.groups
        return name in (*self.groups.operation, *(b.rho.name for b in self.groups.bearings(self.switches).values()))

    def _idle(self, name: str) -> bool:
        """Whether an input serves alternative inputs alone, none of which is used."""
        if not self.groups or self._effective(name):
            return False
        serving = [r for r in self.groups.routes if name in r.names]
        if not serving or any(self.routes.get(r.target.name) is r for r in serving):
            return False
        others = [{**self.switches, k: choice} for k, choices in self.family.switches.items() for choice in choices]
        every = [reads for switches in (self.switches, *others) for reads in self.groups.reads(switches).values()]
        return not any(name in reads for reads in every)

    def _fed(
        self, name: str, explicit: frozenset[str] = frozenset(), switches: Mapping[str, str] | None = None
    ) -> frozenset[str]:
        """Parameters that change with an input."""
        assert self.groups
        return self.groups.fed_by(name, switches or self.switches, explicit, self.routes.values())

    def _input(self, name: str) -> Parameter | None:
        return self.groups.input(name) if self.groups else None

    def _give_way(self, given: Given, beside: frozenset[str], *, by_hand: bool) -> None:
        """Rule 2 of the module."""
        assert self.groups
        if by_hand and self._idle(given.name):
            served = next(r for r in self.groups.routes if given.name in r.names)
            raise CaseError(
                f"{given.name} has no effect: {served.target.name} is not given by {served.key} here, but itself or in"
                " another way"
            )
        if self._effective(given.name):
            by_hand = False
        fed = self._fed(given.name) & self.read
        if self._fed(given.name, frozenset(self.explicit)) & self.read:
            return
        if not fed:
            if by_hand:
                raise CaseError(f"{given.name} has no effect on {self._unread(given.name)}")
            return
        free = self._fed(given.name, beside)
        if free & self.read:
            for name in free & self.explicit.keys():
                del self.explicit[name], self.values[name]
            return
        rivals = sorted(fed & beside)
        raise CaseError(
            f"{given.where}: found {given.name} and {', '.join(rivals)} given together, but {given.name}"
            f" sets nothing but {', '.join(sorted(fed))}; expected one of them"
        )

    def _number(self, given: Given, parameter: Parameter) -> float | Fraction:
        try:
            exact = read(given.value, parameter.unit, given=given.unit)
        except CaseError as error:
            raise CaseError(f"{given.where}: {error} ({parameter.meaning})") from None
        fault = parameter.fault(float(exact))
        if not fault and self._input(given.name) and parameter.order and exact.denominator != 1:
            fault = "must be a whole number"
        if fault:
            raise CaseError(f"{given.where}: found {given.written}, which {fault} ({parameter.meaning})")
        if self._input(given.name):
            return exact
        ratio = isinstance(given.value, int | Fraction) or "/" in str(given.value)
        return exact if parameter.order and ratio else float(exact)

    def _refuse_unread(self, given: Given, *, strict: bool) -> None:
        """Refuse a symbol that the model does not know, or does not read with these switches."""
        if given.name in self.read:
            return
        if given.name in self.family.symbols():
            if not strict:
                return
            raise CaseError(f"{given.where}: " + self._unread(given.name, f" does not read {given.name!r}"))
        parameters = [p for p in self.model.parameters if p.name in self.read]
        inputs = self.groups.inputs if self.groups else ()
        lines = [f"parameters: {' '.join(p.name for p in parameters)}"]
        lines += [f"dimensional inputs: {' '.join(q.name for q in inputs)}"] if inputs else []
        lines += [f"switches: {' '.join(self.family.switches)}"] if self.family.switches else []
        raise CaseError(
            f"{given.where}: {self.family.name} has no symbol {given.name!r}."
            f"{hints.of_symbol(self.family, self.model, given.name, (*parameters, *inputs), given.value)}\n  "
            + "\n  ".join(lines)
        )

    def _unread(self, name: str, verb: str = "") -> str:
        """Name the model with the switches that count, and a change of one that would make it read a name."""
        reader = self._reader(name)
        count = [k for k, v in self.switches.items() if v != self.family.switches[k][0] or (reader and k == reader[0])]
        chosen = f" with {', '.join(f'{k} = {self.switches[k]}' for k in count)}" if count else ""
        hint = f"; {reader[0]} = {reader[1]} {'does' if verb else 'reads it'}" if reader else ""
        return f"{self.family.name}{chosen}{verb}{hint}"

    def _reader(self, name: str) -> tuple[str, str] | None:
        """Find a switch whose change would make the model read a symbol or an input."""
        for switch, choices in self.family.switches.items():
            for choice in choices:
                try:
                    model = self.family.model(**{**self.switches, switch: choice})
                except ModelError:
                    continue
                fed = self._fed(name, switches=model.switches) if self._input(name) else frozenset()
                if ({name} | fed) & {p.name for p in model.read()}:
                    return switch, choice
        return None

    def resolved(self, case: Case) -> Resolved:
        """Evaluate groups and defaults."""
        values: dict[str, float | Fraction] = {}
        notes: dict[str, str] = {}
        written = set(self.given_inputs)
        made_by = alternatives.follow(self.routes, self.inputs, self.given_inputs, self.held, case.name)
        for target, (value, made, _) in made_by.items():
            self.inputs[target], self.given_inputs[target] = value, made
        for check in self.groups.checks if self.groups else ():
            if fault := check(self.inputs):
                raise CaseError(f"{case.name}: {fault}")
        known = {**self.inputs, **self.values}
        expressions = self.groups.expressions(self.switches) if self.groups else {}
        later = []
        for p in self.model.parameters:
            if p.name in self.values:
                values[p.name], notes[p.name] = self.values[p.name], self.explicit[p.name].note
            elif p.name in expressions and (p not in self.model.defaults or not self._missing(p.name, known)):
                values[p.name], notes[p.name] = self._follow(p, known, case)
            elif p in self.model.defaults:
                later.append(p)
            else:
                raise CaseError(f"{case.name}: found no value for {p.name!r}, expected one ({p.meaning})")
        for p in later:
            expression = self.model.defaults[p]
            number = float(value_of(_sympified(expression), values))
            values[p.name], notes[p.name] = number, f"default: {expression}"
        return Resolved(
            case=case,
            model=self.model,
            switches=self.switches,
            values={p.name: values[p.name] for p in self.model.parameters},
            notes=notes,
            inputs=self._shown_inputs(),
            given={name: float(value) for name, value in self.inputs.items()},
            exact={name: Fraction(value) for name, value in self.inputs.items()},
            quantities=self._quantities({**self.inputs, **values}),
            marks=self.history.marks(n for n in self.history.given if n not in self.explicit and n not in written),
            followed={target: how for target, (_, _, how) in made_by.items()},
        )

    def _shown_inputs(self) -> dict[str, Input]:
        shown = {}
        for q in self.groups.inputs if self.groups else ():
            if q.name in self.inputs and not self._replaced(q.name) and not self._idle(q.name):
                given = self.given_inputs[q.name]
                shown[q.name] = Input(q, float(self.inputs[q.name]), given.written, given.note)
        return shown

    def _missing(self, name: str, known: Mapping[str, Any]) -> list[str]:
        assert self.groups
        return self.groups.missing(name, self.switches, frozenset(known))

    def _replaced(self, name: str) -> bool:
        """Whether an input changes nothing because the symbols that it feeds are given themselves."""
        assert self.groups
        fed = self._fed(name) & self.read
        return bool(fed) and not self._fed(name, frozenset(self.explicit)) & self.read

    def _follow(self, p: Parameter, known: Mapping[str, Any], case: Case) -> tuple[float | Fraction, str]:
        assert self.groups
        missing = self._missing(p.name, known)
        if missing:
            raise CaseError(
                f"{case.name}: found no value for {p.name!r} ({p.meaning}), expected one, or the dimensional"
                f" inputs that it follows from: missing {', '.join(dict.fromkeys(missing))}"
            )
        value, expression = self.groups.evaluate(p.name, self.switches, known)
        fault = p.fault(float(value))
        if fault:
            found = f"{p.name} = {expression} = {float(value):g}"
            raise CaseError(f"{case.name}: found {found}, which {fault} ({p.meaning})")
        return value if p.order else float(value), f"group: {expression}"

    def _quantities(self, known: Mapping[str, Any]) -> dict[str, tuple[float, Output]]:
        if not self.groups:
            return {}
        declared = self.groups.quantities(self.switches)
        return {
            name: (float(value_of(_sympified(output.expression), known)), output)
            for name, output in declared.items()
            if {q.name for q in _sympified(output.expression).free_symbols} <= set(known)
        }


def _sympified(expression: Any) -> Any:
    return sympify(expression)
