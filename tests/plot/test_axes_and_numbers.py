"""Every figure function: what its axes say, and that what is drawn are the Dataset's numbers, read back from the artists."""

from functools import partial

import numpy as np
import pytest

import whirlmap
from whirlmap import plot

RIG = "machines/jeffcott-rig"
TURN = np.arange(64 * 32) / 32


@pytest.fixture(scope="module")
def found(chaos, diagram, diagnosed, rotor):
    """Datasets for all functions, by what they are."""
    steps = {"settling": whirlmap.Settling(transient=20, most=4, keep=8), "lyapunov": 256}
    system = whirlmap.load("duffing", gamma=0.2)
    power = whirlmap.power_spectrum(np.sin(2 * np.pi * TURN), rate=32)
    return chaos | {
        "diagram": diagram, "diagnosed": diagnosed, "orbit": rotor["series"], "power": power,
        "full": whirlmap.full_spectrum(np.cos(2 * np.pi * TURN), np.sin(2 * np.pi * TURN), rate=32),
        "map": whirlmap.regime_map(system, {"gamma": [0.2, 0.3, 0.5], "omega": [1.1, 1.2, 1.3]}, **steps),
        "line": whirlmap.regime_map(system, {"gamma": [0.2, 0.3, 0.5]}, **steps),
        "attractors": whirlmap.attractors(system, starts=8, **steps),
        "basins": whirlmap.basins(system, {"x": [-1.0, 0.0, 1.0], "v": [-0.5, 0.5]}, **steps),
        "campbell": whirlmap.campbell(whirlmap.load(RIG), "s", np.linspace(0.5, 2.0, 11)),
        "response": whirlmap.unbalance_response(whirlmap.load(RIG), "s", np.linspace(0.5, 2.0, 11)),
        "run_up": whirlmap.run_up(system, "omega", 1.0, 1.4, time=600.0),
        "speeds": whirlmap.safe_speeds(whirlmap.load(RIG), np.linspace(0.5, 1.5, 6), 0.6, follow=False),
        "branch": whirlmap.continue_orbit(system, "gamma", (0.2, 0.3)),
        "curves": whirlmap.event_curve(system, {"gamma": (0.2, 0.3), "omega": (1.15, 1.25)}, "period-doubling"),
        "waterfall": whirlmap.waterfall(system, "gamma", [0.2, 0.3, 0.4], "x", periods=16),
        "improve": whirlmap.improve(
            partial(whirlmap.load, RIG), {"c": [80, 120]}, [0.5, 1.0, 1.5], 0.6, units={"c": "um"}, refine=False
        ),
    }  # fmt: skip


