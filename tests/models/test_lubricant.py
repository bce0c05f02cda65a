"""Oil viscosity against the worked examples of the standards."""

import numpy as np
import pytest

from whirlmap.errors import CaseError
from whirlmap.models.lubricant import _TABLE, ISO_VG, at_100, by_grade, by_two_points, viscosity_index, walther


@pytest.mark.parametrize(("nu_40", "nu_100", "index"), [(73.30, 8.86, 92), (22.83, 5.05, 156)])
def test_viscosity_index_of_the_standards_examples(nu_40, nu_100, index):
    """The two worked examples of ASTM D2270, procedures A and B."""
    assert round(viscosity_index(nu_40, nu_100)) == index


def test_the_pieces_of_the_table_meet():
    """L and H are smooth functions in the standard's table; the fits meet to 0.5 %."""
    for Y, *_ in _TABLE[1:]:
        for which in (slice(1, 4), slice(4, 7)):
            below = np.polyval(_TABLE[_TABLE[:, 0] < Y][-1][which], Y)
            assert np.polyval(_TABLE[_TABLE[:, 0] == Y][0][which], Y) == pytest.approx(below, rel=5e-3)


@pytest.mark.parametrize("grade", [g for g in ISO_VG if 10 <= g <= 680])
def test_index_and_viscosity_at_100_degrees_are_inverse(grade):
    for index in (80.0, 95.0, 120.0):
        assert viscosity_index(grade, at_100(grade, index)) == pytest.approx(index, abs=0.5)


def test_a_turbine_oil():
    """ISO VG 32 and 46 with index 100 have about 5.4 and 6.9 mm2/s at 100 degC in every table of oils."""
    assert at_100(32, 100) == pytest.approx(5.4, abs=0.1)
    assert at_100(46, 100) == pytest.approx(6.8, abs=0.15)


def test_walther_goes_through_its_points_and_is_straight_between():
    assert walther(46, 6.8, 40) == pytest.approx(46, rel=1e-12)
    assert walther(46, 6.8, 100) == pytest.approx(6.8, rel=1e-12)
    T = np.array([20.0, 60.0, 80.0, 120.0])
    y = np.log10(np.log10([walther(46, 6.8, float(x)) + 0.7 for x in T]))
    slopes = np.diff(y) / np.diff(np.log10(T + 273.15))
    np.testing.assert_allclose(slopes, slopes[0], rtol=1e-10)


def test_both_ways_are_one():
    assert by_grade(46, 100, 65, 860) == pytest.approx(by_two_points(46e-6, at_100(46, 100) * 1e-6, 65, 860), rel=1e-12)
    assert 0.012 < by_grade(46, 100, 65, 860) < 0.020


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: at_100(40, 100), "nearest is 46"), (lambda: at_100(46, 900), "cannot have"),
        (lambda: walther(5, 6, 50), "less at 100"), (lambda: walther(5, 1, 50), "at least 2"),
    ],
)  # fmt: skip
def test_oils_that_are_none_are_refused(call, words):
    with pytest.raises(CaseError, match=words):
        call()
