"""Figures 2 to 5 as pages of the explorer inside of the report: one chooses a speed, and sees its motion."""

from dataclasses import dataclass, field, replace

import xarray as xr

from whirlmap.explorer.exploration import Exploration, labelling_of
from whirlmap.explorer.saved.saved_page import saved_content
from whirlmap.studies.gear_psfd.claims.labelled import S_ORBIT
from whirlmap.studies.gear_psfd.reproduction.edition_data import EditionData
from whirlmap.studies.gear_psfd.reproduction.figures import DIAGRAM_NUMBER

#: Bytes of one diagram at most, about: the report holds four for each edition. And section points of each coordinate in it:
#: a page shows hardly more, and the NetCDF files hold all.
LARGEST, DOTS = 3_500_000, 8_000


@dataclass(frozen=True)
class LiveDiagram:
    """A diagram that can be clicked.

    Attributes
    ----------
    figure : int
        Of the paper.
    content : str
        What stands in an empty page of the explorer (`whirlmap.explorer.saved.saved_page.empty_page`).
    """

    figure: int
    content: str = field(repr=False)


def live_diagrams(e: EditionData) -> list[LiveDiagram]:
    """The diagrams of an edition, opened at the speed of Figures 6 and 7."""
    return [
        LiveDiagram(DIAGRAM_NUMBER[psi], saved_content(explored(e, psi, ds), largest=LARGEST))
        for psi, ds in e.diagrams.items()
    ]


def explored(e: EditionData, psi: float, ds: xr.Dataset) -> Exploration:
    """A diagram in the paper's numbers: without units, and over the paper's s."""
    kept = max(DOTS // ds.sizes["s"], 1)
    found = Exploration(
        replace(e.system.replace(psi=psi, s=S_ORBIT / e.edition.scale), machine=None),
        {"s": (ds["s"].values.tolist(), "1")}, labelling_of(ds.attrs), ds.isel(period=slice(-kept, None)),
        title=f"{e.edition.case}, psi = {psi:g}",
    )  # fmt: skip
    papers = replace(found.controls["s"], meaning="speed ratio of the paper", shown_unit="1", shown_size=e.edition.scale)
    return replace(found, instead={"s": papers})
