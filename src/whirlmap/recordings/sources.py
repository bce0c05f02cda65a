"""Sources of bytes: files, standard input, compressed files; and the encoding of their text."""

import bz2
import gzip
import io
import lzma
import sys
import zipfile
import zlib
from pathlib import Path
from typing import IO, Any

from whirlmap.errors import InputError

#: Bytes by which format and encoding are told.
HEAD = 1 << 19
_MARKS = (
    (b"\xef\xbb\xbf", "utf-8-sig"),
    (b"\xff\xfe\x00\x00", "utf-32"),
    (b"\x00\x00\xfe\xff", "utf-32"),
    (b"\xff\xfe", "utf-16"),
    (b"\xfe\xff", "utf-16"),
)


class _Joined(io.RawIOBase):
    """The head that was read already, then the rest."""

    def __init__(self, head: bytes, *streams: IO[bytes]) -> None:
        self._head, self._rest, self._streams = memoryview(head), streams[-1], streams

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        part = self._head[: len(buffer)] if self._head else self._rest.read(len(buffer)) or b""
        self._head = self._head[len(part) :] if self._head else self._head
        buffer[: len(part)] = part
        return len(part)

    def close(self) -> None:
        for stream in reversed(self._streams):
            if stream is not sys.stdin.buffer:
                stream.close()
        super().close()


def open_bytes(path: str | Path) -> tuple[bytes, io.BufferedReader, str]:
    """First bytes of a file or of standard input (``-``), unpacked; a stream of all its bytes; its name.

    Raises
    ------
    InputError
        It cannot be read, or is an archive of several files.
    """
    name = "standard input" if str(path) == "-" else str(path)
    streams: list[IO[bytes]] = []
    try:
        streams.append(sys.stdin.buffer if str(path) == "-" else Path(path).open("rb"))  # noqa: SIM115 (closed with the stream that is returned)
        head = streams[0].read(HEAD)
        for magic, module in ((b"\x1f\x8b", gzip), (b"BZh", bz2), (b"\xfd7zXZ", lzma)):
            if head.startswith(magic):
                streams.append(module.open(io.BufferedReader(_Joined(head, *streams))))
                head = streams[-1].read(HEAD)
        if head.startswith(b"PK\x03\x04") and str(path) != "-" and zipfile.is_zipfile(path):
            archive = zipfile.ZipFile(path)
            members = [m for m in archive.namelist() if not m.endswith("/")]
            if len(members) == 1 and not members[0].endswith(".npy"):
                streams.append(archive.open(members[0]))
                head = streams[-1].read(HEAD)
            else:
                archive.close()
    except (OSError, EOFError, lzma.LZMAError, zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError) as error:
        _Joined(b"", *streams).close() if streams else None
        if len(streams) > 1 or not isinstance(error, OSError):
            raise InputError(f"{name}: found a damaged or locked compressed file ({error})") from None
        raise InputError(f"{name}: cannot be read ({error.strerror or error})") from None
    return head, io.BufferedReader(_Joined(head, *streams), 1 << 20), name


def open_text(head: bytes, stream: IO[bytes], name: str) -> io.TextIOWrapper:
    """Text of a stream, in the encoding that its first bytes show.

    Raises
    ------
    InputError
        The bytes are no text.
    """
    encoding = _encoding(head)
    text = head.decode(encoding, errors="replace")[:20_000]
    strange = sum((c < " " and c not in "\t\r\n\x0c\x1a") or c == "\x7f" for c in text)
    if strange > 0.01 * len(text) or (
        encoding.startswith("utf-16") and text and not any(c.isascii() and c.isprintable() for c in text)
    ):
        raise InputError(
            f"{name}: found bytes that are no text and no format that is known (CSV and other text, .wav, "
            ".mat, .npy,"
            " .npz, .parquet, .nc, .tdms, .uff), expected one of these"
        )
    return io.TextIOWrapper(stream, encoding=encoding, errors="replace", newline=None)


def _encoding(head: bytes) -> str:
    for mark, encoding in _MARKS:
        if head.startswith(mark):
            return encoding
    zeros = head[:4000].count(0)
    if zeros > 0.3 * len(head[:4000]):
        return "utf-16-le" if head[1:4000:2].count(0) > head[0:4000:2].count(0) else "utf-16-be"
    try:
        head[: head.rfind(b"\n") + 1 or len(head)].decode("utf-8")
    except UnicodeDecodeError:
        return "latin-1"
    return "utf-8"
