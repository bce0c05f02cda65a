"""Diagnosis of a recorded signal: the indicators that need no equations, and the regime that they give together."""

import json
import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.signals.judged_signal import judge_signal
from whirlmap.analysis.signals.order_names import order_name
from whirlmap.analysis.signals.sliding import sliding_verdict
from whirlmap.errors import InputError, RangeError
from whirlmap.recordings.column_names import split_unit
from whirlmap.recordings.declared_rate import samples_per_second
from whirlmap.recordings.missing_values import filled, is_missing
from whirlmap.recordings.shaft_speed import ShaftSpeed, speed_of
from whirlmap.recordings.signal import Signal
from whirlmap.results.regime import Regime

Array = NDArray[np.float64]

#: Smallest rate, and the inverse of the largest.
SLOWEST = 1e-280


def diagnose_series(
    values: ArrayLike | Signal,
    *,
    rate: float | str | None = None,
    unit: str = "s",
    window: float | tuple[float, float] | None = None,
    missing: Sequence[str | float] = (),
    speed: float | str | ArrayLike | None = None,
    teeth: int | None = None,
    start: float = 0.0,
    quantity: str = "",
    quantity_unit: str = "1",
    progress: Callable[[int], None] | None = None,
) -> xr.Dataset:
    """Say of a recorded signal whether it is periodic, quasi-periodic or chaotic, with the evidence.

    Parameters
    ----------
    values : array, shape (time,), or Signal
        Evenly spaced samples; or what `whirlmap.read_signal` returns, which has rate, start, name, unit and speed of the
        shaft with it.
    rate : float or str
        Samples per unit of time; as text with a unit, ``"2 kHz"``, samples per second. A `Signal` that has none needs it.
    unit : str
        Unit of time.
    window : float or (float, float), optional
        First and last time of the part that is judged; or the length of windows that are judged too, half a window apart.
    missing : sequence of str or float
        Values that mean that there is none: ``-999``; ``"nan"`` for what is no finite number. Up to three in a row are
        filled by cubic interpolation; with more, the longest part without is judged. A `Signal` has none left.
    speed : float, str or array of shape (time,), optional
        Turns of a shaft per unit of time; as text with its unit, ``"1480 rpm"``. Lines are named as its orders.
    teeth : int, optional
        Of the gear on that shaft: mesh and sidebands are named.
    start : float
        Time of the first sample.
    quantity, quantity_unit : str
        Name and unit of the values, for pictures.
    progress : callable, optional
        Told of each window.

    Returns
    -------
    xr.Dataset
        ``regime``, ``confidence``, ``series(time)``, and under the names of their functions what the indicators gave:
        spectrum and lines, ``mutual_information(lag)``, ``false_neighbours(dimension)``, ``rosenstein(step)``,
        ``kantz(step)`` and ``dimension_*``, where they were asked. ``attrs["indicators"]`` is a JSON object of every vote,
        ``attrs["verdict"]`` some sentences, ``attrs["warnings"]`` a sentence a line on what was filled or assumed.
        ``attrs["frequency"]`` is the fundamental of periodic motion and its period is ``attrs["period"]``; of other motion
        it is the frequency of the strongest line. With windows, ``window_regime`` and the others of them over
        ``window_start``.

    Raises
    ------
    RangeError
        Fewer than 1000 samples or 30 oscillations, a constant signal, numbers that are not finite, a rate that is not
        positive, a window outside of the record.

    Warns
    -----
    UserWarning
        Values were filled, or a part of the record was left out.

    Notes
    -----
    1. The root mean square frequency, over the strongest bins of the spectrum that hold 95 % of the power, gives the
       oscillation. A signal with more than 80 samples per oscillation is thinned, after an anti-alias filter, to about 40;
       exponents and dimension are of the thinned signal.
    2. Steadiness (`steadiness`): where level, frequency or mean change within the record, it is ``not-steady``.
    3. Regular motion (`regular_motion`): 98 % of the power in lines; periodic where they have a common fundamental and
       the signal is itself again after its period, quasi-periodic where they have none.
    4. Where the motion is steady and does not return: lag from the first minimum of the mutual information (without one, a
       quarter swing, which is said), dimension from false neighbours; without one at that lag, nor at a half or a quarter of
       it, none of the embedded indicators speaks: noise, or too many dimensions. Exponents as `signal_exponents` says. On
       signals that return neighbours coincide, and no exponent is asked; nor of a torus whose lines hold 99.9 % of the
       power.
    5. Chaotic: the 0-1 test wanders, the lines do not hold all of the power, Rosenstein's or Kantz's exponent is
       positive over a scaling range, and so is the other, or the dimension has one: coloured noise may show one of them
       by chance. Quasi-periodic motion must not wander nor have Rosenstein's exponent. Else undecided.

    A signal says less than equations: exponents have no other error than the scatter within the one record, coloured noise
    can imitate a low dimension, and filters add dimensions.

    References
    ----------
    [takens1981] embedding; [fraser1986] its lag; [kennel1992] its dimension.
    [rosenstein1993] and [kantz1994] exponents; [grassberger1983] and [theiler1986] dimension; [gottwald2009] 0-1 test.
    [andrews1993] steadiness.
    """
    notices: list[str] = []
    shaft: ShaftSpeed | None = None
    x: Any = values
    if isinstance(values, Signal):
        rate = values.rate if rate is None else rate
        quantity, quantity_unit = quantity or split_unit(values.column)[0], values.unit or quantity_unit
        start, notices = values.start, list(values.notices)
        shaft, x = values.shaft, values.values
    per_unit = _rate(rate, unit)
    if speed is not None:
        shaft = _shaft(speed, per_unit, unit, np.size(x))
    if teeth is not None and shaft is None:
        raise RangeError("teeth: found it without speed, which it belongs to")
    told = len(notices)
    x, first = _without_missing(x, missing, notices)
    if notices[told:]:
        warnings.warn("; ".join(notices[told:]), stacklevel=2)
    part, length = (window, None) if isinstance(window, tuple) else (None, window)
    if part is not None:
        x, begin = _part(x, part, per_unit, start + first / per_unit, unit)
        first += begin
    if shaft is not None:
        shaft = ShaftSpeed(shaft.at - first, shaft.turns)
    ds = judge_signal(x, per_unit, unit, quantity=quantity, quantity_unit=quantity_unit)
    begun = start + first / per_unit
    ds = _with_orders(ds, shaft, teeth, notices).assign_attrs(start=begun, warnings="\n".join(notices))
    if length is None:
        return ds
    windows = sliding_verdict(
        x, rate=per_unit, length=float(length), start=begun, unit=unit, quantity_unit=quantity_unit, shaft=shaft,
        teeth=teeth, progress=progress,
    )  # fmt: skip
    return ds.merge(windows).assign_attrs(**ds.attrs, **windows.attrs)


