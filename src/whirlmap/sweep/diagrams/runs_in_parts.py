"""Runs of one operating point in parts, so that Ctrl-C keeps what is recorded: simulations in stretches, run-ups in windows.

The numbers do not depend on the parts: each goes on from the end of the one before.
"""

from collections.abc import Iterator
from typing import Unpack

import xarray as xr

from whirlmap.analysis.simulation.run_up import Running
from whirlmap.analysis.simulation.time_series import Series
from whirlmap.integrate.system import System
from whirlmap.options.computed import INTEGRATION, Integration
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import IntegrationParts, takes_options
from whirlmap.progress import tell
from whirlmap.results.memory import refuse_memory
from whirlmap.sweep.interruptible import Work, batches

#: Stretches of a simulation at least, seconds in one at most, and T in the first one.
STRETCHES, STRETCH, SHORT = 16, 1.0, 16


@takes_options()
def simulation_in_stretches(
    system: System,
    *,
    periods: int | None = None,
    transient: int = 0,
    every: int = 1,
    integration: Integration = INTEGRATION,
    execution: Execution = EXECUTION,
    **_given: Unpack[IntegrationParts],
) -> Work:
    """Time series as work in stretches: whoever iterates may stop, and keeps what is recorded.

    Parameters, and the Dataset, are those of `simulate`.
    """
    series = Series(
        system, periods=periods, transient=transient, every=every, integration=integration, execution=execution
    )
    refuse_memory("the time series", 3 * series.samples * (system.model.dimension + len(system.model.outputs)))
    tell(execution.progress, "expect", series.transient + series.periods)

    def parts(_: Work) -> Iterator[int]:
        for part in batches(series.transient, first=SHORT, most=series.transient, seconds=STRETCH):
            series.pass_by(part.stop - part.start)
            yield 0
        unit = series.least  # T after which a sample falls on a whole one
        most = min(series.stretch // unit, max(-(-series.periods // (STRETCHES * unit)), 1))
        for part in batches(series.periods // unit, first=max(SHORT // unit, 1), most=most, seconds=STRETCH):
            series.stretch = (part.stop - part.start) * unit
            series.advance()
            yield series.done
        while series.done < series.periods:  # it has begun anew on the way, with more steps
            series.advance()
            yield series.done

    def gather(work: Work) -> xr.Dataset | None:
        if not series.passed + series.done:
            return None
        ds = series.dataset()
        if not work.complete:
            ds.attrs["incomplete"] = f"interrupted after {series.done} of {series.periods} T" if series.done else (
                f"interrupted after {series.passed} of {series.transient} T of the transient: only the state there is known"
            )  # fmt: skip
        return ds

    return Work(series.periods, parts, gather)


def run_up_in_windows(running: Running) -> Work:
    """Run-up as work in windows: whoever iterates may stop, and keeps the windows that are done.

    The Dataset is that of `run_up`; windows that are missing are NaN.
    """

    def gather(work: Work) -> xr.Dataset | None:
        done = len(running.summed)
        if not done:
            return None
        said = {} if work.complete else {"incomplete": f"interrupted after {done} of {work.total} windows"}
        return running.dataset().assign_attrs(said)

    return Work(running.windows, lambda _: running.run(), gather)
