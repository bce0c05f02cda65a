"""Time series of one operating point."""

from math import gcd
from typing import TYPE_CHECKING, Unpack

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.motion.endings import confirm_run, restarted
from whirlmap.analysis.motion.ensembles import run_attributes
from whirlmap.analysis.motion.record_length import shown_periods
from whirlmap.analysis.simulation.one_point import one_point, refuse_counts, run_facts, units_of_states
from whirlmap.analysis.steady.settled_steps import check_steps
from whirlmap.equations.model import Model
from whirlmap.errors import RangeError
from whirlmap.integrate.system import System
from whirlmap.kernels.running.reference import reference_outputs
from whirlmap.kernels.writing.routine import LANES
from whirlmap.options.computed import INTEGRATION, Integration
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import IntegrationParts, takes_options
from whirlmap.progress import tell
from whirlmap.results.schema import names_coordinate, status_variable, variable, with_attributes

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]


def outputs_of(model: Model, values: Array, x: Array) -> Array:
    """Outputs of a model at states (state, ...) for parameters (parameter,); shape (output, ...)."""
    return reference_outputs(model)(x, values.reshape(-1, *(1,) * (x.ndim - 1)))


#: Least steps per T of a time series whose steps are chosen by accuracy: a smooth picture needs more than an orbit.
SAMPLES = 100


#: The one point of a series.
FIRST = np.zeros(1, dtype=np.intp)

#: Numbers of saved states that one call of the ensemble holds for its lanes.
KEPT = 500_000


