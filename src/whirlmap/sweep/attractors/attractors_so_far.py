"""Result of an interrupted search: the attractors found, whether they return, and their section points."""

from typing import Any

import numpy as np
import xarray as xr

from whirlmap.analysis.motion.ensembles import run_attributes
from whirlmap.integrate.system import System
from whirlmap.results.regime import Regime
from whirlmap.results.schema import regime_variable, variable
from whirlmap.sweep.attractors.attractor_search import Search

#: Variables that only the measurement of an attractor gives: NaN until then.
UNKNOWN = {
    "confidence": ("1", "confidence of the label"), "lyapunov": ("1/time", "largest Lyapunov exponent"),
    "lyapunov_error": ("1/time", "one standard error of it"), "return_distance": ("1", "return distance"),
}  # fmt: skip


def found_so_far(system: System, search: Search) -> tuple[xr.Dataset, dict[str, Any]]:
    """Attractors of a search over ``attractor``, without a measurement, and the attributes of the run.

    Returns
    -------
    ds : xr.Dataset
        ``regime`` (periodic, or undecided), ``period_common``, ``period_T`` (0 where it is not known),
        ``section(attractor, member, state)``; the other numbers of `attractors` are NaN, and no indicator has been asked.
    attributes : dict
    """
    found = search.found
    count, names = len(found.representative), [*system.states, *system.model.outputs]
    if not count:
        return xr.Dataset(), {}
    returns = np.array(found.multiple[:count], dtype=np.int64)
    data: dict[str, Any] = {
        "regime": regime_variable("attractor", np.where(returns > 0, Regime.periodic, Regime.undecided)),
        "period_common": variable("attractor", returns, "1", "smallest return in common periods, 0 where none"),
        "period_T": variable("attractor", returns * (system.strobe == 1), "T", "smallest return, 0 where it is not known"),
        "section": variable(
            ("attractor", "member", "state"), np.stack(found.representative)[:, None, :], "1", "a point of each attractor",
            unit_of_each=" ".join(s.unit for s in system.model.states),
        ),
        "peak_to_peak": variable(("attractor", "quantity"), np.full((count, len(names)), np.nan), "1", "peak to peak"),
        **{name: variable("attractor", np.full(count, np.nan), unit, says) for name, (unit, says) in UNKNOWN.items()},
    }  # fmt: skip
    attributes = run_attributes(system, search.ensemble(search.starts[:, :1]))
    return xr.Dataset(data, {"quantity": names}), attributes
