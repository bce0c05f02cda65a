"""Measures of a perturbed ensemble after its transient: spectrum, section, dimension, multipliers, and their votes."""

from collections.abc import Callable
from fractions import Fraction
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.indicators.birkhoff import locking_ratio
from whirlmap.analysis.indicators.correlation_dimension import STATUS, correlation_dimension
from whirlmap.analysis.indicators.recurrence import recurrence
from whirlmap.analysis.indicators.section_coordinates import moving_coordinates
from whirlmap.analysis.labels.regime import regime
from whirlmap.analysis.labels.votes import INDICATORS, Vote
from whirlmap.analysis.motion.record_length import recorded, spectrum_periods
from whirlmap.analysis.motion.section_crossing import run_with_crossings
from whirlmap.analysis.simulation.time_series import outputs_of
from whirlmap.analysis.spectra.line_names import named_shares
from whirlmap.analysis.spectra.spectral_lines import spectral_lines
from whirlmap.analysis.spectra.spectrum import power_spectrum
from whirlmap.analysis.variational.floquet import STEPS, floquet_multipliers
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.system import System
from whirlmap.results.schema import variable

Array = NDArray[np.float64]
Data = dict[str, Any]

#: Least steps per T of the recorded time series.
RECORD_STEPS = 96
#: Runs of the ensemble whose section points are judged, each by itself.
JUDGED = 8
#: T of the longest orbit whose Floquet multipliers are computed.
LONGEST_ORBIT = 128
#: Distance from its start at which an orbit ends, over the accuracy of its steps, and distance from 1 of the multiplier of
#: an unforced orbit's time direction, up to which its multipliers count.
CLOSES, TRIVIAL = 100.0, 1e-3
#: Distance of a multiplier from 1 that counts as none where a body is held by friction: over the distance by which the orbit
#: fails to close, and at least.
CLOSED, HELD = 10.0, 1e-9
#: Section points of one run whose recurrence is counted.
RECURRENT = 1500
#: Share of the power outside of lines below which a spectrum is one of lines, and above which it is broadband.
ALL_LINES, BROAD = 1e-4, 0.05


def section_votes(
    part: Ensemble, running: NDArray[np.bool_], section: Array, exponent: tuple[float, float], duration: float,
    cyclic: dict[int, float],
) -> Data:  # fmt: skip
    """Votes of 0-1 test, Birkhoff averages and recurrence on non-periodic motion; medians over several runs.

    Parameters
    ----------
    part : Ensemble
        Of the operating point.
    running : array of bool, shape (run,)
    section : array, shape (time, state, run)
        Once per T, or crossings.
    exponent : tuple
        Largest exponent and its error, over all runs.
    """
    some = np.flatnonzero(running)[:JUDGED]
    if not some.size:
        return {}
    judged = regime.find(
        np.zeros(some.size, dtype=np.int8), np.zeros(some.size, dtype=np.int64), exponent=exponent[0],
        exponent_error=exponent[1], duration=duration, section=section[:, :, some], common=part.common_multiple,
        cyclic=cyclic, returns=part.returns,
    )  # fmt: skip
    says = {
        name: Vote(int(np.bincount(row).argmax())).name for name, row in zip(INDICATORS, judged["vote"], strict=True)
    }
    numbers = {n: _median(judged[n]) for n in ("zero_one", "zero_one_low", "digits", "winding", "winding_error")}
    votes: Data = {
        "zero_one": {
            "vote": says["zero_one"], "value": numbers["zero_one"], "lower_quartile": numbers["zero_one_low"],
            "points": section.shape[0],
        },
        "birkhoff": {"vote": says["birkhoff"], "digits": numbers["digits"]},
    }  # fmt: skip
    turned = numbers["winding"]
    error = numbers["winding_error"]
    if turned is not None and error is not None:
        votes["birkhoff"] |= {"winding": turned, "winding_error": error}
        if error * 64**2 < 1:
            locking = locking_ratio(turned, error)
            votes["birkhoff"] |= {"ratio": str(locking.ratio), "locked": locking.locked}
    strobed = section[(section.shape[0] - 1) % part.strobe :: part.strobe]
    columns, moves = moving_coordinates(strobed[-RECURRENT:, :, some[:1]], cyclic)
    if moves.any() and columns.shape[2] >= 100:
        r = recurrence.find(columns[0, moves[0]].T)
        votes["recurrence"] = {
            "vote": None, "rate": float(r["recurrence_rate"]), "determinism": float(r["determinism"]),
            "radius": float(r["radius"]),
        }  # fmt: skip
    return votes


