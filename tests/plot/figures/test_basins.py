"""Pictures of basins: every start in its attractor's colour, and what has none drawn as what it is."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_rgb

from whirlmap.plot.figures.basins import COLOURS, attractors_figure, basins_figure
from whirlmap.results.regime import Regime


@pytest.fixture
def slice_of_basins():
    """Four by five starts: two attractors, and one column each in contact, diverged and undecided."""
    of = np.array([[1, 2, 0, 0, 0]] * 4)
    kinds = [Regime.periodic, Regime.chaotic, Regime.contact, Regime.diverged, Regime.undecided]
    regime = np.array([kinds] * 4, dtype=np.int8)
    section = np.full((2, 100, 2), np.nan)
    section[0, 0], section[1] = (0.1, 0.2), np.random.default_rng(1).uniform(-1, 1, (100, 2))
    return xr.Dataset(
        {
            "attractor_of": (("x", "v"), of), "start_regime": (("x", "v"), regime),
            "regime": ("attractor", np.array([Regime.periodic, Regime.chaotic], dtype=np.int8)),
            "period_T": ("attractor", [3, 0]), "share": ("attractor", [0.2, 0.2]), "starts": ("attractor", [4, 4]),
            "section": (("attractor", "member", "state"), section), "outcome_share": ("outcome", [0.2, 0.2, 0.2]),
        },
        {
            "x": np.linspace(-1, 1, 4), "v": np.linspace(-1, 1, 5), "attractor": [1, 2], "state": ["x", "v"],
            "outcome": ["contact", "diverged", "undecided"],
        },
    )  # fmt: skip


def test_every_start_has_its_colour_and_no_other_end_is_an_attractor(slice_of_basins):
    fig = basins_figure(slice_of_basins)
    ax = fig.axes[0]
    meshes = {mesh.get_gid(): mesh for mesh in ax.collections if mesh.get_gid()}
    fig.draw_without_rendering()
    faces = meshes["basins"].get_facecolors().reshape(5, 4, 4)[:, 0, :3]
    for row, colour in ((0, COLOURS[0]), (1, COLOURS[1])):
        assert np.argmax(faces[row]) == np.argmax(to_rgb(colour)) and not (faces[row] == 1).all()
    assert (faces[2:] == 1).all()  # white beneath what is drawn over it
    for kind, row in (("contact", 2), ("diverged", 3), ("undecided", 4)):
        shown = ~np.ma.getmaskarray(meshes[f"ended-{kind}"].get_array()).reshape(5, 4)
        assert shown[row].all() and shown.sum() == 4
    words = [t.get_text() for t in fig.legends[0].get_texts()]
    names = ["1: periodic, 3T", "2: chaotic", "contact", "diverged", "undecided"]
    assert words == [f"{name} (20.0%)" for name in names]


def test_starts_are_drawn_by_their_attractor(slice_of_basins):
    x, v = np.meshgrid(slice_of_basins["x"], slice_of_basins["v"], indexing="ij")
    ds = slice_of_basins.drop_vars(["x", "v"]).rename(x="i", v="j").stack(start=("i", "j")).reset_index("start", drop=True)
    ds = ds.drop_vars(["i", "j"], errors="ignore")
    ds["start_state"] = (("state", "start"), np.stack([x.ravel(), v.ravel()]))
    ax = attractors_figure(ds, "x", "v").axes[0]
    lines = {line.get_gid(): line for line in ax.lines}
    assert {"starts-1", "starts-2", "ended-contact", "ended-diverged", "ended-undecided", "attractor-1"} <= set(lines)
    assert len(lines["starts-1"].get_xdata()) == 4