#: What one of the Datasets above is drawn with.
AMPLITUDE, X, V, G = r"forcing amplitude, $\gamma$ [–]", "$x$ [–]", "$v$ [–]", r"$\gamma$ [–]"
MESH, SHARE = "frequency / mesh frequency [–]", ("", "share")
UM = {"unit": 100.0, "length": "um"}
#: Function -> Dataset and what it is called with; labels (horizontal, vertical) of its axes, in the order of the figure.
AXES = {
    "draw_time_series": ("series", ["x"], {}, [("time, $t/T$ [–]", X)]),
    "draw_phase_portrait": ("series", ["x"], {}, [(X, V)]),
    "draw_orbit": ("orbit", ["ux", "uy"], {}, [("$u_{x}$ [–]", "$u_{y}$ [–]")]),
    "draw_section": ("section", ["x"], {}, [(X, V)]),
    "draw_diagram": ("diagram", ["x"], {}, [(AMPLITUDE, X)]),
    "draw_regime_strip": ("diagram", [], {}, [(AMPLITUDE, "")]),
    "draw_exponents": ("diagram", [], {}, [(AMPLITUDE, r"$\lambda_1$ [1/time]")]),
    "draw_convergence": ("lyapunov", [], {}, [("common periods [–]", r"$\lambda_1$ [1/time]")]),
    "draw_correlation_sum": ("dimension", [], {}, [("radius, $r$ [–]", "correlation sum, $C(r)$ [–]")]),
    "draw_local_slope": (
        "dimension", [], {}, [("radius, $r$ [–]", r"$\mathrm{d}\,\ln C/\mathrm{d}\,\ln r$ [–]")]),
    "draw_power_spectrum": ("power", [], {"name": "yp"}, [(MESH, "power of $y_{p}$ [dB re 1]")]),
    "draw_full_spectrum": ("full", [], {}, [(MESH, "radius of the circular orbit [–]")]),
    "draw_waterfall": ("waterfall", ["gamma"], {}, [(rf"frequency, in units of {G}", G)]),
    "draw_regime_map": ("map", ["x"], {}, [(AMPLITUDE, r"forcing frequency, $\omega$ [–]")]),
    "draw_shares": ("map", ["gamma"], {}, [SHARE]),
    "regime_map_figure": ("map", ["x"], {}, [(AMPLITUDE, r"forcing frequency, $\omega$ [–]"), SHARE, SHARE[::-1]]),
    "regime_line_figure": ("line", ["x"], {}, [("", "peak to peak of $x$"), (AMPLITUDE, "")]),
    "draw_branches": ("branch", ["x"], {}, [(AMPLITUDE, f"{X}, peak to peak")]),
    "branches_figure": ("branch", [["x", "v"]], {}, [("", f"{X}, peak to peak"), (AMPLITUDE, f"{V}, peak to peak")]),
    "draw_event_curves": ("curves", [], {}, [(AMPLITUDE, r"forcing frequency, $\omega$ [–]")]),
    "event_curves_figure": ("curves", [], {}, [(AMPLITUDE, r"forcing frequency, $\omega$ [–]")]),
    "draw_basins": ("basins", [], {}, [(f"displacement, {X}", f"velocity, {V}")]),
    "draw_starts": ("attractors", ["x", "v"], {}, [(X, V)]),
    "attractors_figure": ("attractors", ["x", "v"], {}, [(X, V)]),
    "basins_figure": ("basins", [], {}, [(f"displacement, {X}", f"velocity, {V}")]),
    "campbell_figure": (
        "campbell", [], {}, [("", "damped frequency [–]"), ("speed ratio omega sqrt(c/g), $s$ [–]", "damping ratio [–]")]),
    "response_figure": (
        "response", [], {}, [("", "peak to peak [–]"), ("speed ratio omega sqrt(c/g), $s$ [–]", "lag, rotor [deg]")]),
    "run_up_figure": (
        "run_up", ["x"], {}, [("", X), ("", "amplitude [–]"), (r"forcing frequency, $\omega$ [–]", "order of the phase"),
        ("", "phase [deg], dotted"), ("", "amplitude [dB]")]),
    "diagram_figure": ("diagram", [["x"]], {"exponents": False}, [("", X), (AMPLITUDE, "")]),
    "paper_diagram_figure": ("diagram", [("x", "v")], {}, [("", X), (AMPLITUDE, ""), ("", V), (AMPLITUDE, "")]),
    "diagnosis_figure": (
        "diagnosed", ["x"], {}, [("time, $t/T$ [–]", X), (X, V), (X, V), ("frequency / forcing frequency [–]",
        "power of $x$ [dB re 1]"), ("common periods [–]", r"$\lambda$ [1/time]"),
        ("radius, $r$ [–]", "correlation sum, $C(r)$ [–]")]),
    "speeds_figure": (
        "speeds", [], {**UM, "force": 3.9, "force_unit": "N"},
        [("", "peak to peak [um]"), ("", "film [um]"), ("speed of the first shaft [rpm]", "load [N]")]),
    "improve_figure": (
        "improve", [], UM, [("$c$ [um]", "widest safe window [rpm]"), ("$c$ [um]", "worst peak to peak [um]"),
        ("widest safe window [rpm]", "worst peak to peak [um]")]),
}  # fmt: skip
#: Functions whose axes other tests look at, or that draw upon none.
ELSEWHERE = {"paper_orbit_figure", "series_figure", "animate_orbit", "encode", "save", "machine_figure"}


def drawn(found, function):
    data, given, options, _ = AXES[function]
    made = getattr(plot, function)(found[data], *given, **options)
    return made if function.endswith("_figure") else made.figure


@pytest.mark.parametrize("function", AXES)
def test_axes_name_what_they_show_with_its_unit(found, function):
    assert [(ax.get_xlabel(), ax.get_ylabel()) for ax in drawn(found, function).axes] == AXES[function][3]


def test_every_function_is_looked_at():
    names = {n for n, f in vars(plot).items() if callable(f) and not isinstance(f, type)}
    assert names == set(AXES) | ELSEWHERE


def curves(ax):
    """Numbers of all lines of a panel, without gaps."""
    return [np.asarray(line.get_xydata())[np.isfinite(line.get_xydata()).all(axis=1)] for line in ax.lines]


def holds(ax, x, y):
    """Whether a line of the panel goes through just these points."""
    expected = np.stack([np.asarray(x, dtype=float), np.asarray(y, dtype=float)], axis=1)
    expected = expected[np.isfinite(expected).all(axis=1)]
    return any(line.shape == expected.shape and np.allclose(line, expected, rtol=1e-12) for line in curves(ax))


def test_numbers_of_panels(found):
    full, slope, orbit = found["full"], found["dimension"], found["orbit"]
    near = full["whirl_frequency"].values <= 1.5
    ax = drawn(found, "draw_full_spectrum").axes[0]
    (forward,) = (line for line in ax.lines if line.get_gid() == "forward")
    np.testing.assert_array_equal(forward.get_xdata(), full["whirl_frequency"].values[near])
    seen = full["forward"].values[near]
    assert np.allclose(np.asarray(forward.get_ydata())[seen > 1e-6], seen[seen > 1e-6]) and seen.max() == pytest.approx(1)
    assert holds(drawn(found, "draw_local_slope").axes[0], slope["radius"], slope["local_slope"])
    assert holds(drawn(found, "draw_orbit").axes[0], *(orbit["x"].sel(state=name) for name in ("ux", "uy")))
    line = found["line"]
    assert holds(drawn(found, "regime_line_figure").axes[0], line["gamma"], line["peak_to_peak"].sel(quantity="x"))


