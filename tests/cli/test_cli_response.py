"""``linear --response`` as it is typed: table, JSON, picture, and the nonlinear motion laid over it."""

import json
import shlex

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import whirlmap
from whirlmap.cli.main import app

SMALL = "linear jeffcott --set b=0.01 --response --vary s=0.5:2.3:30"


def run(line, code=0):
    result = CliRunner(env={"COLUMNS": "160"}).invoke(app, shlex.split(line))
    assert result.exit_code == code, (result.stderr, result.exception)
    return result


def test_json_holds_what_python_returns():
    found = json.loads(run(f"{SMALL} --json").stdout)
    ds = whirlmap.unbalance_response(whirlmap.load("jeffcott", b=0.01), "s", np.linspace(0.5, 2.3, 30))
    assert (found["rotors"], found["stations"], found["probes"]) == (["rotor"], ["rotor"], [["ux", "uy"]])
    for key in ("amplitude", "phase", "total", "stable"):
        np.testing.assert_allclose(found[key], ds[key].values, rtol=1e-12)
    (peak,) = found["critical"]
    assert peak["speed"] == pytest.approx(float(ds["critical"][0])) and peak["one_sided"]
    assert peak["amplification"] == pytest.approx(float(ds["amplification"][0]))
    assert found["operating_range"] == [2.6, 2.6]


def test_a_machine_is_shown_in_rpm_and_um_with_its_own_range():
    said = run("linear machines/jeffcott-rig --response").stdout
    for words in ("speed [rpm] from 300 to 7500", "range of operation: 600 to 6000 rpm", "API 617", "unstable at"):
        assert words in said
    found = json.loads(run("linear machines/jeffcott-rig --response --probe journals --json").stdout)
    assert found["stations"] == ["journals"]
    own, shown = found["critical"][0], found["dimensional"]["critical"][0]
    assert found["dimensional"]["units"]["values"] == "rpm" and found["dimensional"]["units"]["amplitude"] == "um"
    assert shown["speed"] == pytest.approx(2251, abs=5) and shown["amplification"] == pytest.approx(own["amplification"])
    assert shown["margin"] == 0.0 and shown["required_margin"] > 0.1 and shown["enough"] is False


def test_the_nonlinear_motion_stands_beside_it(tmp_path):
    """Computed, or from a diagram's file: the same numbers, near the linear ones where the unbalance is small."""
    diagram = tmp_path / "d.nc"
    run(f"bifurcation jeffcott --set b=0.01 --vary s=0.5:2.3:3 --out {diagram}")
    out = tmp_path / "bode.png"
    over = json.loads(run(f"{SMALL} --over {diagram} --json --out {out}").stdout)
    assert out.stat().st_size > 10_000 and over["files"] == [str(out)]
    computed = json.loads(run(f"{SMALL} --nonlinear 3 --json --quiet").stdout)
    np.testing.assert_allclose(over["nonlinear"]["peak_to_peak"], computed["nonlinear"]["peak_to_peak"], rtol=1e-9)
    linear = np.array(over["total"])[0][:, [0, -1]]
    np.testing.assert_allclose(np.array(over["nonlinear"]["peak_to_peak"])[0][:, [0, -1]], linear, rtol=0.01)


def test_the_file_holds_the_dataset(tmp_path):
    run(f"{SMALL} --out {tmp_path / 'r.nc'}")
    ds = xr.load_dataset(tmp_path / "r.nc")
    assert ds.attrs["varied"] == "s" and ds["amplitude"].dims == ("rotor", "station", "axis", "s")


@pytest.mark.parametrize(("line", "words"), [
    ("linear jeffcott --vary s=1:2:5", "--vary: found it without --response"),
    ("linear jeffcott --nonlinear 4", "--nonlinear: found it without --response"),
    (f"{SMALL} --probe rotr", "expected one of rotor"),
    (f"{SMALL} --threshold s=1:3", "--threshold: found it with --response"),
    (f"{SMALL} --over none.nc", "no such file"),
    (f"{SMALL} --over none.nc --nonlinear 3", "expected one of them"),
    ("linear jeffcott --set b=0.1 --response --vary Gamma=1:2:9", "another parameter than the speed"),
    ("linear duffing --response", "declares no speed"),
])  # fmt: skip
def test_wrong_input_is_refused(line, words):
    result = run(line, 2)
    assert not result.stdout and words in " ".join(result.stderr.split())


def test_a_damper_has_none_and_that_is_an_answer():
    assert "no eigenvalues" in run("linear machines/aero-damper --response").stdout
    assert "no eigenvalues" in json.loads(run("linear machines/aero-damper --response --json").stdout)["note"]
