"""Branches that lie over a diagram, and curves of bifurcations that lie over a map: whether they are of the same system."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import xarray as xr

from whirlmap.errors import InputError
from whirlmap.explorer.exploration import Exploration
from whirlmap.integrate.loading import pieces
from whirlmap.results.files import read


def with_branches(found: Exploration, files: Sequence[Path]) -> Exploration:
    """Lay branches or curves of files over a diagram or a map.

    Raises
    ------
    InputError
        A file of something else, of other parameters, or of other values.
    """
    return lay_over(found, {f"--branches {file}": read(file) for file in files})


def lay_over(found: Exploration, branches: Mapping[str, xr.Dataset]) -> Exploration:
    """Lay branches or curves over a diagram or a map; the keys say in messages where each comes from.

    Raises
    ------
    InputError
        A Dataset of something else, of other parameters, or of other values.
    """
    for source, ds in branches.items():
        _check(found, source, ds)
    return replace(found, branches=[*found.branches, *branches.values()])


def _check(found: Exploration, source: str, ds: xr.Dataset) -> None:
    if "branch_of" not in ds:
        raise InputError(f"{source}: found no branches, expected a result of `whirlmap continue`")
    varied, axes = str(ds.attrs.get("varied")).split(), list(found.axes)
    if sorted(varied) != sorted(axes):
        kinds = {0: "a diagram or a map below them", 1: "branches along", 2: "curves of bifurcations (--event) in"}
        wanted = f"{kinds[len(axes)]} {' and '.join(axes)}".strip()
        raise InputError(f"{source}: found branches in {' and '.join(varied)}, expected {wanted}")
    own = pieces(found.system)
    if ds.attrs.get("model_hash") != own.model_hash:
        raise InputError(f"{source}: found branches of another model, expected those of {found.system.model.name}")
    inputs = dict(found.system.machine.inputs) if found.system.machine else {}
    follows = any(name in inputs for name in varied)  # parameters follow from what varies: inputs are compared then
    names = [n for n in own.parameters if n not in varied and not (follows and n not in inputs)]
    recorded, now = json.loads(str(ds.attrs.get("parameters", "{}"))), json.loads(json.dumps(dict(own.parameters)))
    other = [n for n in names if n in recorded and recorded[n]["value"] != now[n]["value"]]
    if other:
        raise InputError(f"{source}: {', '.join(other)} differ from the values of {found.title or found.system.case}")
