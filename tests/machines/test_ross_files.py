"""Rotors that ROSS saved: machine files written from them, shafts that name them, and files that cannot be read.

The files in `ross_files` were written by `rotor.save` of ROSS 2.3; the damped eigenvalues [rad/s] are its own.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import whirlmap
from whirlmap.cases.from_ross import from_ross
from whirlmap.cases.ross_file import read_ross
from whirlmap.cli.main import app
from whirlmap.errors import CaseError

FILES = Path(__file__).parent / "ross_files"


@pytest.mark.parametrize("name", ["rotor", "pedestal"])
def test_new_from_ross_writes_a_case_with_its_eigenvalues(tmp_path, name):
    """Layers of two materials, a hollow piece, tables of bearings with cross-coupling; a bearing on a mass with springs."""
    file, kept = tmp_path / "mine.toml", json.loads((FILES / "eigenvalues.json").read_text())
    made = CliRunner().invoke(app, ["new", str(file), "--from-ross", str(FILES / f"{name}.toml")])
    assert made.exit_code == 0, made.output
    speed = kept["speed"]
    system = whirlmap.load(file, speed=f"{speed} rad/s")
    theirs = np.array([complex(*z) for z in kept[name]])
    theirs = theirs[(np.abs(theirs) < 3 * speed) & (theirs.imag > -1e-6)]
    theirs = theirs[np.abs(theirs.real) > 1e-9 * np.abs(theirs)]  # without axial motion and torsion, which nothing damps
    assert theirs.size >= 2
    ours = whirlmap.linear_analysis(system).eigenvalues * speed
    error = np.abs(ours[None] - theirs[:, None]).min(axis=1) / np.abs(theirs)
    # ROSS interpolates coefficients between the rows of a table by another spline
    assert error.max() < (5e-3 if name == "pedestal" else 2e-2), (theirs, error)


def test_what_new_writes_runs(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text(from_ross(FILES / "rotor.toml") + '[[unbalance]]\nshaft = "rotor"\nat = 2\nU = "100 g*mm"\n')
    ds = whirlmap.simulate(whirlmap.load(file), periods=2)
    assert int(ds["status"]) == 0 and np.isfinite(ds["x"].values).all()


def test_a_shaft_may_name_the_file(tmp_path):
    """Its elements and disks are those of the written case; a station is a node."""
    whole = from_ross(FILES / "rotor.toml")
    (tmp_path / "rotor.toml").write_text((FILES / "rotor.toml").read_text())
    head, _, rest = whole.partition("elements = [")
    bearings = "[[bearing]]" + rest.partition("[[bearing]]")[2]
    (tmp_path / "named.toml").write_text(head + 'file = "rotor.toml"\n' + bearings)
    (tmp_path / "whole.toml").write_text(whole)
    named, written = (whirlmap.load(tmp_path / f"{name}.toml") for name in ("named", "whole"))
    ours, theirs = (np.sort_complex(whirlmap.linear_analysis(s).eigenvalues) for s in (named, written))
    assert ours == pytest.approx(theirs, rel=1e-9)


GOOD = (FILES / "rotor.toml").read_text()
ELEMENT = '["ShaftElement_Shaft Element 1"]'
#: What is wrong -> (text, what stands in its place), parts of the message.
WRONG = {
    "older version": ('ross_version = "2.3.0"', 'ross_version = "1.4.2"', ["ross_version", "'1.4.2'", "save it again"]),
    "no version": ('ross_version = "2.3.0"', "", ["no ross_version"]),
    "another element": ("[DiskElement_wheel]", "[GearElement_wheel]", ['["GearElement_wheel"]', "type GearElement"]),
    "cone": ("odr = 0.09", "odr = 0.11", ["Shaft Element 2", "odr", "cone"]),
    "layers": (f"{ELEMENT}\nL = 0.1\nidl = 0.0\nodl = 0.08\nidr = 0.0\nodr = 0.08\nn = 1",
               f"{ELEMENT}\nL = 0.1\nidl = 0.0\nodl = 0.08\nidr = 0.0\nodr = 0.08\nn = 0",
               ["Shaft Element 1", ": n:", "second element"]),
    "axial force": ("axial_force = 0", "axial_force = 1e4", ["Shaft Element 0", "axial_force"]),
    "shear of another kind": ('shear_method_calc = "cowper"', 'shear_method_calc = "hutchinson"', ["shear_method_calc"]),
    "text for a number": ("L = 0.12", 'L = "120 mm"', ["Shaft Element 2", ": L:", "number"]),
    "no material": ('["ShaftElement_Shaft Element 1".material]', '["Other".x]', ["Other"]),
    "no mass": ("m = 12.0", "", ["DiskElement_wheel", ": m:", "nothing"]),
    "added mass": ("mxx = [ 0, 0, 0,]", "mxx = [ 3, 0, 0,]", ["Bearing 0", "mxx", "added mass"]),
    "short table": ("kxx = [ 40000000.0, 50000000.0, 60000000.0,]", "kxx = [ 40000000.0, 50000000.0,]",
                    ["Bearing 0", "kxx", "found 2 values, expected 3"]),
    "no TOML": ("[parameters]", "[parameters", ["no TOML"]),
    "disk beyond the shaft": ("[DiskElement_wheel]\nn = 2", "[DiskElement_wheel]\nn = 9", ["wheel", "n: found 9", "0 to 4"]),
}  # fmt: skip


@pytest.mark.parametrize("fault", WRONG)
def test_the_message_names_file_table_and_key(tmp_path, fault):
    before, after, said = WRONG[fault]
    assert before in GOOD
    file = tmp_path / "wrong.toml"
    file.write_text(GOOD.replace(before, after, 1))
    with pytest.raises(CaseError) as error:
        read_ross(file)
    message = str(error.value)
    assert message.startswith(str(file)) and "\n" not in message
    for words in said:
        assert words in message, message


def test_a_link_to_nothing_and_a_missing_file(tmp_path):
    file = tmp_path / "wrong.toml"
    text = (FILES / "pedestal.toml").read_text()
    file.write_text(text.replace('["PointMass_Point Mass 0"]\nn = 5', '["PointMass_P"]\nn = 6'))
    with pytest.raises(CaseError, match="n_link: found node 5 without a point mass"):
        from_ross(file)
    with pytest.raises(CaseError, match=r"nothing\.toml: found no file"):
        from_ross(tmp_path / "nothing.toml")
    found = CliRunner().invoke(app, ["new", str(tmp_path / "x.toml"), "--from-ross", str(tmp_path / "nothing.toml")])
    assert found.exit_code == 2 and "nothing.toml" in found.output
