"""Cases with dimensions are shown in engineering units, in tables, JSON, CSV and pictures; --dimensionless gives groups."""

import json
import shlex

import numpy as np
import pytest
from typer.testing import CliRunner

import whirlmap
from whirlmap.cli.common import pictures
from whirlmap.cli.main import app
from whirlmap.results.signals import read_column

RIG = "machines/jeffcott-rig"
C, OMEGA, W = 100.0, 1800 * np.pi / 30, 0.8 * 9.81 / 2  # um, rad/s, N
SIMULATE = f"simulate {RIG} --periods 4 --steps 40 --quiet"


def run(line):
    result = CliRunner(env={"COLUMNS": "200"}).invoke(app, shlex.split(line))
    assert result.exit_code == 0, (result.stderr, result.exception)
    return result.stdout


def told(line):
    return json.loads(run(f"{line} --json"))


def test_a_simulation_is_told_in_um_mm_s_and_newtons_beside_its_groups():
    said = told(SIMULATE)
    own, found = said["motion"], said["dimensional"]["motion"]
    assert [found[name]["units"]["maximum"] for name in ("y", "vy", "eps", "load")] == ["um", "mm/s", "1", "N"]
    for name, size in (("y", C), ("vy", C * 1e-3 * OMEGA), ("eps", 1), ("load", W)):
        assert found[name]["maximum"] == pytest.approx(own[name]["maximum"] * size, rel=1e-12)
        assert set(own[name]["units"].values()) == {"1"}
    assert said["dimensional"]["period"] == pytest.approx(60 / 1800, rel=1e-12)
    assert said["dimensional"]["units"]["period"] == "s" and said["period"] == pytest.approx(2 * np.pi)
    assert "dimensional" not in told(f"{SIMULATE} --dimensionless")


def test_the_table_of_a_simulation_names_units_unless_groups_are_asked_for():
    said = run(SIMULATE)
    assert all(word in said for word in ("y [um]", "vy [mm/s]", "load [N]", "0.03333333 s"))
    said = run(f"{SIMULATE} --dimensionless")
    assert "um" not in said.replace("minimum", "").replace("maximum", "") and "period T = 6.283185," in said


def test_a_csv_file_is_in_seconds_and_um(tmp_path):
    file, plain = tmp_path / "y.csv", tmp_path / "groups.csv"
    run(f"{SIMULATE} --out {file}")
    run(f"{SIMULATE} --dimensionless --out {plain}")
    assert file.read_text().startswith("# units: s,um,um,um,um,mm/s,mm/s,1,N\n")
    np.testing.assert_allclose(read_column(file, "y"), read_column(plain, "y") * C, rtol=1e-14)
    np.testing.assert_allclose(read_column(file, "time"), read_column(plain, "time") / OMEGA, rtol=1e-12)


def test_the_dataset_of_a_simulation_stays_in_groups(tmp_path):
    run(f"{SIMULATE} --out {tmp_path / 'run.nc'}")
    import xarray as xr

    with xr.open_dataset(tmp_path / "run.nc") as ds:
        assert ds["x"].attrs["units"] == "1" and abs(ds["x"].sel(state="y")).max() < 3


def test_pictures_of_a_simulation_have_um_and_seconds():
    system = whirlmap.load(RIG)
    ds = whirlmap.in_units(system, whirlmap.simulate(system, periods=4, steps=40))
    labels = [ax.get_ylabel() + ax.get_xlabel() for ax in pictures.simulation(system, ds).axes]
    assert "[um]" in labels[0] and "[s]" in labels[0] and "[mm/s]" in labels[-1]


DIAGNOSE = f"diagnose {RIG} --exponents 1 --max-periods 64 --quiet"


@pytest.fixture(scope="module")
def diagnosed():
    return told(DIAGNOSE)


def test_a_diagnosis_is_told_in_um_and_per_second(diagnosed):
    found, units = diagnosed["dimensional"], diagnosed["dimensional"]["units"]
    assert found["amplitude"]["y"]["units"] == {"peak_to_peak": "um", "rms": "um"}
    for name, size in (("y", C), ("vy", C * 1e-3 * OMEGA), ("load", W)):
        own = diagnosed["amplitude"][name]["peak_to_peak"]
        assert found["amplitude"][name]["peak_to_peak"] == pytest.approx(own * size, rel=1e-12)
    assert found["min_film"]["eps"] == pytest.approx(C * diagnosed["min_film"]["eps"]) and units["min_film"] == "um"
    assert found["lyapunov"][0] == pytest.approx(OMEGA * diagnosed["lyapunov"][0]) and units["lyapunov"] == "1/s"


