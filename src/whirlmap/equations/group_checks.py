"""Checks of the dimensional inputs of a family: names that are no inputs, units and roles that there are not."""

from collections.abc import Collection, Iterable, Mapping
from typing import Any, get_args

from sympy import sympify

from whirlmap.equations.parts import OfMachine
from whirlmap.errors import ModelError, nearest

#: Measures whose size in SI units a family may declare; those of `Quantity` follow from them.
UNITS = ("force", "length", "speed", "rotation")
#: Roles of the dimensional results of a machine.
OF_MACHINE: tuple[str, ...] = get_args(OfMachine)


def refuse_measures(units: Iterable[str]) -> None:
    """Refuse sizes of what is no measure."""
    for name in units:
        if name not in UNITS:
            raise ModelError(f"Groups: units has {name!r}, expected {' | '.join(UNITS)}.{nearest(name, UNITS)}")


def refuse_no_inputs(inputs: Collection[str], where: str, names: Iterable[str]) -> None:
    """Refuse names of what is no dimensional input; ``where`` is the part of the declaration."""
    for name in names:
        if name not in inputs:
            raise ModelError(
                f"Groups: {where} names {name!r}, which is no input.{nearest(name, inputs)}\n  inputs: {' '.join(inputs)}"
            )


def refuse_results(model: str, results: Mapping[str, Any], bearings: Collection[str]) -> None:
    """Refuse a role that no dimensional result can have, and one of no bearing."""
    for name, output in results.items():
        where = f"model {model!r}: the result {name!r} of its groups"
        if output.role and output.role not in OF_MACHINE:
            expected = f"expected one of {' | '.join(OF_MACHINE)}, or none.{nearest(output.role, OF_MACHINE)}"
            raise ModelError(f"{where} has the role {output.role!r}, {expected}")
        if output.bearing and output.bearing not in bearings:
            known = f"one of {' | '.join(bearings)}" if bearings else "none, for none is declared"
            raise ModelError(f"{where} is of bearing {output.bearing!r}, expected {known}")


def refuse_symbols(model: str, known: Collection[str], where: str, expressions: Mapping[str, Any]) -> None:
    """Refuse symbols that are neither dimensional inputs nor parameters of the model."""
    for name, expression in expressions.items():
        for symbol in sorted(q.name for q in sympify(expression).free_symbols):
            if symbol not in known:
                raise ModelError(
                    f"model {model!r}: {where} {name!r} of its groups reads {symbol!r}, which is neither a dimensional input"
                    f" nor a parameter of the model.{nearest(symbol, known)}"
                )


def refuse_bearings(model: str, inputs: Collection[str], outputs: Collection[str], bearings: Mapping[str, Any]) -> None:
    """Refuse bearings whose sizes are no inputs, or whose eccentricity is no output of the model."""
    for name, bearing in bearings.items():
        for part in ("R", "L", "c", "mu", "rho"):
            quantity = getattr(bearing, part)
            if quantity.name not in inputs:
                raise ModelError(
                    f"model {model!r}: bearing {name!r} of its groups has {part} = {quantity.name!r}, which is no input."
                    f"{nearest(quantity.name, inputs)}"
                )
        if bearing.eccentricity not in outputs:
            raise ModelError(
                f"model {model!r}: bearing {name!r} of its groups has the eccentricity {bearing.eccentricity!r}, which is no"
                f" output of the model.{nearest(bearing.eccentricity, outputs)}"
            )
