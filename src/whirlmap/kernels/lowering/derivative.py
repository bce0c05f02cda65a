"""The derivative of one lowered expression by one of its symbols."""

from collections.abc import Mapping

from sympy import Abs, DiracDelta, Expr, Integer, Symbol, sign, sympify

from whirlmap.kernels.lowering.powers import inverse, power, root, split_powers


def derivative(e: Expr, symbol: Symbol) -> Expr:
    """Derivative by a symbol, square roots, reciprocals and powers kept in the form that is printed."""
    calls = [a for a in e.atoms(root, inverse, power, Abs, sign) if a.has(symbol) and not _differentiated_by_sympy(a)]
    if not calls:
        return _printable(e.diff(symbol))
    stand_in = {call: Symbol(f"call{i}", real=True) for i, call in enumerate(calls)}
    outermost = e.xreplace(stand_in)
    back: Mapping[Expr, Expr] = {s: call for call, s in stand_in.items()}
    total = outermost.diff(symbol).xreplace(back)
    for call, s in stand_in.items():
        outer = outermost.diff(s).xreplace(back)
        if outer != 0:
            for i, argument in enumerate(call.args):
                if argument.has(symbol):
                    total += outer * _partial(call, i) * derivative(argument, symbol)
    return _printable(total)


def base_and_exponent(factor: Expr) -> tuple[Expr, Expr]:
    """Base and exponent of a power; SymPy's own `as_base_exp` says that the base of ``exp(x)`` is the number e."""
    return factor.args if factor.is_Pow else (factor, Integer(1))


def _differentiated_by_sympy(call: Expr) -> bool:
    """Whether SymPy knows that a magnitude is one of real numbers; it writes real and imaginary parts else."""
    return isinstance(call, Abs | sign) and bool(call.args[0].is_extended_real)


def _partial(call: Expr, argument: int) -> Expr:
    """Derivative of a call by one of its arguments."""
    if isinstance(call, Abs):
        return sign(call.args[0])
    return Integer(0) if isinstance(call, sign) else call.fdiff(argument + 1)


def _printable(slope: Expr) -> Expr:
    """The derivative on either side of a jump (that of ``sign`` is zero), its powers split as in the code before it."""
    return split_powers(sympify(slope).replace(DiracDelta, lambda *_: Integer(0)))
