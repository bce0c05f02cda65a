"""Size, resolution and title of the pictures that commands draw."""

import inspect
import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

from whirlmap.cli.main import COMMANDS, app, loaded

WORK = "simulate duffing --periods 3 --quiet"


@pytest.fixture(autouse=True)
def empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def run(line):
    return CliRunner().invoke(app, shlex.split(line))


@pytest.mark.parametrize(
    ("options", "pixels"),
    [
        ("--size 4x3", (800, 600)),
        ("--size 6.4x4.8 --dpi 100", (640, 480)),  # matplotlib's own size
        ("--size 127x76.2mm --dpi 100", (500, 300)),
        ('--size "12.7 x 7.62 cm" --dpi 50', (250, 150)),
    ],
)
def test_a_picture_has_the_size_that_was_asked_for(options, pixels):
    done = run(f"{WORK} --out a.png {options}")
    assert done.exit_code == 0, done.stderr
    header = Path("a.png").read_bytes()[16:24]
    assert (int.from_bytes(header[:4], "big"), int.from_bytes(header[4:], "big")) == pixels


def test_a_machine_is_drawn_in_the_size_that_was_asked_for():
    done = run('show machines/two-shaft-gearbox --out a.svg --size 6x8 --title "Rig of hall 3"')
    assert done.exit_code == 0, done.stderr
    text = Path("a.svg").read_text(encoding="utf-8")
    assert 'width="432pt" height="576pt"' in text and "<!-- Rig of hall 3 -->" in text


def test_a_title_replaces_that_of_the_picture():
    for title, there in (("Rig of hall 3", True), ("", False)):
        assert run(f'{WORK} --out a.svg --force --title "{title}"').exit_code == 0
        text = Path("a.svg").read_text(encoding="utf-8")
        assert ("<!-- Rig of hall 3 -->" in text) == there and "<!-- duffing -->" not in text


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("--size 4x3", "--size: found it without a picture, expected --out NAME.png"),
        ("--out a.nc --dpi 100", "--dpi: found it without a picture"),
        ("--out a.csv --title x", "--title: found it without a picture"),
        ("--out a.png --size 4", "expected width x height in inches"),
        ("--out a.png --size 4x3kg", "found the unit 'kg'"),
        ("--out a.png --size 0x3", "each from 1 to 200"),
        ("--out a.png --size 1.2.3x3", "--size: "),
        ("--out a.png --size 150x100", "expected at most 1e+08 dots"),
    ],
)
def test_sizes_that_are_none_are_refused_before_anything_is_computed(options, message, tmp_path):
    done = run(f"{WORK} {options}")
    assert done.exit_code == 2 and message in done.stderr and not list(tmp_path.iterdir())


def test_every_command_that_draws_one_picture_takes_them():
    several = {"reproduce", "identify"}  # many pictures, each of its own size and title
    every = {name: set(inspect.signature(loaded(name).callback).parameters) for name in COMMANDS}
    drawing = {name: options for name, options in every.items() if {"out", "picture"} & options}
    assert len(drawing) > 9 and several < set(drawing)
    for name, options in drawing.items():
        assert name in several or {"size", "dpi", "title"} <= options, name
