"""Wrong input: exit code 2, one message that says what was found and expected, and nothing else happens."""

import os
import shlex
import stat

import pytest
from typer.testing import CliRunner

from whirlmap.cli.main import app
from whirlmap.errors import nearest

VARY = "bifurcation duffing --vary"
MACHINE = "show gear-psfd/machine"

#: Command line, and what the message must contain, or after "!" must not.
WRONG = [
    ("sho duffing", "no such command 'sho'", "'show'"),
    ("show duffing --equation", "no option '--equation'", "'--equations'"),
    ("show", "missing CASE"),
    ("show duffing twice", "unexpected extra argument"),
    ("show dufing", "no case 'dufing'", "'duffing'", "gear-psfd/machine"),
    ("show nowhere.toml", "nowhere.toml does not exist"),
    ("show duffing --set gama=1", "no symbol 'gama'", "'gamma'"),
    ("show duffing --set gamma", "--set: found 'gamma', expected name=value"),
    ("show duffing --set gamma=", "expected name=value"),
    ("show duffing --set gamma=abc", "gamma: found 'abc', expected a number"),
    ("show duffing --set gamma=nan", "gamma: found 'nan', expected a finite number"),
    ("show duffing --set gamma=inf", "expected a finite number"),
    ("show duffing --set 'gamma=1 m'", "found the unit 'm', expected no unit"),
    ("show duffing --set omega=-1", "omega", "above 0"),
    ("show duffing --set gamma=1 --set gamma=2", "gamma is given twice", "'1'", "'2'"),
    ("show duffing --set start=1", "--start"),
    (f"{MACHINE} --set 'm_p=-1 kg'", "m_p: found -1 kg", "above 0", "mass of the pinion"),
    (f"{MACHINE} --set m_p=1", "m_p: found '1' without a unit, expected a unit such as kg"),
    (f"{MACHINE} --set 'm_p=1 m'", "m_p: found the unit 'm', expected a unit such as kg"),
    (f"{MACHINE} --set 'speed=1500 rpmm'", "unknown unit 'rpmm'", "'rpm'"),
    (f"{MACHINE} --set 'speed=1500 N'", "expected a unit such as rpm"),
    (f"{MACHINE} --set speed=fast", "expected a number with its unit, as in '1500 rpm'"),
    (f"{MACHINE} --set speed=1500", "without a unit", "as in '1500 rpm'"),
    (f"{MACHINE} --set 'R=25 rpn'", "unknown unit 'rpn', expected one such as m", "!Did you mean"),
    (f"{MACHINE} --set 'T_oil=60 kg'", "expected one of degC, K, degF"),
    (f"{MACHINE} --set preload=0.3", "preload is not modelled", "!Did you mean"),
    (f"{MACHINE} --set tilting_pads=4", "tilting pads are not modelled", "!Did you mean"),
    (f"{MACHINE} --set 'bearing=tilting pad'", "tilting pads are not modelled"),
    ("show jeffcott --set bearing=tilting_pad", "tilting pads are not modelled"),
    (f"{MACHINE} --set qwertz=1", "no symbol 'qwertz'", "!Did you mean"),
    (f"{MACHINE} --set PSI=1e-3", "'psi'"),
    (f"{MACHINE} --set edition=litteral", "edition", "litteral", "'literal'"),
    (f"{MACHINE} --set editon=literal", "'editon'", "'edition'"),
    (f"{MACHINE} --set 'clearance=50 um'", "Did you mean 'c'? (radial clearance of both bearings)"),
    (f"{MACHINE} --set 'viscosity=0.02 Pa*s'", "'mu' (viscosity of the lubricant)"),
    (f"{MACHINE} --set 'density=870 kg/m^3'", "Did you mean 'rho'"),
    ("show machines/turbo-gearbox --set 'power=60 kW'", "'P_t'? (power through the mesh"),
    ("show machines/turbo-gearbox --set 'beta=20 deg'", "'beta_c'? (direction from pinion to gear"),
    ("show machines/turbo-gearbox --set 'backlash=150 um'", "takes no number; j_n: backlash along the line of action"),
    ("show machines/turbo-gearbox --set 'stiffness=1e9 N/m'", "takes no number; K_m: lateral stiffness of the mesh"),
    (f"{MACHINE} --set rpm=1500", "rpm is a unit, as in speed = 1500 rpm", "!Did you mean"),
    (f"{MACHINE} --set 'D=50 mm'", "radius (R, R_1, R_2), half of the diameter", "!Did you mean"),
    (f"{MACHINE} --set 'k_d=50 mm'", "no symbol 'k_d'", "!diameter"),
    (f"{MACHINE} --set 'diameter=50 mm'", "half of the diameter"),
    (f"{MACHINE} --set 'omega=100 rad/s'", "is called speed"),
    ("show machines/jeffcott-rig --set 'supply_pressure=2 bar'", "how oil comes in is not modelled", "!Did you mean"),
    ("show machines/jeffcott-rig --set ux=0.5", "ux is a state", "--start", "!Did you mean"),
    ("show machines/jeffcott-rig --set eps=0.5", "eps is an output", "!Did you mean"),
    (f"{MACHINE} --set 'c=0,05 mm'", "found '0,05 mm' with a comma, expected a decimal point, as in '0.05 mm'"),
    (f"{MACHINE} --set 'mu=20 cSt'", "this is a kinematic viscosity"),
    (f"{MACHINE} --set 'mu=20 mPas'", "expected a unit such as Pa*s. Did you mean 'mPa*s'?"),
    ("show machines/jeffcott-rig --set VG=ISO32", "VG: found 'ISO32', expected a number (ISO VG", "!0.3"),
    ("show machines/jeffcott-rig --set 'T_oil=60 degR'", "expected one of degC, K, degF"),
    ("show machines/turbo-gearbox --set 'P_t=60 PS'", "expected a unit such as kW"),
    ("diagnose jeffcott-rig", "Did you mean 'machines/jeffcott-rig'?"),
    ("diagnose turbo", "Did you mean 'machines/geared-turbo-set' or 'machines/turbo-gearbox'?"),
    ("linear machines/jeffcott-rig --threshold speed=1000:2000", "without units", "speed=500 rpm:6000 rpm"),
    ("improve machines/jeffcott-rig --vary c=60:140:5", "expected its unit, such as m"),
    ("improve machines/jeffcott-rig --vary clearance=60um:140um:5", "'c'? (radial clearance of both bearings)"),
    ("campbell machines/jeffcott-rig --vary c=50um:100um:9", "dimensional input 'c'", "improve takes", "feeds s"),
    ("bifurcation machines/jeffcott-rig --vary c=50:100:9", "c has a dimension", "values with their unit"),
    ("bifurcation machines/jeffcott-rig --vary limit=5um:10um:9", "limit: found", "that changes nothing"),
    (f"{MACHINE} --start u1x=1.2", "u1x = 1.2", "touches its bearing"),
    (f"{MACHINE} --start u1z=0.2", "no state 'u1z'", "u1x u1y"),
    (f"{MACHINE} --start u1x=nan", "u1x: found 'nan', expected a finite number"),
    (f"{MACHINE} --start u1x=0.1 --start u1x=0.2", "u1x is given twice"),
    ("show jeffcott --start ux=-1.0", "ux = -1", "touches its bearing"),
    ("simulate duffing --steps 0", "steps per T must lie between 1 and 1000000, not 0"),
    ("simulate duffing --steps 1e12", "--steps: found '1e12', expected a whole number"),
    ("simulate duffing --steps 10 --steps 20", "--steps is given twice: found '10' and '20'"),
    ("simulate duffing --steps=10 --steps 20", "--steps is given twice"),
    ("simulate duffing --periods -1", "periods must lie between 1 and"),
    ("simulate duffing --periods 99999999", "memory"),
    ("simulate duffing --transient -1", "transient must lie between 0 and"),
    ("simulate duffing --every 7 --steps 64 --periods 4", "every = 7"),
    ("simulate duffing --workers 0", "--workers: found '0', expected at least 1"),
    ("simulate duffing --method rk5", "no method 'rk5'", "'rk4'"),
    ("diagnose duffing --exponents 5", "duffing has 2 exponents"),
    ("diagnose duffing --max-periods 0", "--max-periods: found '0', expected at least 32"),
    ("bifurcation duffing", "missing --vary"),
    (f"{VARY} gamma", "cannot read the range 'gamma': expected name=start:stop:count"),
    (f"{VARY} gama=0:1:10", "no parameter 'gama'", "'gamma'"),
    (f"{VARY} gamma=1:1:10", "stop 1 must be above start 1"),
    (f"{VARY} gamma=1:0:10", "ranges ascend"),
    (f"{VARY} gamma=nan:1:10", "start must be a finite number"),
    (f"{VARY} gamma=0:1:1e12", "count '1e12' is not a whole number"),
    (f"{VARY} gamma=0:1:1000000000000", "count must lie between 2 and 100000000"),
    (f"{VARY} gamma=0:1:90000000", "memory"),
    (f"{VARY} gamma=0:1:-5", "count must lie between 2"),
    (f"{VARY} gamma=0:1:9:log", "above zero"),
    (f"{VARY} omega=-1:1:9", "omega = -1 must be above 0"),
    (f"{VARY} gamma=0:1:9 --vary omega=1:2:9", "--vary is given twice"),
    (f"{VARY} gamma=0:1:9 --set gamma=1", "gamma: found it in --set and in --vary"),
    (f"{VARY} gamma=0:1:9 --follow upp", "--follow: found 'upp', expected up | down | both", "'up'"),
    (f"{VARY} gamma=0:1:9 --plot q", "no state 'q'", "x v"),
    (f"{VARY} gamma=0:1:9 --lyapunov 3", "lyapunov must be 0, or from 16"),
    (f"{VARY} gamma=0:1:9 --tolerance 2", "tolerance must lie between 0 and 1"),
    (f"{VARY} gamma=0:1:9 --keep 0", "keep must lie between 1"),
    ("bifurcation gear-psfd/machine --vary mu=1:2:9", "mu has a dimension", "such as Pa*s"),
    ("reproduce --quality ful", "--quality: found 'ful', expected quick | full", "'full'"),
    ("simulate duffing --out no/x.nc", "no/x.nc: the folder no does not exist"),
    ("simulate duffing --out x.nx", "found the suffix '.nx', expected one of .nc .png .svg .pdf", "'.nc'"),
]


