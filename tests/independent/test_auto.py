"""Branches and bifurcation points against AUTO-07p, which discretises orbits by collocation.

AUTO is no dependency. What it found is kept in `auto_values.json`; where its command and a Fortran compiler are on the PATH,
it is run again in the slow tests. To renew, in the folder of the repository::

    python -m tests.independent.test_auto > tests/independent/auto_values.json
"""

import json
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize_scalar
from tests.independent.auto_runs import ask, program
from tests.independent.auto_systems import SYSTEMS
from tests.sweep.branches.exact_systems import forced_hopf

import whirlmap
from whirlmap.sweep.branches.branch_dataset import events_of, word

KEPT = Path(__file__).parent / "auto_values.json"
#: Relative errors of events; of parameter, period and states along branches, over their largest values there.
EVENT, ALONG = 1e-7, 1e-6
CASES = ("duffing", "forced_hopf", "roessler", "lorenz", "lorenz cycle")


@cache
def followed(case):
    """Our branches of a case, and those of AUTO that they must be: parameter, Dataset and names."""
    if case == "duffing":
        system = whirlmap.load("duffing", delta=0.05, alpha=1, beta=0.1, gamma=0.18)
        return "omega", whirlmap.continue_orbit(system, "omega", (0.5, 2.0), longest=0.01), ["orbit"]
    if case == "forced_hopf":
        system = forced_hopf(g=0.6, Omega=2.1)
        return "Omega", whirlmap.continue_orbit(system, "Omega", (2.0, 4.0), begin=2.1, longest=0.01), ["orbit"]
    if case == "roessler":
        system = whirlmap.load("roessler", a=0.2, b=0.2)
        return "c", whirlmap.continue_orbit(system, "c", (2.6, 4.4), doublings=1, longest=0.01), ["cycle", "doubled"]
    system, near = whirlmap.load("lorenz"), {"begin": 14.0, "orbit": (6, 6, 13)}
    if case == "lorenz":
        return "rho", whirlmap.continue_orbit(system, "rho", (0.5, 30.5), **near), ["equilibrium"]
    near = {"begin": 24.0, "orbit": (5.437, 5.654, 19.966), "period": 1}
    return "rho", whirlmap.continue_orbit(system, "rho", (14.0, 24.5), longest=0.01, **near), ["cycle"]


def compare(ds, name, number, points):
    """Every point of AUTO lies on our branch, in the same order, and so does every event."""
    here = np.flatnonzero(ds["branch_of"].values == number)
    columns = np.column_stack([ds[name].values[here], ds["duration"].values[here], ds["section"].values[here, 0]])
    timed = bool(ds["duration"].values[here].any())
    sizes = np.abs(ds["maximum"].values[here][:, : columns.shape[1] - 2]).max(axis=0)
    scale = np.array([*np.abs(columns[:, :2]).max(axis=0), *sizes])
    scale[1] = scale[1] if timed else np.inf
    length = ds["arclength"].values[here]
    curve = CubicSpline(length, columns)
    places = []
    for point in points:
        found = []
        for state in point["states"]:
            theirs = np.array([point["value"], point["time"], *state])
            near = int(np.linalg.norm((columns - theirs) / scale, axis=1).argmin())
            ends = length[max(near - 1, 0)], length[min(near + 1, length.size - 1)]

            def apart(s, theirs=theirs):
                return float(np.square((curve(s) - theirs) / scale).sum())

            best = min((minimize_scalar(apart, bounds=ends, method="bounded", options={"xatol": 1e-13}).x, *ends), key=apart)
            found.append((float(np.abs((curve(best) - theirs) / scale).max()), best))
        error, place = min(found)
        assert error < ALONG, f"{point['kind']} at {point['value']}: {error:.2g}"
        places.append(place)
    assert len(places) >= 5
    assert (np.diff(places) > 0).all() or (np.diff(places) < 0).all()
    events = events_of(ds)
    mine = np.flatnonzero(events["branch"].values == number)
    kinds = [word(ds, "event_kind", events["kind"].values[k]) for k in mine]
    theirs = sorted((p["kind"], p["value"]) for p in points if p["kind"])
    return sorted(zip(kinds, events[name].values[mine].tolist(), strict=True)), theirs


def check(case, values, validate):
    """One case against AUTO's values."""
    name, ds, branches = followed(case)
    assert ds.sizes["branch"] == len(branches)
    for number, branch in enumerate(branches, 1):
        mine, theirs = compare(ds, name, number, values[case.split()[0]][branch])
        if branch == "equilibrium":  # the pitchfork, at which AUTO sees this branch turn
            mine = sorted(("fold" if kind == "branch-point" else kind, value) for kind, value in mine)
        assert [kind for kind, _ in mine] == [kind for kind, _ in theirs]
        for (kind, value), (_, truth) in zip(mine, theirs, strict=True):
            validate(f"{case}, {branch}: {name} of the {kind}", value, truth, tier="independent",
                     source="AUTO-07p, collocation", rel=EVENT)  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_branches_and_events_are_those_that_auto_found(case, validate):
    """What AUTO found is kept."""
    check(case, json.loads(KEPT.read_text()), validate)


@pytest.mark.slow
@pytest.mark.skipif(program() is None, reason="needs the command of AUTO-07p (auto or auto-07p) and gfortran on the PATH")
@pytest.mark.parametrize("case", CASES)
def test_branches_and_events_are_those_that_auto_finds(case, tmp_path, validate):
    """AUTO is asked again."""
    system = case.split()[0]
    check(case, {system: ask(system, tmp_path)}, validate)


if __name__ == "__main__":
    found = {}
    for each in SYSTEMS:
        with TemporaryDirectory() as folder:
            found[each] = ask(each, Path(folder))
    print(json.dumps(found, indent=1))
