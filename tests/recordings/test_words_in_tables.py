"""Words and lines of text among the numbers of a table: refused, unless what is no number is a missing value."""

import numpy as np
import pytest

from whirlmap.errors import InputError
from whirlmap.recordings.description import describe_file
from whirlmap.recordings.signal import read_signal

X = np.cos(2 * np.pi * 0.025 * np.arange(4000))


def written(folder, columns, changed=(), inserted=()):
    """A table of times, x and y, or of x and y, with some lines replaced or inserted."""
    rows = [f"{k / 1000:.4f},{v:.6f},{-v:.6f}" for k, v in enumerate(X)]
    lines = ["t [s],x [um],y [um]", *rows]
    for number, word in changed:
        lines[number - 1] = lines[number - 1].split(",")[0] + f",{word},0.5"
    for number, text in inserted:
        lines.insert(number - 1, text)
    file = folder / "a.csv"
    file.write_text("\n".join(",".join(line.split(",")[-columns:]) for line in lines))
    return file


WORDS = [(1001, "OVL"), (1501, "OVL"), (3600, "range?")]


@pytest.mark.parametrize("columns", [3, 2])
def test_words_become_missing_values_with_line_and_count(tmp_path, columns):
    file = written(tmp_path, columns, WORDS)
    with pytest.raises(InputError, match=r"line 1001.*--missing nan"):
        read_signal(file, column="x", rate=1000.0)
    found = read_signal(file, column="x", rate=1000.0, missing=["nan"])
    said = " ".join(found.notices)
    assert "line 1001: 'OVL'" in said and "2 such fields" in said
    assert "line 3600: 'range?'" in said and "1 such field)" in said
    assert found.values.size == X.size and np.abs(found.values - X).max() < 1e-3


@pytest.mark.parametrize("number", [2001, 3950])  # within the lines in which the table is sought, and behind them
def test_a_line_of_text_in_the_middle_is_left_out(tmp_path, number):
    file = written(tmp_path, 3, WORDS[:1], [(number, "--- gain changed ---")])
    with pytest.raises(InputError, match=f"--skip {number} .*--missing nan"):
        read_signal(file, column="y")
    found = read_signal(file, column="y", missing=["nan"])
    assert f"line {number}: text within the table, '--- gain changed ---'" in " ".join(found.notices)
    assert found.values.size == X.size and np.abs(found.values + X)[found.values != 0.5].max() < 1e-5


def test_text_after_the_table_is_a_footer_still(tmp_path):
    file = written(tmp_path, 2, (), [(4002, "Mean,0.25")])
    for missing in ((), ("nan",)):
        found = read_signal(file, column="y", rate=1.0, missing=missing)
        assert found.values.size == X.size and "after the table" in " ".join(found.notices)


def test_a_description_names_words_and_constant_columns(tmp_path):
    file = tmp_path / "b.csv"
    rows = [f"{k / 100:.2f},{v:.4f},45.0" for k, v in enumerate(X[:200])]
    rows[60] = "0.60,OVL,45.0"
    file.write_text("\n".join(["t [s],x [um],T [degC]", *rows]))
    facts = describe_file(file)
    assert facts["columns"][1]["missing"] == 1
    said = " ".join(facts["warnings"])
    assert "line 62: 'OVL' in column 2" in said and "column 3, 'T [degC]', is constant at 45" in said


def test_one_variable_of_a_netcdf_file_is_read_without_the_others(tmp_path):
    import tracemalloc

    import xarray as xr

    file = tmp_path / "wide.nc"
    wide = xr.Dataset({f"v{k}": ("time", np.full(100_000, float(k))) for k in range(40)}, {"time": np.arange(100_000) / 100})
    wide["v7"] = ("time", np.sin(np.arange(100_000)))
    wide.to_netcdf(file)
    read_signal(file, column="v7")  # imports
    tracemalloc.start()
    found = read_signal(file, column="v7")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert found.rate == pytest.approx(100) and found.values[1] == pytest.approx(np.sin(1))
    assert peak < 20 * found.values.nbytes
    file.unlink()
