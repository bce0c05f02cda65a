"""Maps in a store: the same bits whoever computes them, and what is refused, reported and mended."""

import errno
import json
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import xarray as xr

import whirlmap
from whirlmap.analysis.labels.labelling import measure
from whirlmap.errors import OutputError, RangeError
from whirlmap.options.computed import Labelling, Settling
from whirlmap.options.execution import Execution
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status
from whirlmap.sweep.diagrams.diagram import bifurcation_diagram
from whirlmap.sweep.maps import executors
from whirlmap.sweep.maps.regime_map import regime_map
from whirlmap.sweep.points.label_points import label_points
from whirlmap.sweep.store.store_folder import MANIFEST
from whirlmap.sweep.store.store_status import store_standing
from whirlmap.sweep.store.zarr_store import Evaluation, Store, differences

SHORT = Settling(transient=40, most=8, keep=8)
GRID = {"gamma": np.linspace(0.2, 0.6, 11), "omega": np.linspace(1.0, 1.4, 9)}


@pytest.fixture(scope="module")
def duffing():
    return whirlmap.load("duffing")


def made(system, place, **options):
    return regime_map(system, GRID, store=place, settling=SHORT, **{"chunk": 7, **options})


@pytest.fixture(scope="module")
def whole(duffing, tmp_path_factory):
    place = tmp_path_factory.mktemp("whole") / "map"
    made(duffing, place)
    return place


def same(a: xr.Dataset, b: xr.Dataset, what: str) -> None:
    for name in a.variables:
        np.testing.assert_array_equal(a[name].values, b[name].values, err_msg=f"{what}: {name}")


def test_a_map_is_its_points(duffing, whole):
    ds = xr.open_zarr(whole)
    gamma, omega = np.meshgrid(*GRID.values(), indexing="ij")
    points = label_points(duffing, {"gamma": gamma.ravel(), "omega": omega.ravel()}, settling=SHORT)
    for name, values in points.data_vars.items():
        np.testing.assert_array_equal(ds[name].values.reshape(values.shape), values.values, err_msg=name)
    assert {Regime.periodic, Regime.chaotic} <= set(ds["regime"].values.ravel())
    assert (ds["evaluation"] == Evaluation.computed).all()


def test_a_store_reads_with_plain_xarray(whole):
    ds = xr.open_zarr(whole)
    assert ds["regime"].dims == ("gamma", "omega")
    np.testing.assert_array_equal(ds["gamma"].values, GRID["gamma"])
    for name, values in ds.data_vars.items():
        assert values.attrs["units"] and values.attrs["long_name"], name
    for name in ("regime", "status", "step_verdict", "evaluation"):
        assert len(ds[name].attrs["flag_values"]) == len(ds[name].attrs["flag_meanings"].split())
    assert ds.attrs["varied"] == "gamma omega" and ds.attrs["kernel_hash"] and ds.attrs["command"]
    assert ds["peak_to_peak"].sel(quantity="x").notnull().all()


@pytest.mark.parametrize("workers", [1, 2, 4])
def test_workers_change_no_byte(duffing, whole, tmp_path, workers):
    made(duffing, tmp_path / "map", workers=workers)
    assert differences(whole, tmp_path / "map") == []


@pytest.mark.parametrize("chunk", [1, 64])
def test_chunks_change_no_bit(duffing, whole, tmp_path, chunk):
    small = {"gamma": GRID["gamma"][::3], "omega": GRID["omega"]} if chunk == 1 else GRID
    ds = regime_map(duffing, small, store=tmp_path / "map", settling=SHORT, chunk=chunk)
    same(ds, xr.open_zarr(whole).isel(gamma=slice(None, None, 3 if chunk == 1 else 1)), f"chunks of {chunk}")


def test_shuffled_chunks_change_no_byte(duffing, whole, tmp_path, monkeypatch):
    in_order = executors.in_threads
    monkeypatch.setattr(
        "whirlmap.sweep.maps.run_sweep.in_threads",
        lambda job, numbers, workers: in_order(job, np.random.default_rng(3).permutation(list(numbers)).tolist(), workers),
    )
    made(duffing, tmp_path / "map")
    assert differences(whole, tmp_path / "map") == []


