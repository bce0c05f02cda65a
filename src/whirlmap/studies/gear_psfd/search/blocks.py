"""The store of a search: one file for each finished piece of work, and a manifest that says which search it belongs to.

A file appears when it is complete (`whirlmap.results.files`), so that a killed search loses the piece that it was in and
nothing else. Every number in a file follows from the manifest and the file's name.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import xarray as xr

from whirlmap.errors import OutputError
from whirlmap.results.files import check_writable, read, replace_file, write

MANIFEST = "search.json"


@dataclass
class Blocks:
    """Pieces of a search by name, in a folder or, without one, in memory."""

    folder: Path | None
    memory: dict[str, xr.Dataset] = field(default_factory=dict)

    def path(self, name: str) -> Path:
        """Where a piece is kept."""
        assert self.folder is not None
        return self.folder / f"{name}.nc"

    def __contains__(self, name: str) -> bool:
        """Whether a piece is finished."""
        return name in self.memory or (self.folder is not None and self.path(name).is_file())

    def __getitem__(self, name: str) -> xr.Dataset:
        """Return a finished piece."""
        if name not in self.memory:
            self.memory[name] = read(self.path(name))
        return self.memory[name]

    def put(self, name: str, ds: xr.Dataset) -> None:
        """Keep a finished piece; another share that finished it first has the same bits."""
        self.memory[name] = ds
        if self.folder is not None:
            write(ds, self.path(name), force=True)

    def names(self, prefix: str) -> Iterator[str]:
        """Names of the finished pieces that begin so, sorted."""
        found = {name for name in self.memory if name.startswith(prefix)}
        if self.folder is not None:
            found |= {p.stem for p in self.folder.glob(f"{prefix}*.nc")}
        yield from sorted(found)


def open_blocks(folder: Path | None, identity: Mapping[str, Any], *, resume: bool) -> Blocks:
    """Open the store of a search, new or to go on with.

    Parameters
    ----------
    identity : mapping
        What every number of the search depends on.
    resume : bool
        Whether the folder may hold a search already.

    Raises
    ------
    OutputError
        Where the folder holds a search and ``resume`` is false; where it holds another search, with the entries that
        differ; or where it is no store.
    """
    if folder is None:
        return Blocks(None)
    manifest = folder / MANIFEST
    wanted = json.loads(json.dumps(identity))
    if manifest.is_file():
        if not resume:
            raise OutputError(f"{folder} holds a search already; continue it with --resume, or choose another --store")
        _compare(manifest, wanted)
        return Blocks(folder)
    check_writable(folder)
    folder.mkdir(exist_ok=True)
    text = json.dumps(wanted, indent=1)
    try:
        replace_file(manifest, lambda trial: trial.write_text(text, encoding="utf-8"), force=True)
    except OutputError:
        if not manifest.is_file():  # another share may have been first
            raise
    _compare(manifest, wanted)
    return Blocks(folder)


def _compare(manifest: Path, wanted: Mapping[str, Any]) -> None:
    try:
        found = dict(json.loads(manifest.read_text(encoding="utf-8")))
    except (ValueError, TypeError, OSError) as error:
        raise OutputError(f"{manifest} is not the manifest of a search: {error}") from error
    differ = [k for k in sorted({*found, *wanted}) if found.get(k) != wanted.get(k)]
    if differ:
        lines = "".join(f"\n  {k}: found {found.get(k)!r}, now {wanted.get(k)!r}" for k in differ)
        raise OutputError(f"{manifest.parent} holds another search; choose another --store{lines}")
