"""Tables of binary files: each format is read by a library."""

import warnings
from collections.abc import Callable, Iterable, Mapping
from functools import wraps
from pathlib import Path
from typing import Any

import numpy as np

from whirlmap.errors import InputError
from whirlmap.recordings.fields import NUMBER
from whirlmap.recordings.table import ArrayTable, Column

#: Scalars of these names are samples per second, or seconds per sample.
RATES = ("fs", "samplerate", "samplingrate", "samplingfrequency", "rate", "samplefrequency", "sr")
STEPS = ("dt", "ts", "deltat", "xincrement", "sampleinterval", "samplinginterval", "wfincrement")


def _reads(form: str) -> Callable[[Callable[[Path], ArrayTable]], Callable[[Path], ArrayTable]]:
    """Say what is wrong with a file instead of raising what a library raises, and collect its warnings."""

    def around(function: Callable[[Path], ArrayTable]) -> Callable[[Path], ArrayTable]:
        @wraps(function)
        def read(path: Path) -> ArrayTable:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                try:
                    table = function(path)
                except (InputError, MemoryError):
                    raise
                except ImportError as error:
                    package = getattr(error, "name", None) or "pyarrow"
                    raise InputError(
                        f"{path}: found {form}, which needs a package that is not installed: pip install {package}"
                    ) from None
                except Exception as error:  # libraries raise what they like for broken files
                    raise InputError(f"{path}: found {form} that cannot be read ({type(error).__name__}: {error})") from None
            table.notices += [
                " ".join(str(w.message).split()) for w in caught if not issubclass(w.category, DeprecationWarning)
            ]
            return table

        return read

    return around


def _table(path: Path, form: str, named: Iterable[tuple[str, Any, str]], rate: float | None = None) -> ArrayTable:
    """Put columns together; a matrix gives one column for each of its shorter side; numbers of the rate are no columns."""
    columns: list[Column] = []
    arrays: list[Any] = []
    notices: list[str] = []
    for name, value, unit in named:
        array = value if hasattr(value, "dtype") else np.asarray(value)  # what is on the disk stays there
        if array.dtype.kind not in "biuf":
            notices.append(f"{name!r} has {'complex numbers' if array.dtype.kind == 'c' else 'no numbers'}: left out")
            continue
        array = array.squeeze()
        plain = "".join(c for c in name.rpartition(".")[2].lower() if c.isalnum())
        if array.size < 2:
            if array.size and plain in RATES and float(array) > 0:
                rate = float(array)
            elif array.size and plain in STEPS and float(array) > 0:
                rate = 1 / float(array)
            continue
        if array.ndim > 2:
            notices.append(f"{name!r} has {array.ndim} dimensions, {array.shape}: left out")
            continue
        if array.ndim == 2 and array.shape[0] < array.shape[1]:
            notices.append(f"{name!r} of shape {array.shape} is read with a signal in each row")
            array = array.T
        each = (
            [(name, array)]
            if array.ndim == 1
            else [(f"{name}_{k + 1}" if name else "", array[:, k]) for k in range(array.shape[1])]
        )
        for title, column in each:
            columns.append(Column.of(title, NUMBER, unit))
            arrays.append(column)
    if not columns:
        raise InputError(f"{path}: found {form} without a series of numbers, expected one")
    return ArrayTable(str(path), form, tuple(columns), arrays, rate, notices)


@_reads("a WAV file")
def wav(path: Path) -> ArrayTable:
    """Sound: whole numbers stay as they are."""
    from scipy.io import wavfile

    rate, data = wavfile.read(path)
    channels = data[:, None] if data.ndim == 1 else data
    names = [""] if channels.shape[1] == 1 else [f"channel {k + 1}" for k in range(channels.shape[1])]
    return _table(path, "a WAV file", [(n, channels[:, k], "") for k, n in enumerate(names)], float(rate))


@_reads("a NumPy file")
def npy(path: Path) -> ArrayTable:
    """One array, mapped into memory."""
    array = np.load(path, mmap_mode="r", allow_pickle=False)
    if array.dtype.names:
        return _table(path, "a NumPy file", [(n, array[n], "") for n in array.dtype.names])
    return _table(path, "a NumPy file", [("", array, "")])


@_reads("an archive of NumPy arrays")
def npz(path: Path) -> ArrayTable:
    """Arrays by name."""
    with np.load(path, allow_pickle=False) as archive:
        return _table(path, "an archive of NumPy arrays", [(name, archive[name], "") for name in archive.files])


@_reads("a MATLAB file")
def mat(path: Path) -> ArrayTable:
    """Arrays by name, those of structures too."""
    from scipy.io import loadmat

    return _table(path, "a MATLAB file", list(_flat(loadmat(path, squeeze_me=True, simplify_cells=True))))


