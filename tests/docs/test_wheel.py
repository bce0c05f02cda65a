"""The wheel: pure, whole, and of use from another folder, by a Python that knows nothing of the checkout."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
#: What is built from; a copy, for a build leaves folders beside what it builds.
SOURCES = ("pyproject.toml", "README.md", "LICENSE")


def run(*words, **options):
    done = subprocess.run(words, capture_output=True, text=True, timeout=200, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    for name in SOURCES:
        shutil.copy(ROOT / name, folder)
    shutil.copytree(ROOT / "src", folder / "src", ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
    alone = ("--quiet", "--no-deps", "--no-build-isolation")  # nothing is downloaded
    run(sys.executable, "-m", "pip", "wheel", *alone, "--wheel-dir", "dist", ".", cwd=folder)
    (built,) = (folder / "dist").iterdir()
    return built


def test_it_is_for_every_python_and_platform_and_has_every_file(wheel):
    assert wheel.name.endswith("-py3-none-any.whl")
    held = set(zipfile.ZipFile(wheel).namelist())
    ours = {p.relative_to(ROOT / "src").as_posix() for p in (ROOT / "src" / "whirlmap").rglob("*") if p.is_file()}
    assert {name for name in ours if "__pycache__" not in name} <= held
    assert not [name for name in held if name.startswith(("tests", "benchmarks"))]


def test_it_works_from_another_folder(wheel, tmp_path):
    """Dependencies are those of the tests; whirlmap itself is that of the wheel."""
    site, work = tmp_path / "site", tmp_path / "work"
    work.mkdir()
    run(sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--target", str(site), str(wheel))
    environment = {**os.environ, "PYTHONPATH": str(site), "COLUMNS": "120"}
    home = run(sys.executable, "-c", "import whirlmap; print(whirlmap.__file__)", cwd=work, env=environment)
    assert Path(home.strip()).is_relative_to(site)
    program = (sys.executable, "-m", "whirlmap")
    assert "label-one-point" in run(*program, "recipes", cwd=work, env=environment)
    said = run(*program, "diagnose", "duffing", "--set", "gamma=0.29", "--quiet", cwd=work, env=environment)
    assert said.startswith("duffing: periodic, 4T")
