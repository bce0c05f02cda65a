"""What runs of one operating point share: their ensemble, attributes, and the counts that they refuse."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.equations.model import Model
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.harmonics import common_multiple_attribute
from whirlmap.integrate.step_retry import end_named
from whirlmap.integrate.system import System
from whirlmap.options.computed import Integration
from whirlmap.options.execution import Execution


def one_point(
    system: System, integration: Integration, execution: Execution, starts: int = 1
) -> tuple[Ensemble, NDArray[np.bool_]]:
    """Ensemble of a system's own operating point, or of starts perturbed from its own; whether its default start exists."""
    repeat = {system.parameters[0]: np.full(starts, system.vector[0])}
    return make_ensemble(system, repeat, perturbed=starts > 1, integration=integration, execution=execution)


def units_of_states(model: Model) -> str:
    """Units of a model's states, in order, as one text."""
    return " ".join(s.unit for s in model.states)


def run_facts(system: System, ensemble: Ensemble, **more: Any) -> dict[str, Any]:
    """Attributes of a run of one operating point."""
    return {
        "period_T": float(ensemble.period[0]),
        **common_multiple_attribute(ensemble.orders),
        "stop": end_named(system.model, int(ensemble.end_stop[0])),
        **more,
    }


def refuse_counts(**counts: tuple[int, int]) -> None:
    """Refuse counts below their least value, or beyond any time; each is given with that value, by name."""
    for name, (value, least) in counts.items():
        if not least <= value <= 100_000_000:
            raise RangeError(f"{name} must lie between {least} and 100000000, not {value}")
