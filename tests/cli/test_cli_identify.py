"""``whirlmap identify`` as a user meets it."""

import json
import shlex

import pytest
from typer.testing import CliRunner

from whirlmap.cli.main import app

QUICK = "--sets 2 --variant literal-printed-clock --no-pilot --quiet"


def run(line):
    return CliRunner(env={"COLUMNS": "80"}).invoke(app, shlex.split(line))


def sentence(line: str) -> str:
    result = run(line)
    assert result.exit_code == 2, result.output
    assert not result.stdout
    return " ".join(result.stderr.split())


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("identify --share 3", "--share: found '3', expected I/N"),
        ("identify --share 4/3 --store x", "found '4/3'"),
        ("identify --share 1/3", "--share needs --store"),
        ("identify --page docs.md", "--page needs --out"),
        ("identify --page docs.md --out answer", "docs.md: expected a page with the lines"),
        ("identify --resume", "--resume continues the search in --store"),
        ("identify --store x --share 1/2 --generations 3", "run it without --share"),
        ("identify --sets 4 --generations 3", "at least 5 sets"),
        ("identify --dask tcp://127.0.0.1:9 --workers 2", "give one of them"),
        ("identify --edition physical", "expected one of literal, intended"),
        ("identify --variant intended-porous-fixed", "intended-porous-fixed-shaft"),
        ("identify --edition literal --variant intended-porous-fixed-shaft", "belongs to the edition literal"),
        ("identify --out missing/answer", "does not exist"),
        ("identify --store missing/store", "does not exist"),
    ],
)
def test_what_is_wrong_is_said_before_anything_is_computed(line, says, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert says in sentence(line)
    assert list(tmp_path.iterdir()) == []


def test_a_search_is_kept_resumed_and_read(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    first = run(f"identify {QUICK} --store kept --json")
    assert first.exit_code == 0, first.output
    found = json.loads(first.stdout)
    assert found["variants"]["literal-printed-clock"]["sets"] == 2
    assert len(found["variants"]["literal-printed-clock"]["claims"]) == 13
    assert "--resume" in sentence(f"identify {QUICK} --store kept")
    assert "seed: found 1, now 2" in sentence(f"identify {QUICK} --store kept --resume --seed 2")
    again = run("identify --store kept --resume --minutes 0 --json --linear 0 --out answer")
    assert again.exit_code == 0, again.output
    kept = json.loads(again.stdout)
    assert kept["variants"] == found["variants"]
    assert kept["best"] == found["best"]
    assert {p.name for p in (tmp_path / "answer").iterdir()} >= {"answer.json", "answer.md", "literal-best.toml"}
    shown = run("identify --store kept --resume --minutes 0")
    assert "best of literal: literal-printed-clock" in shown.stdout
    assert "fig3-mid-8T" in shown.stdout


def test_marks_in_the_wrong_order_are_no_page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = "<!-- end: whirlmap identify -->\n<!-- begin: whirlmap identify -->\n"
    (tmp_path / "docs.md").write_text(text)
    assert "expected a page" in sentence("identify --page docs.md --out answer")
    assert (tmp_path / "docs.md").read_text() == text


def test_a_share_that_came_first_is_said_to_wait(tmp_path, monkeypatch):
    from whirlmap.studies.gear_psfd.search import identify

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(identify, "BLOCK", 1)
    waiting = run(f"identify {QUICK} --store kept --share 2/2 --json")
    assert waiting.exit_code == 0, waiting.output
    assert "finished blocks: 1, but not the first of any variant" in waiting.stderr
    found = json.loads(waiting.stdout)
    assert found["missing"] == ["literal-printed-clock"]
    whole = json.loads(run(f"identify {QUICK} --store kept --resume --json").stdout)
    assert set(found) == set(whole)
    assert whole["missing"] == []
    both = run(f"identify {QUICK} --store kept --resume --variant literal-printed-shaft --minutes 0")
    assert "no set finished yet: literal-printed-shaft" in both.stderr


def test_nothing_finished_is_said(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = run("identify --store empty --minutes 0")
    assert result.exit_code == 0
    assert "nothing to report" in result.stderr