def test_shares_change_no_byte(duffing, whole, tmp_path):
    for part in (3, 1, 2):
        ds = made(duffing, tmp_path / "map", share=(part, 3))
    assert (ds["evaluation"] == Evaluation.computed).all()
    assert differences(whole, tmp_path / "map") == []


def test_shares_race_for_a_new_store(duffing, whole, tmp_path):
    threads = [threading.Thread(target=made, args=(duffing, tmp_path / "map"), kwargs={"share": (k, 2)}) for k in (1, 2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert differences(whole, tmp_path / "map") == []


def test_without_a_store_nothing_is_kept(duffing, whole, tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    ds = regime_map(duffing, GRID, settling=SHORT, chunk=40)
    same(ds, xr.open_zarr(whole), "no store")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("state", ["absent", "empty", "half-made"])
def test_resume_begins_what_is_not_there(duffing, whole, tmp_path, state):
    place = tmp_path / "map"
    if state != "absent":
        place.mkdir()
    if state == "half-made":
        (place / "zarr.json").write_text('{"zarr_for')
        (place / "regime" / "c").mkdir(parents=True)
        (tmp_path / ".map.99.partial" / "regime").mkdir(parents=True)  # of a process killed while it made the store
    told = []
    made(duffing, place, resume=True, on_chunk=lambda p: told.extend(p.messages))
    assert differences(whole, place) == [] and [p.name for p in tmp_path.iterdir()] == ["map"]
    assert (state == "half-made") == any("half-made" in message for message in told)


def test_what_exists_is_refused_or_replaced(duffing, whole, tmp_path):
    with pytest.raises(OutputError, match=r"--resume.*goes on with it, --force"):
        made(duffing, whole)
    place = tmp_path / "map"
    regime_map(duffing, {"gamma": [0.2, 0.3]}, store=place, settling=SHORT, chunk=2)
    made(duffing, place, force=True)
    assert differences(whole, place) == []
    foreign = tmp_path / "thesis"
    foreign.mkdir()
    (foreign / "chapter.tex").write_text("all of it")
    for options in ({}, {"resume": True}, {"force": True}):
        with pytest.raises(OutputError, match="no store of a sweep"):
            made(duffing, foreign, **options)
    assert (foreign / "chapter.tex").exists()


@pytest.mark.parametrize(
    ("change", "says"),
    [({"vary": {**GRID, "omega": GRID["omega"] * 1.01}}, "values of omega: the store has 1 to 1.4"),
     ({"vary": {"gamma": GRID["gamma"]}}, "values of omega"),
     ({"lyapunov": 300}, "lyapunov: the store has nothing, this run 300"),
     ({"accuracy": 1e-8}, "accuracy: the store has nothing, this run 1e-08"), ({"refine": True}, "refined from"),
     ({"settling": Settling(transient=41, most=8, keep=8)}, "settling transient: the store has 40, this run 41")],
)  # fmt: skip
def test_another_sweep_is_refused(duffing, whole, change, says):
    options = {"vary": GRID, "settling": SHORT, **change}
    with pytest.raises(OutputError, match=says):
        regime_map(duffing, options.pop("vary"), store=whole, resume=True, **options)


def test_another_system_version_or_kernel_is_refused(whole, monkeypatch, duffing):
    with pytest.raises(OutputError, match=r"delta: the store has 0\.3, this run 0\.25"):
        made(whirlmap.load("duffing", delta=0.25), whole, resume=True)
    with pytest.raises(OutputError, match="x: the store has nothing, this run -1"):
        made(whirlmap.load("duffing", start={"x": -1.0}), whole, resume=True)
    with monkeypatch.context() as patch:
        patch.setattr("whirlmap.sweep.maps.manifest.__version__", "9.9")
        with pytest.raises(OutputError, match=r"whirlmap_version: the store has .*, this run 9\.9"):
            made(duffing, whole, resume=True)
    monkeypatch.setattr("whirlmap.sweep.maps.run_sweep.kernel_hash", lambda *_: "0" * 64)
    with pytest.raises(OutputError, match="kernel: the store has"):
        made(duffing, whole, resume=True)


def test_other_chunks_are_refused(duffing, whole):
    with pytest.raises(OutputError, match=r"has chunks of \(6, 1\) points, and --chunk 40 would make them \(11, 3\)"):
        made(duffing, whole, resume=True, chunk=40)


def test_a_worker_with_other_kernels_refuses(duffing, whole, tmp_path, monkeypatch):
    monkeypatch.setattr("whirlmap.sweep.maps.executors.kernel_hash", lambda *_: "0" * 64)
    with pytest.raises(OutputError, match="this worker's kernels are 000000000000"):
        made(duffing, tmp_path / "map")


def test_damage_is_found_and_mended(duffing, whole, tmp_path):
    place = tmp_path / "map"
    made(duffing, place)
    chunks = Store(place).chunks
    flipped, short, gone = (Store(place).files(k) for k in (1, 4, 6))
    data = bytearray(flipped[0].read_bytes())
    data[-1] ^= 1
    flipped[0].write_bytes(data)
    short[3].write_bytes(short[3].read_bytes()[:-2])
    gone[5].unlink()
    (place / "chunks" / "receipt" / "c").joinpath(*map(str, chunks.cell(8))).unlink()
    (place / "rms" / "c" / "0" / "0.1234.partial").write_bytes(b"half")
    told = []
    half = place / "rms" / "c" / "0" / "0.1234.partial"
    job = Store(place)
    assert [job._chunk_of(p) for p in (half, flipped[0], gone[5], place / "gamma" / "c" / "0")] == [0, 1, 6, -1]
    made(duffing, place, resume=True, on_chunk=lambda p: told.append(list(p.messages)))
    assert "3 damaged chunks computed again: 1, 4, 6" in told[0]
    assert any("half-written" in message for message in told[0])
    assert differences(whole, place) == []


def test_chunks_of_nothing_but_nan_are_files(duffing, whole):
    """Zarr leaves them out by default, so that they would look as if they had never been computed."""
    ds = xr.open_zarr(whole)
    assert np.isnan(ds["end_time"].values).all()
    assert all(path.is_file() for k in range(Store(whole).chunks.count) for path in Store(whole).files(k))


@pytest.mark.parametrize(("code", "says"), [(errno.ENOSPC, "the disk is full"), (errno.EROFS, "the disk is read-only")])
def test_a_disk_that_refuses_stops_the_sweep_and_resume_goes_on(duffing, whole, tmp_path, monkeypatch, code, says):
    place, write = tmp_path / "map", Store.write

    def refused(self, number, data):
        if number == 5:
            raise OSError(code, os.strerror(code))
        write(self, number, data)

    with monkeypatch.context() as patch:
        patch.setattr(Store, "write", refused)
        with pytest.raises(OutputError, match=f"{says}.*\n.*--resume"):
            made(duffing, place)
    assert 0 < store_standing(place)["chunks_done"] < Store(place).chunks.count
    made(duffing, place, resume=True)
    assert differences(whole, place) == []


def test_a_disk_that_is_really_full(duffing, whole, tmp_path):
    """On a file system of its own, as large as half the store."""
    small = tmp_path / "small"
    small.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", small], capture_output=True, check=False)
    if mounted.returncode:
        pytest.skip("mounting is not allowed here")
    try:
        with pytest.raises(OutputError, match="the disk is full"):
            made(duffing, small / "map", chunk=3)
        subprocess.run(["mount", "-o", "remount,size=64m", small], check=True)
        made(duffing, small / "map", chunk=3, resume=True)
        same(xr.open_zarr(small / "map").load(), xr.open_zarr(whole), "after the disk was full")
        subprocess.run(["mount", "-o", "remount,ro", small], check=True)
        with pytest.raises(OutputError, match="cannot be written"):
            regime_map(duffing, {"gamma": [0.2, 0.3]}, store=small / "other", settling=SHORT)
    finally:
        subprocess.run(["umount", small], check=True)


def test_a_chunk_that_fails_three_times_is_recorded_and_the_sweep_goes_on(duffing, whole, tmp_path, monkeypatch):
    place, tries, compute = tmp_path / "map", [], executors.Job.compute

    def failing(self, number):
        if number == 4:
            tries.append(number)
            raise ArithmeticError("the numbers ran out")
        return compute(self, number)

    with monkeypatch.context() as patch:
        patch.setattr(executors.Job, "compute", failing)
        ds = made(duffing, place)
    assert len(tries) == 3
    box = dict(zip(ds["regime"].dims, Store(place).chunks.box(4), strict=True))
    assert (ds["status"].isel(box) == Status.failed).all() and (ds["evaluation"].isel(box) == Evaluation.failed).all()
    assert int((ds["evaluation"] == Evaluation.failed).sum()) == Store(place).chunks.points(4)
    s = store_standing(place)
    assert s["chunks_failed"] == 1 and "the numbers ran out" in s["reasons"][4]
    made(duffing, place, resume=True)
    assert differences(whole, place) == []


@pytest.mark.slow
def test_a_refined_map_has_the_full_maps_boundaries(duffing, tmp_path):
    """Every point that was computed is the full map's, and so are nearly all inferred ones."""
    axes = {"gamma": np.linspace(0.1, 0.5, 65), "omega": np.linspace(0.8, 1.3, 33)}
    full = regime_map(duffing, axes, settling=SHORT)
    refined = regime_map(duffing, axes, store=tmp_path / "map", refine=True, chunk=33 * 33, settling=SHORT)
    computed = refined["evaluation"].values == Evaluation.computed
    assert 0.02 < computed.mean() < 0.6
    assert (refined["evaluation"].values[~computed] == Evaluation.inferred).all()
    for name in ("regime", "period_T", "lyapunov", "rms"):
        np.testing.assert_array_equal(refined[name].values[computed], full[name].values[computed], err_msg=name)
    assert (refined["regime"] != full["regime"]).mean() < 0.02
    assert np.isnan(refined["rms"].values[~computed]).all()
    for name in ("regime", "status", "period_T", "period_common"):  # what is inferred, is so for every one of them
        assert (refined[name] != full[name]).mean() < 0.02, name
    code = refined["regime"].values.astype(int) + 100 * refined["period_T"].values
    for axis in (0, 1):  # of neighbours with different labels, within a chunk, both were computed
        a, b = np.take(code, range(code.shape[axis] - 1), axis), np.take(code, range(1, code.shape[axis]), axis)
        both = np.take(computed, range(code.shape[axis] - 1), axis) & np.take(computed, range(1, code.shape[axis]), axis)
        edge = np.arange(code.shape[axis] - 1) % 33 == 32
        inside = np.broadcast_to(~np.expand_dims(edge, 1 - axis), a.shape)
        assert both[(a != b) & inside].all()


def test_sections_make_a_store_a_diagram(duffing, tmp_path):
    ds = regime_map(duffing, {"gamma": GRID["gamma"]}, store=tmp_path / "map", sections=True, settling=SHORT, chunk=4)
    diagram = bifurcation_diagram(duffing, "gamma", GRID["gamma"], settling=SHORT)
    for name in ("section", "regime", "lyapunov", "rms"):
        np.testing.assert_array_equal(ds[name].values, diagram[name].values, err_msg=name)
    assert ds["section"].dims == ("gamma", "period", "state") and ds["section"].attrs == diagram["section"].attrs
    with pytest.raises(OutputError, match="sections: the store has True, this run False"):
        regime_map(duffing, {"gamma": GRID["gamma"]}, store=tmp_path / "map", resume=True, settling=SHORT)


def test_progress_and_standing(duffing, tmp_path):
    seen = []
    made(duffing, tmp_path / "map", on_chunk=lambda p: seen.append((p.done, p.total, p.points_done, dict(p.regimes))))
    assert [s[0] for s in seen] == list(range(len(seen))) and seen[-1][:3] == (seen[-1][1], seen[-1][1], 99)
    s = store_standing(tmp_path / "map")
    assert s["chunks_done"] == s["chunks"] and s["points_done"] == 99 and s["rate"] > 0 and not s["running"]
    assert sum(s["regimes"].values()) == 99 and s["regimes"] == {Regime(k).label: n for k, n in seen[-1][3].items()}
    with pytest.raises(OutputError, match="no store of a sweep"):
        store_standing(tmp_path)


def test_ctrl_c_keeps_what_is_done(tmp_path, whole):
    """Also through the program: exit 130, how to go on, and the same bytes afterwards."""
    place = tmp_path / "map"
    command = [sys.executable, "-c", "from whirlmap.cli.main import run; run()", "map", "duffing", "--store", str(place),
               "--vary", "gamma=0.2:0.6:40", "--vary", "omega=1:1.4:40", "--chunk", "8"]  # fmt: skip
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env={**os.environ, "PYTHONUNBUFFERED": "1"},
                               preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))  # fmt: skip
    receipts = place / "chunks" / "receipt" / "c"
    while process.poll() is None and not any(p.is_file() for p in receipts.rglob("*")):
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    said = process.communicate(timeout=60)[1]
    assert process.returncode == 130, said
    assert "chunks done and kept" in said and "--resume" in said
    s = store_standing(place)
    assert 0 < s["chunks_done"] < s["chunks"] and not list(place.rglob("*.partial"))


def test_wrong_options_are_refused(duffing, tmp_path):
    for options, says in (
        ({"vary": {"gamma": GRID["gamma"]}, "refine": True}, "exactly two"), ({"share": (3, 2)}, "share 3/2"),
        ({"share": (1, 2), "store": None}, "give the store"), ({"cluster": "tcp://nowhere:1", "store": None}, "give one"),
        ({"vary": {"gamma": [0.3, 0.2]}}, "ascend"), ({"vary": {"gama": [0.2, 0.3]}}, "gamma"), ({"vary": {}}, "no varied"),
        ({"chunk": 0}, "chunk must"), ({"lyapunov": 3}, "lyapunov must"),
    ):  # fmt: skip
        options = {"vary": GRID, "store": tmp_path / "map", **options}
        with pytest.raises(RangeError, match=says):
            regime_map(duffing, options.pop("vary"), **options)
    with pytest.raises(OutputError, match="does not exist"):
        regime_map(duffing, GRID, store=tmp_path / "nowhere" / "map")
    assert list(tmp_path.iterdir()) == []


def test_systems_go_to_other_machines_whole():
    """The gear pair, its tables and limits too, labels the same there: what Dask sends must lose nothing."""
    cloudpickle = pytest.importorskip("cloudpickle")
    system = whirlmap.load("gear-psfd/reference")
    again = cloudpickle.loads(cloudpickle.dumps(system))
    quantities = [(*s.model.states, *s.model.parameters) for s in (system, again)]
    for a, b in zip(*quantities, strict=True):
        assert a.__getnewargs_ex__() == b.__getnewargs_ex__()
    labelling, at = Labelling(Settling(transient=10, most=2, keep=4), 0), {"s": np.array([0.7])}
    one, two = (measure(s, at, labelling, Execution(workers=1))[0].returns.extremes["rms"] for s in (system, again))
    np.testing.assert_array_equal(one, two)


def test_the_manifest_says_what_the_store_is_of(whole):
    manifest = json.loads((whole / "chunks" / "zarr.json").read_text())["attributes"][MANIFEST]
    assert manifest["parameters"] == {"delta": 0.3, "alpha": -1.0, "beta": 1.0}
    assert (manifest["shape"], manifest["chunk"]) == ([11, 9], [6, 1])


@pytest.mark.slow
@pytest.mark.timeout(1800)  # four minutes alone on two cores
def test_a_large_refined_map_takes_a_quarter_of_the_points(duffing):
    axes = {"gamma": np.linspace(0.1, 0.7, 400), "omega": np.linspace(0.6, 1.6, 300)}
    refined = regime_map(duffing, axes, refine=True)
    full = regime_map(duffing, axes)
    computed = refined["evaluation"].values == Evaluation.computed
    assert computed.mean() <= 0.25
    assert (refined["regime"] != full["regime"]).mean() < 0.01
    np.testing.assert_array_equal(refined["rms"].values[computed], full["rms"].values[computed])