@pytest.fixture(autouse=True)
def empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def refused(line):
    """Run a command that must be refused; returns its one message."""
    before = sorted(p.name for p in os.scandir("."))
    result = CliRunner().invoke(app, shlex.split(line))
    assert result.exit_code == 2, (result.exit_code, result.exception, result.output)
    assert result.stdout == ""
    assert result.stderr.startswith("error: ") and result.stderr.count("error:") == 1
    for word in ("Traceback", "Value error", "Input should be", "╭"):
        assert word not in result.stderr
    assert sorted(p.name for p in os.scandir(".")) == before
    return result.stderr


@pytest.mark.parametrize(("line", "expected"), [(w[0], w[1:]) for w in WRONG], ids=[w[0] for w in WRONG])
def test_wrong_input_is_refused_in_plain_words(line, expected):
    message = refused(line)
    for words in expected:
        assert (words[1:] not in message) if words.startswith("!") else (words in message)


def test_a_name_in_another_case_comes_before_one_with_other_letters():
    assert nearest("MU_1", ["MU_2", "mu_1"]) == " Did you mean 'mu_1'?"


def test_a_file_named_without_its_ending_is_suggested(tmp_path):
    (tmp_path / "my_rotor.toml").write_text('model = "duffing"')
    assert "Did you mean the file 'my_rotor.toml'?" in refused("show my_rotor")


