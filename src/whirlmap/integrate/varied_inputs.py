"""Dimensional inputs that vary: what the parameters of a model are at each of their values.

A clearance feeds many groups. Each follows from the case with the changed input, as in `whirlmap.load`, to the bit: the
group's expression, with all other inputs put in once, is compiled and evaluated exactly at each value (`exact_values`). The
ends are settled as whole cases, which refuse what cannot be and say which parameters change; where the short way does not
give what they have, every value is settled.
"""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sympy import Expr, Rational

from whirlmap.cases import Resolved, resolve
from whirlmap.equations.exact_values import float_function
from whirlmap.equations.groups import Groups
from whirlmap.equations.quantities import Parameter
from whirlmap.errors import CaseError, RangeError, nearest
from whirlmap.integrate.system import System
from whirlmap.units import read, such_as

Array = NDArray[np.float64]


def groups_of(system: System) -> Groups | None:
    """Dimensional inputs of a system's family, and what follows from them; None where it has none."""
    return system.machine.groups if system.machine else None


def input_of(system: System, name: str) -> Parameter | None:
    """The dimensional input of that name, the first of those that share it; None where the case has no such input."""
    groups = groups_of(system)
    return groups.input(groups.shared.get(name, (name,))[0]) if groups else None


@dataclass(frozen=True, eq=False)
class VariedInputs:
    """Parameters of a system as functions of some of its dimensional inputs.

    Attributes
    ----------
    system : System
    units : mapping of str to str
        The inputs, and the unit of their values.
    ends : mapping of str to (float, float)
        The first and the last value of each.
    fixed : collection of str
        Parameters that do not follow: they are varied or drawn themselves.
    """

    system: System
    units: Mapping[str, str]
    ends: Mapping[str, tuple[float, float]]
    fixed: Collection[str] = ()

    def __call__(self, values: Mapping[str, Array], names: Collection[str] | None = None) -> dict[str, Array]:
        """Parameters that follow, or those of these names, at the values of the inputs; all arrays have one length."""
        wanted = [name for name in self.followers if names is None or name in names]
        rows, where = np.unique(np.stack([values[name] for name in self.units]), axis=1, return_inverse=True)
        found = [self._row(tuple(row)) for row in rows.T.tolist()]
        return {name: np.array([one[name] for one in found])[where.ravel()] for name in wanted}

    def _row(self, at: tuple[float, ...]) -> dict[str, float]:
        """All parameters that follow, at values of the inputs: the chunks of a map ask for the same ones again."""
        if at not in self._rows:
            self._rows[at] = self._at(at, self.followers)
        return self._rows[at]

    @cached_property
    def _rows(self) -> dict[tuple[float, ...], dict[str, float]]:
        return {}

    @cached_property
    def sizes(self) -> list[str]:
        """Those of the parameters that follow which say what the model's units are worth."""
        groups = groups_of(self.system)
        read = {q.name for worth in groups.units.values() for q in worth.free_symbols} if groups else set()
        return [name for name in self.followers if name in read]

    def __getstate__(self) -> dict[str, Any]:
        """What is sent to other processes: nothing that is made of it."""
        return {"system": self.system, "units": self.units, "ends": self.ends, "fixed": self.fixed}

    def check(self) -> None:
        """Refuse inputs that cannot be varied, and those that change nothing.

        Raises
        ------
        RangeError
            No such input; one without its unit, or one that counts; one that an order of a harmonic follows.
        CaseError
            A value that the case does not take.
        """
        for name in self.units:
            self._refuse(name)
        for name in self.followers:
            if self.system.model.parameter(name).order:
                raise RangeError(f"{' '.join(self.units)}: {name} follows, the order of a harmonic, which cannot be varied")
        if not self.followers:
            names = " ".join(self.units)
            raise RangeError(f"{names}: found a dimensional input that changes nothing: the symbols that it feeds are given")

    def meaning(self, name: str) -> str:
        """What an input is; of a name that several share, of them."""
        declared, groups = input_of(self.system, name), groups_of(self.system)
        assert declared is not None and groups is not None
        return f"{declared.meaning}, and alike" if name in groups.shared else declared.meaning

    def _refuse(self, name: str) -> None:
        declared, system = input_of(self.system, name), self.system
        if declared is None:
            inputs = system.machine.inputs if system.machine else ()
            raise RangeError(
                f"{system.case} has no parameter {name!r}.{nearest(name, [*system.parameters, *inputs])}"
                f"\n  parameters: {' '.join(system.parameters)}\n  dimensional inputs: {' '.join(inputs)}"
            )
        if declared.order:
            raise RangeError(f"{name} is a whole number ({declared.meaning}): it cannot be varied")
        if declared.unit != "1" and not self.units[name]:
            raise RangeError(f"{name} has a dimension ({declared.meaning}), expected values with their unit,"
                             f" such as {such_as(declared.unit)}")  # fmt: skip

    @property
    def _resolved(self) -> Resolved:
        assert self.system.machine is not None
        return self.system.machine

    @cached_property
    def _corners(self) -> dict[tuple[float, ...], Resolved]:
        """The case at all combinations of the ends."""
        return {at: self._settled(at) for at in product(*(self.ends[name] for name in self.units))}

    @cached_property
    def followers(self) -> list[str]:
        """Parameters that follow the inputs."""
        own, now, notes = self._resolved.values, self.system.values, self.system.notes
        differ = {n for one in self._corners.values() for n, v in one.values.items() if v != own[n]}
        return [
            n for n in self.system.parameters
            if n in differ and n not in self.fixed and now[n] == own[n] and not notes[n].startswith("default")
        ]  # fmt: skip

    def _settled(self, at: tuple[float, ...]) -> Resolved:
        settled = self._resolved
        texts = {name: f"{value!r} {unit}".strip() for (name, unit), value in zip(self.units.items(), at, strict=True)}
        made = resolve(settled.case, {**settled.changes, **texts})
        if made.model.name != self.system.model.name or [*made.values] != [*settled.values]:
            raise CaseError(f"{settled.case.name} with {', '.join(f'{n} = {t}' for n, t in texts.items())} is another model")
        return made

    def _at(self, at: tuple[float, ...], names: Collection[str]) -> dict[str, float]:
        if at not in self._corners and self._exact is not None:
            return self._exact(at, names)
        settled = self._corners[at] if at in self._corners else self._settled(at)
        return {name: float(settled.values[name]) for name in names}

    @cached_property
    def _exact(self) -> Callable[[tuple[float, ...], Collection[str]], dict[str, float]] | None:
        """The parameters at values of the inputs by their groups alone; None where that is not what the case says."""
        groups = groups_of(self.system)
        assert groups is not None
        spread = {name: groups.shared.get(name, (name,)) for name in self.units}
        one = next(iter(self._corners.values()))
        varied = {q for names in spread.values() for q in names}
        following = {q: how for q, how in one.followed.items() if varied & {*how.reads} - how.held.keys()}
        varied |= following.keys()
        inputs = {name: value for name, value in one.exact.items() if name not in varied}
        known = inputs | {n: Fraction(v) for n, v in one.values.items() if not one.notes[n].startswith("group:")}
        expressions = groups.expressions(one.switches)
        if not set(self.followers) <= expressions.keys():
            return None
        partial = {n: float_function(_partial(expressions[n], expressions, known, varied)) for n in self.followers}

        def exact(at: tuple[float, ...], names: Collection[str]) -> dict[str, float]:
            values = dict(inputs)
            for (name, unit), value in zip(self.units.items(), at, strict=True):
                for q in spread[name]:
                    declared = groups.input(q)
                    assert declared is not None
                    values[q] = read(value, declared.unit, given=unit or None)
                    if fault := declared.fault(float(values[q])):
                        raise CaseError(f"{name} = {value:g} {unit} {fault} ({declared.meaning})")
            values |= {q: how.value(values) for q, how in following.items()}
            for check in groups.checks:
                if fault := check(values):
                    raise CaseError(f"{one.case.name}: {fault}")
            return {name: evaluate(values) for name, evaluate in partial.items() if name in names}

        try:
            every = self.followers
            same = all(exact(at, every) == {n: float(end.values[n]) for n in every} for at, end in self._corners.items())
        except (CaseError, KeyError):
            return None
        return exact if same else None


def _partial(
    expression: Expr, expressions: Mapping[str, Expr], known: Mapping[str, Fraction], varied: Collection[str]
) -> Expr:
    """An expression in the varied inputs alone."""
    while missing := [q for q in expression.free_symbols if q.name not in known and q.name not in varied]:
        expression = expression.xreplace({q: expressions[q.name] for q in missing})
    numbers = {q: known[q.name] for q in expression.free_symbols if q.name in known}
    return expression.xreplace({q: Rational(v.numerator, v.denominator) for q, v in numbers.items()})
