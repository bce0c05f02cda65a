"""What every command promises, tested over all that are registered."""

import json
import re
import shlex
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from whirlmap.cli import main
from whirlmap.cli.main import app

COMMANDS = {name: main.loaded(name) for name in main.COMMANDS}

#: The least work with which each command prints its JSON; reproduce, identify and bench have tests of their own.
SMALL = {
    "recipes": "recipes",
    "cases": "cases",
    "show": "show duffing",
    "simulate": "simulate duffing --periods 2",
    "diagnose": "diagnose duffing --set gamma=0.2 --transient 20 --max-periods 64",
    "bifurcation": "bifurcation duffing --vary gamma=0.2:0.21:2 --transient 20",
    "cache": "cache",
    "linear": "linear jeffcott",
    "campbell": "campbell jeffcott --vary s=1:2:5",
    "continue": "continue duffing --vary gamma=0.2:0.21 --transient 20",
    "attractors": "attractors duffing --set gamma=0.2 --starts 4 --transient 20 --lyapunov 256",
    "basins": "basins duffing --set gamma=0.2 --grid x=-1:1:3 --grid v=-1:1:3 --transient 20 --lyapunov 256",
    "speeds": "speeds machines/jeffcott-rig --points 3 --transient 20",
    "improve": "improve machines/jeffcott-rig --vary Gamma=1:2:2 --points 3 --transient 20 --coarse",
    "map": "map duffing --vary gamma=0.2:0.21:2 --transient 20",
}

#: What programs read of each: these keys stay. Those of `diagnose` are the contract of the design.
KEYS = {
    "recipes": "recipes",
    "cases": "cases",
    "show": "case model switches parameters states outputs inputs quantities clocks start warnings period common_period",
    "simulate": "case model parameters period samples time motion status end_time files incomplete units",
    "diagnose": "regime period period_common period_turns confidence lyapunov lyapunov_error lyapunov_per_common_period"
    " phase_exponent kaplan_yorke correlation_dimension correlation_dimension_error indicators amplitude max_eccentricity"
    " min_film status",
    "bifurcation": "case model parameters varied values follow sweeps hysteresis files incomplete units",
    "cache": "path kernels lowered bytes processor roots",
    "linear": "case model equilibrium eigenvalues stable films threshold units",
    "campbell": "case model varied values frequency growth damping_ratio whirl line critical modes shapes status",
    "continue": "case model parameters varied unit branches doubts assumptions files incomplete",
    "attractors": "case model attractors outcomes starts box seed files incomplete",
    "basins": "case model attractors outcomes grid starts files incomplete",
    "speeds": "s rpm limit limit_um verdict verdicts windows stretches margin amplitude min_film max_load operation units",
    "improve": "case varied designs widest calmest limit limit_um s files incomplete units",
    "map": "case model varied points regimes chunks chunks_failed store files incomplete",
}  # fmt: skip


def run(line, **more):
    return CliRunner(env={"COLUMNS": "80"}, **more).invoke(app, shlex.split(line))


@pytest.mark.parametrize("name", COMMANDS)
def test_the_list_says_what_the_command_says(name):
    """The line of the list stands beside the name, for the command is not imported for it."""
    assert " ".join(COMMANDS[name].help.partition("\n\n")[0].split()) == main.COMMANDS[name]


@pytest.mark.parametrize("name", COMMANDS)
def test_help_explains_every_option_and_gives_examples(name):
    """At 80 columns no name may be cut."""
    command = COMMANDS[name]
    result = run(f"{name} --help")
    assert result.exit_code == 0
    assert "Examples" in result.stdout and f"whirlmap {name}" in result.stdout
    for parameter in command.params:
        names = parameter.opts if parameter.param_type_name == "option" else [parameter.metavar]
        for option in names:
            assert option in result.stdout, f"{name} --help does not mention {option}"
        assert parameter.help, f"{name}: {parameter.name} has no help"


@pytest.mark.parametrize("name", COMMANDS)
def test_examples_use_options_that_exist(name):
    """Every example names options and, where it takes one, a case that the program knows."""
    command = COMMANDS[name]
    known = {option for p in command.params for option in (*p.opts, *p.secondary_opts)}
    examples = re.findall(r"`(.+?)`", command.epilog.partition("Examples")[2])
    assert examples
    for line in examples:
        words = shlex.split(line)
        at = words.index("whirlmap")
        assert words[at + 1] == name
        assert {w for w in words if w.startswith("--")} <= known


@pytest.mark.parametrize("name", [n for n in COMMANDS if n not in {"reproduce", "identify", "bench", "new", "explore"}])
def test_json_is_one_object_alone_on_stdout(name):
    result = run(f"{SMALL[name]} --json")
    assert result.exit_code == 0, result.stderr
    facts = json.loads(result.stdout, parse_constant=pytest.fail)
    assert set(KEYS[name].split()) <= set(facts)
    if name == "diagnose":
        assert (facts["regime"], facts["period"], facts["status"]) == ("periodic", 1, "ok")
        assert len(facts["lyapunov"]) == len(facts["lyapunov_error"]) == 2
        assert facts["lyapunov"] == sorted(facts["lyapunov"], reverse=True)
        assert set(facts["amplitude"]["x"]) >= {"peak_to_peak", "rms"}
        assert all("vote" in vote for vote in facts["indicators"].values())


@pytest.mark.parametrize("name", COMMANDS)
def test_wrong_input_ends_with_two_and_one_message(name, tmp_path, monkeypatch):
    """Nothing on stdout, no traceback, and no file."""
    monkeypatch.chdir(tmp_path)
    done = run(f"{name} no-such-case --json" if name != "new" else "new no-such-case")
    assert done.exit_code == 2 and done.stdout == "" and list(tmp_path.iterdir()) == []
    assert done.stderr.startswith("error: ") and done.stderr.count("error:") == 1 and "Traceback" not in done.stderr


@pytest.mark.parametrize("name", [n for n in COMMANDS if n not in {"reproduce", "identify", "bench", "new", "explore"}])
def test_without_out_no_file_is_written(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = run(SMALL[name])
    assert result.exit_code == 0 and result.stdout.strip()
    assert list(tmp_path.iterdir()) == []


def test_program_without_a_command_shows_its_help():
    assert "Commands" in run("").stdout
    assert run("--version").stdout.startswith("whirlmap ")


def test_help_and_version_import_nothing_heavy():
    """The rest of a second is for Python, typer and rich."""
    heavy = ("numba", "numpy", "xarray", "sympy", "matplotlib", "pint", "scipy")
    for option in ("--help", "--version", "bifurcation --help", "map --help"):
        code = (
            "import sys; sys.argv = ['whirlmap', *sys.argv[1:]]\n"
            "from whirlmap.cli.main import app\n"
            "try: app()\n"
            f"except SystemExit: print([m for m in {heavy} if m in sys.modules], file=sys.stderr)"
        )
        done = subprocess.run([sys.executable, "-c", code, *option.split()], capture_output=True, text=True, timeout=60)
        assert done.stderr.strip() == "[]"


def test_a_defect_keeps_its_traceback(monkeypatch):
    """Only whirlmap's own errors become one message."""
    monkeypatch.setattr("whirlmap.kernels.cache.size", lambda: 1 / 0)
    assert isinstance(run("cache").exception, ZeroDivisionError)