def test_the_table_of_a_diagnosis_has_units_and_groups_when_asked():
    said = run(DIAGNOSE)
    assert all(word in said for word in ("y [um]", "vy [mm/s]", "load [N]", "[1/s]", "thinnest film [um]"))
    said = run(f"{DIAGNOSE} --dimensionless")
    assert "[um]" not in said and "thinnest film over c" in said and "per unit of time" in said


def test_the_sheet_of_a_diagnosis_has_the_clearance_circle_in_um():
    from whirlmap.integrate.dimensions import Dimensions

    system = whirlmap.load(RIG)
    ds = whirlmap.diagnose(system, exponent_count=1, max_periods=64)
    axes = pictures.diagnosis(Dimensions(system), ds).axes
    assert "[um]" in axes[0].get_xlabel() and axes[0].get_xlim()[1] == pytest.approx(1.08 * C)
    assert any("um^2" in ax.get_ylabel() for ax in axes) and any("[1/s]" in ax.get_ylabel() for ax in axes)


BIFURCATION = f"bifurcation {RIG} --vary s=0.4:1.2:3 --lyapunov 0 --quiet"


def test_a_diagram_is_told_in_rpm_and_um():
    said = told(BIFURCATION)
    found, omega_0 = said["dimensional"], np.sqrt(9.81 / (C * 1e-6))
    assert found["units"]["values"] == "rpm" and said["values"] == pytest.approx([0.4, 0.8, 1.2])
    np.testing.assert_allclose(found["values"], np.array(said["values"]) * omega_0 * 30 / np.pi, rtol=1e-12)
    (own,), (sweep,) = said["sweeps"], found["sweeps"]
    np.testing.assert_allclose(sweep["peak_to_peak"]["y"], C * np.array(own["peak_to_peak"]["y"]), rtol=1e-12)
    speeds = omega_0 * np.array(said["values"])  # velocities are over c and the radian of each point's own clock
    np.testing.assert_allclose(sweep["peak_to_peak"]["vy"], C * 1e-3 * speeds * own["peak_to_peak"]["vy"], rtol=1e-12)
    assert sweep["units"]["peak_to_peak"]["y"] == "um" and sweep["units"]["lyapunov"] == "1/s"


def test_the_table_and_the_picture_of_a_diagram_are_in_rpm_and_um():
    from whirlmap.integrate.dimensions import Dimensions

    said = run(BIFURCATION)
    assert "speed [rpm]" in said and "[um]" in said
    assert "[" not in run(f"{BIFURCATION} --dimensionless")
    system = whirlmap.load(RIG)
    ds = whirlmap.bifurcation_diagram(system, "s", [0.4, 0.8], lyapunov=0)
    axes = pictures.diagram(Dimensions(system), ds, ["y"]).axes
    assert "[um]" in axes[0].get_ylabel() and any("[rpm]" in ax.get_xlabel() for ax in axes)


LINEAR = f"linear {RIG} --threshold s=1:4"


def test_small_motions_are_told_in_hz_and_per_second_with_names():
    said = told(LINEAR)
    found, own = said["dimensional"], said["eigenvalues"]
    mode = found["eigenvalues"][0]
    assert mode["frequency"] == pytest.approx(own[0]["frequency"] * OMEGA / (2 * np.pi), rel=1e-12)
    assert mode["growth"] == pytest.approx(own[0]["growth"] * OMEGA, rel=1e-12)
    assert mode["name"] == own[0]["name"] == "rotor backward"
    assert found["loads"]["1"] == pytest.approx(W, rel=1e-9) and said["films"]["1"]["load"] == pytest.approx(1)
    assert found["equilibrium"]["y"] == pytest.approx(C * said["equilibrium"]["y"])
    assert found["threshold"]["value"] == pytest.approx(said["threshold"]["value"] * np.sqrt(9.81e4) * 30 / np.pi)
    units = found["units"]
    assert (units["equilibrium"]["y"], units["frequency"], units["loads"], units["threshold"]) == ("um", "Hz", "N", "rpm")


