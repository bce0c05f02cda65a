"""The page as one file: what it shows is what Python finds, with units, sections, spectra; what cannot go there is said."""

import html

import numpy as np
import pytest
from sympy import erf
from tests.explorer.saved.node import needs_node, ran, shown
from typer.testing import CliRunner

import whirlmap
from whirlmap.analysis.spectra.line_names import named_shares
from whirlmap.analysis.spectra.spectral_lines import spectral_lines
from whirlmap.analysis.spectra.spectrum import power_spectrum
from whirlmap.cli.main import app
from whirlmap.equations import Model, Parameter, State, Stop, cos, t
from whirlmap.errors import InputError, OutputError
from whirlmap.explorer.coexisting import coexisting
from whirlmap.explorer.encoding import decoded, json_text
from whirlmap.explorer.exploration import Exploration, of_result
from whirlmap.explorer.jobs import Job
from whirlmap.explorer.saved.packing import text_of
from whirlmap.explorer.saved.saved_page import saved_data, saved_page
from whirlmap.integrate.in_units import in_units
from whirlmap.integrate.system import System

WANTED = 1e-9


@pytest.fixture(scope="module")
def duffing():
    ds = whirlmap.bifurcation_diagram(whirlmap.load("duffing"), "gamma", [0.2, 0.28, 0.29], lyapunov=0)
    return of_result(ds, "duffing.nc")


@needs_node
def test_returns_sections_and_series_are_those_of_python(duffing):
    found, _ = shown(duffing, [{"gamma": 0.2}, {"gamma": 0.28}, {"gamma": 0.29}], "x")
    assert [m["label"]["text"] for m in found] == ["periodic, 1T", "periodic, 2T", "periodic, 4T"]
    for m, gamma, n in zip(found, (0.2, 0.28, 0.29), (1, 2, 4), strict=True):
        x, steps = np.array(m["computed"]["x"]).reshape(-1, 2), m["computed"]["steps"]
        system = duffing.system.replace(gamma=gamma, start={"x": x[0, 0], "v": x[0, 1]})
        series = whirlmap.simulate(system, periods=20, steps=steps)["x"].values
        assert np.max(np.abs(x[: 20 * steps + 1] - series) / np.ptp(series, axis=0)) < WANTED
        section = np.array(m["section"]["x"])
        assert len(np.unique(np.round(section, 4))) == n
        np.testing.assert_array_equal(section, x[steps::steps, 0])
        assert m["turn"][0] == 0
        assert m["turn"][-1] == pytest.approx(4 if n < 4 else n)
        np.testing.assert_allclose(np.array(m["time"]), np.array(m["turn"]) * system.period)


@needs_node
def test_points_that_a_map_left_out_are_computed_with_care(duffing):
    ds = duffing.overview.copy(deep=True)
    ds["steps"][2], ds["settled_after"][2], ds["period_T"][2], ds["regime"][2] = 0, 0, 0, 0
    (m,), _ = shown(of_result(ds, "duffing.nc"), [{"gamma": 0.29}], "x")
    assert m["label"]["text"] == "periodic, 4T"
    assert m["computed"]["steps"] >= 100


@needs_node
def test_engineering_units_are_those_of_in_units():
    system = whirlmap.load("machines/jeffcott-rig")
    ds = whirlmap.bifurcation_diagram(system, "c", ["80 um", "100 um"], lyapunov=0)
    (m,), _ = shown(of_result(ds, "rig.nc"), [{"c": 80.0}], "y")
    at = whirlmap.load("machines/jeffcott-rig", c="80 um")
    x = np.array(m["computed"]["x"]).reshape(-1, at.model.dimension)
    steps = m["computed"]["steps"]
    begin = dict(zip(at.states, x[0].tolist(), strict=True))
    series = in_units(at, whirlmap.simulate(at.replace(start=begin), periods=4, steps=steps))
    last = len(m["series"]["y"])
    assert m["units"] == {**dict(zip(at.states, series["x"].attrs["unit_of_each"].split(), strict=True)),
                          **dict(zip(at.model.outputs, series["outputs"].attrs["unit_of_each"].split(), strict=True)),
                          "time": "s"}  # fmt: skip
    assert m["units"]["y"] == "um"
    for k, name in enumerate(at.states):
        want = series["x"].values[:, k]
        assert np.max(np.abs(np.array(m["series"][name]) - want[-last:])) < 1e-6 * np.ptp(want)  # it has settled
    np.testing.assert_allclose(np.array(m["time"])[:3], series["time"].values[:3])
    assert m["numbers"][0]["unit"] == "um"
    assert "over" not in m["numbers"][0]["name"]
    (load,) = [n for n in m["numbers"] if n["name"].startswith("largest load")]
    assert load["unit"] == "N"
    assert load["value"] == pytest.approx(series["outputs"].sel(output="load").max().item(), rel=1e-6)