class Series:
    """The time series of one operating point, recorded in stretches: the numbers do not depend on them.

    Steps are chosen for the accuracy at the start, no fewer than `SAMPLES` per T for a smooth picture. They are checked
    where the transient has passed and where the record ends (`check_steps`), and an end is believed where more steps find
    it again (`confirm_run`). Where more are needed the series begins anew, with a multiple of the steps: its samples stand
    at the same times.

    Parameters
    ----------
    periods, transient, every, integration, execution
        As in `simulate`.

    Attributes
    ----------
    periods, stretch, done : int
        T that are recorded in the end, in one stretch at most, and by now.
    passed : int
        T of the transient that have passed.
    """

    def __init__(
        self, system: System, *, periods: int | None = None, transient: int = 0, every: int = 1,
        integration: Integration = INTEGRATION, execution: Execution = EXECUTION,
    ) -> None:  # fmt: skip
        refuse_counts(transient=(transient, 0), every=(every, 1), **({} if periods is None else {"periods": (periods, 1)}))
        chosen, self.found = one_point(system, integration, execution)
        self.rung, self.steps = chosen.steps, max(SAMPLES if integration.steps is None else 1, chosen.steps)
        self.least = every // gcd(self.steps, every)  # T after which a sample falls on a whole one
        if periods is None:
            length = shown_periods(system, max(self.steps // every, 1))
            periods = -(-length // self.least) * self.least
        if (periods * self.steps) % every:
            raise RangeError(f"every = {every} does not divide the {periods * self.steps} recorded steps")
        self.system, self.periods, self.transient, self.every = system, periods, transient, every
        self.progress = execution.progress
        self.samples = periods * self.steps // every
        each = max(KEPT // (LANES * system.model.dimension * self.steps // every + 1), 1)
        self.stretch = max(min(each, periods) // self.least, 1) * self.least
        self.ensemble = chosen.subset(FIRST, steps=self.steps)
        self.start = self.ensemble.x.copy()
        self.done = self.passed = 0
        self.believed = False  # whether the run has ended, and more steps have found that
        self.x = self.outputs = np.zeros((0, 0))

    def pass_by(self, periods: int) -> None:
        """Let some T of the transient pass."""
        self.ensemble.advance(periods, progress=self.progress)
        self.passed += periods
        self._check(self.passed == self.transient)

    def advance(self) -> None:
        """Record one more stretch; before the first one, let what is left of the transient pass."""
        while self.passed < self.transient:
            self.pass_by(self.transient - self.passed)
        if not self.done:
            self._begin()
        length = min(self.stretch, self.periods - self.done)
        segment = self.ensemble.advance(length, save_every=self.every, progress=self.progress)
        self._take(self.done * self.steps // self.every + 1, segment.saved[:, :, 0])
        self.done += length
        self._check(self.done == self.periods)

    def _check(self, due: bool) -> None:
        """Begin anew with more steps where the motion here asks for them, or does not end with them.

        A motion that goes on is asked where that is ``due``, one that has ended once.
        """
        e, began = self.ensemble, np.zeros(1, dtype=np.int64)
        if self.believed or (e.running[0] and not due):
            return
        here = e.subset(FIRST, steps=self.rung if e.running[0] else self.steps)
        more = check_steps(here) if e.running[0] else confirm_run(here, self.start, began, self.passed + self.done)
        needed = int(here.point_steps[0]) if more else 0
        e.step_verdict[:] = here.step_verdict
        if not more:
            e.status[:], self.believed = here.status, not e.running[0]
        if needed > self.steps:
            times = -(-needed // self.steps)
            self.rung, self.steps, self.every = needed, self.steps * times, self.every * times
            self.ensemble = restarted(e, FIRST, self.start, began, np.array([self.steps]))
            self.done = self.passed = 0

    def _begin(self) -> None:
        model, rows = self.system.model, self.samples + 1
        # No NaN is written here: memory of rows that were never taken is then not used, and `dataset` gives none of them.
        self.x, self.outputs = np.empty((rows, model.dimension)), np.empty((rows, len(model.outputs)))
        self._take(0, self.ensemble.x.T)

    def _take(self, at: int, x: Array) -> None:
        self.x[at : at + len(x)] = x
        self.outputs[at : at + len(x)] = outputs_of(self.system.model, self.system.vector, x.T).T

    def dataset(self) -> "xr.Dataset":
        """Dataset of what has been recorded; before that begins, of the state that the transient has come to."""
        import xarray as xr

        e, model = self.ensemble, self.system.model
        if not self.done:
            self._begin()
        rows = self.done * self.steps // self.every + 1
        count = np.arange(rows) * self.every + self.passed * self.steps
        ds = xr.Dataset(
            {
                "x": variable(("time", "state"), self.x[:rows], "1", "state", unit_of_each=units_of_states(model)),
                "outputs": variable(("time", "output"), self.outputs[:rows], "1", "output"),
                "status": status_variable((), e.status[0]),
                "end_time": variable((), e.end_time[0], "time", "time at which the run ended early"),
                "start_found": variable((), int(self.found[0]), "1", "whether the default start exists"),
            },
            coords={
                "time": variable("time", count * float(e.period[0]) / self.steps, "time", "model's time"),
                "turn": variable("time", count / self.steps, "T", "time in periods T"),
                "state": names_coordinate("state", self.system.states, "state"),
                "output": names_coordinate("output", list(model.outputs), "output"),
            },
        )
        facts = run_facts(self.system, e, transient=self.transient, steps_per_period=self.steps)
        return with_attributes(ds, run_attributes(self.system, e, **facts))


@takes_options("simulate")
def simulate(
    system: System,
    *,
    periods: int | None = None,
    transient: int = 0,
    every: int = 1,
    integration: Integration = INTEGRATION,
    execution: Execution = EXECUTION,
    **_given: Unpack[IntegrationParts],
) -> "xr.Dataset":
    """Time series of a system.

    Parameters
    ----------
    system : System
        Its values and start states count.
    periods : int, optional
        T that are recorded (of an unforced model: typical times). Where absent 20 turns of the slowest clock, fewer where
        they would hold more than three million numbers (`shown_periods`).
    transient : int
        T dropped before.
    every : int
        Steps between recorded samples.
    integration : Integration, optional
        Method, and steps or accuracy; or its parts as keywords, ``method``, ``steps``, ``accuracy``. `SAMPLES` steps
        per T are taken where the accuracy asks for fewer.
    execution : Execution, optional
        How it is run, which changes no number; or its parts as keywords, ``workers``, ``progress``.

    Returns
    -------
    xr.Dataset
        ``x(time, state)`` and ``outputs(time, output)``, with the start of the record first; ``time`` in the model's
        unit and ``turn(time)`` in T; ``status`` and ``end_time``. After an event the remaining samples are NaN.

    Raises
    ------
    RangeError
        Samples that do not divide the record, an unknown method, steps and an accuracy together, or a count that makes no
        sense.

    Notes
    -----
    Steps per T are fixed and locked to the phase of the forcing, so that samples stand at the same phases in every T; how
    many, follows from the accuracy (`integrate.accuracy`), at the start, after the transient and at the end; where more are
    needed the series begins anew with a multiple of them, and its samples stand at the same times. An end is believed where
    more steps find it again. Default is Dormand-Prince 8(5,3); ``tsit5`` and ``rk4`` are
    the others. Terminal events (contact, divergence) are located within a step. In chaos two runs part after some hundred
    T whatever the steps.

    References
    ----------
    [prince1981] and [hairer1993] ``dop853``; [tsitouras2011] ``tsit5``; [kutta1901] ``rk4``.
    """
    series = Series(
        system, periods=periods, transient=transient, every=every, integration=integration, execution=execution
    )
    tell(execution.progress, "expect", series.transient + series.periods)
    while series.done < series.periods:
        series.advance()
    return series.dataset()
