"""The explorer's page as one file: no server, no network, and the motion of any point computed in the browser.

The file holds the page, the labelled points and the kernels with all that they need at every point (`live_points`). Where
the model cannot run in a browser, it holds motions that were computed before, of some points, and says so.
"""

from dataclasses import replace
from importlib.resources import files
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sympy import Poly, PolynomialError, sympify

from whirlmap.analysis.motion.record_length import slowest_turn, spectrum_periods
from whirlmap.analysis.simulation.time_series import SAMPLES
from whirlmap.errors import InputError
from whirlmap.explorer.encoding import json_text
from whirlmap.explorer.exploration import DIRECTION, Exploration, axis_of, axis_values
from whirlmap.explorer.motion import PER_T, PER_TURN, RECORD
from whirlmap.explorer.page import page_html
from whirlmap.explorer.page_data import page_data
from whirlmap.explorer.saved.grid import Grid
from whirlmap.explorer.saved.live_points import MOST, live_points
from whirlmap.explorer.saved.packing import Packing, text_of
from whirlmap.explorer.saved.shown_units import shown_units
from whirlmap.explorer.saved.stored_motions import stored_motions
from whirlmap.kernels.lowering.formulas import HoistedFunction
from whirlmap.kernels.webassembly.browser_kernel import NoBrowserKernelError
from whirlmap.options.execution import Execution
from whirlmap.options.storage import Storage
from whirlmap.sweep.diagrams.diagram import bifurcation_diagram
from whirlmap.sweep.maps.regime_map import regime_map
from whirlmap.sweep.parameters.space import space_of
from whirlmap.sweep.points.label_points import label_points

Integers = NDArray[np.int64]

#: Scripts of the source of motions, in their order.
SCRIPTS = ("harmonics.js", "live_motion.js", "spectrum.js", "saved.js")
#: Bytes of a file, of the page and its kernels, and least ones of numbers of live points. Numbers grow by this factor in a
#: file: base64 takes four letters for three bytes, and doubles are hardly compressed.
LARGEST, OWN, LEAST, GROWTH = 7_500_000, 500_000, 500_000, 1.35
#: Said in every page.
LIMITS = (
    "This file computes motions by itself. Other quantities, votes of the indicators, finer diagrams, the following of"
    " branches, and the export of data, commands and scripts need the program: whirlmap explore."
)
#: Stands in an empty page where the content comes.
CONTENT = "/* content */null"


def saved_page(exploration: Exploration) -> str:
    """The page as HTML.

    Parameters
    ----------
    exploration : Exploration
        With its labelled points, where it varies anything.

    Returns
    -------
    str
        A file that a browser opens without a server.

    Raises
    ------
    InputError
        The points are still to be computed.
    """
    return empty_page().replace(CONTENT, saved_content(exploration))


def empty_page(*, embedded: bool = False) -> str:
    """The page without its content: it stands where `CONTENT` does. Several diagrams in one file need it once."""
    source = "\n".join((files("whirlmap.explorer.saved") / name).read_text(encoding="utf-8") for name in SCRIPTS)
    return page_html(source=f"{source}\nexplorer.source = whirlmapSaved.source({CONTENT});", embedded=embedded)


def saved_content(exploration: Exploration, *, largest: int = LARGEST) -> str:
    """The content of a page, an expression of JavaScript of letters, digits and ``{}":,+/=``; ``largest``: bytes, about."""
    data, packed = saved_data(exploration, largest=largest)
    return json_text({"data": text_of(json_text(data).encode()), "bytes": text_of(packed)})


def completed(exploration: Exploration, execution: Execution, store: Path | None = None) -> Exploration:
    """The exploration with its points computed: a diagram, or a map, which is kept in ``store`` where one is given."""
    e = exploration
    if len(e.axes) == 1:
        ((name, (values, unit)),) = e.axes.items()
        axis = axis_of(e.system, name, values, unit)
        ds = bifurcation_diagram(e.system, name, axis, follow=e.follow, labelling=e.labelling, execution=execution)
    else:
        vary = {name: axis_values(*axis) for name, axis in e.axes.items()}
        storage = Storage(store, resume=store is not None)
        ds = regime_map(e.system, vary, labelling=e.labelling, execution=execution, storage=storage)
    return replace(e, overview=ds)


