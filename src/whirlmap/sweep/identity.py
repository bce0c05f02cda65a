"""What decides the bits of a sweep beside its parameters: the program, the libraries under it, and the processor."""

import hashlib
import platform
from functools import cache
from importlib.resources import files
from importlib.resources.abc import Traversable

from whirlmap.integrate.loading import pieces
from whirlmap.integrate.system import System
from whirlmap.kernels.root_choice import chosen
from whirlmap.results.provenance import package_version

#: Parts of the package whose source decides what is computed of a point.
DECIDING = (
    "equations", "films", "kernels", "integrate", "analysis", "results", "sweep/points.py", "sweep/point_variables.py",
    "sweep/refine.py",
)  # fmt: skip

#: Packages whose versions do; llvmlite's and LLVM's are part of the platform. Numba compiles loops of the labels.
LIBRARIES = ("whirlmap", "numba", "numpy", "scipy", "sympy")


def kernel_hash(system: System, method: str | None) -> str:
    """Hash of the model, the method, the source that becomes kernels and labels, the versions, processor and roots."""
    return hashlib.sha256(f"{_program()}\n{pieces(system).model_hash}\n{method}\n{chosen()}".encode()).hexdigest()


@cache
def _program() -> str:
    from whirlmap.kernels.machine import platform as processor

    versions = " ".join(f"{name} {package_version(name)}" for name in LIBRARIES)
    digest = hashlib.sha256(f"{processor()} python {platform.python_version()} {versions}".encode())
    root = files("whirlmap")
    for part in DECIDING:
        for name, text in _sources(root.joinpath(part), part):
            digest.update(f"\n{name}\n".encode() + text)
    return digest.hexdigest()


def _sources(place: Traversable, name: str) -> list[tuple[str, bytes]]:
    if place.is_file():
        return [(name, place.read_bytes())] if name.endswith((".py", ".c", ".h")) else []
    found = sorted(place.iterdir(), key=lambda child: child.name)
    return [source for child in found for source in _sources(child, f"{name}/{child.name}")]
