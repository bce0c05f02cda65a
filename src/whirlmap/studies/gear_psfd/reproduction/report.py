"""The report of a reproduction: one HTML file with everything in it, no network.

Its page is in ``report_page``. Figures come first, with the number of each claim under them, then the verdicts, then what
they rest on. The diagrams of Figures 2 to 5 are pages of the explorer: the page itself stands in the report once, and the
content of each diagram where it belongs; ``report.js`` puts them together when a diagram comes into view.
"""

import base64
import json
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib.resources import files
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FunctionLoader, StrictUndefined
from matplotlib import image

from whirlmap.assumptions.violations import violations
from whirlmap.explorer.saved.saved_page import CONTENT, empty_page
from whirlmap.studies.gear_psfd.claims.claims import WORDS, Claim, claims
from whirlmap.studies.gear_psfd.claims.labelled import ORBITS, S_ORBIT
from whirlmap.studies.gear_psfd.reproduction.edition_data import EditionData
from whirlmap.studies.gear_psfd.reproduction.figures import DIAGRAM_NUMBER
from whirlmap.studies.gear_psfd.reproduction.live_diagrams import LiveDiagram
from whirlmap.studies.gear_psfd.reproduction.verdicts import ClaimVerdict

HERE = files("whirlmap.studies.gear_psfd")

#: What the missing parameters mean for a verdict, said in the report for each word.
MEANING = {
    "holds": "the statement comes out with the assumed parameters; the paper's own are unknown, so this does not show"
    " that its computation was right",
    "partly": "a part of the statement comes out with the assumed parameters",
    "fails": "the statement does not come out with the assumed parameters; it may for others, which the paper does not give",
    "cannot be evaluated": "with the assumed parameters the motion is not of the kind that the statement is about",
}
#: Sign and class of each verdict in the page: shapes that differ without their colours.
SIGNS = {"holds": ("✓", "holds"), "partly": ("◐", "partly"), "fails": ("✗", "fails"), "cannot be evaluated": ("?", "cannot")}
#: Bodies whose heights are the paper's coordinates in Figures 6 and 7.
BODIES = {"yp": "pinion", "y2": "bearing 2"}


@dataclass(frozen=True)
class Picture:
    """A picture on disk, the number of its figure, and its caption."""

    path: Path
    figure: int
    caption: str

    @cached_property
    def data(self) -> str:
        """The same pixels as WebP in base64, for the page: less than half of the bytes of the PNG."""
        pixels, kept = np.rint(image.imread(self.path) * 255).astype(np.uint8), BytesIO()
        image.imsave(kept, pixels, format="webp", pil_kwargs={"lossless": True, "method": 2})
        return base64.b64encode(kept.getvalue()).decode()


@dataclass(frozen=True)
class Finished:
    """All of one edition that the report shows."""

    evidence: EditionData
    verdicts: Sequence[ClaimVerdict]
    pictures: Sequence[Picture]
    diagrams: Sequence[LiveDiagram]

    @property
    def name(self) -> str:
        """Name of the edition."""
        return self.evidence.edition.name

    def verdict(self, claim: Claim) -> ClaimVerdict:
        """The verdict on a claim."""
        return next(v for v in self.verdicts if v.claim.id == claim.id)

    def with_word(self, word: str) -> list[ClaimVerdict]:
        """Verdicts of one word."""
        return [v for v in self.verdicts if v.word == word]

    def pictures_of(self, figure: int) -> list[Picture]:
        """Pictures of a figure of the paper."""
        return [p for p in self.pictures if p.figure == figure]

    def diagram_of(self, figure: int) -> LiveDiagram | None:
        """The diagram of a figure of the paper, if it is one."""
        return next((d for d in self.diagrams if d.figure == figure), None)


@dataclass(frozen=True)
class Figure:
    """A figure of the paper, or what several of them show together, and the claims about it."""

    number: int | None
    title: str
    claims: Sequence[Claim]


def write_report(path: Path, done: Sequence[Finished], *, quality: str) -> None:
    """Write the report of the editions computed so far."""
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, loader=FunctionLoader(_part)
    )
    page = environment.get_template("report.html").render(
        claims=claims(),
        editions=done,
        figures=figures(),
        first=first_shown(done),
        words=[word for word in MEANING if word in WORDS],
        signs=SIGNS,
        meaning=MEANING,
        s_orbit=S_ORBIT,
        equations=_equations(),
        parameters=[(one.name, _parameters(one.evidence)) for one in done],
        violations=[(one.name, violations(one.evidence.system, one.evidence.diagrams.values())) for one in done],
        provenance=[(one.name, _provenance(one.evidence)) for one in done],
        quality=quality,
        identified=_identified(),
        amounts=[(one.name, _amount(one.evidence)) for one in done],
        explorer_page=empty_page(embedded=True),
        explorer_content=CONTENT,
        style=_part("report.css"),
        script=_part("report.js"),
    )
    path.write_text(page, encoding="utf-8")


def figures() -> list[Figure]:
    """The figures in their order; what Figures 2 to 5 show together stands after them."""

    def about(number: int) -> list[Claim]:
        return [c for c in claims() if number in c.figures]

    diagrams = [Figure(n, f"motion against the speed, ψ = {psi:g}", about(n)) for psi, n in DIAGRAM_NUMBER.items()]
    together = Figure(None, "Figures 2 to 5 together", [c for c in claims() if not c.figures])
    orbits = [Figure(n, f"motion of the {BODIES[y]} at s = {S_ORBIT}", about(n)) for y, n in ORBITS.items()]
    return [*diagrams, together, *orbits]


def first_shown(done: Sequence[Finished]) -> str:
    """The edition whose figures are shown first: the one with most claims that hold, then with most that hold partly."""
    return max(done, key=lambda one: (len(one.with_word("holds")), len(one.with_word("partly")))).name


def _part(name: str) -> str:
    return HERE.joinpath("report_page", name).read_text(encoding="utf-8")


def _identified() -> dict[str, Any] | None:
    """What a search over the unpublished parameters found (`whirlmap identify`); None where none is kept."""
    kept = HERE.joinpath("identified.json")
    return dict(json.loads(kept.read_text(encoding="utf-8"))) if kept.is_file() else None


def _equations() -> list[dict[str, Any]]:
    return list(tomllib.loads(HERE.joinpath("equations.toml").read_text(encoding="utf-8"))["equation"])


def _parameters(e: EditionData) -> list[dict[str, str]]:
    entries = json.loads(e.diagrams[0.0].attrs["parameters"])
    return [{"name": name, **{key: str(p[key]) for key in ("value", "unit", "source")}} for name, p in entries.items()]


def _provenance(e: EditionData) -> dict[str, Any]:
    attributes = e.diagrams[0.0].attrs
    kept = (
        "whirlmap_version", "model", "model_hash", "case", "case_hash", "switches", "method", "steps_per_period",
        "tolerance", "transient", "common_multiple", "command", "date", "python_version", "numpy_version",
        "llvmlite_version", "platform", "citations",
    )  # fmt: skip
    return {key: attributes[key] for key in kept if key in attributes}


def _amount(e: EditionData) -> str:
    q, ds = e.quality, e.diagrams[0.0]
    return (
        f"{ds.sizes['s']} speeds for each permeability, {q.settling.transient} common periods of transient, returns sought"
        f" up to {q.settling.most} common periods; at s = 3.27 {q.points} section points for the dimension, where the motion"
        " does not return"
    )
