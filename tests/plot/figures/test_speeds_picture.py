"""Pictures of safe speeds: the whole range has a ground, in every panel; an interrupted comparison can be drawn."""

from functools import partial
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.patches import Rectangle

import whirlmap
from whirlmap.plot.figures.improve import improve_figure
from whirlmap.plot.figures.speeds import LOOKS, speeds_figure
from whirlmap.sweep.speeds.verdicts import Verdict

RIG = "machines/jeffcott-rig"


@pytest.fixture(scope="module")
def judged():
    return whirlmap.safe_speeds(whirlmap.load(RIG), np.linspace(0.5, 2.2, 18), 0.6)


def test_no_part_of_the_range_is_without_a_ground(judged):
    fig = speeds_figure(judged, unit=100.0, length="um", force=3.9, force_unit="N")
    assert [ax.get_ylabel() for ax in fig.axes] == ["peak to peak [um]", "film [um]", "load [N]"]
    for ax in fig.axes:
        spans = sorted((p.get_x(), p.get_x() + p.get_width()) for p in ax.patches if isinstance(p, Rectangle))
        assert spans[0][0] <= ax.get_xlim()[0] and spans[-1][1] >= ax.get_xlim()[1] and len(spans) >= 3
        assert all(a[1] == pytest.approx(b[0]) for a, b in pairwise(spans))


def test_every_verdict_has_a_look():
    assert set(LOOKS) == {v.name for v in Verdict} and len({look for look, _ in LOOKS.values()}) == len(LOOKS)


def test_an_incomplete_grid_of_designs_is_drawn():
    vary = {"c": [80, 120], "Gamma": [1.0, 2.0]}
    ds = whirlmap.improve(partial(whirlmap.load, RIG), vary, [0.5, 1.0, 2.0], 0.6, units={"c": "um"}, refine=False)
    part = ds.isel(design=slice(0, 3)).assign_attrs(widest=0, calmest=0)
    filled = improve_figure(part).axes[0].collections[0].get_array()
    assert np.isfinite(np.ma.filled(filled, np.nan)).sum() == 3
