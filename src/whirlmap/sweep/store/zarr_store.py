"""A sweep on disk: a Zarr group in which every chunk is committed whole, and which can be checked, continued and compared.

Layout, all of it Zarr v3 and the group itself what `xarray.open_zarr` opens:

- one array for each variable, chunked as the tasks are: one task writes one chunk of each;
- ``evaluation``, of every point: absent, computed, inferred or failed; written after the data;
- ``chunks/receipt``, of every task: a checksum over the files of its chunk, written last of all. A chunk counts only with
  the receipt that fits its files;
- ``chunks/reason``, of every task that failed: why, as text;
- the manifest: what the store was made of, as the attributes of the group ``chunks``.

A file is written beside and renamed (Zarr does), the store itself is made beside and renamed. A process that is killed at
any moment leaves chunks without a receipt, which are computed again, and ``.partial`` files, which are swept away. Nothing
is forced to the disk: what a power failure tears does not fit its receipt, and is computed again too.
"""

import json
from collections import Counter
from collections.abc import Container, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
import zarr
from numpy.typing import NDArray

from whirlmap.results.provenance import PASSING
from whirlmap.results.status import Status
from whirlmap.sweep.parameters.space import Chunks
from whirlmap.sweep.store.store_folder import AT_WORK, CHUNKS, EVALUATION, read_manifest

#: Bytes kept of the reason for which a chunk failed.
REASON = 1000
#: Checksum of a receipt that cannot be read: it fits no files.
TORN = 2**64 - 1


class Evaluation(IntEnum):
    """Where the label of a point comes from."""

    absent = 0
    computed = 1
    inferred = 2
    failed = 3


@dataclass(frozen=True)
class Standing:
    """How far a store is.

    Attributes
    ----------
    done, failed, damaged : array of int
        Numbers of chunks; the others are absent. A damaged chunk has a receipt that its files do not fit.
    """

    done: NDArray[np.int64]
    failed: NDArray[np.int64]
    damaged: NDArray[np.int64]


