"""Writing of results: paths, permission to overwrite, and atomic files.

A file appears under its name only when it is complete: it is written under another name in the same folder and then
renamed. What exists is replaced only with ``force``, and that is checked before anything is computed.
"""

import errno
import os
import shutil
import tempfile
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from whirlmap.errors import OutputError, nearest

if TYPE_CHECKING:
    import xarray as xr

DATASETS = (".nc",)
PICTURES = (".png", ".svg", ".pdf")
ANIMATIONS = (".gif",)
TEXTS = (".md", ".json", ".toml", ".csv")
#: Files that this process has written, for whoever must say what there is when it is interrupted.
WRITTEN: list[Path] = []
#: Temporary files that are being written, for whoever ends this process at once.
UNFINISHED: set[Path] = set()


#: What the operating system says when nothing can be written, whatever it is.
DISK = {errno.ENOSPC: "the disk is full", errno.EDQUOT: "the quota is used up", errno.EROFS: "the disk is read-only",
        errno.EACCES: "writing is not allowed", errno.EPERM: "writing is not allowed"}  # fmt: skip
#: Bytes: a disk with less than this is full; file systems keep a little that no file gets.
FULL = 65536


class DiskFullError(OutputError):
    """There is no room for a result; what was computed may still be written elsewhere."""


def reason(error: OSError) -> str:
    """Reason for which the operating system refused to write, as words."""
    return DISK.get(error.errno or 0, error.strerror or str(error))


@dataclass(frozen=True)
class Places:
    """Where the outputs of a command go: None where that kind was not asked for."""

    dataset: Path | None = None
    picture: Path | None = None
    folder: Path | None = None


def places(out: str | Path, name: str) -> Places:
    """Read what ``--out`` asks for.

    Parameters
    ----------
    out : str or Path
        ``NAME.nc`` for the Dataset, ``NAME.png``, ``.svg`` or ``.pdf`` for the picture, a folder for both.
    name : str
        Name, without suffix, of the files in a folder.

    Raises
    ------
    OutputError
        For any other suffix.
    """
    path = Path(out).expanduser()
    suffix = path.suffix.lower()
    if suffix in DATASETS:
        return Places(dataset=path)
    if suffix in PICTURES:
        return Places(picture=path)
    if suffix and not path.is_dir():
        known = (*DATASETS, *PICTURES)
        raise OutputError(
            f"{path}: found the suffix {path.suffix!r}, expected one of {' '.join(known)}, or a folder's name"
            f" without suffix.{nearest(suffix, known)}"
        )
    return Places(dataset=path / f"{name}.nc", picture=path / f"{name}.png", folder=path)


def check_writable(path: str | Path, *, force: bool = False, as_file: bool | None = None) -> None:
    """Refuse a place that cannot be written, or must not be overwritten; nothing is created that stays.

    Commands call this before they compute anything.

    Parameters
    ----------
    path : str or Path
        A file, or a folder that is to be made. Its parent must exist. An empty folder counts as new.
    force : bool
        What exists may be replaced.
    as_file : bool, optional
        Whether it is to be a file; where absent its suffix says so.

    Raises
    ------
    OutputError
        The parent is missing or is no folder; something exists and ``force`` is false; the folder refuses a
        file.
    """
    path = Path(path)
    parent = path.parent
    if not parent.is_dir():
        fault = "is not a folder" if parent.exists() else "does not exist"
        raise OutputError(f"{path}: the folder {parent} {fault}; make it first")
    if as_file is None:
        as_file = path.suffix.lower() in (*DATASETS, *PICTURES, *ANIMATIONS, *TEXTS)
    if as_file and path.is_dir():
        raise OutputError(f"{path}: found a folder, expected a file or nothing")
    if not as_file and path.exists() and not path.is_dir():
        raise OutputError(f"{path}: found a file, expected a folder or nothing")
    if not force and os.path.lexists(path) and (as_file or any(path.iterdir())):
        raise OutputError(f"{path}: exists already; use --force (force=True) to replace it, or another name")
    folder = path if path.is_dir() else parent
    try:  # permissions, read-only mounts and full disks answer only to an attempt
        handle, trial = tempfile.mkstemp(dir=folder, prefix=".whirlmap-")
        os.close(handle)
        Path(trial).unlink()
    except OSError as error:
        raise _fault(error)(f"{path}: the folder {folder} cannot be written ({reason(error)})") from None


