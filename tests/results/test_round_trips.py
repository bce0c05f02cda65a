"""Every kind of Dataset survives NetCDF and Zarr, with its numbers, its types and its attributes."""

from functools import partial

import numpy as np
import pytest
import xarray as xr

import whirlmap
from whirlmap.analysis.steady.settling import Settling
from whirlmap.results.files import read, write
from whirlmap.results.labels import labels

SHORT = {"settling": Settling(transient=20, most=4, keep=8)}
RIG = "machines/jeffcott-rig"


def duffing():
    return whirlmap.load("duffing", gamma=0.2)


def cloud():
    return np.random.default_rng(1).normal(size=(600, 2))


def signal():
    return np.sin(2 * np.pi * np.arange(1500) / 21.7)


KINDS = {
    "simulate": lambda: whirlmap.simulate(duffing(), periods=2),
    "ended": lambda: whirlmap.simulate(whirlmap.load("duffing", delta=-2.0, alpha=1.0, beta=0.0), periods=30),
    "section": lambda: whirlmap.section(duffing(), points=4, transient=8, starts=2),
    "section unforced": lambda: whirlmap.section(whirlmap.load("lorenz"), points=4, transient=8),
    "lyapunov_spectrum": lambda: whirlmap.lyapunov_spectrum(duffing(), transient=10, common_periods=16, starts=2),
    "floquet_multipliers": lambda: whirlmap.floquet_multipliers(duffing(), [0.9, 0.1], duffing().period),
    "power_spectrum": lambda: whirlmap.power_spectrum(signal(), rate=32),
    "full_spectrum": lambda: whirlmap.full_spectrum(signal(), signal()[::-1], rate=32),
    "correlation_dimension": lambda: whirlmap.correlation_dimension(cloud(), theiler=1),
    "diagnose": lambda: whirlmap.diagnose(duffing(), max_periods=64, points=200, **SHORT),
    "diagnose_series": lambda: whirlmap.diagnose_series(signal(), rate=100),
    "label_points": lambda: whirlmap.label_points(duffing(), {"gamma": [0.2, 0.5]}, lyapunov=0, ends=True, **SHORT),
    "bifurcation_diagram": lambda: whirlmap.bifurcation_diagram(duffing(), "gamma", [0.2, 0.21], follow="both", **SHORT),
    "waterfall": lambda: whirlmap.waterfall(duffing(), "gamma", [0.2, 0.21], "x", periods=16),
    "regime_map": lambda: whirlmap.regime_map(duffing(), {"gamma": [0.2, 0.3], "omega": [1.1, 1.2]}, lyapunov=0, **SHORT),
    "tolerance_sweep": lambda: whirlmap.tolerance_sweep(duffing(), {"gamma": "normal:3%"}, 3, lyapunov=0, **SHORT),
    "attractors": lambda: whirlmap.attractors(duffing(), starts=4, lyapunov=256, **SHORT),
    "basins": lambda: whirlmap.basins(duffing(), {"x": [-1.0, 1.0], "v": [0.0, 0.5]}, lyapunov=256, **SHORT),
    "safe_speeds": lambda: whirlmap.safe_speeds(whirlmap.load(RIG), [0.5, 0.6], 0.6, follow=False, **SHORT),
    "improve": lambda: whirlmap.improve(
        partial(whirlmap.load, RIG), {"Gamma": [0.1, 0.2]}, [0.5, 0.6], 0.6, refine=False, follow=False, **SHORT
    ),
    "campbell": lambda: whirlmap.campbell(whirlmap.load("jeffcott"), "s", [1.0, 1.5, 2.0]),
    "in_units": lambda: whirlmap.in_units(whirlmap.load(RIG), whirlmap.simulate(whirlmap.load(RIG), periods=1)),
}


def same(back, ds, where):
    assert set(back.variables) == set(ds.variables) and dict(back.sizes) == dict(ds.sizes)
    for name in ds.variables:
        was, now = ds[name], back[name]
        np.testing.assert_array_equal(now.values, was.values, err_msg=f"{where}: {name}")
        assert now.dtype.kind == was.dtype.kind or {now.dtype.kind, was.dtype.kind} <= set("OUT"), (where, name)
        assert was.dims == now.dims and set(was.attrs) == set(now.attrs), (where, name)
        for key, value in was.attrs.items():
            np.testing.assert_array_equal(now.attrs[key], value, err_msg=f"{where}: {name}.{key}")
    assert set(back.attrs) == set(ds.attrs)
    for key, value in ds.attrs.items():
        np.testing.assert_array_equal(back.attrs[key], value, err_msg=f"{where}: {key}")


@pytest.mark.parametrize("kind", KINDS)
def test_numbers_types_and_attributes_come_back(kind, tmp_path):
    ds = KINDS[kind]().load().drop_encoding()
    assert ds.data_vars and all("units" in v.attrs and "long_name" in v.attrs for v in ds.data_vars.values())
    write(ds, tmp_path / "a.nc")
    ds.to_zarr(tmp_path / "a.zarr", zarr_format=2, consolidated=False)
    with xr.open_zarr(tmp_path / "a.zarr", consolidated=False) as lazy:
        for where, back in (("NetCDF", read(tmp_path / "a.nc")), ("Zarr", lazy.load())):
            same(back, ds, where)
            for name in ("regime", "status", "verdict"):
                if name in ds:
                    assert (labels(back, name).values == labels(ds, name).values).all()
                    assert (labels(back, name).values != "").all()
