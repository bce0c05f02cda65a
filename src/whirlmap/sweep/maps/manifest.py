"""The manifest of a store: all that decides its numbers, and whether a run may continue it."""

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from whirlmap.errors import OutputError
from whirlmap.integrate.loading import pieces
from whirlmap.kernels.running.machine import processor
from whirlmap.kernels.running.root_choice import RootChoice, possible
from whirlmap.results.files import check_writable
from whirlmap.results.provenance import as_json
from whirlmap.sweep.maps.executors import Job
from whirlmap.sweep.store.store_folder import CHUNKS, DESCRIPTION, exists, half_made, read_manifest, remains, remove
from whirlmap.version import __version__

#: Format of the manifest.
FORMAT = 1
#: Key of the choice of roots and reciprocals.
ROOTS = "roots"


def claim(folder: Path, *, resume: bool, force: bool) -> None:
    """Refuse a place for a store before anything is computed, and clear it where it is to be replaced."""
    if exists(folder) and not (resume or force):
        raise OutputError(
            f"{folder}: holds a store already; --resume (resume=True) goes on with it, --force (force=True) replaces it"
        )
    lost = remains(folder) and not exists(folder) and not half_made(folder)
    if lost and not force:
        raise OutputError(
            f"{folder}: is no store of a sweep any more: its manifest, {CHUNKS}/{DESCRIPTION}, is lost, and its copy too."
            " What it was made of cannot be known, so its data are left as they are; --force (force=True) replaces it,"
            " or choose another name"
        )
    if folder.is_dir() and any(folder.iterdir()) and not exists(folder) and not remains(folder):
        raise OutputError(f"{folder}: holds files that are no store of a sweep; choose another name")
    check_writable(folder, force=True)
    if force and folder.is_dir() and any(folder.iterdir()):
        remove(folder)


def stored_roots(folder: Path) -> RootChoice | None:
    """How kernels took roots and reciprocals when a store was begun; None where there is no store yet.

    Raises
    ------
    OutputError
        The store does not say so, or this processor cannot compute so.
    """
    if not exists(folder):
        return None
    manifest = read_manifest(folder)
    if ROOTS not in manifest:
        raise OutputError(
            f"{folder}: was begun by a version that did not record whether roots are taken by estimates or by divisions."
            " It opens and is drawn as ever, but cannot be continued; --force replaces it, or choose another name"
        )
    try:
        choice = RootChoice(**manifest[ROOTS])
    except TypeError:
        raise OutputError(f"{folder}: its manifest names no known way to take roots: {_short(manifest[ROOTS])}") from None
    if not possible(choice):
        raise OutputError(
            f"{folder}: was begun on {manifest['processor']} with roots and reciprocals by estimates, which kernels for"
            f" {processor()[0]} do not have: continue it where it was begun; --force replaces it, or choose another name"
        )
    return choice


def manifest_of(job: Job) -> dict[str, Any]:
    """What a store was made of: whatever decides its numbers, in words that can be compared and read."""
    own = pieces(job.system)
    s, labelling = asdict(job.labelling.settling), job.labelling
    parameters = {name: entry["value"] for name, entry in own.parameters.items() if name not in job.space.names}
    return {
        "format": FORMAT,
        "whirlmap_version": __version__,
        "kernel": job.kernel,
        "processor": processor()[0],
        ROOTS: job.roots._asdict(),
        "model": own.model,
        "model_hash": own.model_hash,
        "parameters": json.loads(as_json(parameters)),
        "switches": dict(own.switches),
        "start": dict(own.start),
        **job.space.described(),
        **{f"settling {name}": value for name, value in s.items()},
        "lyapunov": labelling.lyapunov,
        "steps": labelling.integration.steps,
        "accuracy": labelling.integration.accuracy,
        "method": labelling.integration.method,
        "refined from": job.coarse,
        "sections": bool(job.kept),
    }


def refuse_other(folder: Path, found: Mapping[str, Any], wanted: Mapping[str, Any], shape: tuple[int, ...]) -> None:
    """Refuse a store that was made of something else, or of another shape, saying what differs."""
    differ: list[tuple[Any, Any, Any]] = [] if tuple(found["shape"]) == shape else [("shape", found["shape"], list(shape))]
    for name, value in wanted.items():
        other = found.get(name)
        if isinstance(value, dict) and isinstance(other, dict):
            differ += [(k, other.get(k), value.get(k)) for k in {**other, **value} if other.get(k) != value.get(k)]
        elif other != value:
            differ.append((name, other, value))
    differ += [(name, value, None) for name, value in found.items()
               if name.startswith(("values of ", "tolerance of ", "draws")) and name not in wanted]  # fmt: skip
    if differ:
        lines = "".join(f"\n  {name}: the store has {_short(a)}, this run {_short(b)}" for name, a, b in differ[:8])
        more = f"\n  and {len(differ) - 8} more" if len(differ) > 8 else ""
        if not {name for name, *_ in differ} - {"whirlmap_version", "kernel"}:
            raise OutputError(
                f"{folder}: was made by another version of whirlmap or of its libraries, whose numbers need not be the same"
                " to the bit. It opens and is drawn as ever, but cannot be continued; --force replaces it, or choose another"
                f" name{lines}"
            )
        raise OutputError(f"{folder}: holds another sweep; --force replaces it, or choose another name{lines}{more}")


def _short(value: Any) -> str:
    text = "nothing" if value is None else str(value)
    return text if len(text) < 64 else f"{text[:12]}..."
