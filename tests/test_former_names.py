"""Names that have changed work for one release, with a warning that says the new one."""

import pytest

import whirlmap
from whirlmap import cases
from whirlmap.analysis.simulation.surface_crossings import surface_crossings
from whirlmap.assumptions.violations import violations


def test_the_former_name_of_surface_crossings_warns_and_works():
    with pytest.warns(DeprecationWarning, match="whirlmap.switchings is now whirlmap.surface_crossings"):
        assert whirlmap.switchings is surface_crossings


def test_the_former_names_of_resolved_cases_warn_and_work():
    with pytest.warns(DeprecationWarning, match="cases.settle is now whirlmap.cases.resolve"):
        assert cases.settle is cases.resolve
    with pytest.warns(DeprecationWarning, match="cases.Settled is now whirlmap.cases.Resolved"):
        assert cases.Settled is cases.Resolved


def test_the_rotation_number_is_written_under_both_names():
    ds = whirlmap.label_points(whirlmap.load("duffing", gamma=0.2), {"gamma": [0.2, 0.21]})
    assert ds["rotation_number"].identical(ds["winding"].rename("rotation_number").assign_attrs(ds["rotation_number"].attrs))
    assert ds["winding"].attrs["long_name"].startswith("former name of rotation_number")


def test_the_former_keyword_of_sections_and_exponents_warns_and_works():
    duffing = whirlmap.load("duffing", gamma=0.2)
    with pytest.warns(DeprecationWarning, match=r"section\(periods=...\) is section\(points=...\) now"):
        assert whirlmap.section(duffing, periods=4, transient=4).sizes["period"] == 4
    with pytest.warns(DeprecationWarning, match=r"lyapunov_spectrum\(common_periods=...\) now"):
        assert whirlmap.lyapunov_spectrum(duffing, periods=16, transient=4, starts=2).sizes["period"] == 16
    with pytest.raises(TypeError, match="section: found the keyword 'periods'"):
        whirlmap.section(duffing, periods=4, points=4)


def test_the_former_name_of_violated_assumptions_warns_and_works():
    with pytest.warns(DeprecationWarning, match=r"strained\.strained is now whirlmap\.assumptions\.violations\.violations"):
        from whirlmap.assumptions.strained import strained
    assert strained is violations
