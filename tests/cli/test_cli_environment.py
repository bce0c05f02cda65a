"""Disks that are full, homes that cannot be written, files of other editors, terminals of other kinds."""

import errno
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import whirlmap
from whirlmap.cli.main import app
from whirlmap.results import files
from whirlmap.units import read

PROGRAM = [sys.executable, "-c", "from whirlmap.cli.main import run; run()"]


@pytest.fixture(autouse=True)
def empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def refused(line):
    result = CliRunner().invoke(app, line.split())
    assert result.exit_code == 2, (result.stderr, result.exception)
    return result.stderr


def program(line, **environment):
    done = subprocess.run(
        [*PROGRAM, *line.split()], env={**os.environ, **environment}, capture_output=True, encoding="utf-8", timeout=120
    )
    assert done.returncode == 0, done.stderr
    return done


@pytest.mark.parametrize("fault", [OSError(errno.ENOSPC, "No space left on device"), RuntimeError("NetCDF: HDF error")])
def test_a_full_disk_is_called_that_and_the_result_is_kept_elsewhere(fault, tmp_path, monkeypatch):
    (full := tmp_path / "full").mkdir()
    write = xr.Dataset.to_netcdf

    def refuse(self, path, **options):
        if path.parent.name == "full":
            raise fault
        return write(self, path, **options)

    monkeypatch.setattr(xr.Dataset, "to_netcdf", refuse)
    monkeypatch.setattr(files, "_full", lambda _: True)
    monkeypatch.setattr(files, "_device", lambda folder: "full" if folder.name == "full" else "other")
    monkeypatch.setattr(files.tempfile, "gettempdir", lambda: str(tmp_path))
    message = refused("simulate duffing --periods 2 --out full/x.nc --quiet")
    assert "full/x.nc: cannot be written (the disk is full); kept instead: " in message
    kept = message.strip().rpartition(" ")[2]
    assert xr.load_dataset(kept).sizes["time"] > 100
    assert not list(full.iterdir())


def test_where_no_disk_has_room_that_is_said(tmp_path, monkeypatch):
    def refuse(self, path, **options):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", refuse)
    monkeypatch.setattr(files, "_device", lambda folder: folder)
    assert "the disk is full); no other disk had room" in refused("simulate duffing --periods 2 --out x.nc --quiet")
    assert not list(tmp_path.iterdir())


def test_a_full_disk_without_any_other_place_is_still_called_full(tmp_path, monkeypatch):
    """No folder for passing files, and no home."""
    def refuse(self, path, **options):
        raise OSError(errno.ENOSPC, "No space left on device")

    def nowhere():
        raise FileNotFoundError("No usable temporary directory found")

    def homeless():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", refuse)
    monkeypatch.setattr(files.tempfile, "gettempdir", nowhere)
    monkeypatch.setattr(files.Path, "home", homeless)
    assert "the disk is full); no other disk had room" in refused("simulate duffing --periods 2 --out x.nc --quiet")


def test_a_home_that_cannot_be_written_costs_the_cache_alone(tmp_path):
    (tmp_path / "home").write_text("a file, so that no folder can be made in it, by root neither")
    home = str(tmp_path / "home")
    gone = {"HOME": home, "XDG_CACHE_HOME": f"{home}/cache", "WHIRLMAP_CACHE": "", "MPLCONFIGDIR": str(tmp_path)}
    done = program("simulate duffing --periods 2 --json", **gone)
    assert done.stdout.startswith("{")
    assert done.stderr.count("compiled kernels are not kept") == 1 and "WHIRLMAP_CACHE" in done.stderr
    assert "warning: compiled" in done.stderr and ".py" not in done.stderr


def test_a_byte_order_mark_is_no_part_of_a_case_file(tmp_path):
    (tmp_path / "mine.toml").write_bytes(b'\xef\xbb\xbfextends = "duffing"\r\n')
    assert whirlmap.load("mine.toml").values == whirlmap.load("duffing").values