def record_series(
    system: System, part: Ensemble, least: int, data: Data, coords: Data, orders: dict[str, float]
) -> Data | None:
    """Time series of the first run into ``data``; the vote of its spectrum, where it ran to its end.

    ``least`` T, or more where the slowest clock asks for them (`spectrum_periods`). The window is Hann's, as the record need
    not hold whole periods.
    """
    first = part.subset(np.array([0]), steps=max(int(part.point_steps[0]), RECORD_STEPS))
    kept = spectrum_periods(system, least)
    every = max(first.steps // 32, 1)
    while first.steps % every:
        every -= 1
    x = recorded(first, kept, Fraction(every, first.steps))[:, :, 0]
    turn = np.arange(1, x.shape[0] + 1) * every / first.steps
    coords["time"] = variable("time", turn * float(first.period[0]), "time", "time since the record began")
    coords["turn"] = variable("time", turn, "T", "time since the record began, in periods T")
    data["x"] = variable(("time", "state"), x, "1", "state")
    data["outputs"] = variable(("time", "output"), outputs_of(system.model, system.vector, x.T).T, "1", "output")
    if not (first.running[0] and system.model.swing):
        return None
    swing = system.model.swing[0]
    series = x[:, system.states.index(swing.name)]
    if swing.cyclic is not None:
        series = np.sin(2 * np.pi * series / swing.cyclic)
    if np.ptp(series) <= 1e-12 * np.abs(series).max(initial=0.0):
        return None
    spectrum = power_spectrum.find(series, rate=first.steps / every, unit="T")
    lines = spectral_lines.find(spectrum)
    broad = float(lines["broadband_fraction"])
    step = float(spectrum["frequency_step"])
    return {
        "vote": "lines" if broad < ALL_LINES else "broadband" if broad > BROAD else "none",
        "state": swing.name, "lines": int(lines["count"]), "broadband_fraction": broad, "resolution": step,
        "named": named_shares(lines, orders, step=step),
    }  # fmt: skip


def section_and_dimension(
    part: Ensemble, points: int, data: Data, *, members: NDArray[np.intp], runs: int, measure: bool,
    torus: Array | None = None, progress: Callable[[int], None] | None = None,
) -> Data | None:  # fmt: skip
    """Section points of all runs into ``data``; the correlation dimension where wanted.

    Once per common period; once per T where the forcing has none of a reasonable length (`Ensemble.strobe`).

    The runs of the ensemble decorrelate in chaos, and are one sample; on a torus they stay side by side, so that there the
    points of one long run, ``torus`` of shape (time, state), give the dimension. ``part`` holds the ``members`` of ``runs``
    runs that have not ended; the others have no section.
    """
    every = part.strobe
    each = max(-(-points // part.points), 8)
    saved = part.advance(each * every, save_periods=every, progress=progress).saved
    section = np.moveaxis(saved, 2, 0)
    whole = np.full((runs, *section.shape[1:]), np.nan)
    whole[members] = section
    meaning = "section point, once per common period (T if that is long)"
    data["section"] = variable(("run", "period", "state"), whole, "1", meaning)
    good = section[part.running]
    if not measure or not good.size:
        return None
    flat = good.reshape(-1, good.shape[2])
    of = np.repeat(np.arange(good.shape[0]), good.shape[1])
    if torus is not None:
        if not len(torus):
            return {"vote": "none", "reason": "the exponents' run was too short for a section"}
        flat, of = torus, np.zeros(len(torus), dtype=np.int64)
    d = correlation_dimension.find(flat, theiler=10, trajectories=of)
    data |= {f"dimension_{name}": v for name, v in d.variables.items()}
    data |= {name: c for name, c in d.coordinates.items() if name not in data}
    return {"vote": STATUS[int(d["status"])], "value": number(d["D2"]), "error": number(d["D2_error"])}


def multipliers(system: System, part: Ensemble, multiple: int, period: int, data: Data) -> Data:
    """Floquet multipliers of the first run's periodic orbit into ``data``, and their vote."""
    if period > LONGEST_ORBIT:
        return {"vote": "none", "reason": f"the orbit is longer than {LONGEST_ORBIT} T"}
    x, duration = part.x[:, 0], period * float(part.period[0])
    if not system.model.forced:
        closed = _closed_orbit(part.subset(np.array([0])), multiple)
        if closed is None:
            return {"vote": "none", "reason": "the section is not crossed"}
        x, duration = closed
    steps = ceil(int(part.point_steps[0]) * system.period / float(part.period[0]))  # for the typical time as declared
    try:
        found = floquet_multipliers.find(system, x, duration, steps=max(STEPS, steps))
    except RangeError as fault:
        return {"vote": "none", "reason": str(fault)}
    data |= {f"floquet_{name}": found.variable(name) for name in ("log_modulus", "argument")}
    closure, off = float(found["closure"]), float(found["trivial_error"])
    if closure > CLOSES * max(part.accuracy or 0.0, float(np.nan_to_num(part.step_error[0]))) and part.accuracy is not None:
        return {"vote": "none", "reason": "the orbit does not close", "closure": number(closure)}
    if off > TRIVIAL:
        return {"vote": "none", "reason": "the multiplier of the time direction is not 1", "trivial_error": number(off)}
    trivial, moduli = int(found["trivial"]), found["log_modulus"]
    others = np.delete(moduli, trivial) if trivial >= 0 else moduli
    largest = float(np.exp(others[0])) if others.size else 0.0
    vote = "stable" if found["stable"] else "unstable"
    if part.sliding[0]:
        # A body that dry friction holds stays wherever it is put: that multiplier is 1, as well as the orbit closes, and
        # rounding decides on which side of it.
        held = np.abs(np.exp(moduli + 1j * found["argument"]) - 1) <= max(CLOSED * closure, HELD)
        vote = "neutral" if held.any() and (moduli[~held] < 0).all() else vote
    return {
        "vote": vote, "largest": largest,
        "smallest_log10": number(others[-1] / np.log(10)) if others.size else None,
        "trivial_error": number(found["trivial_error"]), "closure": number(found["closure"]),
    }  # fmt: skip


def _closed_orbit(one: Ensemble, multiple: int) -> tuple[Array, float] | None:
    """A section point of an unforced orbit, and the time to its return ``multiple`` crossings later."""
    points, times, _ = run_with_crossings(one, 2 * ceil(multiple) + 2)
    if times.shape[0] <= multiple or not np.isfinite(times[multiple, 0]):
        return None
    return points[0, :, 0], float(times[multiple, 0] - times[0, 0])


def number(value: Any) -> float | None:
    """Plain float, or None where it is not finite."""
    plain = float(value)
    return plain if np.isfinite(plain) else None


def _median(values: Array) -> float | None:
    finite = values[np.isfinite(values)]
    return float(np.median(finite)) if finite.size else None

