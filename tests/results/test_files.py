"""Writing: complete or not at all, and never over what exists unless told so."""

import errno
import stat

import numpy as np
import pytest
import xarray as xr

from whirlmap.errors import OutputError
from whirlmap.results.files import Places, check_writable, places, read, replace_file, write, write_beside
from whirlmap.results.provenance import Pieces, provenance


def dataset():
    ds = xr.Dataset(
        {
            "section": (
                ("s", "period"),
                np.linspace(-1, 1, 12).reshape(3, 4),
                {"units": "1", "long_name": "y_p"},
            ),
            "status": (
                "s",
                np.array([0, 1, 2], dtype=np.int8),
                {"flag_values": np.array([0, 1, 2], dtype=np.int8)},
            ),
        },
        coords={"s": [0.1, 0.2, 0.3], "state": ["xp", "yp"]},
    )
    ds["section"][1, 2] = np.nan
    ds.attrs = provenance(Pieces("duffing", "abc"), method="rk4", steps_per_period=100, seed=1)
    return ds


def test_a_dataset_comes_back_the_same(tmp_path):
    path = write(dataset(), tmp_path / "run.nc")
    back = read(path)
    xr.testing.assert_identical(back, dataset().assign_attrs(back.attrs))
    assert back["status"].dtype == np.int8
    assert {**dataset().attrs, "date": ""} == {**back.attrs, "date": ""}
    assert [p.name for p in tmp_path.iterdir()] == ["run.nc"]


def test_what_exists_is_refused_without_force(tmp_path):
    path = tmp_path / "run.nc"
    path.write_text("precious")
    with pytest.raises(OutputError, match=r"exists already; use --force"):
        write(dataset(), path)
    assert path.read_text() == "precious"
    write(dataset(), path, force=True)
    assert read(path).attrs["model"] == "duffing"


def test_a_failed_or_interrupted_write_leaves_nothing(tmp_path):
    def fail(trial):
        trial.write_text("half")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        replace_file(tmp_path / "run.png", fail)
    assert not list(tmp_path.iterdir())

    def full(trial):
        trial.write_text("half")
        raise OSError(28, "No space left on device")

    (tmp_path / "run.png").write_text("old")
    with pytest.raises(OutputError, match=r"cannot be written .the disk is full"):
        replace_file(tmp_path / "run.png", full, force=True)
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("run.png", "old")]


def test_a_name_taken_meanwhile_is_not_replaced(tmp_path):
    path = tmp_path / "run.png"

    def fill(trial):
        path.write_text("somebody else's")
        trial.write_text("ours")

    with pytest.raises(OutputError, match=r"appeared while"):
        replace_file(path, fill)
    assert path.read_text() == "somebody else's"
    assert [p.name for p in tmp_path.iterdir()] == ["run.png"]


def test_places_follow_the_suffix(tmp_path):
    assert places("a/run.nc", "map") == Places(dataset=places("a/run.nc", "x").dataset)
    for suffix in ("png", "svg", "pdf", "PNG"):
        found = places(f"run.{suffix}", "map")
        assert (found.dataset, found.folder, str(found.picture)) == (None, None, f"run.{suffix}")
    folder = places(tmp_path / "results", "map")
    assert folder.dataset == tmp_path / "results" / "map.nc"
    assert folder.picture == tmp_path / "results" / "map.png"
    with pytest.raises(OutputError, match=r"found the suffix '.csv', expected one of .nc .png .svg .pdf"):
        places("run.csv", "map")


def test_places_that_cannot_be_written(tmp_path):
    with pytest.raises(OutputError, match=r"the folder .* does not exist; make it first"):
        check_writable(tmp_path / "none" / "run.nc")
    assert not (tmp_path / "none").exists()
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match=r"is not a folder"):
        check_writable(tmp_path / "file" / "run.nc")
    with pytest.raises(OutputError, match=r"found a file, expected a folder"):
        check_writable(tmp_path / "file", force=True)
    (tmp_path / "folder.nc").mkdir()
    with pytest.raises(OutputError, match=r"found a folder, expected a file"):
        check_writable(tmp_path / "folder.nc", force=True)
    with pytest.raises(OutputError, match=r"expected .nc for a Dataset"):
        write(dataset(), tmp_path / "run.png")
    check_writable(tmp_path / "new")
    assert not (tmp_path / "new").exists()


def test_a_folder_with_something_in_it_wants_force(tmp_path):
    folder = tmp_path / "results"
    folder.mkdir()
    check_writable(folder)  # empty: as good as new
    (folder / "old.nc").write_text("")
    with pytest.raises(OutputError, match=r"exists already"):
        check_writable(folder)
    check_writable(folder, force=True)
    assert [p.name for p in folder.iterdir()] == ["old.nc"]


def test_a_folder_without_permission(tmp_path):
    folder = tmp_path / "locked"
    folder.mkdir()
    folder.chmod(stat.S_IRUSR | stat.S_IXUSR)
    try:
        (folder / "probe").touch()
    except OSError:
        with pytest.raises(OutputError, match=r"cannot be written .Permission denied"):
            check_writable(folder / "run.nc")
    else:
        pytest.skip("this user may write anywhere")
    finally:
        folder.chmod(stat.S_IRWXU)


def test_reading_what_is_no_dataset(tmp_path):
    with pytest.raises(OutputError, match=r"no such file"):
        read(tmp_path / "none.nc")
    (tmp_path / "text.nc").write_text("not NetCDF")
    with pytest.raises(OutputError, match=r"cannot be read as NetCDF"):
        read(tmp_path / "text.nc")


@pytest.mark.parametrize("whole", [True, False])
def test_a_folder_appears_whole_or_not_at_all(whole, tmp_path):
    def fill(trial):
        (trial / "inside").mkdir(parents=True)
        if not whole:
            raise OSError(errno.ENOSPC, "full")

    try:
        write_beside(tmp_path / "store", fill)
    except OSError as error:
        assert not whole and error.errno == errno.ENOSPC
    assert [p.name for p in tmp_path.iterdir()] == (["store"] if whole else [])
