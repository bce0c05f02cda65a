"""``whirlmap explore``: serves a page until Ctrl-C, and refuses what it cannot show before it does."""

import json
import os
import signal
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pytest
from typer.testing import CliRunner

from whirlmap.cli.main import app

PROGRAM = [sys.executable, "-m", "whirlmap", "explore"]


def test_it_serves_while_a_map_fills_and_ends_with_ctrl_c(tmp_path: Path) -> None:
    words = ["duffing", "--vary", "gamma=0.2:0.5:60", "--vary", "omega=0.8:1.4:60", "--no-browser", "--json"]
    process = subprocess.Popen(
        [*PROGRAM, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path, start_new_session=True
    )
    try:
        assert process.stdout is not None
        said = json.loads(process.stdout.readline())
        assert said["varied"] == ["gamma", "omega"]
        with urllib.request.urlopen(said["address"] + "data", timeout=60) as answer:
            data = json.load(answer)
        assert (data["kind"], data["filling"]) == ("map", 1)
        process.send_signal(signal.SIGINT)
        rest, message = process.communicate(timeout=60)
    finally:
        process.kill()
    assert (process.returncode, rest) == (0, "")
    assert "Traceback" not in message
    assert list(tmp_path.iterdir()) == []
    time.sleep(0.2)
    with pytest.raises(ProcessLookupError):  # nobody is left of its session
        os.killpg(process.pid, 0)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("nothing.toml", "nothing.toml"),
        ("duffing --vary gamma=0.2:0.5:40 --vary omega=1:2:3 --vary delta=0.1:0.2:3", "expected one for a diagram"),
        ("duffing --vary gamm=0.2:0.5:40", "gamm"),
        ("duffing --vary gamma=0.2:0.5:40 --store there", "--store with two"),
        ("duffing --vary gamma=0.2:0.5:40 --follow along", "--follow"),
        ("duffing --vary gamma=0.2:0.5:4000 --vary omega=1:2:4000", "found 16000000 points"),
        ("duffing --vary gamma=0.2:0.5:99999999", "expected at most 1000000 in a page"),
        ("duffing --case duffing", "--case"),
        ("duffing --token short", "--token"),
        ("gone.nc", "gone.nc"),
    ],
)
def test_what_cannot_be_shown_is_refused(words: str, says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, ["explore", *words.split(), "--no-browser"])
    assert result.exit_code == 2
    assert says in result.stderr
