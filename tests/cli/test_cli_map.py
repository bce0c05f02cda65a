"""``whirlmap map``: what it prints, writes, refuses, and how it goes on."""

import json
import shlex

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

from whirlmap.cli.main import app

MAP = "map duffing --vary gamma=0.2:0.5:6 --vary omega=1:1.3:5 --transient 40 --most 8 --chunk 12"


@pytest.fixture(autouse=True)
def empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(line, code=0):
    result = CliRunner().invoke(app, shlex.split(line))
    assert result.exit_code == code, (result.stderr, result.exception)
    return result


def test_a_map_is_stored_drawn_and_gone_on_with(tmp_path):
    said = run(f"{MAP} --store m --out m.png").stdout
    assert "duffing: gamma and omega, 30 points in 3 chunks" in said and "store: m" in said and "written: m.png" in said
    ds = xr.open_zarr("m")
    assert dict(ds.sizes) == {"gamma": 6, "omega": 5, "quantity": 2}
    run(f"{MAP} --store m", 2)
    found = json.loads(run(f"{MAP} --store m --resume --out m.svg --json").stdout)
    assert found["points"] == 30 and sum(found["regimes"].values()) == 30 and found["files"] == ["m.svg"]
    assert found["store"] == "m" and found["varied"] == ["gamma", "omega"]
    standing = json.loads(run("map --status m --json").stdout)
    assert standing["chunks_done"] == 3 and standing["regimes"] == found["regimes"]
    assert "complete" in run("map --status m").stdout
    run(f"{MAP} --store m --force")


def test_without_a_store_out_has_the_data():
    run(f"{MAP} --out m.nc --quiet")
    ds = xr.load_dataset("m.nc")
    assert ds["regime"].shape == (6, 5) and ds.attrs["case"] == "duffing"


def test_shares_say_how_far_they_are():
    first = run(f"{MAP} --store m --share 1/2").stdout
    assert "18 points in 2 chunks" in first
    assert "12 points in 1 chunk\n" in run(f"{MAP} --store m --share 2/2").stdout
    assert (xr.open_zarr("m")["evaluation"] == 1).all()


def test_refinement_says_what_it_saved():
    line = "map duffing --vary gamma=0.1:0.25:33 --vary omega=0.8:1.1:33 --transient 40 --most 8 --refine"
    found = json.loads(run(f"{line} --store m --out m.png --json").stdout)
    assert found["uniform_grid"] == 33 * 33 and 25 <= found["computed"] < 33 * 33
    assert found["computed"] == int((xr.open_zarr("m")["evaluation"] == 1).sum())
    again = json.loads(run(f"{line} --store m --resume --json").stdout)
    assert again["computed"] == found["computed"]


def test_draws_and_lines_have_pictures_too():
    run("map duffing --vary gamma=0.2:0.5:5 --transient 40 --out line.png")
    found = run("map duffing --draw omega=normal:2% --draws 5 --seed 4 --transient 40 --store d --out draws.svg --plot v")
    assert "omega, 5 points" in found.stdout
    ds = xr.open_zarr("d")
    assert ds["omega"].dims == ("draw",) and np.abs(ds["omega"].values - 1.2).max() < 0.2


@pytest.mark.parametrize(
    ("line", "says"),
    [("map", "found no CASE"), ("map duffing", "neither --vary nor --draw"),
     ("map duffing --vary gama=0.2:0.3:3", "'gamma'"),
     ("map duffing --vary gamma=0.2:0.3:3 --vary gamma=0.1:0.2:3", "given twice"), ("map --status .", "no store of a sweep"),
     ("map duffing --vary gamma=0.2:0.3:3 --set gamma=1", "--set and in --vary"), (f"{MAP} --share 3/2", "expected I/N"),
     (f"{MAP} --share x", "expected I/N"), (f"{MAP} --share 1/2", "give the store"),
     (f"{MAP} --plot y", "no state or output"),
     ("map duffing --draw gamma=normal:3%", "go together"), (f"{MAP} --seed 3", "--draw beside it"),
     (f"{MAP} --resume", "resume continues a store"), (f"{MAP} --status m", "nothing beside it"),
     (f"{MAP} --store m --dask tcp://127.0.0.1:9 --workers 2", "give one of them"),
     ("map duffing --draw gamma=norm:3% --draws 3", "uniform or normal"),
     (f"{MAP} --store m/n", "does not exist"), (f"{MAP} --out m.xyz", "suffix"),
     (f"{MAP} --vary delta=0.1:0.2:2 --out m.png", "two"),
     ("map gear-psfd/machine --vary mu=0.01:0.02:3", "with their unit"), (f"{MAP} --store m --dask nowhere", "Dask")],
)  # fmt: skip
def test_what_is_wrong_is_said_before_anything_is_computed(line, says, tmp_path):
    result = run(line, 2)
    assert says in result.stderr and "Traceback" not in result.stderr
    assert not [p for p in tmp_path.iterdir() if p.name != "m"]
