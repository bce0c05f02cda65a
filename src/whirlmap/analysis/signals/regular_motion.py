"""Test for regular motion by spectral lines: share of the power, common fundamental, and return of the signal."""

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.signals.common_grid import ERRORS, CommonGrid, common_grid
from whirlmap.analysis.signals.line_fit import fit_lines
from whirlmap.analysis.signals.signal_return import return_distance
from whirlmap.analysis.spectra.line_names import named_shares
from whirlmap.results.findings import Findings

Array = NDArray[np.float64]

#: Shares of the power: of one line that counts, of all lines in regular motion, outside of lines in broadband motion.
LINE, LINES, BROAD = 1e-3, 0.98, 0.1
#: Share of lines that are asked too where the period of the stronger ones leaves a distance, and distance that is none.
FAINT, FINER = 1e-6, 1e-8
#: Lines that are told apart, at most.
MOST = 40
#: Largest distance after a return, beyond the power outside of lines.
RETURNED = 0.02
#: Periods after which a signal is compared with itself at most, where one period shows too much.
LATER = 16
#: Beats of two neighbouring lines that a record must hold, for fewer may be a slow change.
BEATS = 4.5
#: Frequency steps below which power is slow drift.
SLOW = 8


@dataclass(frozen=True)
class RegularMotion:
    """Votes of the lines, as plain data, and what follows from them.

    Attributes
    ----------
    votes : dict
        ``spectrum``, ``grid`` and ``return``.
    period : float or None
        In samples, where the signal returns.
    counted : array of int, shape (line,)
        Which of the lines of the spectrum count.
    frequency, share : array, shape (line,)
        Of the lines that count, the strongest first: fitted, in cycles per sample, and share of the power.
    broad : float
        Share of the power outside of lines.
    """

    votes: dict[str, Any]
    period: float | None
    counted: NDArray[np.intp]
    frequency: Array
    share: Array
    broad: float


def regular_motion(x: Array, spectrum: Findings, lines: Findings) -> RegularMotion:
    """Ask the lines of a spectrum whether the motion is periodic or quasi-periodic.

    Parameters
    ----------
    x : array, shape (time,)
    spectrum, lines : Findings
        From `power_spectrum` at one sample per unit, and `spectral_lines`.

    Notes
    -----
    Regular motion has 98 % of its power in lines: 17 dB above noise. Those with a thousandth of the power, and with more
    than rounding to the levels of the record makes, are fitted
    (`line_fit`); where they lie on a common grid that is no chance (`common_grid`), and the signal is itself again after the
    period that this grid says (`signal_return`), it is periodic. Without a grid it is quasi-periodic, if the record holds
    4.5 beats of any two neighbouring lines. Fainter lines, to a millionth of the power, decide only whether a period is a
    part of a longer one, after which the signal returns more closely: subharmonics of a motion without noise.
    """
    n = x.size
    broad = float(lines["broadband_fraction"])
    frequency, power = np.asarray(lines["line_frequency"], float), np.asarray(lines["line_power"], float)
    total = float(power.sum()) / max(float(lines["line_fraction"]), 1e-300)
    share = power / total if power.size else power
    counted = np.flatnonzero(share > max(LINE, _rounding(x)))[:MOST]
    density = np.asarray(spectrum["density"])
    slow = float(density[:SLOW].sum() / density.sum())
    vote = "broadband" if broad > BROAD else "none"
    grid, distance, fitted = None, None, frequency[counted] * n
    if broad < 1 - LINES and counted.size:
        grid, fitted = _grid(x, lines, share, counted)
        if grid.kind == "grid":
            grid, distance = _returned(x, grid, broad)
            faint = np.flatnonzero(share > FAINT)[:MOST]
            if distance > FINER and faint.size > counted.size:
                finer, _ = _grid(x, lines, share, faint)
                if finer.kind == "grid" and finer.fundamental < 0.9 * grid.fundamental:
                    finer, shorter = _returned(x, finer, broad)
                    if shorter < distance / 5:
                        grid, distance = replace(finer, multiples=finer.multiples[: counted.size]), shorter
        vote = _vote(grid, distance, broad, fitted)
    named = _named(lines, grid, share, fitted, counted, 1.0 / n)
    votes = {
        "spectrum": {
            "vote": vote,
            "broadband_fraction": broad,
            "slow_fraction": slow,
            "lines": int(lines["count"]),
            "named": named,
        },
        "grid": {
            "vote": grid.kind if grid else None,
            "chance": grid.chance if grid else None,
            "multiples": [int(m) for m in grid.multiples] if grid and grid.kind == "grid" else None,
        },
        "return": {"vote": None if distance is None else "returns" if vote == "periodic" else "no", "distance": distance},
    }
    found = grid if vote == "periodic" else None
    return RegularMotion(votes, n / found.fundamental if found else None, counted, fitted / n, share[counted], broad)


