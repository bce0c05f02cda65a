"""Machine code: a module's assembly compiled for the processor, kept on disk, and called without the interpreter's lock."""

import ctypes
import hashlib
import os
import threading
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import llvmlite
import llvmlite.binding as llvm
import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import CacheError, InputError
from whirlmap.kernels import cache as files
from whirlmap.kernels.writing.routine import LANES, Kind

_LOCK = threading.Lock()

#: Levels of x86 that code can be made for instead of the processor at hand, and features that they need.
LEVELS = {
    "x86-64": ("sse2",), "x86-64-v2": ("sse4.2", "popcnt"), "x86-64-v3": ("avx2", "fma", "bmi2"),
    "x86-64-v4": ("avx2", "fma", "bmi2", "avx512f", "avx512vl", "avx512dq"),
}  # fmt: skip

#: Functions of the C library that loops may call.
LIBRARY = {"sin", "cos", "sincos", "floor", "rint", "sqrt", "pow"}

#: What arrays hold, by kind.
HOLDS: dict[Kind, np.dtype[Any]] = {
    "rows": np.dtype(np.float64), "doubles": np.dtype(np.float64), "flags": np.dtype(np.int64), "ints": np.dtype(np.int64),
}  # fmt: skip


@cache
def _host() -> tuple[str, Mapping[str, bool], str]:
    """Name and features of this processor, the latter also as LLVM takes them; asking for them takes half a millisecond."""
    features = llvm.get_host_cpu_features()
    return llvm.get_host_cpu_name(), features, features.flatten()


def processor() -> tuple[str, str]:
    """Name and features of the processor that code is made for: ``$WHIRLMAP_CPU`` where set, else this one.

    Code made for ``x86-64-v3`` gives the same bits on every processor of the last ten years, and is slower where there are
    wider vectors.

    Raises
    ------
    InputError
        The variable names no level that this processor has: LLVM would end the program.
    """
    chosen = os.environ.get("WHIRLMAP_CPU", "")
    name, features, flat = _host()
    if not chosen:
        return name, flat
    had = [level for level, needed in LEVELS.items() if all(features.get(f) for f in needed)]
    if chosen not in had:
        raise InputError(
            f"WHIRLMAP_CPU: found {chosen!r}, expected {' or '.join(had) or 'nothing'} on this processor, or nothing"
        )
    return chosen, ""


def estimates() -> bool:
    """Whether the processor has estimates of roots and reciprocals of whole vectors."""
    return LANES == 8 and ",+avx512f," in f",{processor()[1]},"  # they are written for registers of eight


def fuses() -> bool:
    """Whether the processor adds a product without rounding it."""
    level, features = os.environ.get("WHIRLMAP_CPU", ""), processor()[1].split(",")  # a level that is not had is refused
    if level:
        return "fma" in LEVELS[level]
    return "+fma" in features or llvm.get_default_triple().startswith(("aarch64", "arm64"))


def platform() -> str:
    """Versions and processor that compiled code depends on."""
    return f"llvmlite {llvmlite.__version__} LLVM {llvm.llvm_version_info} {llvm.get_default_triple()} {processor()}"


def key(text: str) -> str:
    """Hash of a module's assembly and of everything that its machine code depends on."""
    return hashlib.sha256(f"{platform()}\n{text}".encode()).hexdigest()[:32]


@cache
def _target() -> Any:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.Target.from_default_triple()


def _machine() -> Any:
    cpu, features = processor()
    return _target().create_target_machine(cpu=cpu, features=features, opt=3, jit=True)


def compile_assembly(text: str) -> bytes:
    """Object code of a module."""
    machine = _machine()
    module = llvm.parse_assembly(text)
    module.verify()
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=3))
    builder.getModulePassManager().run(module, builder)
    made: bytes = machine.emit_object(module)
    return made


