"""Viscosity of a mineral oil at its temperature, from its ISO VG grade or two given viscosities.

Walther's equation, ASTM D341: log10 log10(nu + 0.7) = A - B log10 T, nu in mm2/s, T in kelvin, through two points, 40 and
100 degrees. An ISO VG grade (ISO 3448) is the viscosity at 40 degrees, good to 10 %; the one at 100 degrees follows from
the viscosity index, ASTM D2270. Pressure and shear do not count.
"""

from math import log10

import numpy as np

from whirlmap.errors import CaseError

KELVIN = 273.15
LOW, HIGH = 40.0, 100.0
#: Temperatures [degC] for which the charts of ASTM D341 are drawn straight.
COLDEST, HOTTEST = -70.0, 340.0

#: Grades of ISO 3448 [mm2/s].
ISO_VG = (2, 3, 5, 7, 10, 15, 22, 32, 46, 68, 100, 150, 220, 320, 460, 680, 1000, 1500, 2200, 3200)

# ASTM D2270: L = a Y^2 + b Y + c and H = d Y^2 + e Y + f of the viscosity Y at 100 degrees, from Y on.
_TABLE = np.array([
    (2.0, 1.14673, 1.7576, -0.109, 0.84155, 1.5521, -0.077),
    (3.8, 3.38095, -15.4952, 33.196, 0.78571, 1.7929, -0.183),
    (4.4, 2.5000, -7.2143, 13.812, 0.82143, 1.5679, 0.119),
    (5.0, 0.10100, 16.6350, -45.469, 0.04985, 9.1613, -18.557),
    (6.4, 3.35714, -23.5643, 78.466, 0.22619, 7.7369, -16.656),
    (7.0, 0.01191, 21.4750, -72.870, 0.79762, -0.7321, 14.610),
    (7.7, 0.41858, 16.1558, -56.040, 0.05794, 10.5156, -28.240),
    (9.0, 0.88779, 7.5527, -16.600, 0.26665, 6.7015, -10.810),
    (12.0, 0.76720, 10.7972, -38.180, 0.20073, 8.4658, -22.490),
    (15.0, 0.97305, 5.3135, -2.200, 0.28889, 5.9741, -4.930),
    (18.0, 0.97256, 5.2500, -0.980, 0.24504, 7.4160, -16.730),
    (22.0, 0.91413, 7.4759, -21.820, 0.20323, 9.1267, -34.230),
    (28.0, 0.87031, 9.7157, -50.770, 0.18411, 10.1015, -46.750),
    (40.0, 0.84703, 12.6752, -133.310, 0.17029, 11.4866, -80.620),
    (55.0, 0.85921, 11.1009, -83.190, 0.17130, 11.3680, -76.940),
    (70.0, 0.83531, 14.6731, -216.246, 0.16841, 11.8493, -96.947),
])  # fmt: skip


def walther(nu_40: float, nu_100: float, temperature: float) -> float:
    """Kinematic viscosity [mm2/s] at a temperature [degC], from those at 40 and 100 degC.

    Raises
    ------
    CaseError
        Where the oil does not get thinner as it warms, or is too thin for the equation (0.7 of ASTM D341 needs about 2);
        for a temperature outside of `COLDEST` to `HOTTEST`.
    """
    if not COLDEST <= temperature <= HOTTEST:
        raise CaseError(
            f"found an oil at {temperature:g} degC, expected {COLDEST:g} to {HOTTEST:g} (Walther's equation, ASTM D341)"
        )
    if not nu_40 > nu_100:
        raise CaseError(f"found {nu_40:g} mm^2/s at 40 degC and {nu_100:g} at 100 degC, expected less at 100 degC")
    if nu_100 < 2.0:
        raise CaseError(f"found {nu_100:g} mm^2/s at 100 degC, expected at least 2 (Walther's equation, ASTM D341)")
    z = [log10(log10(nu + 0.7)) for nu in (nu_40, nu_100)]
    x = [log10(T + KELVIN) for T in (LOW, HIGH, temperature)]
    slope = (z[1] - z[0]) / (x[1] - x[0])
    return float(10 ** (10 ** (z[0] + slope * (x[2] - x[0]))) - 0.7)


def viscosity_index(nu_40: float, nu_100: float) -> float:
    """Viscosity index, ASTM D2270, not rounded."""
    _, a, b, c, d, e, f = _TABLE[np.searchsorted(_TABLE[:, 0], nu_100, side="right") - 1]
    L, H = (a * nu_100 + b) * nu_100 + c, (d * nu_100 + e) * nu_100 + f
    if nu_40 >= H:
        return float(100 * (L - nu_40) / (L - H))
    return float((10 ** (log10(H / nu_40) / log10(nu_100)) - 1) / 0.00715 + 100)


def at_100(grade: float, index: float) -> float:
    """Kinematic viscosity [mm2/s] at 100 degC of an ISO VG grade with a viscosity index: ASTM D2270 turned round.

    Raises
    ------
    CaseError
        For a number that is no grade of ISO 3448, or an index that no oil of this grade has (2 to 500 mm2/s at 100 degC).
    """
    if grade not in ISO_VG:
        near = min(ISO_VG, key=lambda g: abs(g - grade))
        raise CaseError(f"found ISO VG {grade:g}, expected a grade of ISO 3448; the nearest is {near}")
    low, high = 2.0, min(500.0, grade)
    if not viscosity_index(grade, low) < index < viscosity_index(grade, high * (1 - 1e-12)):
        raise CaseError(f"found a viscosity index of {index:g}, which an oil of ISO VG {grade:g} cannot have")
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if viscosity_index(grade, middle) < index else (low, middle)
    return (low + high) / 2


def by_grade(grade: float, index: float, temperature: float, density: float) -> float:
    """Dynamic viscosity [Pa*s] of an ISO VG grade with a viscosity index, at a temperature [degC] and density [kg/m3]."""
    return walther(float(grade), at_100(float(grade), float(index)), float(temperature)) * 1e-6 * float(density)


def by_two_points(nu_40: float, nu_100: float, temperature: float, density: float) -> float:
    """Dynamic viscosity [Pa*s] from kinematic ones [m2/s] at 40 and 100 degC, at a temperature [degC] and density."""
    return walther(float(nu_40) * 1e6, float(nu_100) * 1e6, float(temperature)) * 1e-6 * float(density)