def test_a_byte_order_mark_is_no_part_of_a_model_file(tmp_path):
    model = 'from whirlmap.equations import *\nx = State("x", "1", "x")\n'
    model += 'M = Model("m", (x,), (), {x: -x}, section=Section(x, "rising"))\n'
    (tmp_path / "mine.py").write_bytes(b"\xef\xbb\xbf" + model.encode())
    (tmp_path / "mine.toml").write_text('model = "mine.py:M"\n')
    assert whirlmap.load("mine.toml").states == ("x",)


@pytest.mark.parametrize("text", ["60 C", "60 °C", "60 degC", "60°C", "333.15 K", "140 F", "140 °F"])
def test_temperatures_as_people_write_them(text):
    assert float(read(text, "degC")) == 60


@pytest.mark.parametrize(
    "line",
    [
        "map duffing --vary gamma=0.1:0.7:100000 --vary omega=0.6:1.6:100000 --store m",
        "map duffing --vary gamma=0.1:0.7:100 --draw omega=normal:1% --draws 100000000 --store m",
        "basins duffing --grid x=-1:1:100000 --grid v=-1:1:100000",
        "attractors duffing --starts 10000000000",
        "speeds machines/jeffcott-rig --points 10000000000",
        "speeds machines/jeffcott-rig --points 4 --input-tolerance c=5% --draws 10000000000",
        "improve machines/jeffcott-rig --vary c=60um:140um:2 --points 10000000000",
        "improve machines/jeffcott-rig --vary c=60um:140um:100000 --vary xi=0.01:0.02:100000",
    ],
)
def test_ten_thousand_million_points_are_refused_before_anything_is_made(line, tmp_path, monkeypatch):
    large = []
    linspace = np.linspace
    monkeypatch.setattr(np, "linspace", lambda a, b, n=50, **k: large.append(n) or linspace(a, b, min(n, 100), **k))
    assert "expected at most 1e+09" in refused(line)
    assert not large or max(large) < 1000
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "line", ["--help", "map --help", "show gear-psfd/machine", "cases", "show duffing --json", "show duffing"]
)
def test_an_ascii_terminal_gets_letters_that_it_has(line):
    said = program(line, PYTHONIOENCODING="ascii", COLUMNS="100").stdout
    assert said.isascii() and "?" not in said.replace("(?", "")


@pytest.mark.parametrize("columns", [60, 100, 200])
def test_piped_tables_are_as_wide_as_columns_says(columns):
    said = program("show gear-psfd/machine", COLUMNS=str(columns)).stdout
    table = said[said.index("Dimensional inputs") :].splitlines()
    widest = max(len(line.rstrip()) for line in table[: table.index("Groups") if "Groups" in table else 30])
    assert columns - 40 < widest <= columns


def test_a_description_is_wrapped_between_words(tmp_path):
    said = program("show gear-psfd/machine", COLUMNS="60").stdout
    words = said[: said.index("warning:")].splitlines()[1:]
    assert len(words) > 5 and max(map(len, words)) <= 60 and "".join(words).replace(" ", "").endswith("clock.")


def test_letters_of_cases_that_an_ascii_terminal_lacks_are_written_plainly(tmp_path):
    text = 'extends = "machines/aero-damper"\ndescription = "Größe in µm – für 60 °C"\n'
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    assert "Grosse in um - fur 60 deg C" in program("show mine.toml", PYTHONIOENCODING="ascii").stdout


def test_a_table_that_a_full_disk_refuses_is_kept_elsewhere_too(tmp_path, monkeypatch):
    (tmp_path / "full").mkdir()
    write = np.savetxt

    def refuse(path, *args, **options):
        if path.parent.name == "full":
            raise OSError(errno.ENOSPC, "No space left on device")
        return write(path, *args, **options)

    monkeypatch.setattr(np, "savetxt", refuse)
    monkeypatch.setattr(files, "_device", lambda folder: "full" if folder.name == "full" else "other")
    monkeypatch.setattr(files.tempfile, "gettempdir", lambda: str(tmp_path))
    message = refused("simulate duffing --periods 2 --out full/x.csv --quiet")
    kept = message.strip().rpartition(" ")[2]
    assert "kept instead" in message and len(Path(kept).read_text().splitlines()) > 100
