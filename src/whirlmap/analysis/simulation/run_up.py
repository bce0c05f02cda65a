"""Run-up and coast-down of one machine in time: its speed changes truly, at a constant rate."""

from collections.abc import Generator, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import NDArray
from sympy import sympify

from whirlmap.analysis.motion.endings import restarted
from whirlmap.analysis.motion.ensembles import make_ensemble, run_attributes
from whirlmap.analysis.simulation.one_point import one_point, refuse_counts, run_facts
from whirlmap.analysis.simulation.ramp import Ramp, ramp_of
from whirlmap.analysis.simulation.time_series import Series, outputs_of
from whirlmap.analysis.steady.settled_steps import check_steps
from whirlmap.equations.run_up import ACCELERATION, running_up
from whirlmap.errors import RangeError
from whirlmap.integrate.accuracy import StepVerdict
from whirlmap.integrate.system import System
from whirlmap.options.computed import INTEGRATION, Integration
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import IntegrationParts, takes_options
from whirlmap.progress import tell
from whirlmap.results.schema import names_coordinate, status_variable, variable, with_attributes
from whirlmap.results.status import Status

if TYPE_CHECKING:
    import xarray as xr

    from whirlmap.integrate.ensemble import Ensemble
    from whirlmap.integrate.segment import Segment

Array = NDArray[np.float64]

#: Windows of a run-up where the user does not say, and turns of the slowest clock in one at least.
WINDOWS, TURNS = 200, 8
#: Least steps per T, which are the samples of a spectrum; windows after which steps are checked.
SAMPLES, CHECKED = 32, 10
#: Orders of a spectrum: up to this many times the fastest harmonic, or the slowest clock where that is more.
TOP, MULTIPLES = 1.5, 5.0
#: Runs with twice the steps by which an end is confirmed, at most, and how near two ends are one, in windows.
DOUBLINGS, SAME_END = 5, 1.0
#: The one point of a run.
FIRST = np.zeros(1, dtype=np.intp)


@takes_options("run_up")
def run_up(
    system: System,
    name: str,
    begin: float | str,
    end: float | str,
    *,
    time: float | str,
    transient: int = 0,
    windows: int | None = None,
    integration: Integration = INTEGRATION,
    execution: Execution = EXECUTION,
    **_given: Unpack[IntegrationParts],
) -> "xr.Dataset":
    """Run a machine up, or let it coast down: its speed changes at a constant rate.

    Parameters
    ----------
    system : System
        Of a forced model that declares what an angular acceleration adds (`Model.angular_acceleration`).
    name : str
        Its speed: the parameter, or the dimensional input that stands for it.
    begin, end : float or str
        Speeds; with their unit where the case has dimensions, ``"3000 rpm"``. The larger one first is a coast-down.
    time : float or str
        Duration: ``"20 s"``, or a number in the model's own time.
    transient : int
        T at the first speed before, from the system's start.
    windows : int, optional
        Windows of equal phase in which the motion is summed up; where absent `WINDOWS`, or fewer of at least `TURNS` turns
        of the slowest clock.
    integration : Integration, optional
        Method, and steps or accuracy, as in `simulate`; `SAMPLES` steps per T at least where the accuracy chooses.
    execution : Execution, optional
        How it is run, which changes no number.

    Returns
    -------
    xr.Dataset
        Over the varied speed, in the middle of each window: ``minimum``, ``maximum`` and ``mean`` of every state and output
        (``quantity``); ``clock_amplitude`` and ``clock_phase`` at the order of each ``clock``: x = A cos(order phase + phi);
        ``spectrum`` by ``phase_order``, the multiple of the clock's phase, as amplitudes; ``elapsed``, the time, in seconds
        where the case has them; ``status``, ``end_time`` (a phase) and ``end_speed``. Windows that an event
        cuts off are NaN.

    Raises
    ------
    RangeError
        A speed or duration that cannot be, fewer than two windows, an unknown name.

    Notes
    -----
    The speed is a state, and the phase of the forcing the time (`whirlmap.equations.run_up`), so that the steps stay locked
    to the phase. Extremes are found between the steps too, by cubic Hermite interpolation. For lines and spectra the samples
    of a window are weighted by a Hann window. Steps are chosen for the accuracy at the start and at both speeds, and checked
    after every tenth part of the run; where more are needed the run begins anew with them. An end by an event is believed
    where twice the steps find it again in the same window.
    """
    running = Running(system, ramp_of(system, name, begin, end, time), transient, windows, integration, execution)
    for _ in running.run():
        pass
    return running.dataset()