def series_json(ds: xr.Dataset) -> dict[str, Any]:
    """Label, sentences and votes of `diagnose_series` as plain data; unknown numbers as None."""
    votes = json.loads(ds.attrs["indicators"])
    keys = ("rate", "unit", "samples", "thinned", "swing", "lag", "embedding_dimension")
    return {
        "regime": Regime(int(ds["regime"])).label, "confidence": float(ds["confidence"]), "verdict": ds.attrs["verdict"],
        "period": ds.attrs.get("period"), "frequency": ds.attrs.get("frequency"),
        "lyapunov": votes.get("rosenstein", {}).get("value"), "lyapunov_error": votes.get("rosenstein", {}).get("error"),
        "correlation_dimension": votes.get("dimension", {}).get("value"),
        "correlation_dimension_error": votes.get("dimension", {}).get("error"), "indicators": votes,
        **{key: ds.attrs[key] for key in keys},
    }  # fmt: skip


def _rate(rate: Any, unit: str) -> float:
    """Samples per unit of time."""
    if not isinstance(rate, str):
        try:
            per_unit = float(rate)
        except (TypeError, ValueError):
            per_unit = np.nan
        if not SLOWEST < per_unit < 1 / SLOWEST:
            raise RangeError(
                f"rate = {rate!r}: a positive number of samples per unit of time, {SLOWEST:g} to {1 / SLOWEST:g}, or a text"
                " such as '25.6 kHz', is needed"
            )
        return per_unit
    try:
        found = samples_per_second(rate)
    except InputError:
        found = 0.0
    if found <= 0 or rate.strip()[-1].isdigit() or rate.strip()[-1] == ".":
        raise RangeError(f"rate = {rate!r}: a number, or a text with a unit such as '25.6 kHz', is needed")
    if unit != "s":
        raise RangeError(f"rate = {rate!r} is per second, but unit = {unit!r}: give a number per {unit}")
    return found


