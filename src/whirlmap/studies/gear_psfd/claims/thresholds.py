"""Numbers from which a statement of the paper counts as met, and the windows of speed that it names."""

import math

from whirlmap.studies.gear_psfd.claims.labelled import Labelled, Mask

#: "Almost all", and the least share at which a claim is met in part.
ALMOST_ALL, PARTLY = 0.9, 0.5
#: Lines above the floor, and share of power beside them, from which a spectrum has "numerous excitation frequencies".
MANY_LINES, BROADBAND = 10, 0.01
#: Least number of speeds that a comparison of amplitudes needs.
LEAST_SPEEDS = 8
#: Rank correlations from which the amplitude grows with the speed: in part, and as the paper says.
GROWS = (0.3, 0.8)
#: Ratios of amplitudes from which one is larger, and below which one is smaller.
LARGER, SMALLER = 1.2, 0.95
#: Standard errors within which a dimension is the paper's.
DIMENSION_ERRORS = 2
#: Windows of speeds of Figure 3: permeability, first and last speed, kind of motion.
WINDOWS: dict[str, tuple[float, float, float, str]] = {
    "fig3-low-8T": (1e-4, 0.0, 1.1799, "with the forcing"),
    "fig3-chaos-window": (1e-4, 1.18, 1.60, "chaotic"),
    "fig3-mid-8T": (1e-4, 1.61, 3.10, "with the forcing"),
    "fig3-high-chaos": (1e-4, 3.11, math.inf, "chaotic"),
}
#: Permeabilities of the figures that have three windows each (`windows_of`).
THREE_WINDOWS = {"fig4-windows": 1e-3, "fig5-windows": 0.1}


def chaotic_windows(d: Labelled) -> tuple[Mask, Mask]:
    """Speeds of 1.48 .. 1.60, and of the rest of the chaotic window of Figure 3."""
    return d.between(1.48, 1.60), d.between(1.18, 1.475)


def windows_of(d: Labelled) -> tuple[tuple[str, Mask], ...]:
    """Kinds and speeds of the three windows of Figures 4 and 5."""
    low, high = d.between(1.60, 1.62), d.s > 3.15
    return ("chaotic", low), ("chaotic", high), ("with the forcing", ~(low | high))
