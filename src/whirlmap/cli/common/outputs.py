"""Output files of commands: checked before anything is computed, written complete or not at all."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from whirlmap.errors import CaseError, InputError
from whirlmap.results.files import DiskFullError, check_writable, elsewhere, places, write
from whirlmap.results.findings import Findings
from whirlmap.units import read

if TYPE_CHECKING:
    import xarray as xr

    from whirlmap.results.files import Places

#: ``draw(dataset) -> Figure``.
Draw = Callable[["xr.Dataset"], Any]


@dataclass(frozen=True)
class Looks:
    """What ``--size``, ``--dpi`` and ``--title`` ask for of a picture; None where they leave it as it is drawn."""

    size: tuple[float, float] | None = None
    dpi: int | None = None
    title: str | None = None

    @classmethod
    def read(cls, size: str | None, dpi: int | None, title: str | None, *, picture: str) -> "Looks":
        """Read the options; `InputError` where there is no picture, or one beyond any screen.

        ``picture`` says which option asks for one; empty where it is there.
        """
        inches = None if size is None else _inches(size)
        width, height = inches or (10.0, 10.0)
        if width * height * (dpi or 200) ** 2 > LARGEST_PICTURE:
            raise InputError(
                f"--size, --dpi: found {width:g} x {height:g} inches at {dpi or 200} dots per inch, expected at most"
                f" {LARGEST_PICTURE:.0g} dots"
            )
        given = [name for name, value in {"--size": size, "--dpi": dpi, "--title": title}.items() if value is not None]
        if given and picture:
            raise InputError(f"{given[0]}: found it without a picture, expected {picture}")
        return cls(inches, dpi, title)

    def figure(self, draw: Callable[[], Any]) -> Any:
        """Draw a figure, of the size and with the title that are asked for."""
        import matplotlib as mpl

        with mpl.rc_context({"figure.figsize": self.size} if self.size else {}):
            figure = draw()
        if self.size:
            figure.set_size_inches(self.size)  # where it is matplotlib's own default, which counts as none asked for
        if self.title is not None:
            figure.suptitle(self.title)
        return figure


#: Dots of the largest picture.
LARGEST_PICTURE = 1e8


def _inches(text: str) -> tuple[float, float]:
    """Read ``7x4.5`` [inch] or ``180x120mm``."""
    found = re.fullmatch(r"\s*([\d.]+)\s*[xX*\u00d7]\s*([\d.]+)\s*([a-z]*)\s*", text)
    try:
        sides = [float(read(f"{side} {found[3] or 'inch'}", "inch")) for side in found.groups()[:2]] if found else []
    except CaseError as error:
        raise InputError(f"--size: {error}") from None
    if not sides or not all(1 <= side <= 200 for side in sides):
        raise InputError(
            f"--size: found {text!r}, expected width x height in inches, each from 1 to 200, such as 7x4.5 or 180x120mm"
        )
    return sides[0], sides[1]


@dataclass(frozen=True)
class Destination:
    """What ``--out`` asks for, known to be writable."""

    places: "Places | None"
    force: bool
    looks: Looks = Looks()

    def write(self, found: "xr.Dataset | Findings", draw: Draw) -> list[Path]:
        """Write the Dataset, the picture or both; returns the files written.

        Raises
        ------
        DiskFullError
            The disk has no room; what could be written on another is named.
        """
        if self.places is None:
            return []

        dataset = found.dataset() if isinstance(found, Findings) else found
        kinds: list[tuple[Path | None, Callable[[Path], Path]]] = [
            (self.places.dataset, lambda place: write(dataset, place, force=self.force)),
            (self.places.picture, lambda place: self._picture(lambda: draw(dataset), place)),
        ]
        if self.places.folder is not None:
            self.places.folder.mkdir(exist_ok=True)
        return write_all(kinds)

    def _picture(self, draw: Callable[[], Any], place: Path) -> Path:
        from whirlmap.plot.common.save import save

        check_writable(place, force=self.force)
        return save(self.looks.figure(draw), place, dpi=self.looks.dpi)


def write_all(kinds: Sequence[tuple[Path | None, Callable[[Path], Path]]]) -> list[Path]:
    """Write files, each by its own ``fill(place)``; what a full disk refuses goes to another one.

    Raises
    ------
    DiskFullError
        Where a disk had no room, saying what was kept instead.
    """
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


def claim(
    out: Path | None,
    name: str,
    *,
    force: bool,
    size: str | None = None,
    dpi: int | None = None,
    title: str | None = None,
    animated: bool = False,
) -> Destination:
    """Read ``--out`` and refuse a place that cannot be written or must not be overwritten.

    Parameters
    ----------
    name : str
        Name, without suffix, of the files in a folder.
    size, dpi, title
        Of the picture, as the options give them.
    animated : bool
        Whether the command draws an animation, for which they count too.

    Raises
    ------
    InputError
        Where they are given and there is no picture.
    OutputError
        See `whirlmap.results.files`.
    """
    drawn = animated or (out is not None and out.suffix.lower() not in (".nc", ".csv"))
    looks = Looks.read(size, dpi, title, picture="" if drawn else "--out NAME.png, .svg or .pdf, or a folder")
    if out is None:
        return Destination(None, force, looks)

    found = places(out, name)
    for place in (found.folder,) if found.folder else (found.dataset, found.picture):
        if place is not None:
            check_writable(place, force=force)
    return Destination(found, force, looks)
