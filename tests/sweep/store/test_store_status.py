"""A store says that it is computed only while a process does so, and why an older one cannot be gone on with."""

import numpy as np
import pytest

import whirlmap
from whirlmap.errors import OutputError
from whirlmap.sweep.store.store_folder import at_work, remains, workers_at
from whirlmap.sweep.store.store_status import store_standing
from whirlmap.sweep.store.zarr_store import differences

VARY = {"gamma": np.linspace(0.2, 0.5, 6), "omega": np.linspace(1.0, 1.3, 5)}


def compute(folder, **options):
    settling = whirlmap.Settling(transient=20, most=4)
    return whirlmap.regime_map(
        whirlmap.load("duffing"), VARY, settling=settling, lyapunov=0, store=folder, chunk=6, workers=1, **options
    )


@pytest.fixture
def interrupted(tmp_path):
    """A store of which one chunk is done, and whether it said that it was running at that time."""
    folder, seen = tmp_path / "map", []

    def stop(now):
        if now.done:
            seen.append(store_standing(folder)["running"])
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        compute(folder, on_chunk=stop)
    return folder, seen


def test_an_interrupted_store_is_not_running(interrupted):
    folder, seen = interrupted
    now = store_standing(folder)
    assert seen == [True] and now["seconds_since"] < 60
    assert not now["running"] and 0 < now["chunks_done"] < now["chunks"]


def test_a_killed_one_counts_as_running_for_a_while_and_the_next_run_forgets_it(interrupted, tmp_path, monkeypatch):
    folder, _ = interrupted
    (folder / "chunks" / "at_work.0123.partial").touch()  # as a killed process leaves it
    assert store_standing(folder)["running"]
    monkeypatch.setattr("whirlmap.sweep.store.store_status.QUIET", 0.0)
    assert not store_standing(folder)["running"]
    notes = []
    compute(folder, resume=True, on_chunk=lambda now: notes.extend(now.messages))
    assert not workers_at(folder) and not any("half-written" in note for note in notes)
    compute(tmp_path / "whole")
    assert differences(folder, tmp_path / "whole") == []


def test_the_file_is_a_part_of_a_store(tmp_path):
    (tmp_path / "chunks").mkdir()
    with at_work(tmp_path), at_work(tmp_path):
        assert len(workers_at(tmp_path)) == 2 and remains(tmp_path)
    assert not workers_at(tmp_path)


def test_a_store_of_another_version_says_so(interrupted, monkeypatch):
    folder, _ = interrupted
    monkeypatch.setattr("whirlmap.sweep.maps.run_sweep.kernel_hash", lambda *_: "0" * 64)
    with pytest.raises(OutputError, match=r"made by another version of whirlmap or of its libraries.*\n  kernel: the store"):
        compute(folder, resume=True)
    monkeypatch.setattr("whirlmap.sweep.maps.manifest.__version__", "9.9")
    with pytest.raises(OutputError, match=r"another version.*\n  whirlmap_version: .*, this run 9\.9"):
        compute(folder, resume=True)
    with pytest.raises(OutputError, match="holds another sweep"):
        compute(folder, resume=True, steps=16)
