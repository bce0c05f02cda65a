"""The module of a kernel: one model, one method, phase-locked or per-lane time, with or without tangent dynamics.

Two kinds of module are written. A *locked* module takes steps that are whole parts of T and reads the harmonics from a
table; a *free* module takes any steps and computes them. Both share everything else. A module is
self-contained LLVM assembly, so that its hash is its identity.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

from llvmlite import ir
from sympy import Expr, Integer, Symbol, sympify

from whirlmap.equations.identity import model_digest
from whirlmap.equations.model import Model
from whirlmap.equations.pieces import tabulated
from whirlmap.errors import ModelError
from whirlmap.kernels.cache import remembered
from whirlmap.kernels.lowering.differentiate import Entries, Forms, along_code, jacobian_code
from whirlmap.kernels.lowering.formulas import HoistedFunction
from whirlmap.kernels.lowering.lower import Hoisted, Straight, local_name, straight
from whirlmap.kernels.lowering.poles import pole_guards
from whirlmap.kernels.lowering.surfaces import sided
from whirlmap.kernels.methods import Method
from whirlmap.kernels.writing.advancing import Parts, advance
from whirlmap.kernels.writing.event_location import through as write_through
from whirlmap.kernels.writing.hermite import Between
from whirlmap.kernels.writing.marching import evaluate, march
from whirlmap.kernels.writing.rates import ModelRoutines, Slopes, Time, direction_name
from whirlmap.kernels.writing.roots import Roots
from whirlmap.kernels.writing.routine import FAST_MATH, LANES
from whirlmap.kernels.writing.saltation import Surfaces
from whirlmap.kernels.writing.sines import Sines
from whirlmap.kernels.writing.sliding import sliding_rates
from whirlmap.kernels.writing.stepping import Run, Sizes
from whirlmap.version import __version__

#: Of every function. LLVM would split vectors of 512 bits on processors that have them, and keep those that find no register
#: on a stack that is aligned for 16 bytes: nearly each would then lie across two lines of cache.
ATTRIBUTES = (
    '{ nounwind "stackrealign" "prefer-vector-width"="512" "min-legal-vector-width"="512" "no-trapping-math"="true" }'
)


TermKind = Literal["constant", "input", "slot"]


class JacobianTerm(NamedTuple):
    """A term of an entry of the Jacobian: a constant (its value), an input or a slot (its index), times a weight.

    The weight is a number, times the input of the index ``by`` where that is not -1.
    """

    row: int
    column: int
    weight: float
    by: int
    kind: TermKind
    value: float


@dataclass(frozen=True)
class KernelSource:
    """Source of a kernel module and what its caller must supply.

    Attributes
    ----------
    text : str
        The module, as LLVM assembly.
    sizes : Sizes
        Rows of its arrays.
    hoisted : HoistedFunction
        Inputs of the kernel, computed from the parameters.
    entries : tuple of JacobianTerm
        The Jacobian; terms of the same row and column add up.
    tables : dict of str to (str or float)
        Tables that it reads, in the order of its offsets, each with the name or the value of its parameter.
    nodes : tuple of float
        Distinct stage times of the method, in units of the step.
    """

    text: str
    sizes: Sizes
    hoisted: HoistedFunction
    entries: tuple[JacobianTerm, ...]
    tables: dict[str, str | float]
    nodes: tuple[float, ...]

    def as_data(self) -> dict[str, Any]:
        """Write it as JSON holds it."""
        entries = [list(entry) for entry in self.entries]
        return {
            "text": self.text, "sizes": vars(self.sizes), "inputs": self.hoisted.count, "hoisted": self.hoisted.text,
            "entries": entries, "tables": self.tables, "nodes": self.nodes,
        }  # fmt: skip

    @classmethod
    def from_data(cls, data: dict[str, Any]) -> "KernelSource":
        """Read what `as_data` wrote."""
        entries = tuple(JacobianTerm(*entry) for entry in data["entries"])
        hoisted = HoistedFunction(data["inputs"], data["hoisted"])
        sizes = Sizes(**{**data["sizes"], "runs": tuple(Run(*run) for run in data["sizes"]["runs"])})
        return cls(data["text"], sizes, hoisted, entries, dict(data["tables"]), tuple(data["nodes"]))


KEYS = {"text", "sizes", "inputs", "hoisted", "entries", "tables", "nodes"}


def stored_source(
    model: Model, method: Method, *, slopes: Slopes, kind: Time, estimated: bool, fused: bool
) -> KernelSource:
    """Return `kernel_source` from the cache, where it was written before for the same declaration and method."""
    question = f"kernel source\n{model_digest(model)}\n{method!r}\n{slopes} {kind} {LANES} {FAST_MATH}"
    question += f" {estimated} {fused}"
    data = remembered(
        question,
        lambda: kernel_source(model, method, slopes=slopes, kind=kind, estimated=estimated, fused=fused).as_data(),
        lambda data: isinstance(data, dict) and set(data) == KEYS,
    )
    return KernelSource.from_data(data)


def kernel_source(
    model: Model, method: Method, *, slopes: Slopes, kind: Time, estimated: bool, fused: bool
) -> KernelSource:
    """Write the module for a model and a method, with the derivatives that tangent dynamics need.

    Roots and reciprocals are ``estimated``, or computed by divisions (`whirlmap.kernels.running.root_choice`). Sines are
    computed with ``fused`` products, where the processor has them, or by the C library (`whirlmap.kernels.writing.sines`).
    """
    hoisted = Hoisted(model.parameters)
    found = sided(model)
    rates = straight(model, found.rates, hoisted)
    names = [Symbol(local_name(s), real=True) for s in model.states]
    directions = [Symbol(direction_name(s), real=True) for s in model.states]
    runs = () if slopes == "none" else _runs(rates, names)
    positions = {run.position + i for run in runs for i in range(run.rows)}
    entries: Entries = {}
    forms: Forms = {}
    if slopes == "jacobian":
        rates, entries, forms = jacobian_code(rates, names, hoisted)
    elif slopes == "along":
        rates = along_code(rates, names, directions, hoisted)
    moving = [at for at, e in entries.items() if e.free_symbols and e not in hoisted.places]
    slots = {at: i for i, at in enumerate(moving)}
    rows = range(model.dimension) if slopes == "along" else [row for row, _ in moving]
    observed = straight(model, [o.expression for o in model.outputs.values()], hoisted)
    gaps = straight(model, [stop.gap for stop in model.stops.values()], hoisted)
    frequencies = straight(model, [sympify(w) for w in model.harmonics], hoisted)
    observed_along = along_code(observed, names, directions, hoisted)
    guards, surfaces = _guards(model, found.surfaces, names, directions, hoisted)
    held = guards if found.held == found.surfaces else _guards(model, found.held, names, directions, hoisted)[0]
    kept = straight(model, pole_guards(model), hoisted)  # before the number of inputs counts
    nodes = tuple(sorted({float(c) for c in method.c}))

    module = ir.Module(f"{model.name} {method.name} {kind} {slopes}")
    routines = ModelRoutines(module, model, hoisted, Roots(estimated), Sines(module, fused))
    routines.surfaces = len(found.surfaces)
    of_rates = routines.rates(rates, rows, along=slopes == "along", unwanted=positions)
    of_tangent = routines.tangent(entries, slots, forms, positions) if slopes == "jacobian" else None
    of_outputs, of_end = routines.observed(observed), routines.examine(gaps)
    same_side = routines.same_side(kept) if kept.results else None
    sizes = Sizes(
        states=model.dimension, outputs=len(model.outputs), inputs=len(hoisted.symbols) + 2 * model.dimension,
        tables=len(model.tables),
        harmonics=len(model.harmonics), slots=len(slots), scratch=routines.readings.rows, stages=method.stages,
        slope_slots=1 + max(method.slope_slots(nystroem=bool(runs))), along=slopes == "along", runs=runs,
        surfaces=len(found.surfaces),
    )  # fmt: skip
    between = Between(module, sizes, routines.observed_along(observed_along))
    through = turns = of_sides = None
    motion = of_rates
    if found.surfaces:
        of_guards, of_sides = routines.guards(guards, frequencies), routines.sides(surfaces)
        of_held = of_guards if held is guards else routines.guards(held, frequencies, "held")
        if any(found.jumps):
            motion = sliding_rates(module, sizes, found.jumps, of_rates, of_held, routines.kinds)
        turns, harmonics = routines.turns(frequencies), routines.harmonics(len(model.harmonics))
        through = write_through(
            module, sizes, method,
            Surfaces(
                found.jumps, found.flat, [one == other for one, other in zip(found.held, found.surfaces, strict=True)],
                found.holds, motion, of_tangent, of_guards, of_held, of_sides, of_end, harmonics, between, same_side,
            ),
        )  # fmt: skip
    parts = Parts(of_rates, of_tangent, of_outputs, of_end, between, through, same_side)
    if kind == "locked":
        advance(module, sizes, method, nodes, parts)
    else:
        of_phases = routines.phases(frequencies)
        march(module, sizes, method, parts, of_phases, turns)
        if slopes != "along":
            evaluate(module, sizes, method, parts, of_phases, of_sides)
    return KernelSource(
        text=_text(module, model),
        sizes=sizes,
        hoisted=HoistedFunction.of(hoisted.parameters, hoisted.expressions),
        entries=tuple(_terms(entries, slots, forms, names, hoisted)),
        tables=_table_parameters(model),
        nodes=nodes,
    )


def _guards(
    model: Model, found: list[Expr], names: list[Symbol], directions: list[Symbol], hoisted: Hoisted
) -> tuple[Straight, Straight]:
    """Code of the surfaces with their rates along a vector and with time, and of the surfaces alone."""
    surfaces = straight(model, found, hoisted)
    waves = [Symbol(f"{part}{i}", real=True) for i in range(len(model.harmonics)) for part in "cs"]
    with_time = [Symbol(f"{wave.name}_dt", real=True) for wave in waves]
    return along_code(surfaces, [*names, *waves], [*directions, *with_time], hoisted), surfaces


def _runs(rates: Straight, names: list[Symbol]) -> tuple[Run, ...]:
    """States whose rates are other states, with those; a velocity serves one of them and is no position itself."""
    pairs = [(i, names.index(rate)) for i, rate in enumerate(rates.results) if rate in names]
    positions = {i for i, _ in pairs}
    velocities: set[int] = set()
    runs: list[Run] = []
    for i, j in pairs:
        if j in positions | velocities:
            continue
        velocities.add(j)
        if runs and (i, j) == (runs[-1].position + runs[-1].rows, runs[-1].velocity + runs[-1].rows):
            runs[-1] = runs[-1]._replace(rows=runs[-1].rows + 1)
        else:
            runs.append(Run(i, j, 1))
    return tuple(runs)


def _text(module: ir.Module, model: Model) -> str:
    """Assembly of a module, with the attributes that llvmlite cannot write."""
    body = re.sub(r"(?m)^(define .*)$", r"\1 #0", str(module))
    return f"; whirlmap {__version__}, {model.name}\n{body}\nattributes #0 = {ATTRIBUTES}\n"


def _terms(
    entries: Entries, slots: dict[tuple[int, Symbol], int], forms: Forms, names: list[Symbol], hoisted: Hoisted
) -> Iterator[JacobianTerm]:
    """Terms of the Jacobian by states, from its entries by seeds."""
    kind: TermKind
    value: float
    columns = {name: column for column, name in enumerate(names)}
    for (row, seed), e in entries.items():
        if (row, seed) in slots:
            kind, value = "slot", slots[row, seed]
        elif e in hoisted.places:
            kind, value = "input", hoisted.places[e]
        else:
            kind, value = "constant", float(e)
        weights = forms.get(seed, {seed: Integer(1)})
        for name in sorted(weights, key=columns.__getitem__):
            weight = weights[name]
            number, by = (1.0, hoisted.places[weight]) if weight in hoisted.places else (float(weight), -1)
            yield JacobianTerm(row, columns[name], number, by, kind, value)


def _table_parameters(model: Model) -> dict[str, str | float]:
    """Name of the parameter that each table is made for, or its value where it is a number.

    Raises
    ------
    ModelError
        A table is read at none, at several, or at an expression: its entries are made for one parameter.
    """
    found: dict[str, str | float] = {}
    for table in model.tables:
        calls = {e for rate in model.equations.values() for e in sympify(rate).atoms(tabulated)}
        read = sorted({e.parameter for e in calls if e.table_name == table.name}, key=str)
        if len(read) != 1 or not (read[0] in model.parameters or read[0].is_number):
            where = " and ".join(f"at {p}" for p in read)
            raise ModelError(
                f"model {model.name!r}: table {table.name!r} is read {where or 'by no equation'}, expected one parameter of"
                " the model or one number: declare one table for each"
            )
        found[table.name] = read[0].name if read[0] in model.parameters else float(read[0])
    return found
