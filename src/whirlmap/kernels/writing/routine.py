"""Writing one LLVM function: vectors of lanes, rows of them in memory, and loops.

Numbers of all lanes of a block stand side by side in one vector, so that LLVM need not vectorise: a kernel is
vector code because it is written as vector code. An array is a pointer to its first row; row ``i`` is one vector.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import reduce
from typing import Any, Literal

from llvmlite import ir

#: Lanes of one block: a vector of doubles fills one register of 512 bits, or two of 256.
LANES = 8

#: `nnan` and `ninf` are left out: with them comparisons with NaN lie, and divergence is never seen.
FAST_MATH = ("contract", "reassoc", "nsz", "arcp", "afn")

INT, DOUBLE, BYTE = ir.IntType(64), ir.DoubleType(), ir.IntType(LANES)
LANE, INTS, MASK = ir.VectorType(DOUBLE, LANES), ir.VectorType(INT, LANES), ir.VectorType(ir.IntType(1), LANES)

#: Kinds of arguments: rows of vectors, rows of integer vectors, plain arrays, numbers.
Kind = Literal["rows", "flags", "doubles", "ints", "int"]
TYPES = {
    "rows": LANE.as_pointer(), "flags": INTS.as_pointer(), "doubles": DOUBLE.as_pointer(), "ints": INT.as_pointer(),
    "int": INT,
}  # fmt: skip

Value = Any


def number(value: float) -> Value:
    """The same number in every lane."""
    return ir.Constant(LANE, [float(value)] * LANES)


def integer(value: int) -> Value:
    """A plain integer."""
    return ir.Constant(INT, value)


def integers(value: int) -> Value:
    """The same integer in every lane."""
    return ir.Constant(INTS, [value] * LANES)


class Routine:
    """One function while it is written.

    Parameters
    ----------
    module : ir.Module
    name : str
    arguments : mapping of str to kind
        They become attributes of `at`; different arrays never overlap.
    public : bool
        Whether it is called from outside of the module.
    copied : bool
        Whether it is copied into its callers; other routines are called.
    """

    def __init__(
        self, module: ir.Module, name: str, arguments: Mapping[str, Kind], *, public: bool = False, copied: bool = False
    ) -> None:
        self.module = module
        self.function = ir.Function(module, ir.FunctionType(ir.VoidType(), [TYPES[k] for k in arguments.values()]), name)
        self.at = dict(zip(arguments, self.function.args, strict=True))
        for argument in self.function.args:
            if isinstance(argument.type, ir.PointerType):
                argument.add_attribute("noalias")
        if not public:
            self.function.linkage = "internal"
            self.function.attributes.add("alwaysinline" if copied else "noinline")
        self.entry = self.function.append_basic_block("entry")
        self.b = ir.IRBuilder(self.entry)

    # --- memory ------------------------------------------------------------------------------------------------

    def local(self, kind: ir.Type, count: int = 1) -> Value:
        """Memory of this call, aligned for vectors, reserved once at its entry."""
        with self.b.goto_block(self.entry):
            self.b.position_at_start(self.entry)
            place = self.b.alloca(kind, max(count, 1))
        place.align = 64
        return place

    def row(self, array: Value, index: Value | int) -> Value:
        """The array from a row on."""
        return self.b.gep(array, [integer(index) if isinstance(index, int) else index])

    def load(self, array: Value, index: Value | int = 0) -> Value:
        """One row, or one number of a plain array."""
        return self.b.load(self.row(array, index), align=8)

    def store(self, value: Value, array: Value, index: Value | int = 0) -> None:
        """Put one row, or one number, into its place."""
        self.b.store(value, self.row(array, index), align=8)

    def forget(self) -> None:
        """Let LLVM believe that all arrays have changed: what was read before must be read again."""
        places = [a for a in self.function.args if isinstance(a.type, ir.PointerType)]
        kind = ir.FunctionType(ir.VoidType(), [a.type for a in places])
        self.b.asm(kind, "", ",".join(["r"] * len(places) + ["~{memory}"]), places, side_effect=True)

    def lane(self, array: Value, index: Value | int, lane: Value) -> Value:
        """Address of one lane in a row."""
        base = self.row(array, index)
        plain = self.b.bitcast(base, base.type.pointee.element.as_pointer())
        return self.b.gep(plain, [lane])

    # --- arithmetic --------------------------------------------------------------------------------------------

    def add(self, a: Value, b: Value) -> Value:
        """Sum of two vectors."""
        return self.b.fadd(a, b, flags=FAST_MATH)

    def sub(self, a: Value, b: Value) -> Value:
        """Difference of two vectors."""
        return self.b.fsub(a, b, flags=FAST_MATH)

    def mul(self, a: Value, b: Value) -> Value:
        """Product of two vectors."""
        return self.b.fmul(a, b, flags=FAST_MATH)

    def div(self, a: Value, b: Value) -> Value:
        """Quotient of two vectors."""
        return self.b.fdiv(a, b, flags=FAST_MATH)

    def less(self, a: Value, b: Value) -> Value:
        """Whether a < b, false for NaN."""
        return self.b.fcmp_ordered("<", a, b)

    def spread(self, value: Value) -> Value:
        """A plain number (double, integer or truth) in every lane."""
        vector = ir.VectorType(value.type, LANES)
        nothing = ir.Constant(vector, ir.Undefined)
        one = self.b.insert_element(nothing, value, ir.Constant(ir.IntType(32), 0))
        return self.b.shuffle_vector(one, nothing, ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES))

    def absolute(self, value: Value) -> Value:
        """Magnitude of a vector."""
        return self._intrinsic(f"llvm.fabs.v{LANES}f64", value)

    def root(self, value: Value) -> Value:
        """Square root of a vector."""
        return self._intrinsic(f"llvm.sqrt.v{LANES}f64", value)

    def fused(self, a: Value, b: Value, c: Value) -> Value:
        """``a b + c``, rounded once and never rearranged; slow where the processor has no instruction for it."""
        return self._intrinsic(f"llvm.fma.v{LANES}f64", a, b, c, flags=())

    def increased(self, total: Value, a: Value, b: Value) -> Value:
        """``total + a b`` in one instruction where there is one; LLVM may not move factors out of sums of such products."""
        return self.b.fadd(total, self.b.fmul(a, b, flags=("contract",)), flags=("contract",))

    def _intrinsic(self, name: str, *values: Value, flags: tuple[str, ...] = FAST_MATH) -> Value:
        return self.b.call(self._declared(name, LANE, len(values)), values, fastmath=flags)

    def _declared(self, name: str, kind: ir.Type, count: int) -> ir.Function:
        return self.module.globals.get(name) or ir.Function(self.module, ir.FunctionType(kind, [kind] * count), name)

    def library(self, name: str, count: int = 1) -> ir.Function:
        """A function of the C library, of so many plain numbers."""
        return self._declared(name, DOUBLE, count)

    def per_lane(self, name: str, *values: Value) -> Value:
        """A function of the C library, called once for each lane."""
        function = self.library(name, len(values))
        out = ir.Constant(LANE, ir.Undefined)
        for lane in range(LANES):
            place = ir.Constant(ir.IntType(32), lane)
            found = self.b.call(function, [self.b.extract_element(v, place) for v in values])
            out = self.b.insert_element(out, found, place)
        return out

    def any(self, mask: Value) -> Value:
        """Whether a truth holds in any lane."""
        return self.b.icmp_unsigned("!=", self.bits(mask), ir.Constant(BYTE, 0))

    def bits(self, mask: Value) -> Value:
        """Truths of all lanes as the bits of one small integer."""
        return self.b.bitcast(mask, BYTE)

    def first(self, mask: Value) -> Value:
        """Index of the first lane in which a truth holds; of the last lane where there is none."""
        bits = self.b.or_(self.bits(mask), ir.Constant(BYTE, 1 << (LANES - 1)))
        return self.b.zext(self.b.cttz(bits, ir.Constant(ir.IntType(1), 1)), INT)

    # --- flow --------------------------------------------------------------------------------------------------

    @contextmanager
    def loop(self, count: Value | int, *, start: int = 0, going: Callable[[Value], Value] | None = None) -> Iterator[Value]:
        """Count from ``start`` to below ``count``, as long as ``going(i)`` holds; gives the counter."""
        b = self.b
        before = b.block
        head, body, after = (self.function.append_basic_block(n) for n in ("head", "body", "after"))
        b.branch(head)
        b.position_at_end(head)
        i = b.phi(INT)
        i.add_incoming(integer(start), before)
        condition = b.icmp_signed("<", i, integer(count) if isinstance(count, int) else count)
        if going is not None:
            condition = b.and_(condition, going(i))
        b.cbranch(condition, body, after)
        b.position_at_end(body)
        yield i
        i.add_incoming(b.add(i, integer(1)), b.block)
        b.branch(head)
        b.position_at_end(after)

    @contextmanager
    def together(self, lanes: Value, *keys: Value) -> Iterator[tuple[list[Value], Value]]:
        """Loop over the distinct integers of some lanes; gives those of ``keys``, and the lanes that have them."""
        b, pending = self.b, self.local(INTS)
        self.store(b.sext(lanes, INTS), pending)

        def left() -> Value:
            return b.icmp_signed("!=", self.load(pending), integers(0))

        with self.loop(LANES, going=lambda _: self.any(left())):
            found, same = self.alike(left(), *keys)
            same = b.and_(same, left())
            yield found, same
            self.store(b.sext(b.and_(left(), b.not_(same)), INTS), pending)

    def alike(self, lanes: Value, *keys: Value) -> tuple[list[Value], Value]:
        """Integers of ``keys`` in the first of some lanes, and all lanes, of them or not, that have the same."""
        lane = self.first(lanes)
        found = [self.b.extract_element(key, lane) for key in keys]
        equal = [self.b.icmp_signed("==", key, self.spread(one)) for key, one in zip(keys, found, strict=True)]
        return found, reduce(self.b.and_, equal)

    def call(self, other: "Routine", **arguments: Value) -> None:
        """Call another routine of the module, every argument by name."""
        assert set(arguments) == set(other.at), set(arguments) ^ set(other.at)
        self.b.call(other.function, [arguments[name] for name in other.at])

    def done(self) -> None:
        """End of the function."""
        self.b.ret_void()
