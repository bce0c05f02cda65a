"""What installing meets: which Python `make` takes, what it installs, and what the metadata promise."""

import os
import re
import shlex
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

from whirlmap.cli.main import app

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


@pytest.fixture
def bare(tmp_path):
    """A folder with the Makefile, and a PATH on which there is no Python."""
    if shutil.which("make") is None:
        pytest.skip("there is no make")
    for name in ("Makefile", "pyproject.toml", "constraints.txt"):
        shutil.copy(ROOT / name, tmp_path)
    (tmp_path / "bin").mkdir()
    for tool in ("sh", "echo", "touch"):
        (tmp_path / "bin" / tool).symlink_to(shutil.which(tool))
    return tmp_path


def pretend(folder, name, version, *, new):
    path = folder / "bin" / name
    path.write_text(f'#!/bin/sh\ncase "$1" in --version) echo "Python {version}";; -c) exit {0 if new else 1};; esac\n')
    path.chmod(0o755)


def make(folder, *targets):
    return subprocess.run(
        [shutil.which("make"), *targets], cwd=folder, capture_output=True, text=True, timeout=60,
        env={"PATH": str(folder / "bin"), "HOME": os.environ.get("HOME", "")},
    )  # fmt: skip


def test_make_says_what_is_missing(bare):
    done = make(bare, "setup")
    assert done.returncode and "needs Python 3.11 or newer" in done.stderr
    pretend(bare, "python3", "3.9.2", new=False)
    assert "Found: Python 3.9.2" in make(bare, "setup").stderr


def test_make_takes_the_first_python_that_is_new_enough(bare):
    pretend(bare, "python3", "3.9.2", new=False)
    pretend(bare, "python3.12", "3.12.1", new=True)
    assert '"python3.12" -m venv' in make(bare, "-n", "setup").stdout


def test_reproducing_needs_no_test_tools(bare):
    pretend(bare, "python3", "3.13.0", new=True)
    planned = make(bare, "-n", "reproduce").stdout
    assert "--editable ." in planned and "test" not in planned
    assert "[test]" in make(bare, "-n", "test").stdout
    assert "activate" in make(bare, "-n", "setup").stdout


def test_metadata_say_for_whom_and_for_which_python():
    assert PROJECT["requires-python"] == ">=3.11" and "rotordynamics" in PROJECT["keywords"]
    tried = [f"Programming Language :: Python :: 3.{minor}" for minor in (11, 12, 13)]
    assert [c for c in PROJECT["classifiers"] if re.search(r":: 3\.\d", c)] == tried
    assert not [c for c in PROJECT["classifiers"] if "License" in c]  # the expression says it; both together are refused


def test_the_first_screen_says_for_whom_how_to_install_and_what_to_type():
    screen = "\n".join((ROOT / "README.md").read_text(encoding="utf-8").splitlines()[:40])
    for words in ("engineer", "pip install", "Python 3.11", "whirlmap new", "whirlmap show", "whirlmap speeds"):
        assert words in screen


def test_the_readme_shows_what_its_first_command_prints():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    command = re.search(r"^    whirlmap (diagnose duffing .*?)  ", text, re.MULTILINE)[1]
    said = CliRunner().invoke(app, [*shlex.split(command), "--quiet"]).stdout.splitlines()[0]
    assert f"The first command prints `{said}`" in text
