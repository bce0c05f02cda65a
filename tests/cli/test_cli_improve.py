"""``whirlmap improve``: units on both ends of a range, a table and a picture, one message where the input is wrong."""

import json
import shlex

import pytest
from typer.testing import CliRunner

from whirlmap.cli.main import app
from whirlmap.sweep.speeds import improve as trials

RIG = "machines/jeffcott-rig"


def run(line):
    return CliRunner().invoke(app, shlex.split(line))


@pytest.mark.parametrize("second", ["", "--vary L=5mm:7mm:2"])
def test_designs_in_their_units(tmp_path, second):
    done = run(f"improve {RIG} --vary c=80um:120um:3 {second} --points 8 --quiet --json --out {tmp_path / 'a'}")
    assert done.exit_code == 0, done.output
    facts = json.loads(done.stdout)
    assert facts["units"]["c"] == "um" and facts["limit_um"] == pytest.approx(60)
    given = [d for d in facts["designs"] if not d["refined"]]
    assert len(given) == (6 if second else 3) and len(facts["designs"]) > len(given)
    assert facts["designs"][facts["widest"]]["rpm_width"] == max(d["rpm_width"] for d in facts["designs"])
    assert {f.suffix for f in (tmp_path / "a").iterdir()} == {".nc", ".png"}


def test_the_table_names_the_next_command():
    done = run(f"improve {RIG} --vary c=80um:120um:2 --points 6 --coarse --quiet")
    assert done.exit_code == 0 and "c [um]" in done.stdout
    assert f'whirlmap speeds {RIG} --set "c=' in done.stdout


def test_an_interrupted_comparison_says_of_how_many_designs_it_is(monkeypatch):
    real, calls = trials._Trial.run, []

    def run_two(self, designs, **options):
        calls.append(1)
        if len(calls) > 1:
            raise KeyboardInterrupt
        return real(self, designs, **options)

    monkeypatch.setattr(trials._Trial, "run", run_two)
    monkeypatch.setenv("COLUMNS", "200")
    done = run(f"improve {RIG} --vary c=80um:120um:3 --points 6 --coarse --quiet")
    assert done.exit_code == 130
    assert "incomplete: interrupted in the values given, after 1 of 3 designs" in done.stdout
    assert "widest window so far" in done.stdout and "next, for the best so far: whirlmap speeds" in done.stdout


def test_a_case_without_dimensions():
    line = "improve jeffcott --vary b=0.05:0.1:2 --limit 0.9 --range 0.5:0.8 --points 3 --coarse --quiet"
    done = run(line)
    assert done.exit_code == 0 and "[s]" in done.stdout, done.output


@pytest.mark.parametrize(
    ("line", "word"),
    [
        ("--vary c=60:140:5", "unit"), ("--vary c=60um:140mm:5", "same unit"), ("--vary c=140um:60um:5", "swap"),
        ("--vary q=1:2:3", "no 'q'"), ("--vary s=1:2:3", "the speed"), ("--vary 'speed=1rpm:2rpm:3'", "the speed"),
        ("--vary Gamma=1um:2um:3", "no dimension"), ("--vary c=60um:140um:3 --set c=60um", "in one of them"),
        ("--vary c=60kg:140kg:3", "unit"), ("--vary c=-60um:140um:3", "above 0"), ("--vary limit=1um:2um:3", "same for all"),
        ("--vary c=1um:2um:3 --vary L=4mm:8mm:3 --vary R=1mm:2mm:3", "one or two"),
    ],
)  # fmt: skip
def test_wrong_input_gets_one_message(line, word):
    done = run(f"improve {RIG} {line} --quiet --points 3")
    assert done.exit_code == 2
    assert done.stderr.startswith("error: ") and word in done.stderr, done.stderr