def test_the_table_of_small_motions_has_units():
    said = run(LINEAR)
    assert all(word in said for word in ("frequency [Hz]", "growth [1/s]", "y [um]", "load 3.924 N", "rpm"))
    said = run(f"{LINEAR} --dimensionless")
    assert "Hz" not in said and "[um]" not in said and "per radian of the clock" in said


ATTRACTORS = f"attractors {RIG} --starts 4 --transient 20 --lyapunov 256 --quiet"


def test_attractors_are_told_in_um_and_per_second():
    said = told(ATTRACTORS)
    (own,), (found,) = said["attractors"], said["dimensional"]["attractors"]
    assert found["peak_to_peak"]["y"] == pytest.approx(C * own["peak_to_peak"]["y"], rel=1e-12)
    assert found["lyapunov"] == pytest.approx(OMEGA * own["lyapunov"], rel=1e-12)
    assert found["units"]["peak_to_peak"]["y"] == "um" and found["units"]["lyapunov"] == "1/s"
    said = run(ATTRACTORS)
    assert "1/s" in said and " um" in said
    said = run(f"{ATTRACTORS} --dimensionless")
    assert "1/s" not in said and " um" not in said


def test_pictures_of_attractors_basins_and_maps_have_units():
    from whirlmap.analysis.steady.settling import Settling
    from whirlmap.integrate.dimensions import Dimensions

    system, short = whirlmap.load(RIG), {"settling": Settling(transient=20), "lyapunov": 256}
    units = Dimensions(system)
    (ax,) = pictures.attractors(units, whirlmap.attractors(system, starts=4, **short)).axes
    assert "[um]" in ax.get_xlabel() and "[mm/s]" in ax.get_ylabel()
    slices = whirlmap.basins(system, {"ux": [0.2, 0.4], "uy": [-0.7, -0.5]}, **short)
    (ax,) = pictures.basins(units, slices).axes
    assert "[um]" in ax.get_xlabel() and ax.get_ylim()[0] < -C * 0.7
    ds = whirlmap.regime_map(system, {"s": [0.4, 0.6], "b": [0.05, 0.1]}, lyapunov=0)
    main = pictures.regime_map(units, ds, "y").axes[0]
    assert "[rpm]" in main.get_xlabel() and "[um]" in main.get_ylabel()


@pytest.mark.parametrize("case", ["duffing", "jeffcott"])
def test_cases_without_dimensions_have_none(case):
    assert "dimensional" not in told(f"simulate {case} --periods 2 --quiet")


WITHOUT_UNITS = (
    "speeds {} --limit 20", "speeds {} --range 500:6000", "improve {} --vary c=60um:70um:2 --limit 20",
    "improve {} --vary c=60um:70um:2 --range 500:6000", "improve {} --vary c=60:140:5", "show {} --set speed=1500",
    "bifurcation {} --vary speed=500:6000:5", "campbell {} --vary speed=500:6000:5", "map {} --vary speed=500:6000:5",
    "simulate {} --start y=20", "attractors {} --box y=-20:20", "basins {} --grid ux=-50:50:3 --grid uy=-0.5:0:3",
    "linear {} --threshold speed=500:6000", "bifurcation {} --vary s=500:6000:5", "linear {} --threshold s=500:6000",
)  # fmt: skip


@pytest.mark.parametrize("line", WITHOUT_UNITS)
def test_a_dimensional_quantity_without_its_unit_is_refused_with_an_example(line):
    done = CliRunner().invoke(app, shlex.split(line.format(RIG)))
    assert done.exit_code == 2 and done.stdout == ""
    assert "unit" in done.stderr and "expected" in done.stderr


def test_a_speed_in_rpm_is_varied_as_s():
    said = told(f"bifurcation {RIG} --vary 'speed=1200 rpm:1500 rpm:2' --lyapunov 0 --quiet")
    assert said["varied"] == "s" and said["dimensional"]["values"] == pytest.approx([1200, 1500], rel=1e-12)
    again = told(f"campbell {RIG} --vary 'speed=20 turn/s:25 turn/s:2'")
    assert again["values"] == pytest.approx(said["values"], rel=1e-12)
    found = told(f"linear {RIG} --threshold 'speed=3000 rpm:9000 rpm'")
    assert found["threshold"]["value"] == pytest.approx(told(LINEAR)["threshold"]["value"], rel=1e-6)