def test_kelvins_are_written_in_two_ways():
    lines = [f"show machines/jeffcott-rig --set 'T_oil=300 {unit}' --json" for unit in ("K", "degK")]
    one, other = (CliRunner().invoke(app, shlex.split(line)) for line in lines)
    assert one.exit_code == other.exit_code == 0
    assert '"value": 26.85' in one.stdout and '"value": 26.85' in other.stdout


@pytest.mark.parametrize("line", ["show duffing", "simulate duffing --periods 1"])
def test_an_option_may_be_repeated_with_the_same_value(line):
    result = CliRunner().invoke(app, shlex.split(f"{line} --set gamma=0.3 --set gamma=0.3"))
    assert result.exit_code == 0


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("model = ", "is not valid TOML"),
        ("", "found no model"),
        ('model = "dufing"', "'duffing'"),
        ('model = "duffing"\ngamma = { value = "x" }', "gamma"),
        ('extends = "duffing"\ngama = { value = 1, assumed = "x" }', "'gamma'"),
        ('extends = "duffing"\ngamma = { value = 1 }', "exactly one of"),
        ('extends = "duffing"\ngamma = { value = 1 }\ngamma = { value = 2 }', "key 'gamma' twice, in lines 2 and 3"),
        ('extends = "gear-psfd/machine"\n[gears]\n[film]\n[gears]\n', "found the table [gears] twice, in lines 2 and 4"),
        ("model = gear_pair", 'text stands in quotes, "gear_pair"'),
        ('extends = "gear-psfd/machine"\npsi = { value = 0,05, assumed = "x" }', "numbers have a decimal point, 0.05"),
        ('extends = "gear-psfd/machine"\npsi = { value = 1 assumed = "x" }', "separated by commas"),
        ('extends = "gear-psfd/machine"\npsi = { Value = 1, assumed = "x" }', "found no 'value' but 'Value'"),
        ('extends = "gear-psfd/machine"\n[switches]\nstiffness = "1e9"', "It is a switch, and takes no number; K_m"),
        ('extends = "gear-psfd/machine"\n[operation]\nspeed = 3', 'speed = { value = 1500, unit = "rpm", assumed = "why" }'),
        ('extends = "gear-psfd/machine"\n[bearings]\nR = 3', 'R = { value = 0.05, unit = "mm", assumed = "why" }'),
        ('extends = "gear-psfd/machine"\n[tilting_pads]\nn = { value = 3, assumed = "x" }', "tilting pads are not modelled"),
    ],
)
def test_a_malformed_case_file_is_named(text, expected, tmp_path):
    (tmp_path / "mine.toml").write_text(text)
    message = refused("show mine.toml")
    assert "mine.toml" in message and expected in message


def test_an_unreadable_case_file_is_named(tmp_path):
    (tmp_path / "mine.toml").mkdir()
    assert "mine.toml is not a file" in refused("show mine.toml")
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe\x00")
    assert "bytes.toml: is not text" in refused("show bytes.toml")


@pytest.mark.parametrize("command", ["simulate duffing", "diagnose duffing", f"{VARY} gamma=0:1:9"])
@pytest.mark.parametrize("place", ["here.nc", "here.png", "here"])
def test_what_exists_is_refused_before_anything_is_computed(command, place, tmp_path, monkeypatch):
    monkeypatch.setattr(f"whirlmap.cli.commands.{command.split()[0]}.open_system", lambda *_: pytest.fail("too late"))
    here = tmp_path / place
    if here.suffix:
        here.write_text("mine")
    else:
        here.mkdir()
        (here / "mine").write_text("mine")
    assert "--force" in refused(f"{command} --out {place}")
    assert (here if here.suffix else here / "mine").read_text() == "mine"


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_cannot_be_written_is_refused(tmp_path):
    locked = tmp_path / "locked"
    locked.mkdir()
    locked.chmod(stat.S_IRUSR | stat.S_IXUSR)
    assert "cannot be written" in refused("simulate duffing --out locked/x.nc")
