"""Compiled kernels on disk, and what lowering a model gave: each under the hash of all that it is made of.

Kernels are self-contained modules, one per model, method and kind.
Numba's own cache keys miss what is fatal here (functions of other files, fast-math flags), so nothing is shared between
modules: the module's name is the SHA-256 of its source, of the versions of Numba and llvmlite, and of the processor with
its features. A change in any of them is another module.

Entries (`remembered`) are what SymPy worked out before a kernel can be called: the module's text, the functions beside
it. Their name is the hash of the question, of the source of every layer that writes the answer, and of the versions.
"""

import hashlib
import importlib.util
import json
import os
import platform as machine
import sys
import threading
import warnings
from collections.abc import Callable
from functools import cache
from importlib.resources import files
from pathlib import Path
from types import ModuleType
from typing import TypeVar

from whirlmap.errors import CacheError

_LOCK = threading.Lock()

Data = TypeVar("Data")

#: Layers whose source decides what lowering gives; the model itself is part of every question.
WRITERS = ("equations", "films", "kernels", "integrate", "analysis")


def folder() -> Path:
    """Where compiled kernels are kept: ``$WHIRLMAP_CACHE``, else the user's cache folder."""
    chosen = os.environ.get("WHIRLMAP_CACHE")
    if chosen:
        return Path(chosen).expanduser()
    from platformdirs import user_cache_path

    return user_cache_path("whirlmap") / "kernels"


def size() -> int:
    """Bytes that the cache takes on disk."""
    here = folder()
    return sum(f.stat().st_size for f in here.rglob("*") if f.is_file()) if here.is_dir() else 0


def counts() -> tuple[int, int]:
    """Number of kernels in the cache, and of entries with what lowering gave."""
    here = folder()
    return len(list(here.glob("kernel_*.py"))), len(list(here.glob("lowered_*.json")))


def clear() -> tuple[int, int]:
    """Delete every cached kernel and entry; returns how many there were of each."""
    here, deleted = folder(), counts()
    for f in [*here.glob("**/kernel_*"), *here.glob("lowered_*")]:
        f.unlink(missing_ok=True)
    return deleted


#: LLVM gives up on comparing the many rows of one array unless it may make this many comparisons (its default is 100).
LLVM_OPTION = "-memory-check-merge-threshold=100000"


@cache
def _prepare_llvm() -> None:
    import llvmlite.binding as llvm

    llvm.set_option("whirlmap", LLVM_OPTION)


@cache
def platform() -> str:
    """Versions and processor that compiled code depends on."""
    import llvmlite
    import llvmlite.binding as llvm
    import numba

    features = llvm.get_host_cpu_features().flatten()
    return f"numba {numba.__version__} llvmlite {llvmlite.__version__} {llvm.get_host_cpu_name()} {features} {LLVM_OPTION}"


def key(text: str) -> str:
    """Hash of a kernel's source and of everything that its machine code depends on."""
    return hashlib.sha256(f"{platform()}\n{text}".encode()).hexdigest()[:32]


def module(text: str) -> ModuleType:
    """Import the module of a kernel's source, writing it to the cache first where it is not there.

    Raises
    ------
    CacheError
        Where the folder cannot be written.
    """
    name = f"kernel_{key(text)}"
    with _LOCK:
        if name in sys.modules:
            return sys.modules[name]
        _prepare_llvm()
        path = folder() / f"{name}.py"
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            _write(path, text)
        spec = importlib.util.spec_from_file_location(name, path)
        assert spec is not None and spec.loader is not None
        made = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(made)
        sys.modules[name] = made
        return made


@cache
def _written_by() -> str:
    """Hash of the source that writes entries, and the versions of what it writes them with."""
    import numpy
    import sympy

    from whirlmap.version import __version__

    digest = hashlib.sha256(
        f"{__version__} sympy {sympy.__version__} numpy {numpy.__version__} {machine.python_version()}".encode()
    )
    for layer in WRITERS:
        for f in sorted(files("whirlmap").joinpath(layer).iterdir(), key=lambda f: f.name):
            if f.name.endswith(".py"):
                digest.update(f"\n{layer}/{f.name}\n".encode() + f.read_bytes())
    return digest.hexdigest()


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
    path = folder() / f"lowered_{name}.json"
    text: str | None
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        text = None
    except (OSError, UnicodeDecodeError):
        text = ""
    if text is not None:
        digest, _, body = text.partition("\n")
        if digest == hashlib.sha256(body.encode()).hexdigest():
            found: Data = json.loads(body)
            if sound(found):
                return found
        warnings.warn(f"{path} is damaged and is written again", stacklevel=2)
    made = answer()
    body = json.dumps(made)
    _write(path, f"{hashlib.sha256(body.encode()).hexdigest()}\n{body}")
    return made


def _write(path: Path, text: str) -> None:
    part = path.with_suffix(f".{os.getpid()}.{threading.get_ident()}.part")  # two threads may write the same entry
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.write_text(text, encoding="utf-8")
        part.replace(path)
    except OSError as error:
        raise CacheError(
            f"the folder of compiled kernels cannot be written: {path.parent}: {error.strerror or error}\n"
            "  set WHIRLMAP_CACHE to a folder that can"
        ) from error
