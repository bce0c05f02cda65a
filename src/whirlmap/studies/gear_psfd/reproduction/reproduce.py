"""The paper, reproduced and judged: figures, data and a report that opens from disk."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from whirlmap.errors import RangeError
from whirlmap.integrate.division import cores
from whirlmap.results.files import write
from whirlmap.studies.gear_psfd.claims.labelled import ORBITS, PSI
from whirlmap.studies.gear_psfd.reproduction.edition_data import (
    EDITIONS,
    Edition,
    edition_of,
    gather,
    quality_named,
)
from whirlmap.studies.gear_psfd.reproduction.figures import DIAGRAM_NUMBER, Studio, plans
from whirlmap.studies.gear_psfd.reproduction.live_diagrams import live_diagrams
from whirlmap.studies.gear_psfd.reproduction.output import Folder
from whirlmap.studies.gear_psfd.reproduction.report import Finished, Picture, write_report
from whirlmap.studies.gear_psfd.reproduction.verdicts import judge

REPORT = "report.html"


def reproduce(
    out: Path,
    *,
    quality: str = "quick",
    cases: Sequence[str] | None = None,
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> dict[str, Any]:
    """Compute Figures 2 to 7 for every edition, judge every claim, and write all of it to a folder.

    Data are written as they are finished, figures and report after every edition, so that an interrupted reproduction leaves
    what was done, readable.

    Parameters
    ----------
    out : Path
        Folder; made where it does not exist. Files that an earlier reproduction wrote are replaced, others never.
    quality : {"quick", "full"}
        How much is computed (`edition_data.QUALITIES`).
    cases : sequence of str, optional
        Cases of the gear pair, instead of the three editions.

    Returns
    -------
    dict
        ``report`` (path), ``figures`` (paths), ``verdicts`` {edition: {claim id: {verdict, number, found}}}.

    Raises
    ------
    RangeError
        Where the quality is unknown, or two cases have one name.
    CaseError
        Where a case is unknown or not one of the gear pair.
    OutputError
        Where the folder cannot be written, or holds a file of that name that is not its own.
    """
    level = quality_named(quality)
    editions = EDITIONS if cases is None else tuple(edition_of(case) for case in cases)
    names = [edition.name for edition in editions]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise RangeError(f"several cases are called {', '.join(twice)}, and their files would be, too: rename the cases")
    folder = Folder(Path(out))
    folder.check(file_names(editions))
    done: list[Finished] = []
    with Studio(workers or cores()) as studio:
        for edition in editions:

            def keep(kind: str, psi: float, ds: xr.Dataset, name: str = edition.name) -> None:
                folder.write(f"{kind}-{name}-psi{psi:g}.nc", lambda trial: write(ds, trial))

            evidence = gather(edition, level, workers=workers, progress=progress, keep=keep)
            pictures: list[Picture] = []
            for plan, png in studio.draw(plans(evidence)):
                path = folder.write(f"{plan.stem}.png", lambda trial, png=png: trial.write_bytes(png))  # type: ignore[misc]
                pictures.append(Picture(path, plan.figure, plan.caption))
            done.append(Finished(evidence, judge(evidence), pictures, live_diagrams(evidence)))
            folder.write(REPORT, lambda trial: write_report(trial, done, quality=quality))
    return {
        "report": folder.path / REPORT,
        "figures": [p.path for one in done for p in one.pictures],
        "verdicts": {
            one.name: {
                v.claim.id: {"verdict": v.word, "number": v.measured.number, "found": v.found} for v in one.verdicts
            }
            for one in done
        },
    }


def file_names(editions: Sequence[Edition] = EDITIONS) -> list[str]:
    """Every file that a reproduction writes, but for its manifest."""
    names = [REPORT]
    for edition in editions:
        for psi in PSI:
            names += [f"{kind}-{edition.name}-psi{psi:g}.nc" for kind in ("diagram", "orbit")]
            names.append(f"fig{DIAGRAM_NUMBER[psi]}-{edition.name}.png")
            names += [f"fig{number}-{edition.name}-psi{psi:g}.png" for number in ORBITS.values()]
    return names