@pytest.mark.parametrize(
    ("range_of", "expected"),
    [
        ("speed=1200rpm:20turn/s:2", "same unit"), ("speed=1um:2um:2", "expected a unit such as rpm"),
        ("Gamma=1um:2um:2", "no dimension"), ("speed=1200rpm:1500rpm:2' --set 's=1", "s: found it in --set and in --vary"),
        ("s=1:2:2' --set 'speed=1200 rpm", "speed: found it in --set and in --vary"),
    ],
)  # fmt: skip
def test_ranges_that_cannot_be_are_refused(range_of, expected):
    done = CliRunner().invoke(app, shlex.split(f"bifurcation {RIG} --vary '{range_of}'"))
    assert done.exit_code == 2 and expected in done.stderr


def test_speeds_and_designs_without_dimensions_are_told_in_groups():
    line = f"speeds {RIG} --points 3 --transient 20 --no-follow --quiet"
    said, groups = told(line), told(f"{line} --dimensionless")
    assert said["units"]["limit_um"] == "um" and said["limit_um"] == pytest.approx(60)
    assert groups["limit_um"] is groups["rpm"] is groups["force_N"] is None and groups["limit"] == said["limit"]
    assert "[um]" not in run(f"{line} --dimensionless") and "[rpm]" in run(line)
    line = f"improve {RIG} --vary c=80um:120um:2 --points 3 --coarse --transient 20 --no-follow --quiet"
    said = run(f"{line} --dimensionless")
    assert "rpm" not in said and "worst amplitude [clearances]" in said and "c [um]" in said


def test_starts_are_given_in_um_and_mm_s():
    from whirlmap.cli.common.opening import open_system

    begin = open_system(RIG, None, ["y=-180 um", "vy=0.003 m/s", "ux=0.2"]).start
    assert begin == pytest.approx({"y": -1.8, "vy": 3 / (C * 1e-3 * OMEGA), "ux": 0.2}, rel=1e-12)
    said = told(f"attractors {RIG} --box 'y=-180 um:-150 um' --starts 2 --transient 20 --lyapunov 256 --quiet")
    assert said["attractors"][0]["regime"] == "periodic"
    grid = "--grid 'ux=20 um:40 um:2' --grid 'uy=-70 um:-50 um:2'"
    said = told(f"basins {RIG} {grid} --transient 20 --lyapunov 256 --quiet")
    assert said["grid"]["ux"] == pytest.approx([0.2, 0.4, 2]) and said["grid"]["uy"] == pytest.approx([-0.7, -0.5, 2])


def test_a_unit_of_a_state_without_dimensions_is_refused():
    done = CliRunner().invoke(app, ["simulate", "duffing", "--start", "x=20 um"])
    assert done.exit_code == 2 and "x has no dimension in duffing" in done.stderr


def test_show_says_start_state_clocks_and_period_in_units():
    said = told(f"show {RIG}")
    y = said["states"]["y"]
    assert y["dimensional"] == {"start": pytest.approx(C * y["start"]), "units": {"start": "um"}}
    assert said["clocks"]["shaft"]["Hz"] == pytest.approx(30) and said["period_s"] == pytest.approx(1 / 30)
    shown = run(f"show {RIG}")
    assert f"{C * y['start']:.5g} um" in shown and "Hz" in shown
    assert told("show duffing")["states"]["x"]["dimensional"] is None


def test_safe_speeds_in_units_are_in_rpm_and_um():
    from whirlmap.analysis.steady.settling import Settling

    system = whirlmap.load(RIG)
    ds = whirlmap.safe_speeds(system, [0.4, 0.6], 0.6, follow=False, settling=Settling(transient=20), lyapunov=0)
    found = whirlmap.in_units(system, ds)
    assert [found[name].attrs["units"] for name in ("s", "amplitude", "min_film", "max_load")] == ["rpm", "um", "um", "N"]
    np.testing.assert_allclose(found["s"], ds["rpm"], rtol=1e-12)
    np.testing.assert_allclose(found["amplitude"], C * ds["amplitude"], rtol=1e-12)
