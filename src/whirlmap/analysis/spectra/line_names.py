"""Names of spectral lines: harmonics, subharmonics and combinations of the orders that a machine declares."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from whirlmap.errors import RangeError
from whirlmap.results.findings import Findings

if TYPE_CHECKING:
    import xarray as xr

#: Largest denominator of a fraction of one order that names a line of a motion; share of a spectrum that may lie within the
#: tolerance of some sum of orders; and the sum of coefficients that is always tried.
PARTS, CHANCE, LEAST = 8, 0.1, 2


@dataclass(frozen=True)
class LineName:
    """What a line is.

    Attributes
    ----------
    name : str
        ``"mesh"``, ``"2 mesh - pinion"``, ``"3/8 mesh"``; empty where nothing fits.
    frequency : float
        Of the line.
    deviation : float
        Line less named frequency; NaN without a name.
    """

    name: str
    frequency: float
    deviation: float


def name_lines(
    frequencies: ArrayLike,
    orders: Mapping[str, Fraction | float],
    *,
    tolerance: float,
    most: int = 6,
    parts: int = 16,
) -> list[LineName]:
    """Name lines after the orders p*f1 + q*f2 + ... that they lie on.

    Parameters
    ----------
    frequencies : array, shape (line,)
        Not negative; NaN is skipped.
    orders : mapping of str to number
        Named frequencies in the same unit; the sign of a spin does not matter.
    tolerance : float
        Largest deviation: half a frequency step of the spectrum is honest, for a Hann line is found to 0.02 steps.
    most : int
        Largest sum of the sizes of whole coefficients.
    parts : int
        Largest denominator of a fraction of one single order, tried where no whole coefficients fit: subharmonics.

    Returns
    -------
    list of LineName
        One for each finite frequency, in the order given.

    Raises
    ------
    RangeError
        No orders, or a tolerance so large that names are a matter of chance: several combinations of the same
        simplicity would fit at once.

    Notes
    -----
    The simplest combination wins: least sum of |coefficients|, then fewest orders, then the order in which they are
    declared [nayfeh1995]. With commensurate orders (mesh = 4 pinion) a line has many names; one is given. Names of
    high combinations of incommensurate orders fit anything in the end: ``most`` keeps them few.
    """
    known = {name: abs(float(value)) for name, value in orders.items() if value}
    if not known or not tolerance > 0:
        raise RangeError(f"orders = {dict(orders)}, tolerance = {tolerance}: orders and a positive tolerance are needed.")
    names, sizes = list(known), np.array(list(known.values()))
    if tolerance >= sizes.min() / (2 * parts):
        raise RangeError(
            f"tolerance = {tolerance:g} is too coarse for 1/{parts} of the lowest order {sizes.min():g}:"
            " take a longer record."
        )
    combinations = [c for c in _bounded(len(names), most) if any(c)]
    combinations.sort(key=lambda c: (sum(map(abs, c)), sum(k != 0 for k in c), [-abs(k) for k in c], [-k for k in c]))
    table = np.array(combinations)
    at = table @ sizes
    out = []
    for f in np.asarray(frequencies, dtype=float):
        if not np.isfinite(f):
            continue
        fits = np.flatnonzero(np.abs(at - f) <= tolerance)
        if fits.size:
            best = int(fits[0])
            out.append(LineName(_written(combinations[best], names), float(f), float(f - at[best])))
            continue
        out.append(_fraction(float(f), names, sizes, tolerance, parts))
    return out


def named_shares(
    lines: "xr.Dataset | Findings", orders: Mapping[str, Fraction | float], *, step: float, top: int = 12
) -> list[dict[str, object]]:
    """Strongest lines of a spectrum with their names and shares of the power.

    Parameters
    ----------
    lines : xr.Dataset or Findings
        From `spectral_lines`, of one series.
    orders : mapping of str to number
        May be empty: then the strongest line is ``f1``, and the strongest that its multiples do not name ``f2``.
    step : float
        Frequency step of its spectrum, a fifth of which is the tolerance: ten times what a lone line is off.
    top : int
        Lines given.

    Returns
    -------
    list of dict
        ``frequency``, ``share`` (of the power of the series), ``name`` (None where nothing fits).

    Notes
    -----
    An order of which the record does not hold enough to tell its fractions apart names nothing; the others do. Sums of many
    orders fit anything by chance: they are taken up to a size at which less than `CHANCE` of the spectrum is near one.
    At most two frequencies that no order explains become bases of their own, the strongest first: quasi-periodic motion
    has one besides its forcing. Fractions of one order go to 1/8 only, lest they fit by chance.
    """
    frequency, power = np.asarray(lines["line_frequency"])[:top], np.asarray(lines["line_power"])
    whole = float(np.nansum(power)) / max(float(lines["line_fraction"]), 1e-300)
    tolerance = step / 5
    bases = {name: value for name, value in orders.items() if tolerance < abs(float(value)) / (2 * PARTS)}
    highest = max(np.nanmax(frequency, initial=0.0), step)
    named: list[LineName] = []
    for extra in ("f1", "f2", ""):
        most = _most(bases, tolerance, highest)
        named = name_lines(frequency, bases, tolerance=tolerance, most=most, parts=PARTS) if bases else []
        unnamed = [n.frequency for n in named if not n.name] if named else list(frequency[:1])
        if not extra or not unnamed or unnamed[0] <= 2 * PARTS * tolerance:
            break
        bases[extra] = unnamed[0]
    return [
        {"frequency": float(f), "share": float(power[k]) / whole, "name": (named[k].name or None) if named else None}
        for k, f in enumerate(frequency)
    ]


def _bounded(count: int, most: int) -> Iterator[tuple[int, ...]]:
    """All tuples of so many integers, the sum of whose sizes is at most ``most``."""
    if not count:
        yield ()
        return
    for first in range(-most, most + 1):
        for rest in _bounded(count - 1, most - abs(first)):
            yield first, *rest


def _most(bases: Mapping[str, Fraction | float], tolerance: float, highest: float) -> int:
    """Largest sum of the sizes of coefficients at which sums of orders rarely fit a line by chance."""
    sizes = np.array([abs(float(value)) for value in bases.values()])
    for most in range(6 if len(bases) > 2 else 10, LEAST, -1):
        at = np.array(list(_bounded(len(bases), most))) @ sizes if len(bases) else np.zeros(0)
        distinct = np.unique(np.rint(at[(at > 0) & (at <= highest)] / tolerance)).size
        if distinct * 2 * tolerance < CHANCE * highest:
            return most
    return LEAST


def _fraction(f: float, names: Sequence[str], sizes: np.ndarray, tolerance: float, parts: int) -> LineName:
    """Simplest fraction of a single order, or no name."""
    for q in range(2, parts + 1):
        for name, size in zip(names, sizes, strict=True):
            p = round(f / size * q)
            if p > 0 and abs(f - p * size / q) <= tolerance:
                ratio = Fraction(p, q)
                return LineName(f"{ratio} {name}", f, f - p * float(size) / q)
    return LineName("", f, float("nan"))


def _written(coefficients: Sequence[int], names: Sequence[str]) -> str:
    """``2 mesh - pinion``."""
    text = ""
    for k, name in sorted(zip(coefficients, names, strict=True), key=lambda item: item[0] < 0):
        if k:
            sign = (" - " if k < 0 else " + ") if text else ("-" if k < 0 else "")
            text += sign + (f"{abs(k)} " if abs(k) != 1 else "") + name
    return text
