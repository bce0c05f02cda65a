"""A sweep killed again and again, its workers and its coordinator too, ends in the same bytes as one left alone."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from whirlmap.sweep.store.store_status import store_standing
from whirlmap.sweep.store.zarr_store import Store, differences

#: Forks a process for every request, so that a kill costs no new import; says its number, and how it ended.
FORKING = """
import json, os, sys
import numpy as np
import distributed, zarr
import whirlmap
from whirlmap.analysis.steady.settling import Settling
from whirlmap.sweep.maps.regime_map import regime_map
system, settling = whirlmap.load("duffing"), Settling(transient=40, most=8, keep=8)
vary = {"gamma": np.linspace(0.2, 0.6, 24), "omega": np.linspace(1.0, 1.4, 20)}
whirlmap.label_points(system, {"gamma": [0.2, 0.5]}, settling=settling, workers=1)  # the kernels are there now
print("ready", flush=True)
for line in sys.stdin:
    options = json.loads(line)
    child = os.fork()
    if child == 0:
        os.dup2(os.open(os.devnull, os.O_RDWR), 0)
        try:
            regime_map(system, vary, settling=settling, resume=True, chunk=6, **options)
        except BaseException as fault:
            sys.stderr.write(f"{type(fault).__name__}: {fault}\\n")
            os._exit(3)
        os._exit(0)
    print(child, flush=True)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""

#: A cluster whose workers are killed on request; replaced by its nannies.
CLUSTER = """
import os, random, signal, sys
from distributed import LocalCluster
if __name__ == "__main__":
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster:
        print(cluster.scheduler_address, flush=True)
        for line in sys.stdin:
            alive = [w.pid for w in cluster.workers.values() if w.pid]
            if alive:
                os.kill(random.choice(alive), signal.SIGKILL)
            print(len(alive), flush=True)
"""


class Script:
    """A Python process that is spoken to by lines."""

    def __init__(self, folder: Path, name: str, text: str) -> None:
        path = folder / f"{name}.py"
        path.write_text(text)
        with (folder / f"{name}.log").open("w") as log:
            self.process = subprocess.Popen(
                [sys.executable, str(path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, text=True
            )
        self.first = self.line()

    def line(self) -> str:
        return self.process.stdout.readline().strip()

    def say(self, text: str) -> None:
        self.process.stdin.write(f"{text}\n")
        self.process.stdin.flush()

    def end(self) -> None:
        self.process.stdin.close()
        self.process.wait(30)
        self.process.stdout.close()


@contextmanager
def script(folder: Path, name: str, text: str):
    made = Script(folder, name, text)
    try:
        yield made
    finally:
        made.end()


def committed(store: Path) -> int:
    folder = store / "chunks" / "receipt" / "c"
    return sum(path.is_file() and path.suffix != ".partial" for path in folder.rglob("*")) if folder.is_dir() else 0


def start(runs: Script, store: Path, **options: str) -> int:
    runs.say(json.dumps({"store": str(store), **options}))
    return int(runs.line())


def wait_for(store: Path, more: int, seconds: float) -> None:
    """Until so many chunks more are committed, and a moment of chance later."""
    begun, goal = time.monotonic(), committed(store) + more
    while committed(store) < goal and time.monotonic() - begun < seconds:
        time.sleep(0.005)


@pytest.mark.parametrize(("alone", "clustered"), [(5, 2), pytest.param(12, 5, marks=pytest.mark.slow)])
def test_a_sweep_survives_being_killed(alone, clustered, tmp_path):
    chance = random.Random(20)
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    kills = {"process": 0, "worker": 0, "coordinator": 0}
    with script(tmp_path, "runs", FORKING) as runs:
        assert runs.first == "ready", (tmp_path / "runs.log").read_text()
        start(runs, whole)
        assert runs.line() == "0", (tmp_path / "runs.log").read_text()
        for k in range(alone):  # the first of them while the store is being made
            child = start(runs, broken)
            if k < 3:
                time.sleep(chance.uniform(0.0, 0.1))
            else:
                wait_for(broken, chance.randrange(3), 20)
                time.sleep(chance.uniform(0.0, 0.15))
            os.kill(child, signal.SIGKILL)
            kills["process"] += runs.line() == str(-signal.SIGKILL)
        with script(tmp_path, "cluster", CLUSTER) as cluster:
            for _ in range(clustered):
                child = start(runs, broken, cluster=cluster.first)
                wait_for(broken, chance.randrange(3), 20)
                cluster.say("kill")
                kills["worker"] += cluster.line() != "0"
                wait_for(broken, 1 + chance.randrange(2), 20)
                time.sleep(chance.uniform(0.0, 0.1))
                os.kill(child, signal.SIGKILL)
                kills["coordinator"] += runs.line() == str(-signal.SIGKILL)
            left = store_standing(broken)
            assert 0 < left["chunks_done"] < left["chunks"], "everything was done before the last kill"
            start(runs, broken, cluster=cluster.first)
            assert runs.line() == "0", (tmp_path / "runs.log").read_text()
        start(runs, broken)  # sweeps away what the killed left
        assert runs.line() == "0"
    assert sum(kills.values()) >= alone + 2 * clustered - 2, kills  # a run may end before its kill
    assert Store(broken).standing().done.size == Store(whole).chunks.count == 80
    assert differences(whole, broken) == []
    assert not list(tmp_path.glob(".broken.*"))
