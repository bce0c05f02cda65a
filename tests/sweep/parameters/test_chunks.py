"""How the grid of a sweep is cut into chunks, and which points stand for it."""

import numpy as np

import whirlmap
from whirlmap.sweep.parameters.space import Chunks, Space, chunk_size, pilot_points, table_parameters


def test_chunks_tile_the_grid():
    chunks = Chunks((11, 9), (4, 5))
    seen = np.zeros((11, 9), dtype=int)
    for k in range(chunks.count):
        seen[chunks.index(k)] += 1
        assert chunks.points(k) == chunks.index(k)[0].size
    assert (seen == 1).all()
    shares = [list(chunks.share(i, 4)) for i in (1, 2, 3, 4)]
    assert sorted(k for share in shares for k in share) == list(range(chunks.count))


def test_chunks_hold_few_values_of_a_parameter_with_tables():
    model = whirlmap.load("gear-psfd/machine").model
    assert table_parameters(model) == {"psi"}
    axes = {"psi": np.geomspace(1e-5, 1, 300), "s": np.linspace(0.3, 4, 400)}
    assert chunk_size(Space(axes), model, 100) == (1, 100)
    assert chunk_size(Space(axes), model, 1300) == (3, 400)


def test_the_pilot_has_few_tables_and_lies_in_the_space():
    model = whirlmap.load("gear-psfd/machine").model
    axes = {"psi": np.geomspace(1e-5, 1, 300), "s": np.linspace(0.3, 4, 400)}
    psi, s = pilot_points(Space(axes), model, 64)
    assert psi.size == s.size == 64 and np.unique(psi).size == 4 and np.unique(s).size == 16
    assert (psi.min(), psi.max(), s.min(), s.max()) == (0, 299, 0, 399)
    for small in ({"psi": axes["psi"]}, {"s": axes["s"]}, {"s": axes["s"][:3], "psi": axes["psi"][:2]}):
        index, shape = pilot_points(Space(small), model, 64), Space(small).shape
        assert len(index) == len(shape) and 1 <= index[0].size <= 64
        assert all(i.max() < n for i, n in zip(index, shape, strict=True))
    plain = Space({"gamma": axes["s"], "omega": axes["s"]})
    assert [i.size for i in pilot_points(plain, whirlmap.load("duffing").model, 1)] == [1, 1]