def _shaft(speed: Any, rate: float, unit: str, samples: int) -> ShaftSpeed:
    if isinstance(speed, str):
        turns = speed_of(speed)
        if turns is None:
            raise RangeError(f"speed = {speed!r}: a number with its unit, such as '1480 rpm', is needed")
        if unit != "s":
            raise RangeError(f"speed = {speed!r} is per second, but unit = {unit!r}: give a number of turns per {unit}")
        return ShaftSpeed.constant(turns / rate, samples)
    each = np.asarray(speed, dtype=float)
    if each.ndim == 0 and np.isfinite(each) and each != 0:
        return ShaftSpeed.constant(abs(float(each)) / rate, samples)
    if each.shape != (samples,) or not np.isfinite(each).all():
        raise RangeError(
            f"speed of shape {each.shape}: one finite number that is not zero, or one for each of the {samples} samples, is"
            " needed"
        )
    return ShaftSpeed.of_values(np.arange(samples, dtype=float), each / rate)


def _without_missing(values: Any, missing: Sequence[str | float], notices: list[str]) -> tuple[Any, int]:
    """Signal without missing values, and samples before it."""
    if not len(missing):
        return values, 0
    x = np.asarray(values, dtype=float)

    def place(row: int) -> str:
        return f"sample {row + 1}"

    def refused(row: int, count: int) -> InputError:
        return InputError(
            f"{place(row)} of the signal is {x[row]} ({count} such samples): all must be finite numbers; missing=['nan']"
            " leaves others out"
        )

    gone = is_missing("the signal", x, missing, notices, place, refused)
    return filled(x[~gone], np.flatnonzero(~gone), notices)


def _part(values: Any, part: tuple[float, float], rate: float, start: float, unit: str) -> tuple[Array, int]:
    """Values of a part of the record, and samples before it."""
    x = np.asarray(values, dtype=float)
    end = start + x.size / rate
    first, last = (round((edge - start) * rate) for edge in (max(part[0], start), min(part[1], end)))
    if last - first < 1:
        raise RangeError(f"window = {part}: the signal goes from {start:.6g} to {end:.6g} {unit}")
    return x[first:last], first


def _with_orders(ds: xr.Dataset, shaft: ShaftSpeed | None, teeth: int | None, notices: list[str]) -> xr.Dataset:
    """Name the lines as orders of the shaft, by its mean speed."""
    samples, rate = int(ds.attrs["samples"]), float(ds.attrs["rate"])
    if shaft is None:
        return ds
    turning = shaft.per_sample(0, samples)
    if not turning:
        notices.append("the speed of the shaft is zero, or known in less than half of the record: no line has an order")
        return ds
    votes = json.loads(ds.attrs["indicators"])
    for line in votes["spectrum"]["named"]:
        line["order"] = line["frequency"] / (turning * rate)
        line["order_name"] = order_name(line["frequency"], turning * rate, teeth, rate / samples) or None
    more = {} if teeth is None else {"teeth": teeth}
    return ds.assign_attrs(indicators=json.dumps(votes), speed=turning * rate, **more)
