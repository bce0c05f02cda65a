"""The kernels of a model for a browser: the assembly that is compiled for this processor, compiled to WebAssembly.

The rates, the methods and all that is done in a step are the same instructions. Two things differ: roots and reciprocals are
computed by divisions, and sines by the browser's own, for WebAssembly has neither estimates nor products that go into a sum
without rounding. So the last bits differ, and nothing else.
"""

import hashlib
from dataclasses import dataclass
from functools import cache

import llvmlite
import llvmlite.binding as llvm

from whirlmap.equations.model import Model
from whirlmap.errors import ModelError
from whirlmap.kernels.cache import stored
from whirlmap.kernels.methods import Method
from whirlmap.kernels.running.source import KernelSource, stored_source
from whirlmap.kernels.webassembly.object_file import imported, loadable

#: What the modules are compiled for, and features that every browser has had since 2023.
TARGET, FEATURES = "wasm32-unknown-unknown", "+simd128,+bulk-memory"
#: Functions of the C library that a browser's ``Math`` has too.
MATH = frozenset((
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "exp", "log",
    "pow",
))  # fmt: skip
#: What every module needs beside them.
ALWAYS = frozenset(("__linear_memory", "__stack_pointer"))
#: Functions of each kind of module.
LOCKED, FREE = ("advance",), ("march", "evaluate")


class NoBrowserKernelError(ModelError):
    """A model whose rates browsers cannot compute."""


@dataclass(frozen=True)
class BrowserKernel:
    """Modules of one model and method without tangent vectors.

    Attributes
    ----------
    source : KernelSource
        Of the phase-locked kernel: sizes of its arrays, its inputs and tables.
    locked, free : bytes
        Modules with ``advance``, and with ``march`` and ``evaluate``.
    free_work : int
        Rows of working memory that the free kernel needs.
    """

    source: KernelSource
    locked: bytes
    free: bytes
    free_work: int


def browser_kernel(model: Model, method: Method) -> BrowserKernel:
    """Compile the kernels of a model for a browser, or find them again.

    Raises
    ------
    NoBrowserKernelError
        The model's rates call a function that browsers do not have.
    """
    locked, free = (
        stored_source(model, method, slopes="none", kind=kind, estimated=False, fused=False) for kind in ("locked", "free")
    )
    return BrowserKernel(locked, _module(model, locked.text, LOCKED), _module(model, free.text, FREE), free.sizes.work)


def _module(model: Model, text: str, exports: tuple[str, ...]) -> bytes:
    """Module of a kernel's assembly, from the folder of kernels or compiled for it."""
    depends = f"{TARGET} {FEATURES} llvmlite {llvmlite.__version__} LLVM {llvm.llvm_version_info} {exports}\n{text}"
    name = f"kernel_{hashlib.sha256(depends.encode()).hexdigest()[:32]}.wasm"
    module = stored(name, lambda: loadable(compile_webassembly(text), exports))
    unknown = set(imported(module)) - MATH - ALWAYS
    if unknown:
        raise NoBrowserKernelError(
            f"model {model.name!r} cannot run in a browser: its rates call {' and '.join(sorted(unknown))}, which browsers"
            " do not have"
        )
    return module


@cache
def _target() -> llvm.Target:
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    return llvm.Target.from_triple(TARGET)


def compile_webassembly(text: str) -> bytes:
    """Object file of a kernel's assembly."""
    machine = _target().create_target_machine(cpu="", features=FEATURES, opt=3)
    own = [line for line in text.splitlines() if not line.startswith("target ")]
    module = llvm.parse_assembly("\n".join([f'target triple = "{TARGET}"', *own]))
    module.verify()
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=3))
    builder.getModulePassManager().run(module, builder)
    made: bytes = machine.emit_object(module)
    return made
