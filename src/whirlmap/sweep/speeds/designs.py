"""Several machines of one model judged at the same speeds: designs, or draws over tolerances."""

from collections.abc import Sequence
from typing import Unpack

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.errors import RangeError
from whirlmap.integrate.system import System
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import LabellingParts, takes_options
from whirlmap.results.schema import variable
from whirlmap.results.wilson import wilson_interval
from whirlmap.sweep.speeds.run_up_and_down import cold_motions, motions_met, outcome
from whirlmap.sweep.speeds.verdicts import Judge, Verdict, amplitude_variable, shaft_speed, speed_of, verdict_variable

Array = NDArray[np.float64]


@takes_options()
def safe_probability(
    system: System,
    draws: Sequence[System],
    speeds: ArrayLike,
    limits: ArrayLike,
    *,
    quantity: str | None = None,
    follow: bool = True,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    **_given: Unpack[LabellingParts],
) -> xr.Dataset:
    """Share of drawn machines that are safe at each speed, with its 95 % interval (Wilson), and of each reason why not.

    Parameters
    ----------
    system : System
        The machine as it was meant, whose ``s`` counts the speeds.
    draws : sequence of System
        Machines of the same model.
    speeds, limits, quantity, follow, labelling, execution
        As in `judge_machines`.

    Returns
    -------
    xr.Dataset
        ``probability(s)`` of safe, ``probability_low``, ``probability_high``; ``probability_of(why, s)``,
        by name of the `Verdict`.
    """
    at, speed = np.asarray(speeds, dtype=float), speed_of(system)
    judged = judge_machines(
        system, draws, at, limits, quantity=quantity, follow=follow, labelling=labelling, execution=execution
    )
    codes = np.array(list(Verdict))
    counts = (judged["verdict"].values == codes[:, None, None]).sum(axis=1)
    low, high = wilson_interval(counts[Verdict.safe], len(draws))
    meaning = "share of the drawn machines that are safe"
    return xr.Dataset(
        {
            "probability": variable(speed, counts[Verdict.safe] / len(draws), "1", meaning),
            "probability_low": variable(speed, low, "1", f"{meaning}: lower end of its 95 % interval"),
            "probability_high": variable(speed, high, "1", f"{meaning}: upper end of its 95 % interval"),
            "probability_of": variable(("why", speed), counts / len(draws), "1", "share of the drawn machines of a verdict"),
        },
        {speed: at, "why": [v.name for v in Verdict]},
        judged.attrs,
    )


@takes_options()
def judge_machines(
    system: System,
    machines: Sequence[System],
    speeds: ArrayLike,
    limits: ArrayLike,
    *,
    quantity: str | None = None,
    follow: bool = False,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    **_given: Unpack[LabellingParts],
) -> xr.Dataset:
    """Judge several machines of one model at the same speeds, all of them together.

    Parameters
    ----------
    system : System
        The machine whose ``s`` counts the speeds.
    machines : sequence of System
        They run at the same speed of the first shaft [rad/s] where the cases have dimensions, else at the same ``s``.
    speeds : array_like, shape (s,)
        Values of ``s`` of `system`.
    limits : array_like, shape (machine,)
        Largest peak-to-peak displacement that is allowed to each, in its own length.
    quantity : str, optional
        As in `safe_speeds`.
    follow : bool
        Whether each machine runs up and down through the speeds beside its cold starts.
    labelling : Labelling, optional
        How points are measured; or its parts as keywords, ``settling``, ``lyapunov``, ``method``, ``steps``, ``accuracy``.
    execution : Execution, optional
        How it is run, which changes no number; or its parts as keywords, ``workers``, ``progress``.

    Returns
    -------
    xr.Dataset
        ``verdict(machine, s)`` and, of the worst motion met, ``amplitude(machine, s)`` in each machine's own length.

    Raises
    ------
    RangeError
        No machine; machines of different models or orders of harmonics; a shaft at rest.
    """
    speed = speed_of(system)
    at, allowed = np.asarray(speeds, dtype=float), np.asarray(limits, dtype=float)
    if not machines:
        raise RangeError("found no machine, expected at least one")
    names = [n for n in system.parameters if n != speed]
    differing = {n for m in machines for n in names if m.values.get(n) != system.values[n]}
    for machine in machines:
        if machine.model.states != system.model.states or dict(machine.model.switches) != dict(system.model.switches):
            raise RangeError(f"{machine.case} with these changes is another model than {system.case}: compare one model")
    scales = np.array([shaft_speed(machine) for machine in machines]) / shaft_speed(system)
    scales = np.where(np.isfinite(scales), scales, 1.0)
    if not np.all(scales > 0):
        raise RangeError("the first shaft of a machine does not turn at any s: its speeds cannot be compared")
    values = {n: np.repeat([float(m.values[n]) for m in machines], at.size) for n in names if n in differing}
    values[speed] = (at / scales[:, None]).ravel()
    judge, each = Judge(system, quantity, labelling, execution), np.repeat(allowed, at.size)
    met = motions_met(judge, values, each, at.size) if follow else cold_motions(judge, values, each)
    found, over = outcome(met, each.size), ("machine", speed)
    verdict, swing = (found[name].values.reshape(-1, at.size) for name in ("verdict", "amplitude"))
    return xr.Dataset(
        {"verdict": verdict_variable(over, verdict), "amplitude": amplitude_variable(over, swing, judge.rows)},
        {speed: variable(speed, at, "1", "speed ratio of the machine that was meant")}, met.attrs,
    )  # fmt: skip
