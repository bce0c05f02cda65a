"""Files that were read or judged wrongly once: refused with a reason, or read and called what they are."""

import json
import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

from whirlmap.cli.main import app

FILES = Path(__file__).with_name("files")


def run(line):
    return CliRunner(env={"COLUMNS": "80"}).invoke(app, shlex.split(line))


def diagnose(file, options):
    result = run(f"diagnose --series {FILES / file} {options} --json --quiet")
    assert result.exit_code == 0, result.stderr
    verdict = json.loads(result.stdout, parse_constant=pytest.fail)
    assert [f"warning: {w}" for w in verdict["warnings"]] == [line for line in result.stderr.splitlines() if line]
    return verdict


@pytest.mark.parametrize(
    ("file", "options", "frequency", "rate", "warned"),
    [
        ("c01-one-column-decimal-comma.csv", "--rate 1 --decimal ,", 0.04, 1, ""),
        ("c03-semicolon-comment.csv", "--column Ax", 7.3, 100, "100 samples per second"),
        ("c03-time-rounded-to-ms.csv", "--column a", 9.344, 128, "mean step of 0.0078125"),
        ("c04-meta-row.csv", "--column 2", 0.073 * 25600, 25600, "25600"),
        ("c04-meta-row.csv", "--column 2 --rate '1 kHz'", 73, 1000, ""),
        ("c04-numeric-header.csv", "--column 0 --rate 1", 0.073, 1, "names that are numbers"),
        ("c05-gaps.csv", "--column a", 0.08, 1, "line 11: the time in 'time' steps by 2 s"),
        ("c05-gaps.csv", "--column a --rate 1", 0.08, 1, "line 11"),
        ("c06-t_ms.csv", "--column a", 7.3, 100, ""),
        ("c06-time-in-ms.csv", "--column a", 0.0073, 0.1, "the step is 10 s"),
        ("c06-time-in-ms.csv", "--column a --time 'time [ms]'", 7.3, 100, ""),
        ("c07-labview.lvm", "--column Acc", 0.073, 1, "skipped"),
        ("c07-savetxt-header.csv", "--column a", 0.073, 1, ""),
        ("c08-latin1.csv", "--column Acc", 0.073, 1, ""),
        ("c10-sentinel.csv", "--column a --missing -999", 0.073, 1, "line 502"),
        ("c13-header-one-short.csv", "--column y2 --rate 1", 0.111, 1, ""),
        ("c15-false-exponent.csv", "--rate 1", 0.02, 1, ""),
        ("c15-periodic-9x.csv", "--rate 1", 0.0173, 1, ""),
        ("v-period-2.csv", "--rate 1", 0.5, 1, ""),
    ],
)
def test_periodic_signals(file, options, frequency, rate, warned):
    verdict = diagnose(file, options)
    assert verdict["regime"] == "periodic"
    assert verdict["frequency"] == pytest.approx(frequency, rel=1e-4)
    assert verdict["period"] == pytest.approx(1 / frequency, rel=1e-4)
    assert verdict["rate"] == pytest.approx(rate, rel=1e-5)
    assert verdict["lyapunov"] is None
    assert warned in " ".join(verdict["warnings"])


def test_a_wrong_value_is_named():
    verdict = diagnose("c10-sentinel.csv", "--column a")
    assert "line 502: the value -999 (once)" in " ".join(verdict["warnings"])
    assert verdict["regime"] not in ("periodic", "quasi-periodic", "chaotic")


def test_growth_is_not_steady():
    verdict = diagnose("v-growing.csv", "--rate 1")
    rms = verdict["indicators"]["steadiness"]["rms"]
    assert verdict["regime"] == "not-steady" and verdict["period"] is None
    assert 10 < rms[2] / rms[0] < 54 and f"factor of {rms[2] / rms[0]:.3g}" in verdict["verdict"]


def test_two_tones_in_a_short_record_are_not_periodic():
    assert diagnose("v-two-tone-short.csv", "--rate 1")["regime"] in ("quasi-periodic", "undecided")


