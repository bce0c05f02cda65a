"""The design of the search: inside its ranges, nested, even, and the same for a seed; and the readings that are searched."""

import numpy as np
import pytest

import whirlmap
from whirlmap.errors import CaseError, ModelError, RangeError
from whirlmap.models import family
from whirlmap.studies.gear_psfd.search.ranges import Range, design, digest, ranges
from whirlmap.studies.gear_psfd.search.variants import VARIANTS, Variant, chosen

LITERAL, INTENDED = ({p.name for p in family("gear_pair").model(edition=e).parameters} for e in ("literal", "intended"))


def test_every_unpublished_group_has_a_range_and_a_reason():
    named = {r.name for r in ranges()}
    known = {"s", "psi", "r_p", "r_g", "r_m", "j_p", "j_g", "chi_p", "chi_g"}  # given, or a matter of the variant
    assert named == (LITERAL | INTENDED) - known
    assert all(len(r.why) > 10 for r in ranges())


def test_the_reference_machine_lies_inside():
    system = whirlmap.load("gear-psfd/reference")
    literal = whirlmap.load("gear-psfd/literal")
    for r in ranges():
        value = float((system if r.name in system.parameters else literal).values[r.name])
        assert r.low <= value <= r.high, r.name


def test_blocks_nest():
    whole = design(ranges(), 0, 64, seed=3)
    parts = [design(ranges(), first, 16, seed=3) for first in (0, 16, 32, 48)]
    np.testing.assert_array_equal(np.concatenate(parts, axis=1), whole)
    np.testing.assert_array_equal(design(ranges(), 0, 21, seed=3), whole[:, :21])
    assert not np.array_equal(design(ranges(), 0, 64, seed=4), whole)


def test_the_design_is_even():
    """Each eighth of each range holds an eighth of 512 sets, exactly: what a Sobol sequence promises."""
    sets = design(ranges(), 0, 512, seed=1)
    for k, r in enumerate(ranges()):
        places = r.place(sets[k])
        assert np.all((places >= 0) & (places <= 1))
        assert np.histogram(places, 8, (0, 1))[0].tolist() == [64] * 8


@pytest.mark.parametrize("scale", ["log", "linear"])
def test_places_are_the_reverse_of_values(scale):
    r = Range("x", 0.1, 40.0, scale, "why")
    u = np.linspace(0, 1, 11)
    np.testing.assert_allclose(r.place(r.at(u)), u, atol=1e-15)
    assert (r.at(0.0), r.at(1.0)) == pytest.approx((0.1, 40.0))


@pytest.mark.parametrize("bad", [(1.0, 1.0, "log"), (0.0, 1.0, "log"), (0.0, 1.0, "cubic"), (2.0, 1.0, "linear")])
def test_ranges_that_are_none_are_refused(bad):
    with pytest.raises(ModelError, match="x"):
        Range("x", *bad, "why")


def test_the_reason_alone_changes_no_search():
    one, other = Range("x", 1.0, 2.0, "log", "why"), Range("x", 1.0, 2.0, "log", "because")
    assert digest((one,)) == digest((other,)) != digest((Range("x", 1.0, 3.0, "log", "why"),))


def test_every_variant_is_a_system_of_its_own():
    assert len({v.name for v in VARIANTS}) == len(VARIANTS) == len(set(VARIANTS))
    for v in VARIANTS:
        system = v.system()
        assert system.common_multiple == 8
        assert dict(system.model.switches) | {"edition": v.edition, "film": v.film} == dict(system.model.switches)
        assert bool(system.model.stops) == (v.contact == "stop")


@pytest.mark.parametrize(
    "variant",
    [Variant("literal", "porous", "positive", "shaft"), Variant("intended", "porous", "fixed", "still"),
     Variant("intended", "porous", "positive", "shaft", "ignore")],
)  # fmt: skip
def test_meaningless_readings_are_refused_by_the_model(variant):
    with pytest.raises(CaseError):
        variant.system()


def test_variants_are_chosen_by_name_and_edition():
    assert chosen((), ()) == VARIANTS
    assert {v.edition for v in chosen(("literal",), ())} == {"literal"}
    assert [v.name for v in chosen((), (VARIANTS[3].name,))] == [VARIANTS[3].name]
    with pytest.raises(RangeError, match="intended"):
        chosen(("intendd",), ())
    with pytest.raises(RangeError, match="intended-porous-fixed-shaft"):
        chosen((), ("intended-porous-fixed-shft",))
    with pytest.raises(RangeError, match="belongs"):
        chosen(("literal",), ("intended-porous-fixed-shaft",))