class Store:
    """A store that exists.

    Parameters
    ----------
    folder : Path
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.manifest = read_manifest(folder)
        self.chunks = Chunks(tuple(self.manifest["shape"]), tuple(self.manifest["chunk"]))

    @cached_property
    def group(self) -> zarr.Group:
        """The group, open for reading and writing."""
        return zarr.open_group(self.folder, mode="r+", use_consolidated=False)

    @cached_property
    def arrays(self) -> dict[str, "zarr.Array[Any]"]:
        """Arrays over the points, in the order in which a chunk is written."""
        found = {}
        for name in self.manifest["variables"]:
            array = self._array(name)
            # Without this a chunk of nothing but NaN is no file, and looks as if it had never been written.
            found[name] = array.with_config({"write_empty_chunks": True})
        return found

    def _array(self, name: str) -> "zarr.Array[Any]":
        array = self.group[name]
        assert isinstance(array, zarr.Array)
        return array

    def commit(self, number: int, data: Mapping[str, NDArray[Any]]) -> None:
        """Write a chunk: data, evaluation, and then the receipt over what now stands on the disk."""
        self.write(number, data)
        reason = self._array(f"{CHUNKS}/reason")
        reason[self.chunks.cell(number)] = np.zeros(REASON, dtype=np.uint8)  # no file
        self._array(f"{CHUNKS}/receipt")[self.chunks.cell(number)] = self.checksum(number)

    def write(self, number: int, data: Mapping[str, NDArray[Any]]) -> None:
        """Write the arrays of a chunk, without a receipt."""
        box = self.chunks.box(number)
        for name, array in self.arrays.items():
            array[box] = data[name]

    def fail(self, number: int, reason: str) -> None:
        """Record that a chunk cannot be computed: its points say so, and the reason is kept."""
        size = tuple(s.stop - s.start for s in self.chunks.box(number))
        data = {
            name: np.full((*size, *array.shape[len(size) :]), array.fill_value, array.dtype)
            for name, array in self.arrays.items()
        }
        data["status"][:], data[EVALUATION][:] = Status.failed, Evaluation.failed
        self.write(number, data)
        text = np.zeros(REASON, dtype=np.uint8)
        encoded = np.frombuffer(reason.encode("utf-8", "replace")[:REASON], dtype=np.uint8)
        text[: encoded.size] = encoded
        self._array(f"{CHUNKS}/reason")[self.chunks.cell(number)] = text

    def checksum(self, number: int) -> np.uint64:
        """First 8 bytes of SHA-256 over the files of a chunk; a file that is missing counts as such. Never 0."""
        digest = sha256()
        for path in self.files(number):
            try:
                digest.update(f"{path.relative_to(self.folder)}\n".encode() + path.read_bytes())
            except FileNotFoundError:
                digest.update(b"missing")
        return np.uint64(int.from_bytes(digest.digest()[:8], "little") or 1)

    def files(self, number: int) -> list[Path]:
        """Files of a chunk, one for each array."""
        cell = self.chunks.cell(number)
        found = []
        for name in self.manifest["variables"]:
            rest = (0,) * self.manifest["variables"][name]
            found.append(self.folder.joinpath(name, "c", *map(str, (*cell, *rest))))
        return found

    def receipts(self) -> NDArray[np.uint64]:
        """Checksums of all chunks, 0 where there is none; `TORN` where the receipt itself cannot be read."""
        array = self._array(f"{CHUNKS}/receipt")
        try:
            return np.asarray(array[...]).ravel()
        except (ValueError, RuntimeError, OSError):
            return np.array([_read_or(array, self.chunks.cell(k), TORN) for k in range(self.chunks.count)], dtype=np.uint64)

    def reasons(self) -> dict[int, str]:
        """Why chunks failed."""
        folder = self.folder / CHUNKS / "reason" / "c"
        out = {}
        for path in folder.rglob("*") if folder.is_dir() else ():
            if path.is_file() and path.suffix != ".partial":
                cell = tuple(int(part) for part in path.relative_to(folder).parts[: len(self.chunks.grid)])
                torn = np.frombuffer(b"the reason cannot be read", dtype=np.uint8)
                text = np.asarray(_read_or(self._array(f"{CHUNKS}/reason"), cell, torn)).tobytes().rstrip(b"\0")
                out[int(np.ravel_multi_index(cell, self.chunks.grid))] = text.decode("utf-8", "replace")
        return dict(sorted(out.items()))

    def standing(self, numbers: Iterable[int] | None = None, *, threads: int = 8) -> Standing:
        """Say which chunks are whole, reading and checking every file of them."""
        receipts = self.receipts()
        asked = np.fromiter(range(self.chunks.count) if numbers is None else numbers, dtype=np.int64)
        claimed = asked[receipts[asked] != 0]
        with ThreadPoolExecutor(threads) as pool:
            sums = np.fromiter(pool.map(self.checksum, claimed.tolist()), dtype=np.uint64, count=claimed.size)
        whole = sums == receipts[claimed]
        failed = np.setdiff1d(np.intersect1d(np.array(list(self.reasons()), dtype=np.int64), asked), claimed)
        return Standing(claimed[whole], failed, claimed[~whole])

    def tally(self, numbers: Iterable[int], name: str) -> Counter[int]:
        """Count the values of an array, ``regime`` or ``evaluation``, over chunks."""
        counted, array = Counter[int](), self._array(name)  # of the others some may be lost
        for number in numbers:
            counted.update(counts_of(np.asarray(array[self.chunks.box(number)])))
        return counted

    def sweep_away(self, numbers: Container[int] | None = None) -> int:
        """Delete what killed processes left half-written, of some chunks or of all; returns how many files that were."""
        count = 0
        for path in self.folder.rglob("*.partial"):
            if numbers is None or self._chunk_of(path) in numbers:
                path.unlink(missing_ok=True)
                count += not path.name.startswith(AT_WORK)
        return count

    def _chunk_of(self, path: Path) -> int:
        """Number of the chunk that a file belongs to; -1 where it belongs to none."""
        parts = path.relative_to(self.folder).parts
        place = parts.index("c") + 1 if "c" in parts else len(parts)
        cell = [part.partition(".")[0] for part in parts[place : place + len(self.chunks.grid)]]
        if len(cell) < len(self.chunks.grid) or not all(part.isdigit() for part in cell):
            return -1
        return int(np.ravel_multi_index([int(part) for part in cell], self.chunks.grid))

    def open(self) -> xr.Dataset:
        """Open as a Dataset, its arrays still on the disk."""
        return xr.open_zarr(self.folder)


def differences(one: Path, other: Path) -> list[str]:
    """Files in which two stores differ; of the attributes of the group all but when and by which command count."""
    files = [{p.relative_to(f).as_posix() for p in f.rglob("*") if p.is_file()} for f in (one, other)]
    out = sorted(files[0] ^ files[1])
    return out + sorted(name for name in files[0] & files[1] if _content(one / name) != _content(other / name))


def _content(path: Path) -> Any:
    if path.name != "zarr.json":
        return path.read_bytes()
    content = json.loads(path.read_text())
    for name in PASSING:
        content.get("attributes", {}).pop(name, None)
    return content


def _read_or(array: "zarr.Array[Any]", cell: tuple[int, ...], otherwise: Any) -> Any:
    try:
        return array[cell]
    except (ValueError, RuntimeError, OSError):
        return otherwise


def counts_of(values: NDArray[Any]) -> dict[int, int]:
    """How often each value occurs."""
    found, counts = np.unique(values, return_counts=True)
    return dict(zip(found.tolist(), counts.tolist(), strict=True))
