"""A machine file from a rotor that ROSS saved: every part in a table of its own, ready to be added to."""

import re
from collections.abc import Iterable
from pathlib import Path

from whirlmap.cases.ross_file import DIRECTIONS, RossBearing, RossRotor, read_ross
from whirlmap.errors import CaseError
from whirlmap.units import convert

#: Speed that is written where the bearings have no table [rpm].
SPEED = 3000.0


def from_ross(file: Path) -> str:
    """Write a machine file with the shaft, disks, bearings and supports of a ROSS file.

    Parameters
    ----------
    file : Path

    Returns
    -------
    str
        It loads as it is. ROSS's files hold no speed, no unbalance and no gravity: the speed is assumed, gravity is zero,
        for its bearings are linear about the loaded place.

    Raises
    ------
    CaseError
        As `read_ross`; a bearing between nodes that is no support with a mass on springs.
    """
    rotor, names = read_ross(file), _Names()
    names.of("rotor")
    nodes = len(rotor.elements)
    speed, why = _speed(rotor)
    lines = [
        f"# The rotor of {file.name}, as ROSS saved it. Unbalances, and what else it has, are to be added: docs/parts.md.",
        'model = "machine"',
        f'description = "rotor of {file.name}"',
        "[operation]",
        f'speed = {{ value = {speed:.6g}, unit = "rpm", assumed = "{why}" }}',
        'g = { value = 0, unit = "m/s^2", assumed = "coefficients of the bearings hold about the loaded place" }',
        "[[shaft]]",
        'name = "rotor"',
        "elements = [",
    ]
    for e in rotor.elements:
        hole = f', d_i = "{e.d_i!r} m"' if e.d_i else ""
        material = f'E = "{e.E!r} Pa", G = "{e.G!r} Pa", rho = "{e.rho!r} kg/m^3"'
        lines.append(f' {{ L = "{e.L!r} m", d = "{e.d!r} m"{hole}, {material} }},')
    lines.append("]")
    for disk in rotor.disks:
        lines += ["[[disk]]", f'name = "{names.of(disk.tag)}"', 'shaft = "rotor"', f"at = {disk.node}",
                  f'm = "{disk.m!r} kg"', f'I_d = "{disk.I_d!r} kg*m^2"', f'I_p = "{disk.I_p!r} kg*m^2"']  # fmt: skip
    supports: dict[int, str] = {}
    grounded = {b.node: b for b in rotor.bearings if b.link is None and b.node > nodes}
    for bearing in (b for b in rotor.bearings if b.node <= nodes):
        if bearing.link is not None and bearing.link not in supports:
            if bearing.link not in rotor.masses or bearing.link not in grounded:
                raise CaseError(
                    f"{file}: bearing {bearing.tag}: n_link: found node {bearing.link} without a point mass and a bearing to"
                    " the ground, expected both: a support has mass and stiffness"
                )
            supports[bearing.link] = names.of(f"support {grounded[bearing.link].tag}")
            lines += _support(file, supports[bearing.link], rotor.masses[bearing.link], grounded[bearing.link])
        lines += ["[[bearing]]", f'name = "{names.of(bearing.tag)}"', 'shaft = "rotor"', f"at = {bearing.node}",
                  'kind = "coefficients"', *_coefficients(file, bearing)]  # fmt: skip
        if bearing.link is not None:
            lines.append(f'support = "{supports[bearing.link]}"')
    left = [b for node, b in grounded.items() if node not in supports]
    if left:
        raise CaseError(
            f"{file}: bearing {left[0].tag}: n: found node {left[0].node}, which no bearing of the shaft links to"
        )
    return "\n".join(lines) + "\n"


class _Names:
    """Names of parts from tags: letters, digits and underscores, each once."""

    def __init__(self) -> None:
        self.taken: set[str] = set()

    def of(self, tag: str) -> str:
        """A name for a tag."""
        plain = re.sub(r"\W+", "_", tag, flags=re.ASCII).strip("_").lower() or "part"
        plain = plain if plain[0].isalpha() else f"part_{plain}"
        name, count = plain, 2
        while name in self.taken:
            name, count = f"{plain}_{count}", count + 1
        self.taken.add(name)
        return name


def _speed(rotor: RossRotor) -> tuple[float, str]:
    """A speed within the tables of all bearings [rpm], and where it comes from."""
    tables = [b.frequency for b in rotor.bearings if len(b.frequency) > 1]
    if not tables:
        return SPEED, "to be given: a ROSS file has no speed"
    low, high = max(min(t) for t in tables), min(max(t) for t in tables)
    return convert((low + high) / 2, "rad/s", "rpm"), "to be given: the middle of the tables of the bearings"


def _coefficients(file: Path, bearing: RossBearing) -> Iterable[str]:
    """Coefficients of a bearing, constant or in a table."""
    if not bearing.coefficients:
        raise CaseError(f"{file}: bearing {bearing.tag}: found no stiffness and no damping, expected one of them")

    def entries(row: int) -> list[str]:
        return [
            f'{key[0]}_{key[1:]} = "{values[row]!r} {"N/m" if key[0] == "k" else "N*s/m"}"'
            for key, values in bearing.coefficients.items()
        ]

    if len(bearing.frequency) < 2:
        return entries(0)
    rows = [
        f' {{ speed = "{speed!r} rad/s", {", ".join(entries(row))} }},' for row, speed in enumerate(bearing.frequency)
    ]
    return ["table = [", *rows, "]"]


def _support(file: Path, name: str, mass: float, ground: RossBearing) -> list[str]:
    """A support: a point mass on a bearing to the ground."""
    for ij in DIRECTIONS:
        for q in "kc":
            values = ground.coefficients.get(f"{q}{ij}", ())
            if (values and ij in ("xy", "yx")) or len(set(values)) > 1:
                raise CaseError(
                    f"{file}: bearing {ground.tag}: {q}{ij}: found cross-coupling or a table in a bearing that carries a"
                    " point mass, expected constant kxx, kyy, cxx, cyy"
                )
    made = ["[[support]]", f'name = "{name}"', f'm = "{mass!r} kg"']
    for q, unit in (("k", "N/m"), ("c", "N*s/m")):
        for axis in "xy":
            if found := ground.coefficients.get(f"{q}{axis}{axis}"):
                made.append(f'{q}_{axis} = "{found[0]!r} {unit}"')
    return made
