"""Sine and cosine of vectors: Cody and Waite's reduction, the polynomials of fdlibm, quadrants by selection.

The C library works on one lane at a time, and most of a pendulum's right-hand side is a sine. Here all lanes take
the same path: the nearest multiple of pi/2 is subtracted in three parts, both functions of what is left are polynomials,
and the quadrant chooses between them and their signs. Products go into sums without rounding (`Routine.fused`), and no
instruction may be reassociated: the reduction is built of differences that algebra would cancel.

Within 1.5 units in the last place up to `LIMIT`. Lanes beyond it, infinite or not a number are left to the C library, so
that a lane's bits depend on its own angle alone. The sign of a zero is not kept, here as everywhere in the kernels.

Sources: W. J. Cody and W. Waite, Software Manual for the Elementary Functions, 1980; fdlibm (Sun Microsystems, 1993),
k_sin.c and k_cos.c.
"""

from llvmlite import ir

from whirlmap.kernels.writing.routine import INTS, LANE, LANES, Routine, Value, integers, number

#: pi/2 in three parts of 53 bits. The first difference is exact; what the third leaves out is 2^-163 of a quarter turn.
PARTS = (1.5707963267948966, 6.123233995736766e-17, -1.4973849048591698e-33)
#: Largest angle that is reduced so: none below it is nearer to a multiple of pi/2 (but zero) than 6e-19.
LIMIT = 2.0**30
#: A sum with this is rounded to a whole number, which then stands in its lowest bits.
ROUNDING = 1.5 * 2.0**52
#: Coefficients of x^3, x^5, ... of the sine, and of x^4, x^6, ... of the cosine, for |x| <= pi/4 (fdlibm).
SINE = (
    -1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04, 2.75573137070700676789e-06,
    -2.50507602534068634195e-08, 1.58969099521155010221e-10,
)  # fmt: skip
COSINE = (
    4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05, -2.75573143513906633035e-07,
    2.08757232129817482790e-09, -1.13596475577881948265e-11,
)  # fmt: skip


class Sines:
    """Writes sines and cosines into the routines of one module.

    Parameters
    ----------
    module : ir.Module
    fused : bool
        Whether the processor adds a product without rounding it; where not, the C library is called for every lane.
    """

    def __init__(self, module: ir.Module, fused: bool) -> None:
        self.module, self.fused = module, fused
        self._far: Routine | None = None

    def pair(self, r: Routine, x: Value) -> tuple[Value, Value]:
        """Instructions of the sine and the cosine of a vector."""
        if not self.fused:
            return r.per_lane("sin", x), r.per_lane("cos", x)
        b = r.b
        near = _near(r, x)
        far = r.any(b.fcmp_unordered(">", r.absolute(x), number(LIMIT)))
        before = b.block
        with b.if_then(far, likely=False):
            rows = r.local(LANE, 3)
            for i, value in enumerate((x, *near)):
                r.store(value, rows, i)
            r.call(self._far_lanes(), rows=rows)
            called = [r.load(rows, i) for i in (1, 2)]
            inside = b.block
        found = []
        for value, other in zip(near, called, strict=True):
            either = b.phi(LANE)
            either.add_incoming(value, before)
            either.add_incoming(other, inside)
            found.append(either)
        return found[0], found[1]

    def _far_lanes(self) -> Routine:
        """Write ``far_lanes``: angles, sines and cosines are rows; beyond `LIMIT` they are computed by the C library."""
        if self._far is None:
            r = self._far = Routine(self.module, "far_lanes", {"rows": "rows"})
            functions = [r.library(name) for name in ("sin", "cos")]
            with r.loop(LANES) as lane:
                x = r.b.load(r.lane(r.at["rows"], 0, lane))
                beyond = r.b.or_(
                    r.b.fcmp_unordered(">", x, x.type(LIMIT)), r.b.fcmp_unordered("<", x, x.type(-LIMIT))
                )
                with r.b.if_then(beyond):
                    for i, function in enumerate(functions):
                        r.b.store(r.b.call(function, [x]), r.lane(r.at["rows"], 1 + i, lane))
            r.done()
        return self._far


def _near(r: Routine, x: Value) -> tuple[Value, Value]:
    """Sine and cosine of angles up to `LIMIT`; of others any number."""
    b = r.b
    shifted = r.fused(x, number(1 / PARTS[0]), number(ROUNDING))
    back = b.fsub(number(ROUNDING), shifted)  # minus the number of quarter turns
    left = x
    for part in PARTS:
        left = r.fused(back, number(part), left)
    square = b.fmul(left, left)
    s = r.fused(b.fmul(square, left), _polynomial(r, SINE, square), left)
    half = b.fmul(number(0.5), square)
    one = b.fsub(number(1.0), half)
    lost = b.fsub(b.fsub(number(1.0), one), half)
    c = b.fadd(one, r.fused(b.fmul(square, square), _polynomial(r, COSINE, square), lost))
    quarter = b.bitcast(shifted, INTS)
    odd = b.icmp_signed("!=", b.and_(quarter, integers(1)), integers(0))
    sine = _signed(r, b.select(odd, c, s), quarter)
    return sine, _signed(r, b.select(odd, s, c), b.add(quarter, integers(1)))


def _polynomial(r: Routine, coefficients: tuple[float, ...], x: Value) -> Value:
    out = number(coefficients[-1])
    for c in coefficients[-2::-1]:
        out = r.fused(out, x, number(c))
    return out


def _signed(r: Routine, value: Value, quarter: Value) -> Value:
    """The number with its sign changed in the third and fourth quarter."""
    b = r.b
    change = b.shl(b.and_(quarter, integers(2)), integers(62))
    return b.bitcast(b.xor(b.bitcast(value, INTS), change), LANE)