@pytest.mark.parametrize(
    ("file", "options", "words"),
    [
        ("c01-decimal-comma-in-comma-table.csv", "--column a", "found 2 names, time, a, above rows of 3 fields"),
        ("c01-one-column-decimal-comma.csv", "--rate 1", "decimal comma"),
        ("c06-t_ms.csv", "--column a --time a", "goes back"),
        ("c06-t_ms.csv", "--column a --rate fast", "--rate: found 'fast'"),
        ("c06-t_ms.csv", "--column a --rate 1e-300", "positive number"),
        ("c06-t_ms.csv", "--column a --window 5:3", "--window"),
        ("c06-t_ms.csv", "--column a --window 50:60", "goes from 0 to 10 s"),
        ("c06-t_ms.csv", "--column a --teeth 5", "--teeth"),
        ("c06-t_ms.csv", "--column a --speed '3 kg'", "--speed"),
        ("c06-t_ms.csv", "--column a --separator ab", "--separator"),
        ("c06-t_ms.csv", "--column a --missing x", "--missing"),
    ],
)
def test_refusals_say_why(file, options, words):
    result = run(f"diagnose --series {FILES / file} {options}")
    assert result.exit_code == 2 and words in result.stderr and "Traceback" not in result.stderr
    assert result.stdout == ""


def test_standard_input(monkeypatch):
    text = (FILES / "c06-t_ms.csv").read_bytes()
    result = CliRunner().invoke(app, ["diagnose", "--series", "-", "--column", "a", "--json"], input=text)
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["frequency"] == pytest.approx(7.3, rel=1e-4)


def test_show_says_what_was_understood():
    result = run(f"show --series {FILES / 'c03-semicolon-comment.csv'}")
    assert result.exit_code == 0, result.stderr
    for words in ("separated by commas", "table from line 4", "1000 rows", "100 samples per second", "Ax", "-99"):
        assert words in result.stdout
    facts = json.loads(run(f"show --series {FILES / 'c08-latin1.csv'} --json").stdout)
    assert facts["columns"][1]["unit"] == "m/s²" and facts["columns"][1]["maximum"] == 3
    assert "--equations: found it beside --series" in run(f"show --series {FILES / 'c08-latin1.csv'} --equations").stderr


def test_orders_windows_and_text():
    result = run(f"diagnose --series {FILES / 'c06-t_ms.csv'} --column a --speed '19.0435 rpm' --teeth 23")
    assert result.exit_code == 0, result.stderr
    for words in ("t_ms" and "100 Hz", "1000 samples", "7.299996", "0.13698", "mesh", "23.0"):
        assert words in result.stdout
    part = diagnose("c15-periodic-9x.csv", "--rate 1 --window 200:1500")
    assert part["samples"] == 1300 and part["start"] == 200 and part["regime"] == "periodic"
    slid = diagnose("v-growing.csv", "--rate 1 --window 1000")
    assert [w["regime"] for w in slid["windows"]] == 3 * ["not-steady"] and slid["windows"][1]["start"] == 500


def test_the_picture_slides(tmp_path):
    place = tmp_path / "x.png"
    result = run(f"diagnose --series {FILES / 'v-growing.csv'} --rate 1 --window 1000 --out {place}")
    assert result.exit_code == 0, result.stderr
    assert place.stat().st_size > 20_000


def test_a_run_to_failure_record_needs_no_rate(tmp_path):
    """Comma in some folders, semicolon in others, no names, four columns of clock: equal verdicts."""
    from tests.recordings.kinds import clock_columns

    found = []
    for separator in (b",", b";"):
        file = tmp_path / f"acc{len(found)}.csv"
        file.write_bytes(clock_columns(2).content.replace(b",", separator))
        result = run(f"diagnose --series {file} --column 5 --json")
        assert result.exit_code == 0, result.stderr
        verdict = json.loads(result.stdout)
        found.append({key: verdict[key] for key in ("regime", "samples", "rate", "period", "frequency", "confidence")})
    assert found[0] == found[1]
    assert found[0]["samples"] == 2560 and found[0]["rate"] == pytest.approx(25600, rel=1e-5)
    assert found[0]["regime"] == "periodic" and found[0]["frequency"] == pytest.approx((0.031 + 0.0142) * 25600, rel=1e-4)