def only_function(text: str, wrapper: str, name: str) -> bytes:
    """Object code of a module that is optimised already, of which one function is wanted, under a name of its own.

    Parameters
    ----------
    wrapper : str
        The module's other function that can be called from without; it is left out with all that it alone calls.

    Raises
    ------
    RuntimeError
        The function needs one of another module, which is not in the C library: to load its code would end the program.
    """
    machine = _machine()
    module = llvm.parse_assembly(text)
    defined = [f for f in module.functions if not f.is_declaration]
    (function,) = (f for f in defined if f.linkage == llvm.Linkage.external and f.name != wrapper)
    function.name = name
    for other in defined:
        if other.name != name:
            other.linkage = "internal"
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.run(module, llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options()))
    module.verify()
    called = {f.name for f in module.functions if f.is_declaration and not f.name.startswith("llvm.")}
    if not called <= LIBRARY:
        raise RuntimeError(f"the loop {name} cannot run by itself: it needs {', '.join(sorted(called - LIBRARY))}")
    made: bytes = machine.emit_object(module)
    return made


class Code:
    """Machine code in memory, and its functions.

    Parameters
    ----------
    made : callable
        ``made() -> bytes``: object code, from the folder of kernels or made for it; one thread at a time calls it.
    """

    def __init__(self, made: Callable[[], bytes]) -> None:
        with _LOCK:
            found = made()
            try:
                self._engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _machine())
                self._engine.add_object_file(llvm.ObjectFileRef.from_data(found))
                self._engine.finalize_object()
            except RuntimeError as error:
                raise CacheError(
                    f"a compiled kernel cannot be loaded: {error}\n  clear them with `whirlmap cache --clear`"
                ) from error

    @classmethod
    def of(cls, text: str) -> "Code":
        """Machine code of a module's assembly; compiled where the folder of kernels does not hold it yet."""
        return cls(lambda: files.stored(f"kernel_{key(text)}.o", lambda: compile_assembly(text)))

    def function(self, name: str, arguments: Mapping[str, Kind]) -> "Function":
        """One of its functions."""
        address = self._engine.get_function_address(name)
        assert address, f"the kernel has no function {name}"  # to call it would end the program
        return Function(self, name, address, arguments)


class Function:
    """A compiled function, called with NumPy arrays by name."""

    def __init__(self, code: Code, name: str, address: int, arguments: Mapping[str, Kind]) -> None:
        self.code, self.name, self.arguments = code, name, arguments  # the code stays in memory as long as its functions
        kinds = [ctypes.c_int64 if kind == "int" else ctypes.c_void_p for kind in arguments.values()]
        self._call = ctypes.CFUNCTYPE(None, *kinds)(address)
        self._holds = [(name, HOLDS.get(kind)) for name, kind in arguments.items()]

    def __call__(self, **values: Any) -> None:
        """Call it; every argument by name, arrays C-contiguous and of the kind's type."""
        assert values.keys() == self.arguments.keys(), values.keys() ^ self.arguments.keys()
        passed = []
        for name, held in self._holds:
            value = values[name]
            if held is None:
                passed.append(int(value))
            else:
                assert value.dtype == held, name
                try:  # `begin`, without a call of it for each of some twenty arrays
                    passed.append(ctypes.addressof(ctypes.c_char.from_buffer(value)))
                except (TypeError, ValueError):
                    passed.append(begin(value, name))
        self._call(*passed)


def begin(array: Any, name: str = "") -> int:
    """Address of an array's first number; NumPy's own way to it takes three times as long. It must be C-contiguous."""
    try:
        return ctypes.addressof(ctypes.c_char.from_buffer(array))
    except (TypeError, ValueError):  # not contiguous, read-only, or empty
        assert array.flags.c_contiguous, name
        return int(array.ctypes.data)


def aligned(rows: int) -> NDArray[np.float64]:
    """Uninitialised rows of lanes that begin at a multiple of 64 bytes: a vector is then read from one line of cache."""
    raw = np.empty(rows * LANES + 8)
    skip = (-begin(raw) % 64) // 8
    return raw[skip : skip + rows * LANES]
