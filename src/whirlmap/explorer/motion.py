"""The motion of one point: settled, recorded, and as the page draws it.

A point is settled by `whirlmap.label_points` and recorded by `whirlmap.simulate`, with the options that stand in `Recipe`:
the exported script calls the same two functions with the same options, and gets the same bits.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.analysis.motion.record_length import slowest_turn, spectrum_periods, turns_per_T
from whirlmap.analysis.simulation.poincare_section import section
from whirlmap.analysis.simulation.time_series import simulate
from whirlmap.analysis.spectra.line_names import named_shares
from whirlmap.analysis.spectra.spectral_lines import spectral_lines
from whirlmap.analysis.spectra.spectrum import power_spectrum
from whirlmap.explorer.encoding import encoded
from whirlmap.explorer.exploration import shown
from whirlmap.integrate.system import System
from whirlmap.options.computed import Integration, Labelling
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status
from whirlmap.sweep.points.label_points import label_points

Array = NDArray[np.float64]

#: T of the record at least, steps per T and per turn of the slowest clock at least, and T of a run that ends.
RECORD, PER_T, PER_TURN, ENDED = 256, 24, 192, 400
#: Samples of the time series that the page gets at most, those of each T at least, and bins of the spectrum.
SAMPLES, LEAST, BINS = 1600, 12, 2000
#: Turns of the slowest clock, or returns, that the page shows where they fit.
TURNS = 3
#: Crossings of the section of an unforced motion, in typical times.
CROSSINGS = 400
#: Lines of the spectrum that are named.
LINES = 12


@dataclass(frozen=True)
class Recipe:
    """Options by which a motion is computed: ``label_points`` with a labelling without exponents, then ``simulate``.

    Attributes
    ----------
    start : mapping of str to float
        Start state of the record: the end of the search for steady motion, or the system's own where the run ends.
    periods, steps : int
        T of the record, and steps per T.
    """

    start: Mapping[str, float]
    periods: int
    steps: int


@dataclass(frozen=True)
class Motion:
    """A recorded motion: the system at its point, the labelled point, the recipe and the series in the model's own units."""

    system: System
    point: xr.Dataset
    recipe: Recipe
    series: xr.Dataset
    crossings: xr.Dataset | None = None

    @property
    def status(self) -> Status:
        """How the run ended."""
        return Status(int(self.point["status"][0]))


def motion(system: System, labelling: Labelling, start: Array | None = None) -> Motion:
    """Settle and record the motion of a system.

    Parameters
    ----------
    start : array, shape (state,), optional
        The system's own start where absent.
    """
    name, value = system.parameters[0], float(system.vector[0])
    point = label_points(
        system, {name: [value]}, starts=None if start is None else start[:, None], ends=True,
        labelling=Labelling(labelling.settling, 0, labelling.integration),
    )  # fmt: skip
    end, least = np.asarray(point["end_state"])[0], int(point["steps"][0])
    turn = slowest_turn(system)
    wanted = max(PER_T, ceil(PER_TURN / turn)) if system.model.forced else max(least, PER_T)
    steps = max(least, 1) * ceil(wanted / max(least, 1))
    method, settled = labelling.integration.method, bool(np.isfinite(end).all())
    if settled:
        begin = dict(zip(system.states, end.tolist(), strict=True))
        periods = spectrum_periods(system, max(RECORD, 2 * int(point["period_T"][0])))
    else:
        begin = {} if start is None else dict(zip(system.states, start.tolist(), strict=True))
        late = float(point["end_time"][0]) / system.period
        periods = min(max(ceil(late * 1.02) if np.isfinite(late) else ENDED, 4), ENDED)
    recipe = Recipe(begin, periods, steps)
    series = simulate(
        system.replace(start=begin), periods=periods, integration=Integration(method, recipe.steps)
    )
    crossings = None
    if settled and not system.model.forced:
        crossings = section(system.replace(start=begin), points=CROSSINGS, transient=0, integration=labelling.integration)
    return Motion(system, point, recipe, series, crossings)


def motion_json(m: Motion, quantity: str) -> dict[str, Any]:
    """A motion as the page takes it; described at the top of ``page/explorer.js``."""
    ds = shown(m.system, m.series)
    x, outputs = np.asarray(ds["x"]), np.asarray(ds["outputs"])
    good = np.isfinite(x).all(axis=1)
    count = int(good.sum())
    steps = round((len(x) - 1) / max(float(ds["turn"][-1] - ds["turn"][0]), 1e-300))
    last, every = _shown_samples(m, steps, count) if m.status == Status.ok else (min(SAMPLES, count - 1), 1)
    part = slice(max(count - 1 - last * every, 0), count, every)
    units = _units(ds)
    names = [*m.system.states, *m.system.model.outputs]
    columns = dict(zip(names, np.concatenate([x, outputs], axis=1).T, strict=True))
    return {
        "turn": encoded(np.asarray(ds["turn"])[part] - float(ds["turn"][part.start])),
        "time": encoded(np.asarray(ds["time"])[part] - float(ds["time"][part.start])),
        "time_unit": str(ds["time"].attrs.get("units", "time")),
        "series": {name: encoded(column[part]) for name, column in columns.items()},
        "units": units,
        "section": _section(m, columns, steps, good),
        "spectrum": _spectrum(m, columns.get(quantity, columns[names[0]])[good], steps, quantity),
        "label": label_json(m),
        "numbers": _numbers(m),
    }  # fmt: skip


