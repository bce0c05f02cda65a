"""Names of spectral lines: multiples, fractions and sums of the orders that a machine declares."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from whirlmap.errors import RangeError
from whirlmap.results.findings import Findings

if TYPE_CHECKING:
    import xarray as xr


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
    combinations = [c for c in product(range(-most, most + 1), repeat=len(names)) if 0 < sum(map(abs, c)) <= most]
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
    At most two frequencies that no order explains become bases of their own, the strongest first: quasi-periodic motion
    has one besides its forcing. Fractions of one order go to 1/8 only, lest they fit by chance.
    """
    frequency, power = np.asarray(lines["line_frequency"])[:top], np.asarray(lines["line_power"])
    whole = float(np.nansum(power)) / max(float(lines["line_fraction"]), 1e-300)
    bases = dict(orders)
    named: list[LineName] = []
    for extra in ("f1", "f2", ""):
        most = 6 if len(bases) > 2 else 10  # with three bases as many combinations would fit by chance
        named = name_lines(frequency, bases, tolerance=step / 5, most=most, parts=8) if bases else []
        unnamed = [n.frequency for n in named if not n.name] if named else list(frequency[:1])
        if not extra or not unnamed or unnamed[0] < 16 * step / 5:
            break
        bases[extra] = unnamed[0]
    return [
        {"frequency": float(f), "share": float(power[k]) / whole, "name": (named[k].name or None) if named else None}
        for k, f in enumerate(frequency)
    ]


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
