"""Fingerprint of a computation: program, libraries and processor, which decide the bits beside the parameters."""

import hashlib
import platform
from functools import cache

from whirlmap.integrate.loading import pieces
from whirlmap.integrate.system import System
from whirlmap.kernels.cache import source_of
from whirlmap.kernels.running import machine
from whirlmap.kernels.running.root_choice import chosen
from whirlmap.results.provenance import package_version

#: Parts of the package whose source decides what is computed of a point.
DECIDING = (
    "equations", "films", "kernels", "integrate", "analysis", "results", "options/computed.py", "sweep/points",
    "sweep/maps/refine.py",
)  # fmt: skip

#: Packages whose versions do; llvmlite's and LLVM's are part of the platform. Numba compiles loops of the labels.
LIBRARIES = ("whirlmap", "numba", "numpy", "scipy", "sympy")


def kernel_hash(system: System, method: str | None) -> str:
    """Hash of the model, the method, the source that becomes kernels and labels, the versions, processor and roots."""
    return hashlib.sha256(f"{_program()}\n{pieces(system).model_hash}\n{method}\n{chosen()}".encode()).hexdigest()


@cache
def _program() -> str:
    versions = " ".join(f"{name} {package_version(name)}" for name in LIBRARIES)
    what = f"{machine.platform()} python {platform.python_version()} {versions} {source_of(DECIDING)}"
    return hashlib.sha256(what.encode()).hexdigest()
