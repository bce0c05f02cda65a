"""Repair of a store: lost axes and descriptions of arrays are detected on the disk and restored.

Chunks guard themselves by receipts. Axes and descriptions (``zarr.json``) are the same in every store of the sweep, so
that they are copied from one that is made anew beside it.
"""

import json
from collections.abc import Iterable
from functools import partial
from math import prod
from pathlib import Path
from shutil import copyfile

import numpy as np

from whirlmap.results.files import write_beside
from whirlmap.sweep.store.store_folder import CHUNKS, DESCRIPTION, passing
from whirlmap.sweep.store.zarr_store import Store

#: Name under which the description of the whole group is lost.
WHOLE = DESCRIPTION


def lost_parts(store: Store) -> list[str]:
    """Name the arrays whose description or, of axes, whose values are missing or cannot be read.

    Returns
    -------
    list of str
        Paths within the store, ``gamma`` or ``chunks/receipt``; `WHOLE` for the description of the group itself.
    """
    lost = []
    try:
        whole = json.loads((store.folder / WHOLE).read_text())
        copies = dict(whole["consolidated_metadata"]["metadata"])
        described = set(copies)
        if "varied" not in whole["attributes"]:
            raise KeyError("attributes")
    except (OSError, ValueError, KeyError, TypeError):
        lost.append(WHOLE)
        copies = {}
        described = {*store.manifest["variables"], *store.manifest.get("dims", ()), f"{CHUNKS}/receipt", f"{CHUNKS}/reason"}
        described |= {path.parent.name for path in store.folder.glob("*/zarr.json")}
    for name in described:
        if name == CHUNKS:
            continue
        try:
            own = json.loads((store.folder / name / "zarr.json").read_text())
            shape = own["shape"]
        except (OSError, ValueError, KeyError, TypeError):
            lost.append(name)
            continue
        if own != copies.get(name, own):
            lost.append(name)
            continue
        axis = name not in store.manifest["variables"] and not name.startswith(f"{CHUNKS}/")
        if axis and not _readable(store, name, shape, whole_lost=WHOLE in lost):
            lost.append(name)
    return sorted(lost)


def _readable(store: Store, name: str, shape: list[int], *, whole_lost: bool) -> bool:
    """Whether an axis has its values; one value alone may be the fill value, which is no file."""
    if prod(shape) > 1 and not any(path.is_file() for path in (store.folder / name / "c").rglob("*")):
        return False
    if whole_lost:
        return True
    try:
        return np.asarray(store.group[name][...]).shape == tuple(shape)  # type: ignore[index]
    except Exception:  # each codec raises errors of its own for torn bytes
        return False


def put_back(store: Store, lost: Iterable[str], whole: Path) -> None:
    """Copy what a store has lost from another one of the same sweep, each file whole or not at all."""
    for name in lost:
        source = whole / name
        for path in [source] if source.is_file() else sorted(p for p in source.rglob("*") if p.is_file()):
            target = store.folder / path.relative_to(whole)
            target.parent.mkdir(parents=True, exist_ok=True)
            write_beside(target, partial(copyfile, path), trial=passing(target))
