"""Points that do not return stop when they are labelled and sure enough, each by itself."""

import numpy as np

import whirlmap
from whirlmap.analysis.open_points import ENOUGH
from whirlmap.sweep.points import label_points

GAMMA = {"gamma": np.array([0.35, 0.41, 0.45, 0.5, 0.54, 0.58])}


def labelled(values, **options):
    options = {"settling": whirlmap.Settling(transient=200), "lyapunov": 2048} | options
    return label_points(whirlmap.load("duffing"), values, **options)


def test_a_point_stops_by_its_own_error():
    ds = labelled(GAMMA)
    ran = ds["lyapunov_periods"].values
    measured = ran > 0
    assert set(ran[measured].tolist()) <= {256, 512, 1024, 2048}
    assert len(set(ran[measured].tolist())) > 1  # not all as long as each other
    target = np.maximum(ENOUGH[0] * np.abs(ds["lyapunov"]), ENOUGH[1]).values
    early = measured & (ran < 2048)
    assert early.any() and (ds["lyapunov_error"].values[early] <= target[early]).all()


def test_bits_do_not_depend_on_the_company():
    whole = labelled(GAMMA)
    for k in range(GAMMA["gamma"].size):
        alone = labelled({"gamma": GAMMA["gamma"][k : k + 1]})
        for name in ("regime", "lyapunov", "lyapunov_error", "lyapunov_periods", "confidence", "winding"):
            np.testing.assert_array_equal(alone[name].values, whole[name].values[k : k + 1], name)


def test_the_exponent_of_known_chaos_is_within_its_error():
    """known_values.md: 0.1057 +- 0.001 at gamma = 0.5 for delta 0.3, omega 1.2."""
    ds = labelled({"gamma": np.array([0.5])}, lyapunov=16384)
    assert abs(float(ds["lyapunov"][0]) - 0.1057) < 4 * float(ds["lyapunov_error"][0]) + 0.002
