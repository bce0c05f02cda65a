"""The readings of the paper that are searched: edition, film, arc, spin of the journals in their films, and wall.

What the text leaves open: the film with or without h^3 (5); the half film fixed at 0..pi, (8) and (9), or where the pressure
is positive, which "cavitating" means; journals that spin with the clock, the 1/2 of (31) and (33), with their own shafts, or
not at all, for a squeeze-film damper does not turn; and whether anything stops a journal at its bearing, for in the printed
film nothing does. Combinations that mean nothing are in `MEANINGLESS`.
"""

from dataclasses import dataclass
from typing import Any

from whirlmap.errors import RangeError, nearest
from whirlmap.integrate.loading import load
from whirlmap.integrate.system import System

#: Spins of the journals in their films, in clock turns, by edition: the gear of the print turns with the pinion.
SPINS: dict[str, dict[str, tuple[float, float]]] = {
    "literal": {"clock": (1.0, 1.0), "shaft": (1 / 4, 1 / 8), "still": (0.0, 0.0)},
    "intended": {"clock": (1.0, 1.0), "shaft": (1 / 4, -1 / 8), "still": (0.0, 0.0)},
}

MEANINGLESS = (
    (
        "literal, porous film",
        "nobody's film: h^3 restored, and the misprints of (31) and (33), which vanish without it, left in; they push"
        " journals through a plain film, where nearly every step has to be redone",
    ),
    ("literal, positive arc", "(30)-(33) as printed are written for the half film fixed at 0..pi"),
    ("porous film, fixed arc, still", "the fixed half film follows the spin, and there is none"),
    ("printed film, any other arc", "without h^3 the film is a linear damper, the same on every half circle"),
    ("porous film, no wall", "with h^3 there is no film beyond an eccentricity of one"),
    ("printed film, no wall, still", "a damper without spin: no force but friction holds the journal, so it only sinks"),
)


@dataclass(frozen=True)
class Variant:
    """One reading of the paper.

    Attributes
    ----------
    edition, film, arc, contact : str
        Switches of the model.
    spin : str
        ``clock``: as printed, both journals turn with the clock; ``shaft``: with their shafts; ``still``: not at all.
    """

    edition: str
    film: str
    arc: str
    spin: str
    contact: str = "stop"

    @property
    def name(self) -> str:
        """Its name: ``intended-porous-positive-shaft``."""
        arc = [] if self.film == "printed" else [self.arc]
        wall = ["no-wall"] if self.contact == "ignore" else []
        return "-".join([self.edition, self.film, *arc, self.spin, *wall])

    @property
    def changes(self) -> dict[str, Any]:
        """What it changes in the reference machine on the paper's clock, but for the edition."""
        j_p, j_g = SPINS[self.edition][self.spin]
        switches = {"film": self.film, "arc": self.arc, "contact": self.contact}
        return {**switches, "j_p": j_p, "j_g": j_g}

    def system(self) -> System:
        """Load it, with the numbers of the reference machine."""
        return load("gear-psfd/reference", edition=self.edition, **self.changes)


def _printed(edition: str) -> list[Variant]:
    no_wall = [Variant(edition, "printed", "fixed", spin, "ignore") for spin in ("clock", "shaft")]
    walled = [Variant(edition, "printed", "fixed", spin) for spin in ("clock", "shaft", "still")]
    return [*no_wall, *walled]


#: All that are searched, literal first.
VARIANTS = (
    *_printed("literal"),
    *(Variant("intended", "porous", "fixed", spin) for spin in ("clock", "shaft")),
    *(Variant("intended", "porous", "positive", spin) for spin in ("clock", "shaft", "still")),
    *(Variant("intended", "printed", "fixed", spin, "ignore") for spin in ("clock", "shaft")),
)


def chosen(editions: tuple[str, ...], names: tuple[str, ...]) -> tuple[Variant, ...]:
    """Variants of some editions, or of some names; all where nothing is asked.

    Raises
    ------
    RangeError
        For an unknown edition or name.
    """
    for edition in editions:
        if edition not in SPINS:
            raise RangeError(f"edition: found {edition!r}, expected one of {', '.join(SPINS)}.{nearest(edition, SPINS)}")
    known = {v.name: v for v in VARIANTS}
    for name in names:
        if name not in known:
            raise RangeError(f"variant: found {name!r}, expected one of {', '.join(known)}.{nearest(name, known)}")
    found = tuple(v for v in VARIANTS if (not names or v.name in names) and (not editions or v.edition in editions))
    if not found:
        raise RangeError(f"no variant {' '.join(names)} belongs to the edition {' '.join(editions)}")
    return found
