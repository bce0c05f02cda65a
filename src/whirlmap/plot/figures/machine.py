"""A machine from parts, drawn to scale: side view of its shafts, with disks, bearings, supports and meshes."""

from collections.abc import Mapping
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from whirlmap.plot.common.style import BLUE, GREEN, GREY, INK, ORANGE, PALE, VERMILION, WIDE, new_figure, styled, text_size

#: Size of a lumped rotor, which has none, over the length of its drawing; density of the steel that a disk is drawn of.
LUMPED, STEEL = 0.2, 7800.0


@styled
def machine_figure(parts: Mapping[str, Any], *, title: str = "") -> Figure:
    """Draw the parts of a machine as `whirlmap show --json` lists them.

    Parameters
    ----------
    parts : mapping
        ``shafts``, ``bearings``, ``meshes``, ``supports``, ``unbalances`` and ``couplings``, in SI.
    title : str
        Over the figure; nothing where empty.

    Returns
    -------
    Figure
        Not known to pyplot; `save` writes it. Shafts stand one under the other, each with its own axis in mm; wheels of a
        mesh are drawn with their pitch diameter.
    """
    shafts = parts["shafts"]
    fig = new_figure(WIDE, 0.6 + 2.3 * len(shafts))
    for i, shaft in enumerate(shafts):
        ax = fig.add_subplot(len(shafts), 1, i + 1)
        _shaft(ax, shaft, parts)
        ax.margins(0.05, 0.25)  # room for words
        ax.set_aspect("equal", adjustable="datalim")
        ax.set_title(f"{shaft['name']}: {shaft['speed'] * 9.549297:.5g} rpm, {shaft['mass']:.4g} kg", loc="left")
        ax.set_yticks([])
        for side in ("left", "right", "top"):
            ax.spines[side].set_visible(False)
    fig.axes[-1].set_xlabel("distance from the first end [mm]")
    if title:
        fig.suptitle(title)
    return fig


def _shaft(ax: Axes, shaft: Mapping[str, Any], parts: Mapping[str, Any]) -> None:
    name = shaft["name"]
    elements = shaft["elements"]
    length = sum(e["L"] for e in elements) or 1.0
    largest = max((e["d"] for e in elements), default=LUMPED * length)
    for e in elements:
        _box(ax, e["z"], e["L"], e["d"], facecolor=PALE, edgecolor=INK)
        if e["d_i"]:
            _box(ax, e["z"], e["L"], e["d_i"], facecolor="white", edgecolor=GREY, linestyle="--")
    if not elements:
        ax.plot([-500, 500], [0, 0], color=INK, lw=2)
        _box(ax, -LUMPED / 2, LUMPED, 2 * LUMPED, facecolor=PALE, edgecolor=INK)
    wheels: dict[tuple[float, int, float], list[str]] = {}  # one wheel may have several meshes
    for mesh in parts["meshes"]:
        for way, z, teeth in zip(("driver", "driven"), mesh["z"], mesh["teeth"], strict=True):
            if mesh[way] == name:
                d = mesh["module"] * teeth if mesh["module"] else 2.2 * largest
                wheels.setdefault((z, teeth, d), []).append(mesh["name"])
    for (z, teeth, d), meshes in wheels.items():
        _box(ax, z - 0.03 * length, 0.06 * length, d, facecolor="none", edgecolor=GREEN, lw=1.5)
        _label(ax, z, d / 2, f"{', '.join(meshes)}, {teeth} teeth", GREEN)
    for disk in shaft["disks"]:
        radius = (2 * disk["I_p"] / disk["m"]) ** 0.5 or 1.2 * largest
        width = disk["m"] / (STEEL * 3.14159 * radius**2)
        _box(ax, disk["z"] - width / 2, width, 2 * radius, facecolor=BLUE, edgecolor=INK, alpha=0.5)
        _label(ax, disk["z"], -radius, disk["name"], BLUE, below=True)
    for bearing in parts["bearings"]:
        if bearing["shaft"] == name:
            _bearing(ax, bearing, largest)
    for unbalance in parts["unbalances"]:
        if unbalance["shaft"] == name:
            ax.plot(1e3 * unbalance["z"], 0, "o", color=VERMILION, ms=4)
            ax.annotate(unbalance["name"], (1e3 * unbalance["z"], 0), xytext=(4, 3), textcoords="offset points",
                        fontsize=text_size(6), color=VERMILION)  # fmt: skip
    for coupling in parts["couplings"]:
        if coupling["shaft"] == name:
            ax.plot(1e3 * coupling["z"], 0, "s", mfc="none", color=INK, ms=7)


def _bearing(ax: Axes, bearing: Mapping[str, Any], largest: float) -> None:
    z = bearing["z"] if bearing["z"] else 0.0
    R, L = bearing.get("R", 0.5 * largest), bearing.get("L", 0.5 * largest)  # one by its coefficients has no size
    for side in (1, -1):
        low = R if side > 0 else -R - 0.25 * largest
        ax.add_patch(Rectangle((1e3 * (z - L / 2), 1e3 * low), 1e3 * L, 250 * largest, facecolor=ORANGE, edgecolor=INK))
    foot = -R - 0.25 * largest
    if bearing["support"]:
        x = 1e3 * z
        zigzag = [(x + (6 if i % 2 else -6) * (0 < i < 6), 1e3 * (foot - 0.05 * largest * i)) for i in range(7)]
        ax.plot(*zip(*zigzag, strict=True), color=INK, lw=1)
        foot -= 0.3 * largest
    ax.plot([1e3 * (z - 0.6 * L), 1e3 * (z + 0.6 * L)], [1e3 * foot] * 2, color=INK, lw=2)
    on = f"\non {bearing['support']}" if bearing["support"] else ""
    carried = bearing["load"] or bearing.get("spring_load")  # at rest the film of a damper carries nothing
    load = "" if carried is None else f"\n{carried:.4g} N"
    _label(ax, z, foot, f"{bearing['name']}{load}{on}", INK, below=True)


def _box(ax: Axes, z: float, L: float, d: float, **look: Any) -> None:
    """A body of revolution from the side, in mm."""
    ax.add_patch(Rectangle((1e3 * z, -500 * d), 1e3 * L, 1e3 * d, **look))
    ax.update_datalim([(1e3 * z, -500 * d), (1e3 * (z + L), 500 * d)])
    ax.autoscale_view()


def _label(ax: Axes, z: float, height: float, text: str, colour: str, *, below: bool = False) -> None:
    ax.annotate(
        text, (1e3 * z, 1e3 * height), xytext=(0, -3 if below else 3), textcoords="offset points", ha="center",
        va="top" if below else "bottom", fontsize=text_size(6.5), color=colour,
    )  # fmt: skip
