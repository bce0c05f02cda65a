"""Loading: from a case, or a model in hand, to a system that is ready to integrate."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from whirlmap.cases import Case, read, settle
from whirlmap.cases.case import start_values
from whirlmap.equations.model import Family, Model
from whirlmap.integrate.system import System, exact_order


def load(
    case: str | Path | Case | Family | Model, /, *, start: Mapping[str, Any] | None = None, **changes: Any
) -> System:
    """Load a case as a system.

    Parameters
    ----------
    case : str, Path, Case, Family or Model
        Name of a stock case (`whirlmap.cases.names`), path of a TOML file, or a model of your own, whose parameters
        are then all given as changes.
    start : mapping of str to number, optional
        Start values that replace the case's and the model's.
    **changes : number or str
        Dimensionless symbols (``s=2.5``, ``r_p="1/4"``), dimensional inputs with their units (``mu="0.03 Pa*s"``,
        ``speed="1500 rpm"``) and switches (``edition="literal"``). A changed input recomputes its groups; a symbol that
        is given wins over its group.

    Returns
    -------
    System
        ``notes`` say where each value comes from; ``details`` is the `Settled` case with its inputs.

    Raises
    ------
    CaseError
        Naming what was found, what was expected and the nearest valid name.
    RangeError
        For a start value of an unknown state.
    """
    found = _case(case)
    settled = settle(found, changes)
    orders = {p.name for p in settled.model.parameters if p.order}
    values = {name: _order(value, name) if name in orders else float(value) for name, value in settled.values.items()}
    return System(
        model=settled.model,
        values=values,
        start={**found.start, **start_values(start or {})},
        case=found.name,
        notes=dict(settled.notes),
        details=settled,
    )


def _case(case: str | Path | Case | Family | Model) -> Case:
    if isinstance(case, Case):
        return case
    if isinstance(case, Family):
        return Case(case.name, None, case)
    if isinstance(case, Model):
        return Case(case.name, None, Family(case.name, lambda: case))
    return read(case)


def _order(value: Any, name: str) -> Any:
    exact = exact_order(value, name)
    return float(value) if exact is None else exact