def saved_data(exploration: Exploration, *, largest: int = LARGEST) -> tuple[dict[str, Any], bytes]:
    """What a saved page holds beside the page itself, as ``saved.js`` describes it."""
    e = exploration
    if e.axes and e.overview is None:
        raise InputError("found a map or diagram whose points are still to be computed, expected labelled points")
    page = page_data(e)
    page["controls"] = [control for control in page["controls"] if control["axis"]]
    data: dict[str, Any] = {"page": page, "record": _record(e), "note": "", "limits": LIMITS}
    try:
        room = largest - len(text_of(json_text(page).encode())) - OWN
        data["live"], packed = _live(e, min(max(int(room / GROWTH), LEAST), MOST))
        thinned = [(name, t) for name, t in zip(e.axes, data["live"]["thinned"], strict=True) if t > 1]
        if thinned:
            often = " and ".join(f"one of {t} values of {name}" for name, t in thinned)
            data["note"] = f"To keep this file small, motions are computed at {often}: the nearest one is shown."
    except NoBrowserKernelError as error:
        data["stored"], packed = stored_motions(e)
        count = len(data["stored"]["motions"])
        data["note"] = f"Motions are not computed here, for {error}. The nearest of {count} stored motions is shown;"
        data["note"] += " coexisting motions are not sought."
    return data, packed


def _record(e: Exploration) -> dict[str, Any]:
    """How motions are recorded: T, part of each range to which they return, and T in a turn of the slowest clock."""
    return {
        "periods": spectrum_periods(e.system, RECORD), "tolerance": e.labelling.settling.tolerance,
        "turn": max(1, round(slowest_turn(e.system))), "common": e.system.strobe,
        "cyclic": {s.name: float(s.cyclic) for s in e.system.model.states if s.cyclic is not None},
    }  # fmt: skip


def _live(e: Exploration, most: int) -> tuple[dict[str, Any], bytes]:
    """Live points of an exploration, with the steps and the time of settling that its points had."""
    system = e.system
    space = space_of(system, {name: axis_values(*axis) for name, axis in e.axes.items()}) if e.axes else None
    steps, settling = _known(e)
    wanted = max(PER_T, ceil(PER_TURN / slowest_turn(system))) if system.model.forced else PER_T

    def more(grid: Grid, packing: Packing) -> dict[str, Any]:
        units, sizes = shown_units(system, grid)
        return {
            "units": units, "sizes": packing.rows(sizes), "settling": packing.rows(grid.thinned(settling).astype(float)),
            **_section(grid, packing),
        }  # fmt: skip

    method = e.labelling.integration.method or "dop853"
    return live_points(system, space, method=method, steps=steps * -(-wanted // steps), most=most, more=more)


def _known(e: Exploration) -> tuple[Integers, Integers]:
    """Steps per T of every point; and its return in T, 0 where there is none, with the T that it took to settle.

    Points that a map has not computed, as those that a refinement leaves out, take the most steps and T of the others, and
    their return is looked for: -1.
    """
    ds, forced = e.overview, e.system.model.forced
    if ds is None:
        name, value = e.system.parameters[0], float(e.system.vector[0])
        ds = label_points(e.system, {name: [value]}, lyapunov=0).isel(point=0)
    if DIRECTION in ds.dims:
        ds = ds.isel({DIRECTION: 0})
    common = np.asarray(ds["common_multiple"]) if "common_multiple" in ds else e.system.strobe
    waits = np.maximum(np.asarray(ds["settled_after"]) * np.maximum(common, 1), 1)
    period = np.asarray(ds["period_T"]) if forced else np.zeros(waits.shape)  # that of an unforced motion counts crossings
    steps = np.asarray(ds["steps"]).astype(np.int64)
    unknown = steps < 1
    steps = np.where(unknown, max(int(steps.max()), SAMPLES), steps)
    waits = np.where(unknown, waits.max(), waits)
    period = np.where(unknown, -1 if forced else 0, period)
    return steps, np.stack([period, waits]).astype(np.int64)


def _section(grid: Grid, packing: Packing) -> dict[str, Any]:
    """The plane in which an unforced motion is cut, at every point; nothing where the model's surface is no plane."""
    model = grid.system.model
    if model.section is None:
        return {}
    try:
        plane = Poly(sympify(model.section.surface), *model.states)
    except PolynomialError:
        return {}
    if plane.total_degree() > 1:
        return {}
    factors = [*(plane.coeff_monomial(s) for s in model.states), plane.coeff_monomial(1)]
    rows = HoistedFunction.of(model.parameters, factors).evaluate(grid.values)
    return {"section": packing.rows(grid.over(rows)), "rising": model.section.direction == "rising"}
