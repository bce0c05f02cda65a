"""Diagnosis of recorded signals: verdicts, files, and clear refusals."""

import json
import shlex

import numpy as np
import pytest
from scipy.signal import lfilter
from tests.analysis.maps import GOLDEN, henon, sines
from typer.testing import CliRunner

from whirlmap.cli.main import app


def run(line):
    return CliRunner(env={"COLUMNS": "80"}).invoke(app, shlex.split(line))


def write(folder, values, name="signal.csv", head="t,y"):
    file = folder / name
    rows = [head] if head else []
    file.write_text("\n".join([*rows, *(f"{k / 100},{v!r}" for k, v in enumerate(np.asarray(values).tolist()))]) + "\n")
    return file


def test_chaos_in_a_file(tmp_path):
    file = write(tmp_path, henon(4000)[:, 0])
    result = run(f"diagnose --series {file} --column y --rate 1 --json --out {tmp_path / 'sheet.png'}")
    assert result.exit_code == 0, result.stderr
    verdict = json.loads(result.stdout, parse_constant=pytest.fail)
    assert verdict["regime"] == "chaotic"
    assert verdict["lyapunov"] == pytest.approx(0.41922, rel=0.1)
    assert verdict["correlation_dimension"] == pytest.approx(1.22, abs=0.1)
    assert verdict["embedding_dimension"] == 2
    assert (tmp_path / "sheet.png").stat().st_size > 20_000


def test_regular_motion_in_a_file(tmp_path):
    """A sine with its second harmonic and 1 % noise, 250 samples a swing; and two sines."""
    noise = 0.01 * np.random.default_rng(0).normal(size=20_000)
    one = run(f"diagnose --series {write(tmp_path, sines(20_000, 1 / 250, 2 / 250) + noise)} --column 2 --rate 25600")
    assert one.exit_code == 0, one.stderr
    assert one.stdout.startswith("signal.csv: periodic") and "The signal is periodic." in one.stdout
    file = write(tmp_path, sines(20_000, GOLDEN / 60, 0.41421356 / 60) + noise)
    two = run(f"diagnose --series {file} --column y --rate 100 --json")
    assert json.loads(two.stdout)["regime"] == "quasi-periodic"


NOISE = {
    "white": ([1.0], [1.0]),
    "resonant": ([1.0], [1.0, -1.8, 0.95]),
    "sharply resonant": ([1.0], [1.0, -1.95, 0.98]),
    "smooth": (np.hanning(30), [1.0, -1.97, 0.99]),
}


@pytest.mark.parametrize("name", NOISE)
def test_noise_is_undecided(tmp_path, name):
    """Also where a resonance colours it, so that it swings like an oscillator, or where it is smooth."""
    noise = lfilter(*NOISE[name], np.random.default_rng(3).normal(size=10_000))[2000:]
    file = write(tmp_path, noise)
    assert json.loads(run(f"diagnose --series {file} --column y --rate 1 --json").stdout)["regime"] == "undecided"


@pytest.mark.parametrize(
    ("content", "options", "message"),
    [
        (None, "--column y --rate 1", "cannot be read"),
        (b"\xff\xfe\x00\x80", "--column y --rate 1", "no text"),
        (b"", "--column y --rate 1", "found nothing"),
        (b"t,y\n", "--column y --rate 1", "no rows of numbers"),
        (b"t,y\n1,2\n2,x\n", "--column y --rate 1", "line 3: found 'x'"),
        (b"t,y\n1,2\n2\n", "--column y --rate 1", "line 3: found 1 column,"),
        (b"t,y\n1,2\n2,nan\n", "--column y --rate 1", "line 3: found 'nan'"),
        (b"t,y\n1,2\n", "--column z --rate 1", "no column 'z'"),
        (b"t,y\n1,2\n", "--column 3 --rate 1", "no column '3'"),
        (b"t,y\n1,2\n", "--rate 1", "expected --column"),
        (b"t,y\n1,2\n2,3\n", "--column y --rate 1", "at least 1000 samples"),
        (b"y\n" + 2000 * b"1.5\n", "--column y --rate 1", "constant"),
        (b"y\n" + 2000 * b"1.5\n", "--rate -1", "positive"),
        (b"y\n1\n", "", "--rate: missing"),
        (b"y\n1\n", "--rate 1 --set gamma=1", "--set: found it beside --series"),
    ],
)  # fmt: skip
def test_refusals(tmp_path, content, options, message):
    file = tmp_path / "signal.csv"
    if content is not None:
        file.write_bytes(content)
    result = run(f"diagnose --series {file} {options}")
    assert result.exit_code == 2
    assert message in result.stderr
    assert result.stderr.count("\n") <= 3 and "Traceback" not in result.stderr


def test_a_case_or_a_series_is_needed(tmp_path):
    assert "missing CASE" in run("diagnose").stderr
    assert "without --series" in run("diagnose duffing --rate 5").stderr
    assert "CASE: found it beside --series" in run(f"diagnose duffing --series {tmp_path / 'x.csv'} --rate 5").stderr
