"""Compiled kernels on disk: one self-contained module per model, method and kind, named by the hash of all it is made of.

Numba's own cache keys miss what is fatal here (functions of other files, fast-math flags), so nothing is shared between
modules: the module's name is the SHA-256 of its source, of the versions of Numba and llvmlite, and of the processor with
its features. A change in any of them is another module.
"""

import hashlib
import importlib.util
import os
import sys
import threading
from functools import cache
from pathlib import Path
from types import ModuleType

from whirlmap.errors import CacheError

_LOCK = threading.Lock()


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


def clear() -> int:
    """Delete every cached kernel; returns the number of modules deleted."""
    here = folder()
    modules = list(here.glob("kernel_*.py")) if here.is_dir() else []
    for f in here.glob("**/kernel_*") if here.is_dir() else []:
        f.unlink(missing_ok=True)
    return len(modules)


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


def _write(path: Path, text: str) -> None:
    part = path.with_suffix(f".{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.write_text(text, encoding="utf-8")
        part.replace(path)
    except OSError as error:
        raise CacheError(
            f"the folder of compiled kernels cannot be written: {path.parent}: {error.strerror or error}\n"
            "  set WHIRLMAP_CACHE to a folder that can"
        ) from error
