"""The folder of a reproduction replaces its own files and no others."""

import pytest

from whirlmap.errors import OutputError, RangeError
from whirlmap.studies.gear_psfd.reproduction.output import Folder
from whirlmap.studies.gear_psfd.reproduction.reproduce import file_names, reproduce


def text(content):
    return lambda path: path.write_text(content, encoding="utf-8")


def test_own_files_are_replaced_and_others_never(tmp_path):
    folder = Folder(tmp_path / "out")
    folder.write("report.html", text("one"))
    again = Folder(tmp_path / "out")
    again.check(["report.html"])
    again.write("report.html", text("two"))
    assert (tmp_path / "out" / "report.html").read_text() == "two"
    (tmp_path / "out" / "report.html").write_text("mine now")
    with pytest.raises(OutputError, match=r"report\.html was not written by a reproduction, or was changed"):
        Folder(tmp_path / "out").check(["report.html"])
    (tmp_path / "out" / "report.html").unlink()
    (tmp_path / "out" / "fig2-machine.png").write_text("a holiday")
    with pytest.raises(OutputError, match="fig2-machine"):
        reproduce(tmp_path / "out")


def test_a_failed_file_leaves_nothing_behind(tmp_path):
    folder = Folder(tmp_path / "out")

    def fail(path):
        path.write_text("half")
        raise OSError(28, "No space left on device")

    with pytest.raises(OutputError, match="the disk is full"):
        folder.write("report.html", fail)
    assert list((tmp_path / "out").iterdir()) == []


def test_refusals_come_before_any_work(tmp_path):
    with pytest.raises(RangeError, match="quick or full"):
        reproduce(tmp_path / "out", quality="best")
    assert not (tmp_path / "out").exists()
    with pytest.raises(OutputError):
        reproduce(tmp_path / "missing" / "out")
    (tmp_path / "file").write_text("x")
    with pytest.raises(OutputError, match="is a file"):
        reproduce(tmp_path / "file")


def test_every_figure_of_the_paper_is_among_the_files():
    for number in range(2, 8):
        for edition in ("literal", "intended", "machine"):
            assert any(name.startswith(f"fig{number}-{edition}") for name in file_names())


def test_two_cases_of_one_name_are_refused_before_anything_is_computed(tmp_path):
    own = tmp_path / "intended-best.toml"
    own.write_text('extends = "gear-psfd/intended-best"\n')
    with pytest.raises(RangeError, match="called intended-best"):
        reproduce(tmp_path / "out", cases=["gear-psfd/intended-best", str(own)])
    assert not (tmp_path / "out").exists()
