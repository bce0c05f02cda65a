"""A search by the workers of a Dask cluster: the same bits as by this process, and clear words where it cannot be."""

import numpy as np
import pytest
from distributed import Client, LocalCluster
from tests.studies.gear_psfd.search.test_identify import BRIEF, QUICK, same

from whirlmap.errors import OutputError
from whirlmap.options.execution import Execution
from whirlmap.studies.gear_psfd.search import identify, tasks
from whirlmap.studies.gear_psfd.search.blocks import Blocks
from whirlmap.studies.gear_psfd.search.identify import judged_so_far, search
from whirlmap.studies.gear_psfd.search.refine import refine


@pytest.fixture(scope="module")
def client():
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None, "silence_logs": 50}
    with LocalCluster(**options) as cluster, Client(cluster) as connected:
        yield connected


def test_a_cluster_computes_the_same_bits(client, monkeypatch):
    monkeypatch.setattr(identify, "BLOCK", 3)
    monkeypatch.setattr(tasks, "PART", 2)
    here, there, points = Blocks(None), Blocks(None), []
    names = list(search((QUICK,), BRIEF, here, sets=4))
    execution = Execution(cluster=client, progress=points.append)
    assert sorted(search((QUICK,), BRIEF, there, sets=4, execution=execution)) == names
    for name in names:
        same(there[name], here[name])
        assert there[name].sizes == here[name].sizes
    assert sum(points) == 4 * BRIEF.points
    assert max(points) == 2 * BRIEF.points  # parts, not whole blocks


@pytest.mark.slow  # two generations of a refinement, on a cluster and here
def test_a_cluster_refines_to_the_same_bits(client):
    here, there = Blocks(None), Blocks(None)
    for blocks in (here, there):
        list(search((QUICK,), BRIEF, blocks, sets=8))
    start = judged_so_far(there, QUICK, BRIEF)
    assert start is not None
    refined = [
        refine(start, BRIEF, blocks, generations=1, execution=Execution(cluster=c))
        for blocks, c in ((here, None), (there, client))
    ]
    np.testing.assert_array_equal(refined[0].score, refined[1].score)


def test_a_worker_with_other_kernels_is_refused(client, monkeypatch):
    monkeypatch.setattr(tasks, "kernel_hash", lambda *_: "another processor")
    with pytest.raises(OutputError, match="another version of whirlmap or its libraries, or another processor"):
        list(search((QUICK,), BRIEF, Blocks(None), sets=4, execution=Execution(cluster=client)))
