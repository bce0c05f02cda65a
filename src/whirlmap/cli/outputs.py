"""Where a command's results go: refused before anything is computed, written complete or not at all."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr

    from whirlmap.results.files import Places
    from whirlmap.results.findings import Findings

#: ``draw(dataset) -> Figure``.
Draw = Callable[["xr.Dataset"], Any]


@dataclass(frozen=True)
class Destination:
    """What ``--out`` asks for, known to be writable."""

    places: "Places | None"
    force: bool

    def write(self, found: "xr.Dataset | Findings", draw: Draw) -> list[Path]:
        """Write the Dataset, the picture or both; returns the files written.

        Raises
        ------
        DiskFullError
            The disk has no room; what could be written on another is named.
        """
        if self.places is None:
            return []
        from whirlmap.results.files import write
        from whirlmap.results.findings import Findings

        dataset = found.dataset() if isinstance(found, Findings) else found
        kinds: list[tuple[Path | None, Callable[[Path], Path]]] = [
            (self.places.dataset, lambda place: write(dataset, place, force=self.force)),
            (self.places.picture, lambda place: self._picture(draw(dataset), place)),
        ]
        if self.places.folder is not None:
            self.places.folder.mkdir(exist_ok=True)
        return write_all(kinds)

    def _picture(self, figure: Any, place: Path) -> Path:
        from whirlmap.plot.save import save
        from whirlmap.results.files import check_writable

        check_writable(place, force=self.force)
        return save(figure, place)


def write_all(kinds: Sequence[tuple[Path | None, Callable[[Path], Path]]]) -> list[Path]:
    """Write files, each by its own ``fill(place)``; what a full disk refuses goes to another one.

    Raises
    ------
    DiskFullError
        Where a disk had no room, saying what was kept instead.
    """
    from whirlmap.results.files import DiskFullError, elsewhere

    written, faults = list[Path](), list[str]()
    for place, fill in kinds:
        if place is None:
            continue
        try:
            written.append(fill(place))
        except DiskFullError as error:
            other = elsewhere(fill, place.name, place.parent)
            faults.append(f"{error}; " + (f"kept instead: {other}" if other else "no other disk had room for it"))
    if faults:
        raise DiskFullError("; ".join(faults))
    return written


def claim(out: Path | None, name: str, *, force: bool) -> Destination:
    """Read ``--out`` and refuse a place that cannot be written or must not be overwritten.

    Parameters
    ----------
    name : str
        Name, without suffix, of the files in a folder.

    Raises
    ------
    OutputError
        See `whirlmap.results.files`.
    """
    if out is None:
        return Destination(None, force)
    from whirlmap.results.files import check_writable, places

    found = places(out, name)
    for place in (found.folder,) if found.folder else (found.dataset, found.picture):
        if place is not None:
            check_writable(place, force=force)
    return Destination(found, force)
