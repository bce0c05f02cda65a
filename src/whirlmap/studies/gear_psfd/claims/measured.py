"""The number by which each statement of the paper is judged, in a few words, for one machine.

A verdict is one word; the report puts beside it the number that it comes from, and what that number has to be.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from whirlmap.studies.gear_psfd.claims.claims import (
    Claim,
    calm_and_rough,
    rank_correlation,
    suppressed,
    without_return,
)
from whirlmap.studies.gear_psfd.claims.labelled import PSI, Array, Labelled, median_of, positive
from whirlmap.studies.gear_psfd.claims.thresholds import (
    ALMOST_ALL,
    BROADBAND,
    DIMENSION_ERRORS,
    GROWS,
    LARGER,
    MANY_LINES,
    SMALLER,
    THREE_WINDOWS,
    WINDOWS,
    chaotic_windows,
    windows_of,
)

ALMOST = f"at least {ALMOST_ALL:.0%}"
#: Where numbers of all permeabilities stand beside each other.
AT_EACH = f"at ψ = {' / '.join(f'{psi:g}' for psi in PSI)}"
#: Speeds of a kind, and coordinates, in words.
SPEEDS = {"chaotic": "chaotic speeds", "with the forcing": "speeds with the period of the forcing"}
SYMBOLS = {"yp": "y_p", "y2": "y_2"}


@dataclass(frozen=True)
class Measured:
    """What is measured for a claim, what it has to be, and what it is."""

    quantity: str
    wanted: str
    number: str


def measured(d: Labelled, claim: Claim) -> Measured:
    """The number of a claim; of the first parameter set, where there are several."""
    return MEASURES[claim.id](d, claim)


def _nonperiodic(d: Labelled, _claim: Claim) -> Measured:
    return Measured("speeds without a return", ALMOST, f"{float(d.open[0, 0].mean()):.0%}")


def _amplitude_grows(d: Labelled, _claim: Claim) -> Measured:
    rank = float(rank_correlation(d)[0])
    number = "none: too few speeds run to the end" if np.isnan(rank) else f"{rank:+.2f}"
    return Measured("rank correlation of the peak-to-peak of y_p with s", f"above {GROWS[1]:g}", number)


def _window(psi: float, low: float, high: float, kind: str) -> Callable[[Labelled, Claim], Measured]:
    speeds = f"from s = {low:g}" if np.isinf(high) else f"at s = {low:.2f} .. {high:.2f}" if low else f"up to s = {high:.2f}"
    quantity = f"{SPEEDS[kind]} {speeds}"

    def found(d: Labelled, _claim: Claim) -> Measured:
        return Measured(quantity, ALMOST, _share(d, PSI.index(psi), kind, d.between(low, high)))

    return found


def _share(d: Labelled, psi: int, kind: str, where: np.ndarray) -> str:
    return f"{float(d.share(d.kinds[kind][:, psi], where)[0]):.0%}" if where.any() else "no speed"


def _large_amplitude(d: Labelled, _claim: Claim) -> Measured:
    at = PSI.index(1e-4)
    inside, rest = chaotic_windows(d)
    quantity = "peak-to-peak of y_p at s = 1.48 .. 1.60, over that of the rest of the chaotic window"
    if not (d.kinds["chaotic"][0, at] & (inside | rest)).any():
        return Measured(quantity, f"above {LARGER:g}", "none: no chaos there")
    a, b = (float(median_of(d.amplitude[:, at], where)[0]) for where in (inside, rest))
    return Measured(quantity, f"above {LARGER:g}", f"{a / b:.2f}" if b > 0 else "none: the rest does not run to the end")


def _three_windows(psi: float) -> Callable[[Labelled, Claim], Measured]:
    quantity = "chaotic speeds at s = 1.60 .. 1.62 / above 3.15 / speeds with the period of the forcing elsewhere"

    def found(d: Labelled, _claim: Claim) -> Measured:
        shares = " / ".join(_share(d, PSI.index(psi), kind, where) for kind, where in windows_of(d))
        return Measured(quantity, f"{ALMOST} each", shares)

    return found


def _each(values: Array, write: str, none: str = "none") -> str:
    """Numbers of all permeabilities, with a dash where there is none."""
    if not np.isfinite(values).any():
        return none
    return " / ".join(format(v, write) if np.isfinite(v) else "–" for v in map(float, values))


def _lyapunov(d: Labelled, _claim: Claim) -> Measured:
    o = d.orbits
    above = int(positive(o.exponent, o.error, o.least)[0].sum())
    number = _each(o.exponent[0], "+.5f")
    if number != "none":
        number += f"; {above} of {len(PSI)} above zero"
    return Measured(f"largest exponent per radian {AT_EACH}", "three standard errors above zero", number)


def _dimension(coordinate: str) -> Callable[[Labelled, Claim], Measured]:
    def found(d: Labelled, claim: Claim) -> Measured:
        value, error = (rows[0] for rows in d.orbits.dimension[coordinate])
        had = [f"{v:.2f} ± {e:.2f}" if np.isfinite(v) else "–" for v, e in zip(value, error, strict=True)]
        number = " / ".join(had) if np.isfinite(value).any() else "none"
        wanted = f"{claim.value} within {DIMENSION_ERRORS} errors, at any"
        return Measured(f"dimension of {SYMBOLS[coordinate]} {AT_EACH}", wanted, number)

    return found


def _spectrum(d: Labelled, _claim: Claim) -> Measured:
    number = _each(d.orbits.lines[0], ".0f")
    if number != "none":
        number += f"; {_each(d.orbits.broadband[0], '.1%')}"
    quantity = f"lines in the spectrum of y_p; power beside them, {AT_EACH}"
    return Measured(quantity, f"at least {MANY_LINES} lines; or at least {BROADBAND:.0%}", number)


def _regularises(d: Labelled, _claim: Claim) -> Measured:
    return Measured(f"speeds without a return {AT_EACH}", "falls with ψ", _each(without_return(d)[0], ".0%"))


def _suppresses(d: Labelled, _claim: Claim) -> Measured:
    shared, median, less = suppressed(d)
    number = "none: no speed runs to its end at every ψ"
    if shared[0].any():
        number = f"{float(median[0, -1] / median[0, 0]):.2f}; smaller at {float(less[0]):.0%}"
    quantity = f"peak-to-peak of y_p at ψ = {PSI[-1]:g}, over that at ψ = {PSI[0]:g}; speeds at which it is smaller"
    return Measured(quantity, f"below {SMALLER:g}; more than half", number)


def _safe_speeds(d: Labelled, _claim: Claim) -> Measured:
    choice, calm, rough = (rows[0] for rows in calm_and_rough(d))
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = np.where(choice, calm / rough, np.nan)
    quantity = f"peak-to-peak of y_p at periodic speeds, over that at the others, {AT_EACH}"
    return Measured(quantity, "below 1", _each(ratio, ".2f", "none: no choice of speeds"))


MEASURES: dict[str, Callable[[Labelled, Claim], Measured]] = {
    "fig2-nonperiodic": _nonperiodic,
    "fig2-amplitude-grows": _amplitude_grows,
    **{name: _window(*found) for name, found in WINDOWS.items()},
    "fig3-large-amplitude": _large_amplitude,
    **{name: _three_windows(psi) for name, psi in THREE_WINDOWS.items()},
    "fig67-lyapunov": _lyapunov,
    "fig6-dimension-yp": _dimension("yp"),
    "fig7-dimension-y2": _dimension("y2"),
    "fig67-spectrum": _spectrum,
    "permeability-regularises": _regularises,
    "permeability-suppresses-amplitude": _suppresses,
    "safe-speeds": _safe_speeds,
}