def _flat(found: Mapping[str, Any], above: str = "") -> Iterable[tuple[str, Any, str]]:
    for name, value in found.items():
        if name.startswith("__"):
            continue
        if isinstance(value, Mapping):
            yield from _flat(value, f"{above}{name}.")
        elif isinstance(value, np.ndarray | float | int | list | np.number):
            yield f"{above}{name}", value, ""


@_reads("an HDF5 file")
def hdf(path: Path) -> ArrayTable:
    """MATLAB 7.3 and other HDF5: arrays by name."""
    import h5py

    found: list[tuple[str, Any, str]] = []

    def keep(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and not name.startswith("#"):
            found.append((name.replace("/", "."), item[()], str(item.attrs.get("units", ""))))

    with h5py.File(path) as file:
        file.visititems(keep)
    return _table(path, "an HDF5 file", found)


@_reads("a NetCDF or HDF5 file")
def nc(path: Path) -> ArrayTable:
    """Variables of xarray, read when they are asked for; a second dimension with names gives a column for each name."""
    import xarray as xr

    try:
        ds = xr.open_dataset(path, engine="netcdf4", decode_times=False, cache=False)
    except (OSError, ValueError):
        return hdf(path)
    if not ds.variables:
        ds.close()
        return hdf(path)
    named: list[tuple[str, Any, str]] = []
    for name, v in ds.variables.items():
        unit = str(v.attrs.get("units", "")).partition(" since ")[0]
        unit = "" if unit in ("1", "time") else unit
        long = max(v.dims, key=lambda d: v.sizes[d]) if v.dims else None
        if v.ndim != 2:
            named.append((str(name), v, unit))
            continue
        other = next(d for d in v.dims if d != long)
        labels = (
            [str(x) for x in ds[other].values] if other in ds.coords else [f"{name}_{k + 1}" for k in range(v.sizes[other])]
        )
        each = str(v.attrs.get("unit_of_each", "")).split()
        units = each if len(each) == len(labels) else [unit] * len(labels)
        named += [
            (label, v.transpose(long, other)[:, k], u) for k, (label, u) in enumerate(zip(labels, units, strict=True))
        ]
    try:
        table = _table(path, "a NetCDF file", named)
    except InputError:
        ds.close()
        raise
    table.closing = ds.close
    return table


@_reads("a Parquet file")
def parquet(path: Path) -> ArrayTable:
    """Columns of pandas."""
    import pandas as pd

    frame = pd.read_parquet(path)
    named = [(str(n), frame[n].to_numpy(), "") for n in frame.columns]
    stamps = [(n, *(_seconds(v) if v.dtype.kind == "M" else (v, u))) for n, v, u in named]
    return _table(path, "a Parquet file", stamps)


def _seconds(stamps: Any) -> tuple[Any, str]:
    """Dates as seconds since the first one, and their unit."""
    numbers = stamps.astype("datetime64[ns]").astype(np.int64)
    return (numbers - numbers[0]) * 1e-9, "s"


@_reads("a TDMS file")
def tdms(path: Path) -> ArrayTable:
    """Channels of LabVIEW, each with its unit."""
    import nptdms

    named, rates = [], set()
    with nptdms.TdmsFile.open(path) as file:
        for group in file.groups():
            for channel in group.channels():
                step = channel.properties.get("wf_increment")
                rates |= {1 / step} if step else set()
                named.append(
                    (
                        f"{group.name}/{channel.name}" if len(file.groups()) > 1 else channel.name,
                        channel[:],
                        str(channel.properties.get("unit_string", "")),
                    )
                )
    return _table(path, "a TDMS file", named, rates.pop() if len(rates) == 1 else None)


@_reads("a universal file (UFF)")
def uff(path: Path) -> ArrayTable:
    """Time records of data sets 58."""
    import pyuff

    sets = pyuff.UFF(str(path)).read_sets()
    sets = [s for s in (sets if isinstance(sets, list) else [sets]) if s.get("type") == 58]
    times = [s for s in sets if s.get("func_type") == 1]
    if not times:
        raise InputError(f"{path}: found a universal file without time records (data set 58, function 1), expected one")
    named = [
        (
            str(s.get("id1") or s.get("id4") or f"record {k + 1}").strip(),
            np.real(s["data"]),
            str(s.get("ordinate_axis_units_lab", "")).strip(),
        )
        for k, s in enumerate(times)
    ]
    steps = {float(s["abscissa_inc"]) for s in times if s.get("abscissa_spacing") == 1 and s.get("abscissa_inc")}
    return _table(path, "a universal file (UFF)", named, 1 / steps.pop() if len(steps) == 1 else None)
