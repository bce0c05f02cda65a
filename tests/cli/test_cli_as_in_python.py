"""Commands and functions give the same numbers where nothing but the task is said: their defaults are one."""

import json
import shlex
from functools import partial

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import whirlmap
from whirlmap.cli.main import app

RIG = "machines/jeffcott-rig"


def duffing(**changes):
    return whirlmap.load("duffing", **changes)


#: Command -> the function without any option of how to compute.
SAME = {
    "simulate duffing --periods 3": lambda: whirlmap.simulate(duffing(), periods=3),
    "diagnose duffing --set gamma=0.28": lambda: whirlmap.diagnose(duffing(gamma=0.28)),
    "bifurcation duffing --vary gamma=0.2:0.3:5": lambda: whirlmap.bifurcation_diagram(
        duffing(), "gamma", np.linspace(0.2, 0.3, 5)
    ),
    "map duffing --vary gamma=0.2:0.3:3 --vary omega=1.1:1.2:2": lambda: whirlmap.regime_map(
        duffing(), {"gamma": np.linspace(0.2, 0.3, 3), "omega": [1.1, 1.2]}
    ),
    "attractors duffing --set gamma=0.2 --starts 16": lambda: whirlmap.attractors(duffing(gamma=0.2), starts=16),
    "basins duffing --set gamma=0.2 --grid x=-1:1:4 --grid v=-1:1:3": lambda: whirlmap.basins(
        duffing(gamma=0.2), {"x": np.linspace(-1, 1, 4), "v": [-1.0, 0.0, 1.0]}
    ),
    f'speeds {RIG} --range 0.4:0.8 --points 5 --limit "60 um"': lambda: whirlmap.safe_speeds(
        whirlmap.load(RIG), np.linspace(0.4, 0.8, 5), 0.6
    ),
    f'improve {RIG} --vary Gamma=0.1:0.2:3 --range 0.4:0.8 --points 5 --limit "60 um"': lambda: whirlmap.improve(
        partial(whirlmap.load, RIG), {"Gamma": np.linspace(0.1, 0.2, 3)}, np.linspace(0.4, 0.8, 5), 0.6
    ),
    "campbell jeffcott --vary s=1:2:5": lambda: whirlmap.campbell(whirlmap.load("jeffcott"), "s", np.linspace(1, 2, 5)),
}


@pytest.mark.parametrize("line", SAME, ids=lambda line: line.split()[0])
def test_the_same_numbers_without_options(line, tmp_path):
    done = CliRunner().invoke(app, [*shlex.split(line), "--out", str(tmp_path / "a.nc"), "--json"])
    assert done.exit_code == 0, done.output
    json.loads(done.stdout)
    with xr.open_dataset(tmp_path / "a.nc") as there:
        there.load()
    here = SAME[line]().load()
    assert set(there.variables) >= set(here.variables)
    for name in here.variables:
        np.testing.assert_array_equal(there[name].values, here[name].values, err_msg=name)
    passing = {"date", "command"}
    for key, value in here.attrs.items():
        if key not in passing:
            np.testing.assert_array_equal(there.attrs[key], value, err_msg=key)
