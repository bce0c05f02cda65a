"""What is in results, as Markdown: Datasets, JSON objects, labels and statuses."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import small_results
from json_keys import MEANINGS
from markdown_tables import code, table
from whirlmap.results.regime import Regime
from whirlmap.results.status import SENTENCES, Status

if TYPE_CHECKING:
    import xarray as xr

#: What the label of each regime says.
LABELS = {
    Regime.undecided: "the votes disagree, or indicators were not computed",
    Regime.periodic: "the motion repeats after `period_T` periods",
    Regime.quasi_periodic: "two or more frequencies without a ratio: a torus",
    Regime.chaotic: "a positive largest Lyapunov exponent, and a second indicator",
    Regime.contact: "a journal reaches its bearing",
    Regime.diverged: "a state grows without bound",
    Regime.at_rest: "the motion dies away to an equilibrium",
    Regime.drifting: "a state moves away at a constant mean rate, the rest of the motion is steady",
    Regime.growing: "the amplitude grows steadily",
    Regime.locked: "no frequency but those of the forcing and their n-th parts, where the forcing has no common period",
    Regime.not_settled: "the motion contracts, but no orbit was reached in the given time",
    Regime.not_steady: "of a signal: its character changes during the record",
}
#: Words of JSON for the types of Python.
TYPES = {dict: "object", list: "array", str: "string", bool: "true or false", int: "number", float: "number", type(None): ""}


def labels() -> str:
    """The regimes, with their codes in Datasets."""
    return table(("code", "label", "meaning"), [(int(r), code(r.label), LABELS[r]) for r in Regime])


def statuses() -> str:
    """How a run can end, with the codes in Datasets."""
    return table(("code", "status", "meaning"), [(int(s), code(s.name), SENTENCES[s]) for s in Status])


def datasets() -> str:
    """Dimensions, variables and attributes of the Dataset of every function."""
    return "\n\n".join(_dataset(name, call()) for name, call in small_results.datasets().items())


def _dataset(name: str, ds: "xr.Dataset") -> str:
    rows = [_variable(str(key), values) for key, values in {**ds.coords, **ds.data_vars}.items()]
    attributes = ", ".join(code(key) for key in ds.attrs)
    head = f"## Dataset of {{py:func}}`whirlmap.{name}`"
    parts = [f"(dataset-{name})=\n{head}", table(("variable", "dimensions", "unit", "meaning"), rows)]
    return "\n\n".join([*parts, *([f"Attributes: {attributes}."] if attributes else [])])


def _variable(name: str, values: "xr.DataArray") -> tuple[str, str, str, str]:
    unit = str(values.attrs.get("units", ""))
    dims = ", ".join(code(dim) for dim in values.dims) or "scalar"
    return code(name), dims, "" if unit == "1" else unit, values.attrs.get("long_name") or "position along the dimension"


def json_objects() -> str:
    """Keys of the JSON object of every command."""
    return "\n\n".join(_object(name, small_results.printed(name)) for name in small_results.COMMANDS)


def _object(command: str, found: Mapping[str, Any]) -> str:
    rows = [(code(key), TYPES[type(value)] or "null here", meaning(command, key)) for key, value in found.items()]
    return f"## JSON of `whirlmap {command}`\n\n" + table(("key", "type", "meaning"), rows)


def meaning(command: str, key: str) -> str:
    """What a key means: to this command, or to all."""
    return MEANINGS.get(command, {}).get(key) or MEANINGS[""][key]
