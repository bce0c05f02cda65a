"""The least work that gives one Dataset of every function, and one JSON object of every command, to list what is in it."""

import json
import shlex
from collections.abc import Callable
from functools import partial
from os import chdir
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from typer.testing import CliRunner

import whirlmap
from whirlmap.cli.main import app

if TYPE_CHECKING:
    import xarray as xr

#: Arguments of each command that prints JSON, behind its first word. What stands in the object does not depend on how
#: much was computed.
COMMANDS = {
    "cases": "", "show": "machines/jeffcott-rig", "simulate": "jeffcott --periods 2",
    "diagnose": "duffing --set gamma=0.2 --transient 20 --max-periods 64", "linear": "jeffcott",
    "campbell": "jeffcott --vary s=1:2:5", "bifurcation": "duffing --vary gamma=0.2:0.21:2 --transient 20",
    "continue": "duffing --vary gamma=0.2:0.21 --transient 20", "map": "duffing --vary gamma=0.2:0.21:2 --transient 20",
    "speeds": "machines/jeffcott-rig --points 3 --transient 20",
    "improve": "machines/jeffcott-rig --vary Gamma=1:2:2 --points 3 --transient 20 --coarse",
    "attractors": "duffing --set gamma=0.2 --starts 4 --transient 20 --lyapunov 256",
    "basins": "duffing --set gamma=0.2 --grid x=-1:1:3 --grid v=-1:1:3 --transient 20 --lyapunov 256", "cache": "",
    "show --series": "--series signal.csv",
    "diagnose --series": "--series signal.csv --column x --window 20 --speed 1.6Hz",
    "simulate --vary": "machines/jeffcott-rig --vary speed=3000rpm:3300rpm --time 0.5s",
    "linear --response": "machines/jeffcott-rig --response --vary speed=2000rpm:4000rpm:8",
    "new": "my_case.toml", "recipes": "",
}  # fmt: skip
#: Commands that print JSON and are too long to be run for the reference -> where their result is described.
TOO_LONG = {
    "explore": "case, varied, and the address or the file", "reproduce": "the tables of its report",
    "identify": "docs/identification.md", "bench": "docs/performance.md",
}  # fmt: skip


def printed(command: str) -> dict[str, Any]:
    """The JSON object that a command prints."""
    first = command.split()[0]
    before = Path.cwd()
    with TemporaryDirectory() as folder:
        chdir(folder)
        try:
            np.savetxt("signal.csv", np.c_[np.arange(4000) / 100, _tone()], "%.6f", ",", header="t [s],x [um]", comments="")
            done = CliRunner().invoke(app, [first, *shlex.split(COMMANDS[command]), "--json"])
        finally:
            chdir(before)
    if done.exit_code:
        raise RuntimeError(f"whirlmap {command}: {done.output}")
    return json.loads(done.stdout)


def _tone() -> "np.ndarray":
    return np.sin(0.1 * np.arange(4000)) + 0.1 * np.sin(0.32 * np.arange(4000))


def datasets() -> dict[str, "Callable[[], xr.Dataset]"]:
    """A call for each function that returns a Dataset, in the order of the reference."""
    duffing, rotor = whirlmap.load("duffing", gamma=0.2), whirlmap.load("jeffcott")
    rig, teeth = partial(whirlmap.load, "machines/jeffcott-rig"), whirlmap.load("gear_backlash", F_ah=0.05)
    series = whirlmap.simulate(duffing, transient=50, periods=8)
    x, v = (series["x"].sel(state=name).values[:-1] for name in ("x", "v"))
    two, speeds = {"gamma": [0.2, 0.21], "omega": [1.1, 1.2]}, np.linspace(0.3, 1, 3)
    cloud = np.random.default_rng(0).normal(size=(2000, 2))
    return {
        "simulate": lambda: whirlmap.simulate(rotor, periods=2),
        "section": lambda: whirlmap.section(duffing, points=8, transient=50),
        "surface_crossings": lambda: whirlmap.surface_crossings(teeth, whirlmap.simulate(teeth, periods=8)),
        "power_spectrum": lambda: whirlmap.power_spectrum(x, rate=100),
        "full_spectrum": lambda: whirlmap.full_spectrum(x, v, rate=100),
        "waterfall": lambda: whirlmap.waterfall(duffing, "gamma", [0.2, 0.21], "x"),
        "diagnose": lambda: whirlmap.diagnose(duffing, max_periods=64),
        "diagnose_series": lambda: whirlmap.diagnose_series(_tone(), rate=100.0, speed=1.6, window=20.0),
        "lyapunov_spectrum": lambda: whirlmap.lyapunov_spectrum(duffing, transient=20, common_periods=16),
        "correlation_dimension": lambda: whirlmap.correlation_dimension(cloud, theiler=1),
        "floquet_multipliers": lambda: whirlmap.floquet_multipliers(duffing, series["x"].values[-1], duffing.period),
        "run_up": lambda: whirlmap.run_up(rig(), "speed", "3000 rpm", "3300 rpm", time="0.5 s"),
        "unbalance_response": lambda: whirlmap.unbalance_response(rig(), "speed", "2000 rpm:4000 rpm:8"),
        "tolerance_sweep": lambda: whirlmap.tolerance_sweep(duffing, {"gamma": "uniform:5%"}, 2),
        "campbell": lambda: whirlmap.campbell(rotor, "s", [1, 1.5, 2]),
        "bifurcation_diagram": lambda: whirlmap.bifurcation_diagram(rotor, "s", [1.0, 1.1], follow="both"),
        "label_points": lambda: whirlmap.label_points(rotor, {"s": [1.0, 1.1]}),
        "regime_map": lambda: whirlmap.regime_map(duffing, two),
        "attractors": lambda: whirlmap.attractors(duffing, starts=4),
        "basins": lambda: whirlmap.basins(duffing, {"x": [-1.0, 1.0], "v": [-1.0, 1.0]}),
        "continue_orbit": lambda: whirlmap.continue_orbit(duffing, "gamma", "0.2:0.3"),
        "event_curve": lambda: whirlmap.event_curve(teeth, {"Omega": "0.6:1.0", "F_ah": "0.049:0.051"}, "fold"),
        "safe_speeds": lambda: whirlmap.safe_speeds(rig(), speeds, "60 um"),
        "improve": lambda: whirlmap.improve(rig, {"c": ["90 um", "110 um"]}, speeds, "60 um", refine=False, follow=False),
    }
