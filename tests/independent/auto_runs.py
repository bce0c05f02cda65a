"""Run AUTO-07p in a folder, and read what it saved."""

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from tests.independent.auto_systems import COMMON, ROUTINES, SYSTEMS

#: AUTO's numbers of special points, and what they are called here. A user's point is no event.
TYPES = {
    1: "branch-point", 2: "fold", 3: "hopf", 4: None, 5: "fold", 6: "branch-point", 7: "period-doubling",
    8: "neimark-sacker", 9: None, -4: None,
}  # fmt: skip


def program() -> str | None:
    """The command, as AUTO's own installation or a distribution calls it; None without a Fortran compiler."""
    return (shutil.which("auto") or shutil.which("auto-07p")) if shutil.which("gfortran") else None


def ask(name: str, folder: Path) -> dict[str, list[dict]]:
    """Follow the branches of a system; each point has ``kind``, ``value``, ``time`` (one return) and ``states``."""
    system, command = SYSTEMS[name], program()
    assert command is not None
    (folder / "equations.f90").write_text(ROUTINES.format(rates=system.rates, first=system.first))
    (folder / "branches.auto").write_text(COMMON + system.commands)
    if name == "roessler":
        np.savetxt(folder / "cycle.dat", cycle_of_roessler())
    done = subprocess.run([command, "branches.auto"], cwd=folder, capture_output=True, text=True, timeout=900)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    return {
        branch: [placed(name, branch, point) for point in points(folder / f"s.{branch}")] for branch in system.branches
    }


def placed(name: str, branch: str, point: dict) -> dict:
    """The same point with its states at phase zero, or at each crossing of the section; SciPy goes there from the first.

    The mesh begins at any phase, at which the collocation has its full order.
    """
    first = np.array(point.pop("first"))
    if branch == "equilibrium":
        return {**point, "states": [first.tolist()]}
    rates, crossed = SECTIONS[name](point["value"])
    begin, end = 0.0, 1.02 * point["time"]
    if SYSTEMS[name].forced:
        begin = float(np.arctan2(-first[3], first[2]) % (2 * np.pi) / point["value"])
        end, first = 2 * np.pi / point["value"], first[:2]
    run = solve_ivp(rates, (begin, end), first, method="DOP853", rtol=1e-12, atol=1e-13, events=crossed)
    states = [run.y[:, -1]] if SYSTEMS[name].forced else run.y_events[0]
    different = [x for k, x in enumerate(states) if all(np.abs(x - y).max() > 1e-4 for y in states[:k])]
    return {**point, "states": [x.tolist() for x in different]}


def _duffing(Omega):
    return lambda t, u: [u[1], 0.18 * np.cos(Omega * t) - 0.05 * u[1] - u[0] - 0.1 * u[0] ** 3], None


def _hopf(Omega):
    def rates(t, u):
        z = u[0] + 1j * u[1]
        slope = (1 + 2j - abs(z) ** 2) * z + 0.6 * np.exp(1j * Omega * t)
        return [slope.real, slope.imag]

    return rates, None


def _roessler(c):
    def crossed(_, u):
        return u[0]

    crossed.direction = 1
    return lambda _, u: [-u[1] - u[2], u[0] + 0.2 * u[1], 0.2 + u[2] * (u[0] - c)], crossed


def _lorenz(rho):
    def crossed(_, u):
        return u[2] - (rho - 1)

    crossed.direction = -1
    return lambda _, u: [10 * (u[1] - u[0]), u[0] * (rho - u[2]) - u[1], u[0] * u[1] - 8 * u[2] / 3], crossed


#: Rates and section of each system at a value of the varied parameter, written once more for SciPy.
SECTIONS = {"duffing": _duffing, "forced_hopf": _hopf, "roessler": _roessler, "lorenz": _lorenz}


def points(path: Path) -> Iterator[dict]:
    """Labelled solutions of one of AUTO's files, in their order; the last, where the run stopped, too."""
    words = path.read_text().split("\n")
    at = 0
    while at < len(words) and words[at].strip():
        head = [int(n) for n in words[at].split()]
        kind, per_point, lines, parameters = head[2], head[7], head[8], head[11]
        body = words[at + 1 : at + 1 + lines]
        numbers = [float(n) for n in body[0].split()]
        row = 1
        while len(numbers) < per_point:
            numbers += [float(n) for n in body[row].split()]
            row += 1
        rows = (parameters + 6) // 7  # of 7 numbers each, at the end
        par = [float(n) for line in body[len(body) - rows :] for n in line.split()]
        yield {"kind": TYPES[kind], "value": par[0], "time": par[10], "first": numbers[1:per_point]}
        at += 1 + lines


def cycle_of_roessler() -> np.ndarray:
    """One return of the settled cycle at c = 2.6: time and states, from which AUTO begins."""

    def returned(t, u):
        return u[1]

    returned.direction = 1
    settled = solve_ivp(_roessler(2.6)[0], (0, 600), (1, 1, 0), rtol=1e-10, atol=1e-10, events=returned, dense_output=True)
    begin, end = settled.t_events[0][-2:]
    times = np.linspace(begin, end, 401)
    return np.column_stack([times - begin, settled.sol(times).T])
