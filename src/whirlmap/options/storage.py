"""Where the points of a map are kept: options that change no number."""

from dataclasses import dataclass
from pathlib import Path

from whirlmap.errors import RangeError
from whirlmap.options.refused import refuse_count


@dataclass(frozen=True)
class Storage:
    """Where the points of a map are kept, and which of them are computed now.

    Attributes
    ----------
    store : path, optional
        Folder of the Zarr store, which `xarray.open_zarr` opens; its parent exists. Where absent nothing is kept on disk.
    resume : bool
        Go on with what the store holds; begin it where it is absent, empty or half-made.
    force : bool
        Replace an existing store; with ``resume`` it has no meaning.
    share : (i, n), optional
        Work on share i of n of the chunks only, i from 1: the jobs of an array each take one, on one store.
    chunk : int, optional
        Points of a chunk; where absent such that one takes about 3 seconds.

    Raises
    ------
    RangeError
        A share or a chunk that makes no sense, or options that contradict each other.
    """

    store: str | Path | None = None
    resume: bool = False
    force: bool = False
    share: tuple[int, int] | None = None
    chunk: int | None = None

    def __post_init__(self) -> None:
        """Refuse what contradicts itself."""
        if self.share is not None:
            if not isinstance(self.share, tuple | list) or len(self.share) != 2:
                raise RangeError(f"share: found {self.share!r}, expected (i, n) with i from 1 to n")
            i, n = self.share
            for number in (i, n):
                refuse_count("share (i, n)", number, 1, 10_000_000)
            if i > n:
                raise RangeError(f"share {i}/{n}: expected i/n with i from 1 to n")
        if self.chunk is not None:
            refuse_count("chunk", self.chunk, 1, 10_000_000)
        if self.share is not None and (self.store is None or (self.force and not self.resume)):
            raise RangeError("a share works on a store that others share: give the store, and no force")
        if self.store is None and self.resume:
            raise RangeError("resume continues a store: give one")

    @property
    def goes_on(self) -> bool:
        """Whether a store that exists is gone on with."""
        return self.resume or self.share is not None


#: What holds where nothing is said: nothing is kept on disk.
STORAGE = Storage()
