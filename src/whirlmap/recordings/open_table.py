"""Opening of a file of any known format as a table; the format is found by its first bytes, not by its name."""

import io
import tempfile
from collections.abc import Callable
from pathlib import Path

from whirlmap.errors import InputError
from whirlmap.recordings import array_files
from whirlmap.recordings.sources import open_bytes, open_text
from whirlmap.recordings.table import ArrayTable, Table
from whirlmap.recordings.text_table import open_text_table

#: First bytes, where they stand, and what reads them.
MAGIC: tuple[tuple[bytes, int, Callable[[Path], ArrayTable]], ...] = (
    (b"WAVE", 8, array_files.wav),
    (b"\x93NUMPY", 0, array_files.npy),
    (b"MATLAB 5.0", 0, array_files.mat),
    (b"MATLAB 7", 0, array_files.hdf),
    (b"PAR1", 0, array_files.parquet),
    (b"CDF", 0, array_files.nc),
    (b"\x89HDF", 0, array_files.nc),
    (b"TDSm", 0, array_files.tdms),
    (b"    -1", 0, array_files.uff),
)


def open_table(
    path: str | Path, *, separator: str | None = None, decimal: str | None = None, skip: int = 0, words_missing: bool = False
) -> Table:
    """Open a file as a table; nothing but its head is read.

    Parameters
    ----------
    path : path
        Text, packed or not; WAV, MATLAB, NumPy, Parquet, NetCDF, TDMS, UFF 58; ``-`` for standard input.
    separator, decimal, skip
        Of a text file, see `text_layout.find_layout`.
    words_missing : bool
        Words among the numbers of a text file are missing values, and lines of text among its rows are skipped; else both
        are refused.

    Raises
    ------
    InputError
        It cannot be read, or is no table.
    """
    for option, value, allowed in (("--separator", separator, 1), ("--decimal", decimal, 1)):
        if value is not None and value != "blank" and len(value) != allowed:
            raise InputError(
                f"{option}: found {value!r}, expected one character" + (", or blank" if option == "--separator" else "")
            )
    if decimal is not None and decimal not in ".,":
        raise InputError(f"--decimal: found {decimal!r}, expected . or ,")
    if decimal is not None and decimal == separator:
        raise InputError(f"--decimal: found {decimal!r}, which is the separator too, expected different ones")
    if skip < 0:
        raise InputError(f"--skip: found {skip}, expected a number of lines")
    if Path(path).is_dir():
        raise InputError(f"{path}: found a folder, expected a file")
    head, stream, name = open_bytes(path)
    try:
        return _opened(path, head, stream, name, separator, decimal, skip, words_missing)
    except BaseException:
        stream.close()
        raise


def _opened(
    path: str | Path,
    head: bytes,
    stream: io.BufferedReader,
    name: str,
    separator: str | None,
    decimal: str | None,
    skip: int,
    words_missing: bool,
) -> Table:
    for magic, at, read in MAGIC:
        if head[at : at + len(magic)] == magic:
            return _binary(path, head, stream, read)
    if head.startswith(b"PK\x03\x04"):
        if b"xl/" in head:
            raise InputError(f"{name}: found a workbook of a spreadsheet program, expected a table in text: save it as CSV")
        if b".npy" not in head:
            raise InputError(f"{name}: found an archive of several files, expected one file; unpack it first")
        return _binary(path, head, stream, array_files.npz)
    if head.startswith(b"\xd0\xcf\x11\xe0"):
        raise InputError(f"{name}: found a file of an office program, expected a table in text: save it as CSV")
    if str(path).lower().endswith(".mat"):
        return _binary(path, head, stream, array_files.mat)
    text = open_text(head, stream, name)
    return open_text_table(
        text, name, separator=separator, decimal=decimal, skip=skip, words_missing=words_missing
    )


def _binary(path: str | Path, head: bytes, stream: io.BufferedReader, read: Callable[[Path], ArrayTable]) -> Table:
    """Read a binary file; one that comes from a pipe or is packed goes to a temporary file first."""
    if str(path) != "-":
        with Path(path).open("rb") as plain:
            same = plain.read(16) == head[:16]
        if same:
            stream.close()
            return read(Path(path))
    with stream, tempfile.NamedTemporaryFile(suffix=Path(path).stem[-20:].replace("/", "")) as unpacked:
        while part := stream.read(1 << 20):
            unpacked.write(part)
        unpacked.flush()
        table = read(Path(unpacked.name))
        table.load()
        table.source = str(path)
        return table
