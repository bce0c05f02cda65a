"""The report of a reproduction: one HTML file with everything in it, no network."""

import base64
import json
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, StrictUndefined

from whirlmap.assumptions.violations import violations
from whirlmap.studies.gear_psfd.claims.claims import claims
from whirlmap.studies.gear_psfd.reproduction.edition_data import EditionData
from whirlmap.studies.gear_psfd.reproduction.verdicts import ClaimVerdict

HERE = files("whirlmap.studies.gear_psfd")

#: What the missing parameters mean for a verdict, said in the report for each word.
MEANING = {
    "holds": "the statement comes out with the assumed parameters; the paper's own are unknown, so this does not show"
    " that its computation was right",
    "fails": "the statement does not come out with the assumed parameters; it may for others, which the paper does not give",
    "partly": "a part of the statement comes out with the assumed parameters",
    "cannot be evaluated": "with the assumed parameters the motion is not of the kind that the statement is about",
}


@dataclass(frozen=True)
class Picture:
    """A picture on disk, its caption and its edition."""

    path: Path
    caption: str
    edition: str

    @property
    def data(self) -> str:
        """The picture as text for an HTML page."""
        return base64.b64encode(self.path.read_bytes()).decode()


def write_report(
    path: Path, done: Sequence[tuple[EditionData, list[ClaimVerdict]]], pictures: Sequence[Picture], *, quality: str
) -> None:
    """Write the report of the editions computed so far."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(HERE.joinpath("report.html").read_text(encoding="utf-8"))
    path.write_text(
        template.render(
            claims=claims(),
            editions=[e.edition for e, _ in done],
            verdicts={
                claim.id: {e.edition.name: v for e, judged in done for v in judged if v.claim.id == claim.id}
                for claim in claims()
            },
            meaning=MEANING,
            equations=_equations(),
            parameters=[(e.edition.name, _parameters(e)) for e, _ in done],
            violations=[(e.edition.name, violations(e.system, e.diagrams.values())) for e, _ in done],
            provenance=[(e.edition.name, _provenance(e)) for e, _ in done],
            pictures=pictures,
            quality=quality,
            identified=_identified(),
            amounts=[(e.edition.name, _amount(e)) for e, _ in done],
        ),
        encoding="utf-8",
    )


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
