"""Stores that have lost or torn a part: their status says so, and going on puts them back, to the same bytes."""

import json
import shutil

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import whirlmap
from whirlmap.analysis.settling import Settling
from whirlmap.cli.main import app
from whirlmap.errors import OutputError
from whirlmap.sweep.standing import store_standing
from whirlmap.sweep.store import differences

VARY = {"gamma": np.linspace(0.2, 0.5, 6), "omega": np.linspace(1.0, 1.3, 5)}


def compute(folder, **options):
    settling = Settling(transient=40, most=8)
    return whirlmap.regime_map(whirlmap.load("duffing"), VARY, settling=settling, store=folder, chunk=12, **options)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("stores") / "whole"
    compute(folder)
    return folder


def chunk_of(folder, name):
    return next(path for path in sorted((folder / name / "c").rglob("*")) if path.is_file())


def deleted_array(folder):
    shutil.rmtree(folder / "regime")


DAMAGES = {
    "a chunk of labels is gone": (lambda f: chunk_of(f, "regime").unlink(), 1, []),
    "a chunk is torn": (lambda f: chunk_of(f, "lyapunov").write_bytes(chunk_of(f, "lyapunov").read_bytes()[:-3]), 1, []),
    "a chunk is empty": (lambda f: chunk_of(f, "status").write_bytes(b""), 1, []),
    "an axis is gone": (lambda f: shutil.rmtree(f / "gamma"), 0, ["gamma"]),
    "the values of an axis are gone": (lambda f: shutil.rmtree(f / "omega" / "c"), 0, ["omega"]),
    "the values of an axis are torn": (lambda f: chunk_of(f, "gamma").write_bytes(b"\x28\xb5"), 0, ["gamma"]),
    "the description of an array is gone": (lambda f: (f / "lyapunov" / "zarr.json").unlink(), 0, ["lyapunov"]),
    "the description of an array is torn": (lambda f: (f / "regime" / "zarr.json").write_text("{"), 0, ["regime"]),
    "an array is gone": (deleted_array, 3, ["regime"]),
    "the description of the store is gone": (lambda f: (f / "zarr.json").unlink(), None, ["zarr.json"]),
    "the receipts are gone": (lambda f: shutil.rmtree(f / "chunks" / "receipt"), None, ["chunks/receipt"]),
    "a receipt is gone": (lambda f: chunk_of(f, "chunks/receipt").unlink(), 0, []),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_status_says_what_is_missing_and_resume_puts_it_back(damage, whole, tmp_path, monkeypatch):
    broken = tmp_path / "broken"
    shutil.copytree(whole, broken)
    spoil, damaged, lost = DAMAGES[damage]
    spoil(broken)
    standing = store_standing(broken)
    assert standing["lost"] == lost
    if damaged is not None:
        assert standing["chunks_damaged"] == damaged
    said = CliRunner().invoke(app, ["map", "--status", str(broken)])
    assert said.exit_code == 0 and "complete" not in said.stdout
    for name in lost:
        assert name in said.stdout
    compute(broken, resume=True)
    assert differences(whole, broken) == []
    assert store_standing(broken)["chunks_done"] == 3 and not store_standing(broken)["lost"]
    assert dict(xr.open_zarr(broken).sizes) == {"gamma": 6, "omega": 5, "quantity": 2}
    assert not list(tmp_path.glob(".*"))


def test_a_whole_store_is_complete(whole):
    said = json.loads(CliRunner().invoke(app, ["map", "--status", str(whole), "--json"]).stdout)
    assert (said["chunks_done"], said["chunks_damaged"], said["lost"]) == (3, 0, [])


@pytest.mark.parametrize("text", ["", "[]", '{"attributes": 1}', '{"attributes": {"manifest": 1}}'])
def test_a_store_without_a_manifest_is_called_no_store(text, whole, tmp_path):
    broken = tmp_path / "broken"
    shutil.copytree(whole, broken)
    (broken / "chunks" / "zarr.json").write_text(text)
    with pytest.raises(OutputError, match="is no store of a sweep"):
        store_standing(broken)


def test_a_cluster_without_workers_is_waited_for_and_that_is_said(whole, tmp_path):
    distributed = pytest.importorskip("distributed")
    options = {"n_workers": 0, "threads_per_worker": 1, "dashboard_address": None, "silence_logs": 50, "processes": False}
    told = []
    with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:

        def on_chunk(progress):
            if progress.messages and not told:
                cluster.scale(1)  # the worker comes after it was said
            told.extend(progress.messages)

        compute(tmp_path / "m", cluster=client, on_chunk=on_chunk)
    assert any("no workers" in message for message in told)
    assert differences(whole, tmp_path / "m") == []
