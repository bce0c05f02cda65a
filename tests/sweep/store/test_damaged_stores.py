"""Stores that have lost or torn a part: their status says so, and going on puts them back, to the same bytes."""

import json
import shutil

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import whirlmap
from whirlmap.analysis.steady.settling import Settling
from whirlmap.cli.main import app
from whirlmap.errors import OutputError
from whirlmap.sweep.store.store_status import store_standing
from whirlmap.sweep.store.zarr_store import differences

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


def described(folder, change):
    """Change the description of the group that holds the manifest."""
    place = folder / "chunks" / "zarr.json"
    content = json.loads(place.read_text())
    change(content["attributes"])
    place.write_text(json.dumps(content))


#: Damages of the manifest, of which the description of the store holds a copy.
MANIFESTS = {
    "gone": lambda f: (f / "chunks" / "zarr.json").unlink(),
    "empty": lambda f: (f / "chunks" / "zarr.json").write_text(""),
    "without a manifest": lambda f: described(f, lambda a: a.clear()),
    "with an empty manifest": lambda f: described(f, lambda a: a.update(manifest={})),
    "without variables": lambda f: described(f, lambda a: a["manifest"].pop("variables")),
    "of no shape": lambda f: described(f, lambda a: a["manifest"].update(shape=[6, 0])),
    "with its whole folder gone": lambda f: shutil.rmtree(f / "chunks"),
}


def data_of(folder):
    """Files of chunks and what is in them."""
    return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if "c" in p.parts and p.is_file()}


@pytest.mark.parametrize("damage", MANIFESTS)
def test_a_lost_manifest_is_put_back_from_its_copy_and_no_data_are_deleted(damage, whole, tmp_path):
    broken = tmp_path / "broken"
    shutil.copytree(whole, broken)
    MANIFESTS[damage](broken)
    said = CliRunner().invoke(app, ["map", "--status", str(broken)])
    assert said.exit_code == 2 and "chunks/zarr.json, is lost or torn" in said.stderr.replace("\n", " ")
    assert "--resume puts it back" in said.stderr.replace("\n", " ")
    before, told, begun = data_of(broken), [], []
    compute(broken, resume=True, on_chunk=lambda p: (told.extend(p.messages), begun.append(p.done)))
    assert told[0] == "the manifest of the store was lost, and put back from its copy"
    assert begun[0] == (0 if "folder" in damage else 3)  # chunks found whole; without receipts none is believed
    assert before.items() <= data_of(broken).items() and differences(whole, broken) == []


@pytest.mark.parametrize("kept", ["the arrays", "only chunks"])
def test_data_whose_manifest_and_its_copy_are_lost_are_left_alone(kept, whole, tmp_path):
    broken = tmp_path / "broken"
    shutil.copytree(whole, broken)
    for place in broken.rglob("zarr.json"):
        if kept == "only chunks" or place.parent.name in ("broken", "chunks"):
            place.unlink()
    before = data_of(broken)
    with pytest.raises(OutputError, match=r"chunks/zarr.json, is lost, and its copy too.*left as they are; --force"):
        compute(broken, resume=True)
    assert data_of(broken) == before
    compute(broken, force=True)
    assert differences(whole, broken) == []


STRANGE = {
    "a receipt is torn": (lambda f: chunk_of(f, "chunks/receipt").write_bytes(b"12"), (2, 1, [])),
    "attributes of an array are lost": (lambda f: stripped(f / "regime" / "zarr.json"), (3, 0, ["regime"])),
    "attributes of the store are lost": (lambda f: stripped(f / "zarr.json"), (0, 0, ["zarr.json"])),
}


def stripped(place):
    place.write_text(json.dumps({**json.loads(place.read_text()), "attributes": {}}))


@pytest.mark.parametrize("damage", STRANGE)
def test_torn_receipts_and_lost_attributes_are_seen_and_put_back(damage, whole, tmp_path):
    broken = tmp_path / "broken"
    shutil.copytree(whole, broken)
    spoil, expected = STRANGE[damage]
    spoil(broken)
    standing = store_standing(broken)
    assert (standing["chunks_done"], standing["chunks_damaged"], standing["lost"]) == expected
    compute(broken, resume=True)
    assert differences(whole, broken) == []


@pytest.mark.parametrize(
    ("change", "says"),
    [({"format": 2, "whirlmap_version": "9.9"}, "whirlmap_version: the store has 9.9"),
     ({"roots": {"a": 1}}, "names no known way to take roots"), ({"shape": [7, 5]}, r"shape: the store has \[7, 5\]")],
)  # fmt: skip
def test_manifests_of_other_stores_are_refused_in_a_sentence(change, says, whole, tmp_path):
    broken = tmp_path / "broken"
    shutil.copytree(whole, broken)
    described(broken, lambda a: a["manifest"].update(change))
    before = data_of(broken)
    with pytest.raises(OutputError, match=says):
        compute(broken, resume=True)
    assert data_of(broken) == before


def test_a_file_and_a_folder_of_other_things_are_no_stores(tmp_path):
    place = tmp_path / "broken"
    place.write_text("x")
    for options in ({}, {"resume": True}, {"force": True}):
        with pytest.raises(OutputError, match="found a file, expected a folder"):
            compute(place, **options)
    with pytest.raises(OutputError, match=r"is no store of a sweep .it is a file"):
        store_standing(place)
    code = tmp_path / "program" / "src" / "c"
    code.mkdir(parents=True)
    (code / "main.c").write_text("int main;")
    for options in ({"resume": True}, {"force": True}):
        with pytest.raises(OutputError, match="no store of a sweep"):
            compute(tmp_path / "program", **options)
    assert place.read_text() == "x" and (code / "main.c").is_file()


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
