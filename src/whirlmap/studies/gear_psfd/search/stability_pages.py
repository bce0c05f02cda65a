"""Linear theory of the searched sets and of the reference machine, as Markdown tables and one picture."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from whirlmap.integrate.loading import load
from whirlmap.results.regime import Regime
from whirlmap.studies.gear_psfd.claims.labelled import Array
from whirlmap.studies.gear_psfd.search.answer import Answer
from whirlmap.studies.gear_psfd.search.blocks import Blocks
from whirlmap.studies.gear_psfd.search.identify import finished
from whirlmap.studies.gear_psfd.search.stability import (
    FINDS,
    GROWS,
    STANDS,
    Modes,
    against_simulation,
    half_speed,
    modes,
    modes_of_block,
    permeability,
)
from whirlmap.studies.gear_psfd.search.variants import Variant
from whirlmap.sweep.points.label_points import label_points

#: Static eccentricities, of the more loaded journal at psi = 0, between which points are counted together.
EDGES = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0)
#: Permeabilities and speeds of the reference machine's threshold; its clock is the pinion.
THRESHOLD_PSI = (0.0, 1e-3, 0.1, 0.3)
THRESHOLD_S = np.linspace(0.2, 5.0, 241)


@dataclass(frozen=True)
class Linear:
    """Linear theory of one variant's first sets, and what their simulations found."""

    variant: Variant
    modes: Modes
    outcomes: Array


def linear(answer: Answer, blocks: Blocks, sets: int) -> list[Linear]:
    """Compute the modes of every variant whose journals can have an equilibrium."""
    out = []
    for j in answer.judged:
        if j.variant.spin == "still":  # without spin a film carries nothing
            continue
        ds = blocks[finished(blocks, j.variant)[0]]
        found = modes_of_block(j.variant, ds, answer.settings, sets)
        out.append(Linear(j.variant, found, against_simulation(found, ds, j.labelled.forced)))
    return out


def linear_page(found: list[Linear]) -> str:
    """Tables of linear theory against simulation, and of what permeability does."""
    if not found:
        return "### Linear theory of the same sets\n\nNone of the searched journals turns: no film carries a load at rest.\n"
    parts = [
        "### Linear theory of the same sets",
        "Operating points by what linear theory says of their static equilibrium (all points, and the share of them that a"
        " simulation finds in each motion, in percent), and the share of the unstable ones whose mode turns at half of a"
        " journal's spin, within 10 %:",
        _stands(found),
    ]
    for one in found:
        if one.variant.film == "porous" and one.variant.edition == "intended":
            said = f"What ψ = 0.1 does to points of `{one.variant.name}` that have an equilibrium at ψ = 0:"
            parts += [said, _seepage(one)]
    return "\n\n".join(parts) + "\n"


def _stands(found: list[Linear]) -> str:
    head = f"| variant | linear theory | points | {' | '.join(FINDS)} | half-speed |"
    lines = [head, "| --- | --- |" + " ---: |" * (len(FINDS) + 2)]
    for one in found:
        unstable = np.nan_to_num(one.modes.growth, nan=-1.0) > GROWS
        half = half_speed(one.modes, one.variant).sum() / max(int(unstable.sum()), 1)
        for stand, row in zip(STANDS, one.outcomes, strict=True):
            total = int(row.sum())
            cells = [f"{100 * v / total:.0f}" if total else "-" for v in row]
            turning = f"{100 * half:.0f}" if stand == "unstable" and total else ""
            lines.append(f"| `{one.variant.name}` | {stand} | {total} | {' | '.join(cells)} | {turning} |")
    return "\n".join(lines)


def _seepage(one: Linear) -> str:
    rows = permeability(one.modes, EDGES)
    head = ("static eccentricity", "points", "unstable, calmed", "unstable still", "stable still", "upset", "no equilibrium")
    lines = [f"| {' | '.join(head)} |", "| --- |" + " ---: |" * 6]
    for low, high, row in zip(EDGES[:-1], EDGES[1:], rows, strict=True):
        cells = [str(int(row[0])), *(f"{100 * v / row[0]:.1f} %" if row[0] else "-" for v in row[1:])]
        lines.append(f"| {low:g} .. {high:g} | {' | '.join(cells)} |")
    return "\n".join(lines)


def draw_threshold(workers: int | None = None) -> Figure:
    """Draw growth and frequency of the reference machine's fastest mode, with what simulations find, against the speed."""
    system = load("gear-psfd/machine")
    figure = Figure(figsize=(8, 6.4), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    spin = abs(float(system.values["j_g"]))
    coarse = THRESHOLD_S[::6]
    for k, psi in enumerate(THRESHOLD_PSI):
        found = modes(system, {"s": THRESHOLD_S, "psi": np.full(THRESHOLD_S.size, psi)})
        line = {"color": f"C{k}", "ls": "--" if k % 2 else "-"}  # the first two coincide
        above.plot(THRESHOLD_S, found.growth, label=f"ψ = {psi:g}", **line)
        near = found.growth > -0.01
        below.plot(np.where(near, THRESHOLD_S, np.nan), found.frequency / spin, **line)
        ds = label_points(system, {"s": coarse, "psi": np.full(coarse.size, psi)}, lyapunov=512, workers=workers)
        regime = ds["regime"].values
        y = np.full(coarse.size, -0.0125 - 0.0012 * k)
        marks = {Regime.periodic: ".", Regime.undecided: "o", Regime.contact: "x"}
        for kind, mark in marks.items():
            wanted = regime == kind
            above.plot(coarse[wanted], y[wanted], mark, color=f"C{k}", ms=4)
    above.axhline(0, color="0.6", lw=0.8)
    above.set(ylim=(-0.018, 0.007), ylabel="growth per radian of the pinion")
    above.legend(fontsize=8, loc="upper left")
    above.set_title("The reference machine: fastest mode of its static equilibrium; marks: simulation with its forcing\n"
                    "(dot: periodic, circle: does not return, cross: contact)", loc="left", fontsize=10)  # fmt: skip
    below.axhline(0.5, color="0.6", lw=0.8)
    below.set(xlabel="pinion speed over √(K_p/m_p)", ylabel="its frequency over the gear's spin", ylim=(0.3, 0.6))
    return figure
