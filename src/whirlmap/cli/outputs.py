"""Where a command's results go: refused before anything is computed, written complete or not at all."""

from collections.abc import Callable
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
        """Write the Dataset, the picture or both; returns the files written."""
        if self.places is None:
            return []
        from whirlmap.results.files import check_writable, write
        from whirlmap.results.findings import Findings

        dataset = found.dataset() if isinstance(found, Findings) else found
        written = []
        if self.places.folder is not None:
            self.places.folder.mkdir(exist_ok=True)
        if self.places.dataset is not None:
            written.append(write(dataset, self.places.dataset, force=self.force))
        if self.places.picture is not None:
            from whirlmap.plot.save import save

            check_writable(self.places.picture, force=self.force)
            written.append(save(draw(dataset), self.places.picture))
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
