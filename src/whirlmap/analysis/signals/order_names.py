"""Spectral lines as orders of a shaft: multiples, fractions, tooth mesh and its sidebands."""

from fractions import Fraction

#: Share of a frequency by which a line may lie beside an order: speeds are known to three digits.
BESIDE = 2e-3
#: Sidebands on either side of a mesh line, and largest denominator of a fraction of the shaft's speed.
SIDEBANDS, PARTS = 6, 4


def order_name(frequency: float, turns: float, teeth: int | None, step: float) -> str:
    """Name of a line: ``1x``, ``3x``, ``1/2x``, ``mesh``, ``2 mesh - 3x``; nothing where no order fits.

    Parameters
    ----------
    frequency, turns : float
        Of the line and of the shaft, in the same unit.
    teeth : int, optional
        Of the gear on that shaft.
    step : float
        Frequency step of the spectrum.

    Notes
    -----
    A line may lie half a step beside an order, or 0.2 % of its frequency. Where neighbouring orders would both fit, none is
    named.
    """
    tolerance = max(step / 2, BESIDE * frequency)
    if turns <= 2 * tolerance:
        return ""
    whole = round(frequency / turns)
    if whole >= 1 and abs(frequency - whole * turns) <= tolerance:
        if teeth:
            meshes = round(whole / teeth)
            aside = whole - meshes * teeth
            if meshes >= 1 and abs(aside) <= min(SIDEBANDS, (teeth - 1) // 2):
                mesh = "mesh" if meshes == 1 else f"{meshes} mesh"
                return mesh if not aside else f"{mesh} {'+' if aside > 0 else '-'} {abs(aside)}x"
        return f"{whole}x"
    for q in range(2, PARTS + 1):
        p = round(frequency / turns * q)
        if p >= 1 and abs(frequency - p * turns / q) <= tolerance < turns / (2 * q):
            return f"{Fraction(p, q)}x"
    return ""
