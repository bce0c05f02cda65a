"""Branches of periodic orbits as lines over a diagram."""

from typing import Any

import numpy as np
import xarray as xr

from whirlmap.explorer.encoding import encoded
from whirlmap.explorer.exploration import shown
from whirlmap.integrate.system import System


def branch_lines(system: System, ds: xr.Dataset) -> dict[str, Any]:
    """Branches of periodic orbits as lines over a diagram.

    Returns
    -------
    dict
        ``name`` of the parameter, ``values``, ``branch`` and ``stable`` of each point; ``section`` by state, over points and
        T; ``events``: kind and value of each, with its section.
    """
    name = str(ds.attrs["varied"])
    units = shown(system, ds)
    states = [str(s) for s in np.asarray(ds["state"])]
    section = np.asarray(units["section"].transpose("state", "point", "period"), dtype=np.float32)
    words = str(ds["event_kind"].attrs["flag_meanings"]).split() if "event_kind" in ds else []
    events: list[dict[str, Any]] = []
    if words:
        at = np.asarray(units["event_section"].transpose("event", ...), dtype=float)
        for k, code in enumerate(np.asarray(ds["event_kind"]).tolist()):
            place = dict(zip(states, at[k].reshape(-1, len(states))[0].tolist(), strict=True))
            events.append({"kind": words[code].replace("_", "-"), "value": float(ds[f"event_{name}"][k]), "section": place})
    return {
        "name": name, "values": encoded(np.asarray(ds[name], dtype=float)), "branch": encoded(np.asarray(ds["branch_of"])),
        "stable": encoded(np.asarray(ds["stable"]).astype(np.int8)),
        "section": {state: encoded(section[k]) for k, state in enumerate(states)}, "events": events,
    }  # fmt: skip
