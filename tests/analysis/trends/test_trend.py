"""Trends of sections: found for many points at once, no bit of a point depending on those beside it."""

import numpy as np

from whirlmap.analysis.trends.trend import trend


def test_a_points_trend_does_not_depend_on_its_company():
    rng = np.random.default_rng(7)
    rate = np.linspace(-0.02, 0.03, 17)
    row = np.arange(256)[:, None, None]
    section = rng.normal(size=(1, 20, 17)) * np.exp(rate * row) * np.cos(2.4 * row + rng.normal(size=(1, 20, 1)))
    together = trend(section)
    alone = [trend(section[:, :, [k]]) for k in range(17)]
    assert np.isfinite(together.growth).sum() > 12
    np.testing.assert_array_equal(together.growth, np.concatenate([t.growth for t in alone]))
    np.testing.assert_array_equal(together.drift, np.concatenate([t.drift for t in alone], axis=1))
    steady = np.isfinite(together.growth)
    np.testing.assert_allclose(together.growth[steady], rate[steady], rtol=0.05, atol=2e-4)
