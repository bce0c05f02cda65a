"""The folder of a reproduction: it replaces only unchanged files of an earlier reproduction."""

import hashlib
import json
from collections.abc import Callable
from pathlib import Path

from whirlmap.errors import OutputError
from whirlmap.results.files import check_writable, replace_file

MANIFEST = "manifest.json"


class Folder:
    """A folder with a manifest of the files that it owns.

    Raises
    ------
    OutputError
        Where the folder cannot be made or written, or holds a manifest that is none.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        if path.exists() and not path.is_dir():
            raise OutputError(f"{path} is a file, not a folder")
        if not path.exists():
            check_writable(path)
            path.mkdir()
        self.owned: dict[str, str] = self._read()

    def _read(self) -> dict[str, str]:
        manifest = self.path / MANIFEST
        if not manifest.exists():
            return {}
        try:
            found = json.loads(manifest.read_text(encoding="utf-8"))["files"]
        except (ValueError, KeyError, TypeError, OSError) as error:
            raise OutputError(f"{manifest} is not the manifest of a reproduction: {error}") from error
        return dict(found)

    def check(self, names: list[str]) -> None:
        """Refuse, before anything is computed, to replace a file that is not this folder's own."""
        for name in names:
            path = self.path / name
            if path.exists() and self.owned.get(name) != _digest(path):
                raise OutputError(
                    f"{path} was not written by a reproduction, or was changed since: move it away, or choose another --out"
                )

    def write(self, name: str, fill: Callable[[Path], object]) -> Path:
        """Write one file, complete or not at all, and own it."""
        self.check([name])
        path = replace_file(self.path / name, fill, force=True)
        self.owned[name] = _digest(path)
        text = json.dumps({"written_by": "whirlmap reproduce", "files": self.owned}, indent=1)
        replace_file(self.path / MANIFEST, lambda trial: trial.write_text(text, encoding="utf-8"), force=True)
        return path


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
