"""Cache on disk of compiled kernels and lowered models, each under the hash of everything that it depends on.

Kernels are object files, one per model, method and kind. Their name is the SHA-256 of the module's assembly, of the version
of llvmlite, and of the processor with its features (`running.machine.platform`). A change in any of them is another file.

Loops of the analyses (`whirlmap.kernels.running.loops`) are object files too, under the hash of their source.

Entries (`remembered`) are results of SymPy that a kernel needs: the text of its module, and the functions beside it. Their
name is the hash of the question, of the source of every layer that computes the answer, and of the versions.
Tables are fitted film mobilities (`lowering.tabulate`), under the hash of the source that solves the film.
"""

import hashlib
import json
import os
import platform as machine
import warnings
from collections.abc import Callable
from functools import cache
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import TypeVar

import numpy
from platformdirs import user_cache_path

from whirlmap.errors import CacheError
from whirlmap.progress import compiling
from whirlmap.results.files import reason, write_beside
from whirlmap.version import __version__

Data = TypeVar("Data")

#: Layers whose source decides the result of lowering; the model itself is part of every question. A layer above these adds
#: the digest of its own source to the question (`file_digest`).
WRITERS = ("equations", "films", "kernels", "integrate")


def folder() -> Path:
    """Where compiled kernels are kept: ``$WHIRLMAP_CACHE``, else the user's cache folder."""
    chosen = os.environ.get("WHIRLMAP_CACHE")
    if chosen:
        return Path(chosen).expanduser()

    return user_cache_path("whirlmap") / "kernels"


def size() -> int:
    """Bytes that the cache takes on disk."""
    here = folder()
    return sum(f.stat().st_size for f in here.rglob("*") if f.is_file()) if here.is_dir() else 0


def counts() -> tuple[int, int]:
    """Number of kernels in the cache, and of entries with what lowering gave."""
    here = folder()
    return len(list(here.glob("kernel_*.o"))), len(list(here.glob("lowered_*.json")))


def clear() -> tuple[int, int]:
    """Delete every cached kernel, loop, entry and table; returns how many kernels and entries there were."""
    here, deleted = folder(), counts()
    for f in [*here.glob("kernel_*"), *here.glob("loop_*"), *here.glob("lowered_*"), *here.glob("table_*")]:
        f.unlink(missing_ok=True)
    return deleted


def stored(name: str, make: Callable[[], bytes], sound: Callable[[bytes], bool] = lambda _: True) -> bytes:
    """Return the bytes that are kept under a name, else make them and keep them.

    Parameters
    ----------
    name : str
        File name; it holds the hash of everything that the bytes depend on.
    make : callable
        Makes them.
    sound : callable, optional
        Whether bytes that are whole have the form that is expected.

    Raises
    ------
    CacheError
        Where the folder that ``WHIRLMAP_CACHE`` names cannot be written. Where the user's own cannot (a read-only HOME),
        nothing is kept, which is warned of once.

    Notes
    -----
    A file is written whole or not at all, so that two processes may fill it at once. One that is damaged is made again, with
    a warning.
    """
    path = folder() / name
    try:
        digest, _, found = path.read_bytes().partition(b"\n")
        if digest == hashlib.sha256(found).hexdigest().encode() and sound(found):
            return found
        warnings.warn(f"{path} is damaged and is made again", stacklevel=2)
    except (FileNotFoundError, NotADirectoryError):
        pass
    except OSError:
        warnings.warn(f"{path} cannot be read and is made again", stacklevel=2)
    with compiling():
        made = make()
    _write(path, hashlib.sha256(made).hexdigest().encode() + b"\n" + made)
    return made


@cache
def _written_by() -> str:
    """Hash of the source that writes entries, and the versions of what it writes them with."""
    import sympy

    return hashlib.sha256(f"sympy {sympy.__version__} {source_of(WRITERS)}".encode()).hexdigest()


@cache
def source_of(parts: tuple[str, ...]) -> str:
    """Hash of the source of some parts of the package, and of the versions of this package, NumPy and Python."""
    digest = hashlib.sha256(f"{__version__} numpy {numpy.__version__} {machine.python_version()}".encode())
    for part in parts:
        for name, text in _sources(files("whirlmap").joinpath(part), part):
            digest.update(f"\n{name}\n".encode() + text)
    return digest.hexdigest()


def _sources(place: Traversable, name: str) -> list[tuple[str, bytes]]:
    if place.is_file():
        return [(name, place.read_bytes())] if name.endswith(".py") else []
    found = sorted(place.iterdir(), key=lambda child: child.name)
    return [source for child in found for source in _sources(child, f"{name}/{child.name}")]


@cache
def file_digest(path: str) -> str:
    """Hash of one source file."""
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def remembered(question: str, answer: Callable[[], Data], sound: Callable[[Data], bool]) -> Data:
    """Return what was worked out before for the same question, else work it out and keep it.

    Parameters
    ----------
    question : str
        Everything that the answer depends on, but for the source of `WRITERS`.
    answer : callable
        Works it out: plain data, as JSON holds it.
    sound : callable
        Whether data has the form of an answer.

    Raises
    ------
    CacheError
        Where the folder cannot be written.

    Notes
    -----
    An entry is written whole or not at all, so that two processes may fill it at once. One that is damaged is worked out
    again, with a warning.
    """
    name = hashlib.sha256(f"{_written_by()}\n{question}".encode()).hexdigest()[:32]
    found: Data = json.loads(
        stored(f"lowered_{name}.json", lambda: json.dumps(answer()).encode(), lambda data: sound(json.loads(data)))
    )
    return found


@cache
def _warn_once(place: Path, why: str) -> None:
    warnings.warn(
        f"compiled kernels are not kept, and every run compiles anew: {place} cannot be written ({why});"
        " set WHIRLMAP_CACHE to a folder that can",
        stacklevel=2,
    )


def _write(path: Path, data: bytes) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_beside(path, lambda trial: trial.write_bytes(data))
    except OSError as error:
        if not os.environ.get("WHIRLMAP_CACHE"):
            _warn_once(path.parent, reason(error))
            return
        raise CacheError(
            f"the folder of compiled kernels cannot be written: {path.parent}: {reason(error)}\n"
            "  set WHIRLMAP_CACHE to a folder that can"
        ) from error