class Running:
    """One run-up, window after window: whoever iterates over `run` may stop, and `dataset` has the windows that are done.

    Attributes
    ----------
    system : System
        At the first speed.
    moving : System
        The same with the speed as a state.
    windows, length, before : int
        Windows, T in each, and T before the first.
    order : array, shape (order,)
        Orders of the spectrum.
    summed : list of dict
        The windows that are done.
    """

    def __init__(
        self, system: System, ramp: Ramp, transient: int, windows: int | None, integration: Integration, execution: Execution
    ) -> None:
        refuse_counts(transient=(transient, 0), **({} if windows is None else {"windows": (windows, 2)}))
        first: dict[str, Any] = {ramp.name: ramp.begin}
        self.system, self.ramp, self.transient = system.replace(**first), ramp, transient
        self.integration, self.execution = integration, execution
        model = running_up(system.plain_model(), ramp.name)
        values = {name: value for name, value in system.values.items() if name != ramp.name}
        values[ACCELERATION] = ramp.acceleration
        self.moving = replace(system, model=model, values=values, machine=None, start={})
        turns = {name: abs(float(w)) for name, w in self._orders().items() if float(w) != 0}
        count = round(ramp.phase / self.moving.period)
        slowest = TURNS / min(turns.values(), default=1.0) * 2 * np.pi / self.moving.period
        most = int(count / max(slowest, 1.0))
        if (most if windows is None else count // 2) < max(windows or 2, 2):
            raise RangeError(
                f"time: found {count} T in the run, expected {2 * slowest:.0f} at least, two windows of {TURNS} turns of the"
                " slowest clock"
            )
        self.length = count // (min(WINDOWS, most) if windows is None else windows)
        self.windows = count // self.length
        self.before = count - self.windows * self.length  # T that fill no window, at the beginning
        fastest = 2 * np.pi / self.moving.period
        top = max(TOP, MULTIPLES * min(turns.values(), default=1.0) / fastest)
        self.order = np.arange(1, int(top * self.length) + 1) * fastest / self.length
        self.summed: list[dict[str, Array]] = []

    def _orders(self) -> dict[str, float]:
        """Order of every clock: its frequency over the phase."""
        numbers = {p: float(self.moving.values[p.name]) for p in self.moving.model.parameters}
        return {name: float(sympify(w).subs(numbers)) for name, w in self.moving.model.clocks.items()}

    def _start(self) -> tuple["Ensemble", bool]:
        """The ensemble at the beginning of the run, after the transient at its first speed."""
        if self.transient:
            quiet = Execution(workers=self.execution.workers)
            series = Series(
                self.system, periods=1, transient=self.transient - 1, integration=self.integration, execution=quiet
            )
            while series.done < series.periods:
                series.advance()
            still, found = series.ensemble, series.found
            if not still.running[0]:
                ended = Status(int(still.status[0])).name
                raise RangeError(f"transient: the motion at the first speed ended before the run-up: {ended}")
        else:
            still, found = one_point(self.system, self.integration, self.execution)
        x = np.concatenate([still.x[:, :1], [[self.ramp.begin]]])
        # Steps for both ends of the run: fast motions take more of them per T where the clock is slow.
        both = np.concatenate([x, np.concatenate([x[:-1], [[self.ramp.end]]])], axis=1)
        two = {ACCELERATION: np.full(2, self.ramp.acceleration)}
        made, _ = make_ensemble(self.moving, two, starts=both, integration=self.integration, execution=self.execution)
        least = 1 if self.integration.steps is not None else SAMPLES
        return made.subset(FIRST, steps=np.maximum(made.point_steps.max(), least)), bool(found[0])

    def run(self) -> Iterator[int]:
        """Run; gives how many windows are done, after each. The count falls where the run begins anew with more steps."""
        self.ensemble, self.found = self._start()
        start, began = self.ensemble.x.copy(), np.zeros(1, dtype=np.int64)
        tell(self.execution.progress, "expect", self.before + self.windows * self.length)
        ends = list[tuple[int, float]]()
        while True:
            more = yield from self._once()
            if not more and self._believed(self.ensemble, ends):
                return
            self.ensemble = restarted(self.ensemble, FIRST, start, began, self.ensemble.point_steps * (1 if more else 2))

    def dataset(self) -> "xr.Dataset":
        """Windows that are done, one at least; the others are NaN."""
        import xarray as xr

        ensemble, whole = self.ensemble, self.windows - len(self.summed)
        summed = {
            key: np.stack([part[key] for part in self.summed] + [np.full_like(value, np.nan)] * whole)
            for key, value in self.summed[0].items()
        }
        model, ramp = self.moving.model, self.ramp
        at_T = self.before + (np.arange(self.windows) + 0.5) * self.length
        middle = np.asarray(at_T * self.moving.period, dtype=float)
        names = [*self.moving.states[:-1], *model.outputs]
        own, unit = model.states[-1], ("s" if np.isfinite(ramp.unit) else "1")
        elapsed = ramp.elapsed(middle) * (ramp.unit if np.isfinite(ramp.unit) else 1.0)
        end = float(ensemble.end_time[0])
        each, at_clock, at_order = ((ramp.name, *over, "quantity") for over in ([], ["clock"], ["phase_order"]))
        ds = xr.Dataset(
            {
                **{key: variable(each, summed[key], "1", f"{key} in each window") for key in ("minimum", "maximum", "mean")},
                "clock_amplitude": variable(at_clock, summed["amplitude"], "1", "amplitude at the clock"),
                "clock_phase": variable(at_clock, summed["phase"], "rad", "phase before the clock's"),
                "spectrum": variable(at_order, summed["spectrum"], "1", "amplitude at each order"),
                "elapsed": variable(ramp.name, elapsed, unit, "time in the middle of the window"),
                "status": status_variable((), ensemble.status[0]),
                "end_time": variable((), end, "rad", "phase at which the run ended early"),
                "end_speed": variable((), ramp.speed(np.array(end)), own.unit, "speed there", measure=own.measure),
                "start_found": variable((), int(self.found), "1", "whether the default start exists"),
            },
            coords={
                ramp.name: variable(ramp.name, ramp.speed(middle), own.unit, own.meaning),
                "clock": names_coordinate("clock", list(model.clocks), "clock"),
                "phase_order": variable("phase_order", self.order, "1", "multiple of the phase"),
                "quantity": names_coordinate("quantity", names, "state or output"),
            },
        )  # fmt: skip
        facts = run_facts(self.moving, ensemble, transient=self.transient, steps_per_period=int(ensemble.point_steps[0]))
        facts |= {"varied": ramp.name, "run_up_begin": ramp.begin, "run_up_end": ramp.end, "run_up_duration": ramp.duration}
        return with_attributes(ds, run_attributes(self.system, ensemble, **facts))

    def _believed(self, ensemble: "Ensemble", ends: list[tuple[int, float]]) -> bool:
        """Whether a run went to its end, or one with twice the steps ended like it; else the end is kept in ``ends``."""
        if ensemble.running[0] or ensemble.accuracy is None:
            return True
        status, end = int(ensemble.status[0]), float(ensemble.end_time[0])
        near = SAME_END * self.length * self.moving.period
        if any(status == other and abs(end - there) < near for other, there in ends):
            return True
        ends.append((status, end))
        if len(ends) <= DOUBLINGS:
            return False
        ensemble.status[0], ensemble.step_verdict[0] = Status.unresolved, StepVerdict.stiff
        return True

    def _once(self) -> "Generator[int, None, bool]":
        """Run all windows; gives True in the end where more steps are needed, which the ensemble then has."""
        ensemble, every = self.ensemble, max(self.windows // CHECKED, 1)
        self.summed.clear()
        if self.before:
            ensemble.advance(self.before, progress=self.execution.progress)
        for i in range(self.windows):
            window = ensemble.advance(self.length, save_every=1, extremes="between", progress=self.execution.progress)
            self.summed.append(self._summed(window, self.before + i * self.length))
            if ensemble.running[0] and (i + 1) % every == 0 and check_steps(ensemble):
                return True
            yield i + 1
        return False

    def _summed(self, window: "Segment", began: int) -> dict[str, Array]:
        """Extremes, order lines and spectrum of one window."""
        model, x, extremes = self.moving.model, window.saved[:, :, 0], window.extremes
        assert extremes is not None
        own = len(model.states) - 1  # the row of the speed
        low, high, mean = (np.delete(extremes[key][:, 0], own) for key in ("minimum", "maximum", "mean"))
        rows = np.concatenate([x[:, :-1], outputs_of(model, self.moving.vector, x.T).T], axis=1)
        phase = (began + np.arange(1, len(rows) + 1) / len(rows) * self.length) * self.moving.period
        weight = np.hanning(len(rows) + 1)[1:]
        weighted = (rows - rows.mean(axis=0)) * (2 * weight / weight.sum())[:, None]
        lines = np.array([weighted.T @ np.exp(-1j * w * phase) for w in self._orders().values()]).reshape(-1, rows.shape[1])
        bins = np.fft.rfft(weighted, axis=0)[1 : self.order.size + 1]
        whole = np.where(np.isfinite(rows).all(axis=0), 1.0, np.nan)
        return {
            "minimum": whole * low, "maximum": whole * high, "mean": whole * mean,
            "amplitude": np.abs(lines), "phase": np.angle(lines), "spectrum": np.abs(bins),
        }  # fmt: skip