def write(dataset: "xr.Dataset", path: str | Path, *, force: bool = False) -> Path:
    """Write a Dataset as NetCDF (netCDF4), complete or not at all.

    Raises
    ------
    OutputError
        As `replace_file`; or a suffix other than ``.nc``.
    """
    path = Path(path)
    if path.suffix.lower() not in DATASETS:
        raise OutputError(f"{path}: found the suffix {path.suffix!r}, expected .nc for a Dataset")

    def fill(trial: Path) -> None:
        try:
            dataset.to_netcdf(trial, engine="netcdf4", format="NETCDF4")
        except RuntimeError as error:  # the library hides what the operating system said
            raise OSError(errno.ENOSPC if _full(trial.parent) else errno.EIO, f"{error}") from error

    return replace_file(path, fill, force=force)


def replace_file(path: Path, fill: Callable[[Path], object], *, force: bool = False) -> Path:
    """Have ``fill(temporary path)`` write a file, and give it its name when it is complete.

    The temporary file lies in the same folder, keeps the suffix, and is removed whatever happens.

    Raises
    ------
    OutputError
        As `check_writable`, or the disk refuses; `DiskFullError` where it has no room.
    """
    check_writable(path, force=force, as_file=True)
    try:
        write_beside(path, fill, _replace if force else _claim)
    except OSError as error:
        raise _fault(error)(f"{path}: cannot be written ({reason(error)})") from error
    WRITTEN.append(path)
    return path


def _replace(trial: Path, path: Path) -> None:
    trial.replace(path)


def write_beside(
    path: Path, fill: Callable[[Path], object], place: Callable[[Path, Path], object] = _replace, trial: Path | None = None
) -> None:
    """Have ``fill(trial)`` write a file or a folder beside its place, then ``place(trial, path)`` give it its name.

    Whatever whirlmap writes appears so, whole or not at all. Where ``trial`` is absent its name is that of this process and
    thread, for several may write the same file, with the suffix of ``path``. What is left under it is removed whatever
    happens; what the operating system says is for the caller to answer.
    """
    trial = trial or path.with_name(f".{path.stem}.{os.getpid()}.{threading.get_ident()}.part{path.suffix}")
    UNFINISHED.add(trial)
    try:
        fill(trial)
        place(trial, path)
    finally:
        drop(trial)
        UNFINISHED.discard(trial)


def drop(path: Path) -> None:
    """Remove a file or a folder, where there is one."""
    if path.is_dir():
        shutil.rmtree(path, ignore_errors=True)
    else:
        with suppress(OSError):
            path.unlink(missing_ok=True)


def _fault(error: OSError) -> type[OutputError]:
    return DiskFullError if error.errno in (errno.ENOSPC, errno.EDQUOT) else OutputError


def _full(folder: Path) -> bool:
    return shutil.disk_usage(folder).free < FULL


def _device(folder: Path) -> int:
    return folder.stat().st_dev


def elsewhere(fill: Callable[[Path], object], name: str, full: Path) -> Path | None:
    """Write a file where there is room for it: the first of the folder for passing files, the home and the present folder.

    Parameters
    ----------
    fill : callable
        ``fill(path)`` writes the file, in a new folder.
    name : str
    full : Path
        A folder on the disk that has no room.

    Returns
    -------
    Path or None
        The file; None where no other disk takes it.
    """
    for where in (tempfile.gettempdir, Path.home, Path.cwd):  # each may find nothing
        made = None
        try:
            folder = Path(where())
            if _device(folder) == _device(full):
                continue
            made = Path(tempfile.mkdtemp(prefix="whirlmap-", dir=folder))
            fill(made / name)
        except (OSError, RuntimeError, OutputError):
            if made:
                shutil.rmtree(made, ignore_errors=True)
            continue
        return made / name
    return None


def _claim(trial: Path, path: Path) -> None:
    """Name a file, unless the name was taken while it was computed."""
    try:
        os.link(trial, path)
    except OSError:  # the name is taken, or the file system has no hard links
        if os.path.lexists(path):
            raise OutputError(
                f"{path}: appeared while this was computed; use --force to replace it"
            ) from None
        trial.replace(path)


def read(path: str | Path) -> "xr.Dataset":
    """Read a Dataset into memory and close its file.

    Raises
    ------
    OutputError
        Where there is no such file, or it is not NetCDF.
    """
    import xarray as xr

    path = Path(path)
    if not path.is_file():
        raise OutputError(f"{path}: no such file")
    try:
        return xr.load_dataset(path, engine="netcdf4")
    except (OSError, ValueError) as error:
        raise OutputError(f"{path}: cannot be read as NetCDF ({error})") from error