def _shown_samples(m: Motion, steps: int, count: int) -> tuple[int, int]:
    """Steps of the series that is shown, at the end of the record, and one of how many samples it takes.

    Whole returns or turns of the slowest clock; where one of them has more samples than a page gets, a part of these.
    """
    n = int(m.point["period_T"][0])
    turn = max(1, round(slowest_turn(m.system)))
    whole = n * max(min(ceil(TURNS * turn / n), SAMPLES // (n * steps)), 1) if n else TURNS * 4 * turn
    least = min((n or turn) * steps, count - 1)
    parts = [k for k in range(1, steps // LEAST + 1) if steps % k == 0] or [1]
    every = next((k for k in parts if least <= SAMPLES * k), parts[-1])
    return min(whole * steps, count - 1, SAMPLES * every) // every, every


def _section(m: Motion, columns: Mapping[str, Array], steps: int, good: NDArray[np.bool_]) -> dict[str, Any]:
    """Section points by state: once per T of a forced motion, crossings of an unforced one."""
    if not m.system.model.forced:
        if m.crossings is None:
            return {}
        found = np.asarray(shown(m.system, m.crossings)["section"])[0]
        found = found[np.isfinite(found).all(axis=1)]
        return {name: encoded(found[:, k]) for k, name in enumerate(m.system.states)}
    some = np.arange(len(good)) % steps == 0
    return {name: encoded(columns[name][some & good][1:]) for name in m.system.states}


def _spectrum(m: Motion, values: Array, steps: int, quantity: str) -> dict[str, Any] | None:
    """Power spectrum over frequencies in 1/T, the largest bin of each group where there are many; None without motion."""
    cyclic = {s.name: s.cyclic for s in m.system.model.states if s.cyclic is not None}
    if quantity in cyclic:
        values = np.sin(2 * np.pi * values / cyclic[quantity])
    if values.size < 64 or m.status != Status.ok or np.ptp(values) <= 1e-12 * np.abs(values).max(initial=0.0):
        return None
    spectrum = power_spectrum.find(values[1:], rate=float(steps), unit="T")
    lines = spectral_lines.find(spectrum)
    step = float(spectrum["frequency_step"])
    orders = turns_per_T(m.system)
    frequency, power = np.asarray(spectrum["frequency"]), np.asarray(spectrum["power"])
    seen = frequency <= max(4.0, 4 * max([abs(v) for v in orders.values()], default=1.0))
    frequency, power = frequency[seen], power[seen]
    group = ceil(power.size / BINS)
    rows = power.size // group * group
    best = power[:rows].reshape(-1, group).argmax(axis=1) + np.arange(rows // group) * group
    return {
        "quantity": quantity, "frequency": encoded(frequency[best]), "power": encoded(power[best]),
        "lines": named_shares(lines, orders, step=step, top=LINES),
        "broadband": float(lines["broadband_fraction"]),
    }  # fmt: skip


def label_json(m: Motion) -> dict[str, Any]:
    """The label of the search for steady motion: undecided where the motion does not return, for no votes were asked."""
    regime, n = Regime(int(m.point["regime"][0])), int(m.point["period_T"][0])
    status = m.status
    decided = regime != Regime.undecided
    text = regime.label if decided else "does not return"
    if regime == Regime.periodic:
        text = f"periodic, {n}T" if m.system.model.forced else f"periodic, {n} crossings"
    elif status not in (Status.ok, Status.contact, Status.diverged):
        text = status.name.replace("_", " ")
    return {
        "regime": int(regime), "name": regime.name, "text": text, "period": n, "decided": decided, "status": status.name,
        "settled_after": int(m.point["settled_after"][0]), "steps": int(m.point["steps"][0]),
        "distance": float(m.point["return_distance"][0]),
    }  # fmt: skip


def _numbers(m: Motion) -> list[dict[str, Any]]:
    """Amplitudes, films and loads over the record of the labelled point, in the units that are shown."""
    words = {"max_eccentricity": "largest eccentricity", "min_film": "thinnest film", "max_load": "largest load"}
    ds = shown(m.system, m.point[["peak_to_peak", *(name for name in words if name in m.point)]])
    found: list[dict[str, Any]] = []
    units = dict(zip([str(q) for q in np.asarray(ds["quantity"])], _each(ds["peak_to_peak"]), strict=False))
    for state in m.system.model.swing or m.system.model.states[:1]:
        value = float(ds["peak_to_peak"].sel(quantity=state.name)[0])
        unit = units.get(state.name, "1")
        meaning = state.meaning if unit == "1" else state.meaning.partition(", over ")[0]  # in a unit it is over nothing
        found.append({"name": f"peak to peak of {meaning}", "of": state.name, "value": value, "unit": unit})
    for name, text in words.items():
        for bearing in np.asarray(ds["bearing"]).tolist() if name in ds else ():
            value = float(ds[name].sel(bearing=bearing)[0])
            found.append({"name": f"{text}, bearing {bearing}", "of": "", "value": value,
                          "unit": str(ds[name].attrs.get("units", "1"))})  # fmt: skip
    return found


def _each(values: xr.DataArray) -> list[str]:
    return str(values.attrs.get("unit_of_each", "")).split()


def _units(ds: xr.Dataset) -> dict[str, str]:
    """Unit of every state and output."""
    found: dict[str, str] = {}
    for variable, dim in (("x", "state"), ("outputs", "output")):
        names = [str(n) for n in np.asarray(ds[dim])]
        found |= dict(zip(names, _each(ds[variable]) or ["1"] * len(names), strict=False))
    return {name: found.get(name, "1") for name in (*np.asarray(ds["state"]).tolist(), *np.asarray(ds["output"]).tolist())}