def test_numbers_of_starts_and_shares(found):
    ds = found["attractors"]
    of = ds["attractor_of"].values
    assert (of > 0).any()
    ax = drawn(found, "draw_starts").axes[0]
    for number in np.unique(of[of > 0]):
        chosen = ds["start_state"].isel(start=np.flatnonzero(of == number))
        assert holds(ax, chosen.sel(state="x"), chosen.sel(state="v"))
    bands = [c for c in drawn(found, "draw_shares").axes[0].collections if c.get_gid()]
    tops = np.max([band.get_datalim(band.axes.transData).y1 for band in bands])
    assert len(bands) == np.unique(found["map"]["regime"].values).size and tops == pytest.approx(1.0)


def test_numbers_of_campbell_diagrams(found):
    ds = found["campbell"]
    upper, lower = drawn(found, "campbell_figure").axes
    at = ds["s"].values
    for name, ax in (("frequency", upper), ("damping_ratio", lower)):
        shown = {tuple(point) for line in curves(ax) for point in line}
        moving = ds["frequency"].transpose("mode", "s").values > 0
        values = ds[name].transpose("mode", "s").values
        assert moving.any() and {(s, v) for k in range(len(values)) for s, v in zip(at[moving[k]], values[k][moving[k]],
                                                                                       strict=True)} <= shown  # fmt: skip
    assert all(holds(upper, at, ds["line"].sel(clock=clock)) for clock in ds["clock"].values)
    rings = [line for line in upper.lines if line.get_marker() == "o"]
    assert ds["critical"].size and np.allclose(rings[0].get_xdata(), ds["critical"])


def test_numbers_of_responses_and_run_ups(found):
    ds = found["response"]
    upper, *lags = drawn(found, "response_figure").axes
    for station in ds["station"].values:
        for axis in ("x", "y"):
            here = ds.sel(station=station, axis=axis)
            assert holds(upper, ds["s"], here["total"])
            for ax, rotor in zip(lags, ds["rotor"].values, strict=True):
                assert holds(ax, ds["s"], np.degrees(here["phase"].sel(rotor=rotor)))
    ds = found["run_up"].sel(quantity="x")
    upper, middle, lower = drawn(found, "run_up_figure").axes[:3]
    assert all(holds(upper, ds["omega"], ds[name]) for name in ("minimum", "maximum"))
    assert holds(middle, ds["omega"], ds["clock_amplitude"].isel(clock=0))
    (mesh,) = lower.collections
    level = 20 * np.log10(ds["spectrum"].transpose("phase_order", "omega").values)
    np.testing.assert_allclose(np.ma.getdata(mesh.get_array()).reshape(level.shape), level, rtol=1e-12)


def test_numbers_of_speeds_and_designs(found):
    """In um, N and rpm: what the Dataset holds in clearances, loads and s, times their sizes."""
    ds = found["speeds"]
    amplitude, film, load = drawn(found, "speeds_figure").axes
    assert holds(amplitude, ds["rpm"], 100 * ds["amplitude"])
    assert holds(film, ds["rpm"], 100 * ds["min_film"].isel(bearing=0))
    assert holds(load, ds["rpm"], 3.9 * ds["max_load"].isel(bearing=0))
    ds = found["improve"]
    width, worst, _ = drawn(found, "improve_figure").axes
    assert holds(width, ds["c"], ds["window_width"] * float(ds["rpm"][-1] / ds["s"][-1]))
    assert holds(worst, ds["c"], 100 * ds["worst_amplitude"])


def test_branches_are_solid_where_stable_and_dashed_where_not(found):
    ds = found["branch"]
    ax = plot.draw_branches(ds, "x")
    lines = {line.get_gid(): line for line in ax.lines if str(line.get_gid()).startswith("branch")}
    stable = ds["stable"].values == 1
    assert 0 < stable.sum() < stable.size
    heights = ds["peak_to_peak"].sel(quantity="x").values
    for name, here, style in (("branch-1-stable", stable, "-"), ("branch-1-unstable", ~stable, "--")):
        np.testing.assert_array_equal(lines[name].get_xdata(), ds["gamma"].values)
        np.testing.assert_array_equal(lines[name].get_ydata()[here], heights[here])
        assert lines[name].get_linestyle() == style
    (mark,) = [line for line in ax.lines if line.get_gid() == "event-period_doubling"]
    np.testing.assert_array_equal(mark.get_xdata(), ds["event_gamma"].values)


def test_curves_of_events_lie_where_their_parameters_are(found):
    ds = found["curves"]
    (line,) = [line for line in plot.draw_event_curves(ds).lines if line.get_gid() == "curve-1"]
    np.testing.assert_array_equal(line.get_xydata(), np.stack([ds["gamma"].values, ds["omega"].values], axis=1))
