"""Store folders: whether a folder is a store, complete or damaged, and its removal; from names and the manifest alone.

The manifest, the attribute of the group ``chunks``, stands once more in the description of the whole store, where Zarr
consolidates all others. A store that has lost the one gets it back from the other.
"""

import json
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any
from uuid import uuid4

from whirlmap.errors import OutputError
from whirlmap.results.files import reason, write_beside

#: Group of what is known of the tasks, and the attribute of it that holds the manifest.
CHUNKS, MANIFEST = "chunks", "manifest"
#: Array that says where the label of each point comes from.
EVALUATION = "evaluation"
#: Description of a group or an array; that of the whole store holds a copy of all others.
DESCRIPTION = "zarr.json"
#: Files of a store: descriptions and chunks of the group, its arrays, and those of ``chunks``; also half-written ones.
PART = re.compile(r"(?:\w+/){0,2}(?:zarr\.json|at_work|c(?:/\d+)*)(?:\.\w+\.partial)?")
#: File that a process keeps in the group ``chunks`` while it computes.
AT_WORK = "at_work"


def exists(folder: Path) -> bool:
    """Whether a folder is a store with its manifest."""
    try:
        read_manifest(folder)
    except OutputError:
        return False
    return True


def read_manifest(folder: Path) -> dict[str, Any]:
    """Read the manifest of a store.

    Raises
    ------
    OutputError
        The folder is no store, or has lost its manifest.
    """
    try:
        return _checked(json.loads((folder / CHUNKS / DESCRIPTION).read_text())["attributes"][MANIFEST])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise OutputError(f"{folder}: is no store of a sweep ({_why(folder, error)})") from None


def _checked(found: Any) -> dict[str, Any]:
    """Return a manifest that says how a store is laid out, else raise `ValueError` or `KeyError`."""
    shape, chunk, variables = (found[name] for name in ("shape", "chunk", "variables"))
    whole = [n for n in (*shape, *chunk) if not isinstance(n, int) or n < 1]
    if not shape or len(shape) != len(chunk) or whole or {"regime", "status", EVALUATION} - set(variables):
        raise ValueError("it does not say the shape and the variables of the sweep")
    return dict(found)


def _why(folder: Path, error: Exception) -> str:
    """Say why a folder is no store, and what can be done where it has been one."""
    if folder.is_file():
        return "it is a file, expected a folder"
    if not folder.is_dir():
        return "there is no such folder"
    if not remains(folder):
        return f"its manifest, {CHUNKS}/{DESCRIPTION}, cannot be read: {_said(error)}"
    copy = "the same command with --resume puts it back" if copied_manifest(folder) else "its copy is lost too"
    return f"its manifest, {CHUNKS}/{DESCRIPTION}, is lost or torn: {_said(error)}; {copy}"


def _said(error: Exception) -> str:
    return reason(error) if isinstance(error, OSError) else f"{type(error).__name__} {error}"


def copied_manifest(folder: Path) -> dict[str, Any] | None:
    """Description of the group ``chunks``, the manifest in it, as the whole store's description holds it; None without."""
    try:
        copy: dict[str, Any] = json.loads((folder / DESCRIPTION).read_text())["consolidated_metadata"]["metadata"][CHUNKS]
        _checked(copy["attributes"][MANIFEST])
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return copy


def restore_manifest(folder: Path) -> bool:
    """Put the manifest back from its copy where it is lost or torn; returns whether that was done."""
    copy = None if exists(folder) else copied_manifest(folder)
    if copy is None or not remains(folder):
        return False
    try:
        (folder / CHUNKS).mkdir(exist_ok=True)
        text = json.dumps({k: v for k, v in copy.items() if k != "consolidated_metadata"}, indent=2)
        place = folder / CHUNKS / DESCRIPTION
        write_beside(place, lambda trial: trial.write_text(text), trial=passing(place))
    except OSError as error:
        raise OutputError(f"{folder}: its manifest cannot be put back ({reason(error)})") from error
    return True


def passing(path: Path) -> Path:
    """Name of what is not finished, as Zarr names it: `remains` and `clear_trials` know it where a process was killed."""
    return path.with_name(f"{path.name}.{uuid4().hex}.partial")


@contextmanager
def at_work(folder: Path) -> Iterator[None]:
    """Keep a file in a store that says that a process computes; one that is killed leaves it to the next run."""
    place = passing(folder / CHUNKS / AT_WORK)
    try:
        place.touch()
    except OSError as error:
        raise OutputError(f"{folder}: cannot be written ({reason(error)})") from error
    try:
        yield
    finally:
        with suppress(OSError):  # of a disk that is gone: what is raised already says so
            place.unlink(missing_ok=True)


def workers_at(folder: Path) -> list[Path]:
    """Files of the processes that compute, and of those that were killed while they did."""
    return list((folder / CHUNKS).glob(f"{AT_WORK}.*.partial"))


def remains(folder: Path) -> bool:
    """Whether a folder that is no store holds nothing but parts of one: descriptions, and files of chunks."""
    if not folder.is_dir() or not any(folder.iterdir()):
        return False
    files = (path.relative_to(folder).as_posix() for path in folder.rglob("*") if not path.is_dir())
    return all(PART.fullmatch(name) for name in files)


def half_made(folder: Path) -> bool:
    """Whether a folder holds remains of a store without any data: what has been computed is never begun anew by itself."""
    data = (path for path in folder.rglob("*") if "c" in path.relative_to(folder).parts[:-1] and not path.is_dir())
    return remains(folder) and not any(data)


def clear_trials(folder: Path) -> None:
    """Delete what processes left beside a store that were killed while they made it."""
    for trial in folder.parent.glob(f".{folder.name}.*.partial"):
        shutil.rmtree(trial, ignore_errors=True)


def remove(folder: Path) -> None:
    """Delete a store, or the remains of one; a folder that holds anything else is refused."""
    if not (exists(folder) or remains(folder)):
        raise OutputError(f"{folder}: is no store of a sweep, so it is not replaced; choose another name")
    shutil.rmtree(folder)
