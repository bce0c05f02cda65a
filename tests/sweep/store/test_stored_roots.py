"""A store keeps the way of roots and reciprocals that it was begun with, and is continued with it or not at all."""

import json

import numpy as np
import pytest
import xarray as xr

import whirlmap
from whirlmap.analysis.steady.settling import Settling
from whirlmap.errors import OutputError
from whirlmap.kernels.running import machine
from whirlmap.sweep.maps.regime_map import regime_map
from whirlmap.sweep.store.store_status import store_standing
from whirlmap.sweep.store.zarr_store import Store, differences

GRID = {"s": np.linspace(2.0, 2.5, 6)}
SHORT = Settling(transient=10, most=2, keep=2)


@pytest.fixture(scope="module")
def rotor():
    """Its film asks for roots and reciprocals."""
    return whirlmap.load("jeffcott")


def made(system, place, **options):
    return regime_map(system, GRID, store=place, settling=SHORT, lyapunov=0, chunk=1, workers=2, **options)


@pytest.fixture
def divided(rotor, tmp_path, monkeypatch):
    """Half of a store that was begun with divisions."""
    monkeypatch.setenv("WHIRLMAP_ROOTS", "divisions")
    made(rotor, tmp_path / "half", share=(1, 2))
    return tmp_path / "half"


def forget(place, *names):
    """Take keys out of a manifest, as a store of an older version lacks them."""
    path = place / "chunks" / "zarr.json"
    data = json.loads(path.read_text())
    for name in names:
        del data["attributes"]["manifest"][name]
    path.write_text(json.dumps(data))


def test_the_manifest_and_the_attributes_say_it(divided):
    manifest = Store(divided).manifest
    assert manifest["roots"] == {"plain": "divisions", "tables": "divisions"}
    assert manifest["processor"] == machine.processor()[0]
    attributes = xr.open_zarr(divided).attrs
    assert attributes["roots"] == "divisions" and attributes["processor"] == machine.processor()[0]


def test_a_store_goes_on_with_the_choice_that_it_was_begun_with(rotor, divided, tmp_path, monkeypatch):
    if not machine.estimates():
        pytest.skip("this processor has no estimates of whole vectors")
    made(rotor, tmp_path / "divisions")
    monkeypatch.setenv("WHIRLMAP_ROOTS", "estimates")
    other = made(rotor, tmp_path / "estimates")
    told = []
    found = made(rotor, divided, resume=True, on_chunk=lambda p: told.extend(p.messages))
    assert differences(divided, tmp_path / "divisions") == []
    assert "roots and reciprocals as the store was begun: divisions; a new store would have estimates" in told
    assert (found["regime"] == other["regime"]).all()  # what differs is rounding, and something does
    assert not np.array_equal(found["rms"].values, other["rms"].values)
    np.testing.assert_allclose(found["rms"], other["rms"], rtol=1e-6)


def test_a_share_joins_with_the_stores_choice(rotor, divided, tmp_path, monkeypatch):
    made(rotor, tmp_path / "divisions")
    monkeypatch.delenv("WHIRLMAP_ROOTS")
    made(rotor, divided, share=(2, 2))
    assert differences(divided, tmp_path / "divisions") == []


def test_force_begins_with_this_processors_choice(rotor, divided, monkeypatch):
    if not machine.estimates():
        pytest.skip("this processor has no estimates of whole vectors")
    monkeypatch.setenv("WHIRLMAP_ROOTS", "estimates")
    made(rotor, divided, force=True)
    assert Store(divided).manifest["roots"]["plain"] == "estimates"


def test_what_this_processor_cannot_compute_is_refused(rotor, divided, monkeypatch):
    path = divided / "chunks" / "zarr.json"
    path.write_text(path.read_text().replace('"plain": "divisions"', '"plain": "estimates"'))
    monkeypatch.delenv("WHIRLMAP_ROOTS")
    monkeypatch.setattr(machine, "_host", lambda: ("znver3", {}, "+avx2,+fma"))
    with pytest.raises(OutputError, match="by estimates, which kernels for znver3 do not have: continue it where"):
        made(rotor, divided, resume=True)


def test_another_processor_is_refused_by_name(rotor, divided, monkeypatch):
    own = machine._host()
    other = "znver4" if own[0] != "znver4" else "znver3"
    monkeypatch.setattr(machine, "_host", lambda: (other, *own[1:]))
    with pytest.raises(OutputError, match=f"processor: the store has {own[0]}, this run {other}"):
        made(rotor, divided, resume=True)


def test_an_older_store_opens_but_is_not_continued(rotor, divided):
    before = xr.open_zarr(divided).load()
    forget(divided, "roots", "processor")
    xr.testing.assert_identical(xr.open_zarr(divided).load(), before)
    assert store_standing(divided)["chunks_done"] == 3
    with pytest.raises(OutputError, match="did not record whether roots are taken by estimates or by divisions"):
        made(rotor, divided, resume=True)
