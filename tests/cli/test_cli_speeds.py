"""``whirlmap speeds``: engineering units in, windows out, and one message where the input is wrong."""

import json
import shlex

import numpy as np
import pytest
from typer.testing import CliRunner

from whirlmap.cli.main import app
from whirlmap.integrate.loading import load
from whirlmap.sweep.points.label_points import label_points

RIG = "machines/jeffcott-rig"


def run(line):
    return CliRunner(env={"COLUMNS": "160"}).invoke(app, shlex.split(line))


def test_windows_in_rpm_and_micrometres(tmp_path):
    done = run(f'speeds {RIG} --limit "60 um" --range "1000 rpm:6000 rpm" --points 16 --quiet --json --out {tmp_path / "a"}')
    assert done.exit_code == 0, done.output
    facts = json.loads(done.stdout)
    assert facts["limit_um"] == pytest.approx(60) and facts["limit"] == pytest.approx(0.6)
    assert facts["rpm"][0] == pytest.approx(1000) and facts["rpm"][-1] == pytest.approx(6000)
    assert facts["windows"] and sum(facts["verdicts"].values()) == 16
    assert {f.suffix for f in (tmp_path / "a").iterdir()} == {".nc", ".png"}
    assert facts["followed"] and facts["force_N"] == pytest.approx(0.8 * 9.81 / 2)
    for row in facts["stretches"]:
        assert row["min_film_um"] == pytest.approx(100 * row["min_film"]) and 0 < row["min_film_um"] < 100
        assert row["max_load_N"] == pytest.approx(facts["force_N"] * row["max_load"]) and row["max_load"] > 0.9


def test_the_machine_s_own_speed_has_its_margins():
    """1800 rpm lies below the resonance: what forbids is above, and the range's own end is no boundary."""
    line = f'speeds {RIG} --range "1000 rpm:3000 rpm" --points 11 --no-follow --quiet'
    at = json.loads(run(f"{line} --json").stdout)["operation"]
    assert at["verdict"] == "safe" and at["rpm"] == pytest.approx(1800) and set(at["margins"]) == {"above"}
    assert at["margins"]["above"]["to"] == "amplitude" and 250 < at["margins"]["above"]["rpm"] < 350
    said = run(line).stdout
    assert f"1800 rpm: safe, margin {at['margins']['above']['rpm']:.0f} rpm above (amplitude)" in said
    assert "thinnest film [um]" in said and "largest load [N]" in said and "cold starts alone" in said
    beyond = run(f'speeds {RIG} --range "2500 rpm:3000 rpm" --points 3 --no-follow --quiet')
    assert "own speed" not in beyond.stdout and "no safe speed" in beyond.stdout


def test_limit_and_range_of_the_case_are_the_defaults():
    done = run(f"speeds {RIG} --points 4 --quiet --json")
    facts = json.loads(done.stdout)
    assert facts["limit_um"] == pytest.approx(60) and facts["rpm"][0] == pytest.approx(600)


def test_draws_over_tolerances_give_the_probabilities_of_a_known_range():
    """Below resonance the amplitude grows with the unbalance: a limit that a machine with 0.8 U just meets is met by none of
    the machines with 0.8 U to 1.2 U, that of 1.2 U by all, and those of U and 1.1 U by a half and by three quarters."""
    speeds, draws = np.array([0.4, 0.5]), 64
    reached = {
        share: label_points(load(RIG, U=f"{8 * share} g*mm"), {"s": speeds[:1]})["peak_to_peak"].sel(quantity=["y", "uy"])
        for share in (0.8, 1.0, 1.1, 1.2)
    }
    um = 100.0 * (1 + 1e-6)  # of a clearance
    for share, expected in ((0.8, 0.0), (1.0, 0.5), (1.1, 0.75), (1.2, 1.0)):
        limit = float(reached[share].max()) * um
        line = f'speeds {RIG} --points 2 --range {speeds[0]}:{speeds[1]} --limit "{limit!r} um" --no-follow --quiet --json'
        line = f"{line} --input-tolerance U=20% --draws {draws}"
        done = run(line)
        assert done.exit_code == 0, done.output
        facts = json.loads(done.stdout)
        p, low, high = (facts[name][0] for name in ("probability", "probability_low", "probability_high"))
        assert low <= expected <= high and p == (expected if expected in (0.0, 1.0) else pytest.approx(expected, abs=0.15))
        assert facts["probability_of"]["amplitude"][0] == pytest.approx(1 - p)
        assert p * draws == pytest.approx(round(p * draws), abs=1e-9)
    assert facts == json.loads(run(line).stdout)


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ('--limit "20 kg"', "--limit: found the unit 'kg'"), ("--limit 5000", "unit"),
        ('--range "6000 rpm:500 rpm"', "lower one first"),
        ('--range "-500 rpm:500 rpm"', "positive"), ("--range 0:1", "positive"), ("--range 1", "LOW:HIGH"),
        ("--limit 20 --range 500:6000", "--limit: found 20 without a unit"),
        ("--range 500:6000", "--range: found '500:6000' without units"), ("--range 10:60", "rpm"),
        ('--range "1 kg:2 rpm"', "--range: found the unit 'kg'"),
        ("--input-tolerance c=-5%", "expected a tolerance"), ("--input-tolerance nothing=5%", "nothing"),
        ("--input-tolerance c", "as in --input-tolerance c=5%"),
    ],
)  # fmt: skip
def test_wrong_input_gets_one_message(options, word):
    done = run(f"speeds {RIG} --points 4 --quiet {options}")
    assert done.exit_code == 2
    assert done.stderr.startswith("error: ") and word in done.stderr, done.stderr


def test_a_case_without_dimensions_wants_numbers():
    done = run('speeds gear-psfd/reference --limit "20 um" --points 4 --quiet')
    assert done.exit_code == 2 and "--range" in done.stderr
