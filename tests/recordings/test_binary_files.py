"""Files of other programs: the values bit for bit, rate and unit as they stand in the file."""

import bz2
import gzip
import io
import json
import lzma
import zipfile

import numpy as np
import pytest
import xarray as xr
from scipy.io import savemat, wavfile

import whirlmap
from whirlmap.errors import InputError
from whirlmap.recordings.signal import read_signal
from whirlmap.results.files import write

X = np.sin(0.3 * np.arange(600))
TEXT = "\n".join(repr(v) for v in X.tolist()).encode()


def made(function, *arguments, **options):
    file = io.BytesIO()
    function(file, *arguments, **options)
    return file.getvalue()


def zipped(**members):
    with zipfile.ZipFile(file := io.BytesIO(), "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return file.getvalue()


@pytest.mark.parametrize(
    ("content", "column", "rate"),
    [
        (made(wavfile.write, 48000, X), None, 48000),
        (made(wavfile.write, 44100, np.c_[X, -X]), "channel 1", 44100),
        (made(np.save, X), None, None),
        (made(np.save, np.c_[-X, X]), "2", None),
        (made(np.savez, acc=X, fs=12000.0), "acc", 12000),
        (made(np.savez, acc=X, t=np.arange(600) / 50), "acc", 50),
        (made(savemat, {"s": {"DE": X[:, None], "dt": 0.001, "bearing": "6205"}}), None, 1000),
        (gzip.compress(TEXT), None, None),
        (bz2.compress(TEXT), None, None),
        (lzma.compress(TEXT), None, None),
        (zipped(**{"a.csv": TEXT}), None, None),
    ],
)
def test_known_formats(content, column, rate, tmp_path):
    file = tmp_path / "x.dat"  # the name does not matter
    file.write_bytes(content)
    found = read_signal(file, column=column)
    np.testing.assert_array_equal(found.values, X)
    assert found.rate == (None if rate is None else pytest.approx(rate))


def test_whole_numbers_of_wav_stay(tmp_path):
    wavfile.write(tmp_path / "x.wav", 8000, (X * 30000).astype(np.int16))
    np.testing.assert_array_equal(read_signal(tmp_path / "x.wav").values, (X * 30000).astype(np.int16))


def test_datasets(tmp_path):
    xr.Dataset({"acc": ("time", X, {"units": "g"})}, {"time": ("time", np.arange(600) / 25, {"units": "s"})}).to_netcdf(
        tmp_path / "x.nc", engine="netcdf4"
    )
    found = read_signal(tmp_path / "x.nc", column="acc")
    assert found.rate == pytest.approx(25) and found.unit == "g"
    ds = whirlmap.simulate(whirlmap.load("duffing"), periods=10)
    own = read_signal(write(ds, tmp_path / "y.nc"), column="x")
    np.testing.assert_array_equal(own.values, ds["x"].sel(state="x"))
    assert own.rate == pytest.approx(1 / float(ds["time"][1] - ds["time"][0]))


def test_formats_of_the_extra(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "x.h5", "w") as file:
        file["run/acc"], file["run/time"] = X, np.arange(600) / 50
    assert read_signal(tmp_path / "x.h5", column="run.acc").rate == pytest.approx(50)


DAMAGED = {
    "picture": (b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 20, "no text"),
    "bare doubles": (X.tobytes(), "no text"),
    "pickle": (made(np.save, np.array([{1: 2}], dtype=object), allow_pickle=True), "cannot be read"),
    "cut gzip": (gzip.compress(TEXT)[:-200], "damaged"),
    "two files": (zipped(**{"a.csv": b"1", "b.csv": b"2"}), "several files"),
    "workbook": (zipped(**{"xl/workbook.xml": b"1", "b": b"2"}), "save it as CSV"),
    "broken HDF5": (b"\x89HDF\r\n\x1a\n" + bytes(100), "HDF5"),
    "broken parquet": (b"PAR1" + bytes(100), "Parquet"),
    "cut wav": (made(wavfile.write, 48000, X)[:30], "WAV"),
    "JSON": (json.dumps({"a": X.tolist()}).encode(), "JSON"),
    "markup": (b"<html><td>1</td></html>\n" * 9, "markup"),
    "hexadecimal": (b"07A2\n00FF\n1234\n0A0A\n5555\n0AF0\n", "found"),
    "log": (b"[2024-01-02 03:04:05] INFO value=1\n" * 9, "no rows of numbers"),
    "thousands": (b"0;1.000,5\n1;1.001,5\n" * 9, "found"),
    "percent": (b"t,a\n0,1%\n1,2%\n", "found '1%'"),
    "two tables": (b"t,a\n0,1\n1,2\n2,4\n\nt,b\n0,1\n", "several tables"),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_what_is_no_table_is_refused_with_a_reason(name, tmp_path):
    content, words = DAMAGED[name]
    (tmp_path / "x.csv").write_bytes(content)
    with pytest.raises(InputError, match=words):
        read_signal(tmp_path / "x.csv", column="2" if name in ("thousands", "percent", "two tables") else None, time="none")


TYPED = {
    "quoted decimal comma": '"t","a"\n{rows}',
    "typographic minus": "t;a\n{rows}",
    "double spacing": "t,a\n\n{rows}",
    "hard blanks": "t;a\n{rows}",
    "names with blanks": "Time (s)   Accel X (m/s^2)\n{rows}",
    "markdown": "{rows}",
}


@pytest.mark.parametrize("name", TYPED)
def test_what_people_type_is_read(name, tmp_path):
    each = {
        "quoted decimal comma": lambda k, v: f'"{k / 100:.2f}","{v!r}"'.replace(".", ","),
        "typographic minus": lambda k, v: f"{k / 100:.2f};{v!r}".replace("-", "\u2212"),
        "double spacing": lambda k, v: f"{k / 100:.2f},{v!r}\n",
        "hard blanks": lambda k, v: f"{k / 100:.2f}\u00a0;{v!r}\u00a0",
        "names with blanks": lambda k, v: f"{k / 100:.2f}   {v!r}",
        "markdown": lambda k, v: f"|{k / 100:.2f}|{v!r}|",
    }[name]
    x = np.round(X, 6)
    rows = "\n".join(each(k, v) for k, v in enumerate(x.tolist()))
    (tmp_path / "x.txt").write_text(TYPED[name].format(rows=rows) + "\n", encoding="utf-8")
    column, time = ("3", "2") if name == "markdown" else ("2", None)
    found = read_signal(tmp_path / "x.txt", column=column, time=time)
    np.testing.assert_array_equal(found.values, x)
    assert found.rate == pytest.approx(100)


def test_memory_is_that_of_one_column(tmp_path):
    """A wide table is read in pieces, of which one column stays."""
    import tracemalloc

    rows = ",".join(f"{v:.6f}" for v in X[:40]) + "\n"
    (tmp_path / "x.csv").write_text(rows * 60_000)
    read_signal(tmp_path / "x.csv", column="3", rate=1.0)  # imports
    tracemalloc.start()
    found = read_signal(tmp_path / "x.csv", column="3", rate=1.0)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert found.values.size == 60_000 and peak < 12 * 4 * 2**20 < 60_000 * 40 * 8 * 3
