"""Record lengths of time series, sections and spectra: some turns of the slowest clock, in whole periods T.

A machine with hunting teeth repeats after thousands of T, with two hunting pairs after hundreds of thousands. No series,
section or spectrum needs that: a series shows some turns of the slowest shaft, and a spectrum resolves lines whose distance
is the frequency of one such turn.
"""

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import ceil

import numpy as np
from numpy.typing import NDArray
from sympy import sympify

from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.harmonics import common_multiple, frequencies, strobe
from whirlmap.integrate.system import System
from whirlmap.kernels.writing.routine import LANES

#: Turns of the slowest clock, and least T, of a time series whose length is not given; numbers that it holds at most.
SHOWN, LEAST_SHOWN, NUMBERS = 20, 20, 3_000_000
#: Turns of the slowest clock in a transient whose length is not given.
SETTLED = 200
#: T of that transient at most.
LONGEST_SETTLED = 100_000
#: Turns of the slowest clock in the record of a spectrum: a line stands four main lobes of Hann's window from zero frequency
#: at the least (`spectral_lines`), and the shaft's own line should be among them.
SEEN = 16
#: T of the longest record, whatever its clocks.
LONGEST = 8192
#: Common periods in the record of an operating point at least. Where there are none: turns of the slowest harmonic, and as
#: many where extremes are to be those of the motion (beats of a hunting pair are longer: they are missed by some per cent).
WHOLE, MANY = 2, 8
#: How much longer a record may become for holding whole common periods, so that every forced line stands on a bin.
STRETCHED = 1.5
#: Numbers that one stretch of a record saves at most.
KEPT = 4_000_000


def turns_per_T(system: System) -> dict[str, float]:
    """Turns that each named clock makes in one T, with the sign of its spin."""
    rates = {name: sympify(rate) for name, rate in system.model.clocks.items()}
    numbers = {p: float(system.values[p.name]) for p in system.model.parameters if any(r.has(p) for r in rates.values())}
    return {name: float(rate.subs(numbers)) * system.period / (2 * np.pi) for name, rate in rates.items()}


def slowest_turn(system: System) -> float:
    """T in one turn of the slowest clock, or of the slowest harmonic of the forcing where that is slower; at least 1."""
    if not system.model.forced:
        return 1.0
    rates = np.abs(frequencies(system.model, system.vector[:, None])[:, 0]) * system.period / (2 * np.pi)
    turning = [r for r in (*rates.tolist(), *map(abs, turns_per_T(system).values())) if r > 0]
    return max(1.0, 1 / min(turning))


def settled_periods(system: System, turns: int = SETTLED) -> int:
    """T in so many turns of the slowest clock, up to `LONGEST_SETTLED`: a transient whose length is not given."""
    return min(_whole(turns * slowest_turn(system)), max(turns, LONGEST_SETTLED))


def record_periods(orders: tuple[Fraction, ...], keep: int, turns: int = WHOLE) -> int:
    """T of the record of an operating point from which its section and extremes are read, at least ``keep``.

    Whole common periods, `WHOLE` at least. Where the forcing has none, so many turns of its slowest harmonic, up to
    `LONGEST` T: the extremes of less than a turn of the slow shaft are not those of its motion.
    """
    cycle = strobe(orders)
    if cycle == common_multiple(orders):
        return cycle * max(-(-keep // cycle), WHOLE)
    slowest = min(abs(order) for order in orders if order)
    return max(keep, min(ceil(turns / slowest), LONGEST))


def shown_periods(system: System, samples: int) -> int:
    """T of a time series whose length is not given, with so many samples per T.

    `SHOWN` turns of the slowest clock; fewer, or a part of one, where the series would hold more than `NUMBERS` numbers.
    """
    turn = slowest_turn(system)
    most = max(NUMBERS // (samples * (system.model.dimension + len(system.model.outputs))), 1)
    turns = min(SHOWN, int(most / turn))
    return min(max(_whole(turns * turn), LEAST_SHOWN), most)


def spectrum_periods(system: System, least: int, turns: int = SEEN) -> int:
    """T of the record of a spectrum: at least ``least``, and so many turns of the slowest clock, up to `LONGEST`.

    Rounded up to whole common periods of the forcing where that makes it no more than `STRETCHED` times as long: then every
    forced line stands on a bin. Where not, it stands between two, and the window spreads it.
    """
    wanted = max(least, min(_whole(turns * slowest_turn(system)), LONGEST))
    whole = -(-wanted // system.common_multiple) * system.common_multiple
    return whole if whole <= STRETCHED * wanted else wanted


def _whole(periods: float) -> int:
    return max(ceil(periods * (1 - 1e-12)), 1)


def recorded(
    ensemble: Ensemble, periods: int, every: Fraction, states: Sequence[int] | slice = slice(None),
    progress: Callable[[int], None] | None = None,
) -> NDArray[np.float64]:
    """Run an ensemble for so many T and save some states every ``every`` T: array, shape (save, state, point).

    In parts, for a call of the kernel saves all states, and a whole block of lanes for a single point.
    """
    numbers = ensemble.model.dimension * -(-ensemble.points // LANES) * LANES / every
    least = every.numerator
    stretch = max(int(KEPT / numbers) // least, 1) * least
    out = []
    for first in range(0, periods, stretch):
        segment = ensemble.advance(min(stretch, periods - first), save_periods=every, progress=progress)
        out.append(segment.saved[:, states].copy())
    return np.concatenate(out)
