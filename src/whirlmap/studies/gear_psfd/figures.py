"""Figures 2 to 7 in the paper's arrangement, for one edition."""

from collections.abc import Iterator

from matplotlib.figure import Figure

from whirlmap.plot.figures import paper_diagram_figure, paper_orbit_figure
from whirlmap.plot.parts import parts_of, spectrum_of
from whirlmap.results.regime import Regime
from whirlmap.studies.gear_psfd.evidence import ORBITS, PSI, S_ORBIT, Evidence

#: What the coordinates of Figures 2 to 5 are.
NAMES = {"yp": "pinion", "yg": "gear", "y1": "bearing 1", "y2": "bearing 2"}
#: Said of an edition whose clock is not the paper's.
SCALED = "; s counts the pinion's speed, a quarter of the paper's s"
#: Figure of the paper that shows the diagrams of each permeability.
DIAGRAM_NUMBER = dict(zip(PSI, (2, 3, 4, 5), strict=True))


def figures(e: Evidence) -> Iterator[tuple[str, str, Figure]]:
    """Draw all figures of an edition: file stem, caption, figure."""
    name = e.edition.name
    for psi, ds in e.diagrams.items():
        number = DIAGRAM_NUMBER[psi]
        caption = (
            f"Figure {number} ({name}): pinion, gear and bearing centres against s, once per T, psi = {psi:g};"
            f" {e.edition.says}{SCALED if e.edition.scale != 1 else ''}"
        )
        yield f"fig{number}-{name}", caption, paper_diagram_figure(ds, names=NAMES, title=f"{name}, ψ = {psi:g}")
    for coordinate, number in ORBITS.items():
        for psi, ds in e.orbits.items():
            parts = parts_of(ds, coordinate)
            spectrum, lines = spectrum_of(ds, coordinate) if "x" in ds else (None, None)
            label = Regime(int(ds["regime"])).label
            figure = paper_orbit_figure(
                coordinate, series=parts.series, spectrum=spectrum, lines=lines, section=parts.section,
                lyapunov=parts.lyapunov, dimension=e.dimensions[psi, coordinate].get("plane"),
                orders={k: abs(v) for k, v in parts.orders.items()}, reasons=parts.reasons,
                title=f"{name}, s = {S_ORBIT} of the paper, ψ = {psi:g}: {label}",
            )  # fmt: skip
            caption = f"Figure {number} ({name}): {coordinate} at the paper's s = {S_ORBIT}, psi = {psi:g}: {label}"
            yield f"fig{number}-{name}-psi{psi:g}", caption, figure