@needs_node
def test_spectra_and_their_names_are_those_of_python():
    rng, rate, clocks = np.random.default_rng(3), 24, {"mesh": 1.0, "pinion": 0.25, "gear": 0.125}
    turn = np.arange(256 * rate - 7) / rate
    lines = ((1, 1.0), (0.25, 0.3), (0.618, 0.1), (1.618, 0.02), (3 / 16, 0.05), (7.31, 0.004))
    x = sum(a * np.cos(2 * np.pi * f * turn + k) for k, (f, a) in enumerate(lines)) + 1e-3 * rng.normal(size=turn.size)
    got = ran("const work = ({ x, rate, clocks }) => whirlmapSpectrum.spectrum(x, rate, clocks);",
              {"x": x.tolist(), "rate": rate, "clocks": clocks})  # fmt: skip
    spectrum = power_spectrum.find(x, rate=float(rate), unit="T")
    found, step = spectral_lines.find(spectrum), float(spectrum["frequency_step"])
    want = named_shares(found, clocks, step=step)
    assert [line["name"] for line in got["lines"]] == [line["name"] for line in want]
    assert {"mesh", "pinion", "f1", "mesh + f1"} < {line["name"] for line in want}
    for one, other in zip(got["lines"], want, strict=True):
        assert one["frequency"] == pytest.approx(other["frequency"], rel=1e-9)
        assert one["share"] == pytest.approx(other["share"], rel=1e-6)
    assert got["broadband"] == pytest.approx(float(found["broadband_fraction"]), rel=1e-6)
    bins = np.rint(np.array(got["frequency"]) / step).astype(int)
    power = np.asarray(spectrum["power"])
    np.testing.assert_allclose(got["power"], power[bins], atol=1e-12 * power.max())


@needs_node
def test_unforced_motions_are_cut_where_the_model_says():
    system = whirlmap.load("roessler", c=2.5)
    (m,), _ = shown(Exploration(system, {}), [{}], "x")
    x = np.array(m["computed"]["x"]).reshape(-1, 3)
    begin = dict(zip(system.states, x[0].tolist(), strict=True))
    want = whirlmap.section(system.replace(start=begin), points=40, transient=0)["section"].values[0]
    got = np.stack([m["section"][name] for name in system.states], axis=1)[:40]
    assert np.max(np.abs(got - want[: len(got)]) / np.ptp(x, axis=0)) < 1e-4  # a cubic through four samples
    assert len(got) == 40


@needs_node
def test_coexisting_motions_are_those_of_python():
    """Between the folds of a hardening oscillator: the large motion comes from below, the small one from above."""
    system = whirlmap.load("duffing", alpha=1.0, beta=0.04, delta=0.1, gamma=2.5, start={"x": 0.0, "v": 0.0})
    values = np.linspace(1.0, 2.2, 61)
    ds = whirlmap.bifurcation_diagram(system, "omega", values, lyapunov=0)
    e = Exploration(system, {"omega": (values.tolist(), "1")}, overview=ds)
    at, job = {"omega": float(values[35])}, Job(1)
    want = coexisting(job, e, at, "omega", "x")
    data, packed = saved_data(e)
    got = ran(
        """const work = async ({ data, bytes, at }) => {
             const source = whirlmapSaved.source({ data, bytes });
             await source.load();
             return (await source.coexisting(at, "omega", "x")).result;
           };""",
        {"data": text_of(json_text(data).encode()), "bytes": text_of(packed), "at": at},
    )
    sizes = {}
    for way in ("up", "down"):
        assert got[way]["label"]["text"] == want[way]["label"]["text"] == "periodic, 1T"
        sizes[way] = np.ptp(got[way]["series"]["x"])
        assert sizes[way] == pytest.approx(np.ptp(decoded(want[way]["series"]["x"])), rel=1e-3)
    assert sizes["up"] > 3 * sizes["down"]


# --- models that cannot go there -------------------------------------------------------------------------------------

x, v = State("x", "1", "position", start=0.3), State("v", "1", "velocity")
a, w = Parameter("a", "1", "forcing"), Parameter("w", "1", "frequency")


@needs_node
def test_a_model_that_browsers_cannot_compute_shows_stored_motions_and_says_so():
    rates = {x: v, v: a * cos(w * t) - erf(x) - 0.2 * v}
    model = Model("soft", (x, v), (a, w), rates, harmonics=(w,))
    system = System(model, {"a": 0.4, "w": 1.1})
    values = np.linspace(0.2, 0.5, 4)
    ds = whirlmap.bifurcation_diagram(system, "a", values, lyapunov=0)
    found, data = shown(Exploration(system, {"a": (values.tolist(), "1")}, overview=ds), [{"a": 0.201}], "x")
    assert data["note"].startswith("Motions are not computed here, for model 'soft' cannot run in a browser")
    assert data["note"].endswith("The nearest of 4 stored motions is shown; coexisting motions are not sought.")
    (m,) = found
    assert m["computed"]["values"] == {"a": 0.2}
    assert m["label"]["text"] == "periodic, 1T"
    assert "shown is the motion at a" in [n["name"] for n in m["numbers"]]
    states = np.array(m["computed"]["x"]).reshape(-1, 2)
    steps = m["computed"]["steps"]
    begin = {"x": states[0, 0], "v": states[0, 1]}
    want = whirlmap.simulate(system.replace(a=0.2, start=begin), periods=4, steps=steps)["x"].values
    assert np.max(np.abs(states[: len(want)] - want)) < 1e-5  # single precision


