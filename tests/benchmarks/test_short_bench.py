"""The result of a benchmark: its keys, and what it says where a peer is missing or too coarse."""

import json
import shlex
import sys

import pytest
from typer.testing import CliRunner

from contest import run
from contest.report import figure, markdown, ratio_rows
from whirlmap.cli.main import app

ROW = {"who", "psi", "batch", "tol_or_steps", "median_error", "worst_error", "us_per_lane_and_T"}


def rows(who, psi, times):
    return [
        {"who": who, "psi": psi, "batch": 8, "tol_or_steps": e, "median_error": e, "worst_error": None,
         "us_per_lane_and_T": t}
        for e, t in times
    ]


def made_up():
    """Whirlmap twice as fast as heyoka, ten times as fast as SciPy, half as fast as C."""
    curve = [(1e-4, 1.0), (1e-6, 2.0), (1e-10, 8.0)]

    def slower(factor):
        return [(e, factor * t) for e, t in curve]

    raw = [
        *rows("whirlmap rk4", 0.0, curve), *rows("whirlmap rk4", 1e-3, curve), *rows("heyoka", 0.0, slower(2)),
        *rows("heyoka", 1e-3, slower(3)), *rows("scipy DOP853", 0.0, slower(10)), *rows("c_reference rk4", 0.0, slower(0.5)),
        *rows("scipy LSODA", 0.0, [(1e-3, 1.0)]),
    ]  # fmt: skip
    missing = {}
    return {**run.summary(raw, missing), "raw": raw, "missing": missing}


def test_ratios_of_made_up_rows():
    result = made_up()
    assert result["heyoka"]["psi=0"] == pytest.approx({"1e-5": 2.0, "1e-7": 2.0, "1e-9": 2.0})
    assert result["heyoka"]["psi=0.001"] == pytest.approx({"1e-5": 3.0, "1e-7": 3.0, "1e-9": 3.0})
    assert result["scipy"]["DOP853"] == pytest.approx(10.0)
    assert result["c_reference"] == pytest.approx(0.5)


def test_a_ratio_that_cannot_be_had_is_null_with_a_reason():
    result = made_up()
    assert result["scipy"]["LSODA"] is None
    assert "1e-07" in result["missing"]["scipy LSODA"]
    assert "-" in ratio_rows(result)[-2]


def test_c_is_held_against_rk4_alone():
    """A faster method of ours says nothing about our kernel beside theirs."""
    result = made_up()
    raw = [*result["raw"], *rows("whirlmap other", 0.0, [(1e-12, 1e-3)])]
    assert run.summary(raw, {})["c_reference"] == pytest.approx(0.5)
    assert run.summary(raw, {})["scipy"]["DOP853"] > 1000


def test_table_and_picture_show_every_contender():
    result = made_up()
    text = markdown(result)
    drawn = [line.get_label() for axes in figure(result).axes for line in axes.lines]
    for row in result["raw"]:
        assert row["who"] in text and row["who"] in drawn


SMALL = run.Plan(points=2, scipy_points=2, rounds=1, tolerances=(1e-6,), taylor=((2, "time"),), scipy_tolerances=(1e-9,),
                 scipy_repeats=1, c_lanes=(2,))  # fmt: skip


@pytest.fixture
def little(monkeypatch):
    monkeypatch.setattr(run, "EVALUATIONS", (480, 4000))
    monkeypatch.setattr(run, "QUICK", SMALL)


def bench(line):
    return CliRunner().invoke(app, shlex.split(line))


def test_json_has_the_promised_keys(little):
    pytest.importorskip("heyoka")
    done = bench("bench --quick --json --quiet")
    assert done.exit_code == 0, done.output
    result = json.loads(done.stdout)
    assert set(result) == {"heyoka", "scipy", "c_reference", "raw", "missing", "processor", "roots"}
    assert {k: set(v) for k, v in result["heyoka"].items()} == {psi: set(run.ERRORS) for psi in run.PSI}
    assert set(result["scipy"]) == {"DOP853", "LSODA"}
    assert all(set(row) == ROW for row in result["raw"])
    assert {row["who"] for row in result["raw"]} >= {"whirlmap rk4", "heyoka", "scipy DOP853", "scipy LSODA"}


def test_without_heyoka_the_others_are_compared_and_the_extra_is_named(little, monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "heyoka", None)
    picture = tmp_path / "bench.svg"
    done = bench(f"bench --quick --json --picture {picture}")
    assert done.exit_code == 0, done.output
    result = json.loads(done.stdout)
    assert "whirlmap[benchmarks]" in done.stderr and "whirlmap[benchmarks]" in result["missing"]["heyoka"]
    assert picture.stat().st_size > 1000
    assert set(result["heyoka"]["psi=0"].values()) == {None}
    assert result["scipy"]["DOP853"] is not None
    assert {row["psi"] for row in result["raw"]} == {0.0}


def test_an_installed_program_asks_for_a_checkout(monkeypatch, tmp_path):
    monkeypatch.setattr("whirlmap.cli.common.checkout.BENCHMARKS", tmp_path)
    done = bench("bench --quick")
    assert done.exit_code == 2
    assert "make bench" in done.stderr and "Traceback" not in done.output
