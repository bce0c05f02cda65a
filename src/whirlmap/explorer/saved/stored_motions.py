"""Motions that are computed when a page is saved: of some points, for a model that cannot run in a browser."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.explorer.control import system_at
from whirlmap.explorer.exploration import Exploration
from whirlmap.explorer.motion import Motion, motion
from whirlmap.explorer.saved.shown_units import shown_units

#: Points whose motions are stored, and T that each is long at least.
POINTS, PERIODS = 40, 32


def stored_motions(e: Exploration) -> tuple[dict[str, Any], bytes]:
    """Motions of points that lie evenly over the axes, as single precision numbers.

    Returns
    -------
    description : dict
        As ``saved.js`` reads it.
    data : bytes
    """
    each = max(int(POINTS ** (1 / len(e.axes))), 2) if e.axes else 1
    few = {name: np.asarray(values)[_evenly(len(values), each)] for name, (values, _) in e.axes.items()}
    index = np.stack(np.meshgrid(*few.values(), indexing="ij"), axis=-1).reshape(-1, len(few)) if few else np.zeros((1, 0))
    out, pieces, at = [], [], 0
    for row in index:
        values = dict(zip(few, row.tolist(), strict=True))
        m = motion(system_at(e.system, e.controls, values), e.labelling)
        numbers, described = _one(m)
        out.append({"values": values, "at": at, **described})
        pieces.append(numbers.tobytes())
        at += numbers.nbytes
    axes = [{"name": name, "low": float(v[0]), "high": float(v[-1])} for name, (v, _) in e.axes.items()]
    model = e.system.model
    description = {
        "axes": axes, "states": list(e.system.states), "outputs": list(model.outputs), "motions": out,
        "units": shown_units(e.system)[0],
    }  # fmt: skip
    return description, b"".join(pieces)


def _evenly(count: int, wanted: int) -> NDArray[np.intp]:
    return np.unique(np.linspace(0, count - 1, wanted).astype(int))


def _one(m: Motion) -> tuple[NDArray[np.float32], dict[str, Any]]:
    """Numbers of a motion, states and then outputs sample by sample, and what a page needs beside them."""
    steps, n = m.recipe.steps, int(m.point["period_T"][0])
    x, outputs = np.asarray(m.series["x"]), np.asarray(m.series["outputs"])
    good = np.isfinite(x).all(axis=1)
    whole = max(PERIODS, 2 * n) * steps + 1
    x, outputs = x[good][:whole], outputs[good][:whole]
    late = float(m.series["end_time"])
    described = {
        "samples": len(x), "steps": steps, "period": n, "time": m.system.period, "settled": int(m.point["settled_after"][0]),
        "ended": None if np.isnan(late) else {"turn": late / m.system.period}, "sizes": shown_units(m.system)[1].tolist(),
    }  # fmt: skip
    return np.concatenate([x.ravel(), outputs.ravel()]).astype("<f4"), described
