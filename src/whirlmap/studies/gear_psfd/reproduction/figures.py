"""Figures 2 to 7 in the paper's arrangement, for one edition."""

import signal
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from whirlmap.plot.common.diagnosis_parts import parts_of, spectrum_of
from whirlmap.plot.common.save import encode
from whirlmap.plot.figures.diagnosis_figure import paper_diagram_figure, paper_orbit_figure
from whirlmap.results.regime import Regime
from whirlmap.studies.gear_psfd.claims.labelled import ORBITS, PSI, S_ORBIT
from whirlmap.studies.gear_psfd.reproduction.edition_data import EditionData

#: Of the pictures, which the report carries inside: sharp on a screen.
DPI = 120
#: What the coordinates of Figures 2 to 5 are.
NAMES = {"yp": "pinion", "yg": "gear", "y1": "bearing 1", "y2": "bearing 2"}
#: Said of an edition whose clock is not the paper's.
SCALED = "; s counts the pinion's speed, a quarter of the paper's s"
#: Figure of the paper that shows the diagrams of each permeability.
DIAGRAM_NUMBER = dict(zip(PSI, (2, 3, 4, 5), strict=True))


@dataclass(frozen=True)
class Plan:
    """A figure before it is drawn: plain data, so that another process can draw it."""

    stem: str
    figure: int
    caption: str
    draw: Callable[..., Figure]
    arguments: tuple[Any, ...]


def plans(e: EditionData) -> Iterator[Plan]:
    """All figures of an edition."""
    name = e.edition.name
    for psi, ds in e.diagrams.items():
        number = DIAGRAM_NUMBER[psi]
        caption = (
            f"Figure {number} ({name}): pinion, gear and bearing centres against s, once per T, psi = {psi:g};"
            f" {e.edition.says}{SCALED if e.edition.scale != 1 else ''}"
        )
        yield Plan(f"fig{number}-{name}", number, caption, diagram_sheet, (ds, f"{name}, ψ = {psi:g}"))
    for coordinate, number in ORBITS.items():
        for psi, ds in e.orbits.items():
            label = Regime(int(ds["regime"])).label
            title = f"{name}, s = {S_ORBIT} of the paper, ψ = {psi:g}: {label}"
            caption = f"Figure {number} ({name}): {coordinate} at the paper's s = {S_ORBIT}, psi = {psi:g}: {label}"
            plane = e.dimensions[psi, coordinate].get("plane")
            yield Plan(f"fig{number}-{name}-psi{psi:g}", number, caption, orbit_sheet, (ds, coordinate, plane, title))


def diagram_sheet(ds: xr.Dataset, title: str) -> Figure:
    """Draw one of Figures 2 to 5."""
    return paper_diagram_figure(ds, names=NAMES, title=title)


def orbit_sheet(ds: xr.Dataset, coordinate: str, plane: xr.Dataset | None, title: str) -> Figure:
    """Draw Figure 6 or 7 for one permeability; ``plane`` is the correlation dimension of the coordinate's plane."""
    parts = parts_of(ds, coordinate)
    spectrum, lines = spectrum_of(ds, coordinate) if "x" in ds else (None, None)
    return paper_orbit_figure(
        coordinate, series=parts.series, spectrum=spectrum, lines=lines, section=parts.section,
        lyapunov=parts.lyapunov, dimension=plane, orders={k: abs(v) for k, v in parts.orders.items()},
        reasons=parts.reasons, title=title,
    )  # fmt: skip


class Studio:
    """Draws figures, in as many processes as there are workers: matplotlib takes a second for each and holds the GIL.

    The processes start when the first figure is drawn, and end with the ``with`` block. Ctrl-C is left to the process that
    started them.
    """

    def __init__(self, workers: int) -> None:
        self.pool = (
            ProcessPoolExecutor(workers, get_context("spawn"), signal.signal, (signal.SIGINT, signal.SIG_IGN))
            if workers > 1
            else None
        )

    def __enter__(self) -> "Studio":
        """Return the studio."""
        return self

    def __exit__(self, *_: object) -> None:
        """End its processes; figures that are not begun are cancelled."""
        if self.pool:
            self.pool.shutdown(cancel_futures=True)

    def draw(self, chosen: Iterable[Plan]) -> Iterator[tuple[Plan, bytes]]:
        """Draw figures; gives each with the bytes of its PNG, in order."""
        wanted = list(chosen)
        drawn = self.pool.map(picture, wanted) if self.pool else map(picture, wanted)
        yield from zip(wanted, drawn, strict=True)


def picture(plan: Plan) -> bytes:
    """Draw a figure as PNG."""
    return encode(plan.draw(*plan.arguments), "png", dpi=DPI)
