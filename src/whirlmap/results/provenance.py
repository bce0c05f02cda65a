"""Provenance of a result: everything that is needed to compute it again, as attributes of a Dataset.

Plain data goes in and attributes that NetCDF and Zarr can hold come out: text, integers and floats. What has
structure (parameters, switches) is JSON text.
"""

import hashlib
import json
import platform
import shlex
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from whirlmap.version import __version__

#: Attributes whose value differs between two runs of the same thing.
PASSING = ("date", "command")


@dataclass(frozen=True)
class Pieces:
    """Description of a system as plain data.

    Attributes
    ----------
    model, model_hash : str
        Name of the model, and `model_hash` of its equations.
    case, case_hash : str
        Name of the case, and the SHA-256 of its text; empty where there is no file.
    parameters : mapping of str to mapping
        For each symbol its ``value``, ``unit`` and ``source``, dimensional inputs included.
    switches : mapping of str to str
    start : mapping of str to float
        Start values that replace the model's own.
    roles : mapping
        `Model.roles`: names of quantities by what they are.
    citations : sequence of str
        Keys of the bibliography.
    """

    model: str
    model_hash: str
    case: str = ""
    case_hash: str = ""
    parameters: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    switches: Mapping[str, str] = field(default_factory=dict)
    start: Mapping[str, float] = field(default_factory=dict)
    roles: Mapping[str, Any] = field(default_factory=dict)
    citations: Sequence[str] = ()


def provenance(
    pieces: Pieces,
    *,
    method: str | None = None,
    steps_per_period: int | str | None = None,
    seed: int | None = None,
    settings: Mapping[str, Any] | None = None,
    citations: Iterable[str] = (),
    command: str | Sequence[str] | None = None,
) -> dict[str, str | int | float]:
    """Attributes that say where a result comes from.

    Parameters
    ----------
    pieces : Pieces
        What the system says about itself.
    method : str, optional
        Integration method.
    steps_per_period : int or str, optional
        Its steps in a period T.
    seed : int, optional
        Seed of whatever was random.
    settings : mapping, optional
        Further settings of the computation (tolerances, lengths), as JSON in ``settings``.
    citations : iterable of str
        Keys of methods and analyses, added to the system's own.
    command : str or sequence of str, optional
        What made the result; the command line of this process where absent.

    Returns
    -------
    dict of str to str, int or float
    """
    keys = list(dict.fromkeys([*pieces.citations, *citations]))
    attributes: dict[str, str | int | float | None] = {
        "whirlmap_version": package_version("whirlmap"),
        "model": pieces.model,
        "model_hash": pieces.model_hash,
        "case": pieces.case,
        "case_hash": pieces.case_hash,
        "parameters": as_json(pieces.parameters),
        "switches": as_json(pieces.switches),
        "start": as_json(pieces.start),
        "roles": as_json(pieces.roles),
        "method": method,
        "steps_per_period": steps_per_period,
        "seed": seed,
        "settings": as_json(settings) if settings else None,
        "citations": " ".join(keys),
        "command": _command(command),
        "python_version": platform.python_version(),
        "numpy_version": package_version("numpy"),
        "llvmlite_version": package_version("llvmlite"),
        "platform": f"{platform.system()} {platform.machine()}",
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
    }
    return {name: value for name, value in attributes.items() if value is not None}


def model_hash(expressions: Iterable[tuple[str, str]]) -> str:
    """SHA-256 of named expressions, ``("vxp", srepr(...))``, in their declared order."""
    digest = hashlib.sha256()
    for name, expression in expressions:
        digest.update(f"{name} = {expression}\n".encode())
    return digest.hexdigest()


def package_version(package: str) -> str:
    """Version of an installed package; that of the source tree where whirlmap itself is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        if package != "whirlmap":
            return "not installed"

        return __version__


def as_json(value: Any) -> str:
    """JSON text with exact floats; fractions as ``"p/q"``, NumPy numbers as numbers."""
    return json.dumps(value, default=_plain, ensure_ascii=False)


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Mapping):
        return dict(value)
    return str(value)


def _command(command: str | Sequence[str] | None) -> str:
    if isinstance(command, str):
        return command
    words = list(sys.argv if command is None else command)
    if words:  # the program's name, not the folder it happens to be installed in
        words[0] = Path(words[0]).name
    return shlex.join(words)