@needs_node
def test_a_run_that_ends_is_shown_to_its_end():
    rates = {x: v, v: a * cos(w * t) + x - 0.1 * v}
    model = Model("leaving", (x, v), (a, w), rates, harmonics=(w,), stops={"wall": Stop(2 - x**2, "wall")})
    system = System(model, {"a": 0.4, "w": 2.1})
    (m,), _ = shown(Exploration(system, {}), [{}], "x")
    series = whirlmap.simulate(system, periods=4, steps=m["computed"]["steps"])
    late = series["end_time"].item() / system.period
    assert 0.2 < late < 4  # the premise: it comes to the wall
    assert m["label"]["text"] == f"the run ends after {late:.5g} T"
    assert m["computed"]["ended"]["turn"] == pytest.approx(late, rel=1e-9)
    assert m["spectrum"] is None
    last = series["x"].values[np.isfinite(series["x"].values).all(axis=1)][-1]
    assert m["series"]["x"][-1] == pytest.approx(last[0], rel=1e-9)


# --- file and notebook ------------------------------------------------------------------------------------------------


def test_the_page_is_one_file_that_asks_for_nothing(duffing):
    page = saved_page(duffing)
    assert len(page.encode()) < 8_000_000
    for asks in ("src=", "@import", "url(", "XMLHttpRequest", "WebSocket", "fetch("):
        assert asks not in page, asks
    assert page == saved_page(duffing)  # nothing of it depends on the moment


def test_a_map_of_many_points_stays_below_eight_megabytes():
    """Points without motions of their own: sizes alone are asked."""
    system = whirlmap.load("duffing")
    few = whirlmap.regime_map(system, {"gamma": [0.2, 0.25], "omega": [1.0, 1.1]}, lyapunov=0).load()
    rng = np.random.default_rng(1)
    many = few.isel(gamma=rng.integers(0, 2, 400), omega=rng.integers(0, 2, 250))
    for name in ("peak_to_peak", "lyapunov", "rotation_number"):
        many[name] = many[name].dims, rng.normal(size=many[name].shape), many[name].attrs
    many = many.assign_coords(gamma=np.linspace(0.2, 0.4, 400), omega=np.linspace(1, 1.3, 250))
    axes = {name: (many[name].values.tolist(), "1") for name in ("gamma", "omega")}
    page = saved_page(Exploration(system, axes, overview=many))
    assert 1_000_000 < len(page.encode()) < 8_000_000


def test_points_must_have_been_computed():
    with pytest.raises(InputError, match="still to be computed, expected labelled points"):
        saved_data(Exploration(whirlmap.load("duffing"), {"gamma": ([0.2, 0.3], "1")}))


def test_a_notebook_shows_the_page_in_a_frame_of_its_own(duffing, tmp_path):
    page = whirlmap.explore(duffing.overview, height=700)
    shown_there = page._repr_html_()
    assert shown_there.startswith("<iframe ")
    assert 'sandbox="allow-scripts allow-downloads"' in shown_there
    assert 'height="700"' in shown_there
    inner = shown_there.split('srcdoc="')[1].split('"')[0]
    assert html.unescape(inner) == page.html == saved_page(of_result(duffing.overview, "the Dataset"))
    assert repr(page).startswith("Explorer of duffing, the Dataset, 0.")
    assert page.save(tmp_path / "page.html").read_text(encoding="utf-8") == page.html
    with pytest.raises(OutputError, match="exists already"):
        page.save(tmp_path / "page.html")
    assert page.save(tmp_path / "page.html", force=True).exists()


def test_a_system_is_explored_at_its_own_point():
    page = whirlmap.explore(whirlmap.load("van_der_pol"))
    assert "van_der_pol" in repr(page)
    with pytest.raises(InputError, match="height: found 0"):
        whirlmap.explore(whirlmap.load("van_der_pol"), height=0)


def test_the_command_saves_a_page(tmp_path):
    place = tmp_path / "page.html"
    first = CliRunner().invoke(app, f"explore duffing --vary gamma=0.2:0.3:3 --lyapunov 0 --save {place}".split())
    assert (first.exit_code, first.stdout.strip()) == (0, f"written: {place}"), first.stderr
    assert "whirlmapSaved.source(" in place.read_text(encoding="utf-8")
    again = CliRunner().invoke(app, ["explore", "duffing", "--save", str(place)])
    assert again.exit_code == 2
    assert "exists already; use --force" in again.stderr
    assert CliRunner().invoke(app, ["explore", "duffing", "--save", str(place), "--force"]).exit_code == 0