def _grid(x: Array, lines: Findings, share: Array, chosen: NDArray[np.intp]) -> tuple[CommonGrid, Array]:
    """Common grid of some lines, and their fitted frequencies in cycles per record."""
    frequency, floor = (np.asarray(lines[name], float)[chosen] for name in ("line_frequency", "line_floor"))
    found = fit_lines(x, frequency * x.size, floor)
    return common_grid(found.frequency, found.error, share[chosen], samples=x.size), found.frequency


def _returned(x: Array, grid: CommonGrid, broad: float) -> tuple[CommonGrid, float]:
    """Distance after the period of a grid, and the grid, moved to a whole number of samples where that is as good."""
    period = x.size / grid.fundamental
    distance = return_distance(x, period)
    # Edges between samples do not move by parts of a sample: a few periods later they may lie on samples again.
    for later in range(2, LATER + 1) if distance > broad + RETURNED else ():
        if later * period < x.size / 2:
            distance = min(distance, return_distance(x, later * period))
    whole = round(period)
    if whole >= 2 and abs(period - whole) < max(0.02, ERRORS * period * grid.error / grid.fundamental):
        exact = return_distance(x, float(whole))
        if exact <= distance:
            return replace(grid, fundamental=x.size / whole), exact
    return grid, distance


def _rounding(x: Array) -> float:
    """Share of the power that comes from rounding to few levels: a twelfth of the square of their step."""
    part = x[:100_000]
    levels = np.unique(part)
    if levels.size > part.size / 3 or levels.size < 3:
        return 0.0
    return float(np.diff(levels).min() ** 2 / 12 / x.var())


def _vote(grid: CommonGrid, distance: float | None, broad: float, fitted: Array) -> str:
    if grid.kind == "grid":
        return "periodic" if distance is not None and distance <= broad + RETURNED else "none"
    if grid.kind == "chance":
        return "none"
    apart = np.diff(np.sort(fitted))
    return "quasi-periodic" if apart.size and apart.min() >= BEATS else "none"


def _named(
    lines: Findings,
    grid: CommonGrid | None,
    share: Array,
    fitted: Array,
    counted: NDArray[np.intp],
    step: float,
) -> list[dict[str, Any]]:
    """Lines with fitted frequency, share and name: fractions of the strongest where there is a grid, else sums of two."""
    if grid is None or grid.kind != "grid":
        listed = [line for line in named_shares(lines, {}, step=step) if float(str(line["share"])) > LINE]
        known = np.asarray(lines["line_frequency"], float)[counted]
        for line in listed:  # the peak of the spectrum is less exact than the fit
            beside = np.abs(known - float(str(line["frequency"])))
            if beside.size and beside.min() < step / 100:
                line["frequency"] = float(fitted[int(beside.argmin())]) * step
        return listed
    first = int(grid.multiples[0])
    out = []
    for k, m in enumerate(grid.multiples[:12]):
        ratio = Fraction(int(m), first)
        name = "f1" if ratio == 1 else f"{ratio} f1"
        out.append({"frequency": float(fitted[k]) * step, "share": float(share[counted[k]]), "name": name})
    return out
