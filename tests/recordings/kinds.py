"""Files as loggers and programs write them: for each kind ten variants, with the truth.

A kind is a function of a number from 0 to 9 that gives the bytes of a file, the options with which it is read, and what must
come out: the values with the rate, or the words of a refusal.
"""

import io
from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass
class Recorded:
    """One file and its truth; ``warned`` are words that a warning must have."""

    content: bytes
    values: Any = None
    rate: float | None = None
    options: dict[str, Any] = field(default_factory=dict)
    refused: str = ""
    warned: str = ""
    suffix: str = ".csv"


def signal(variant, size=400, amplitude=99.0):
    k = np.arange(size)
    return np.round(amplitude * np.sin(2 * np.pi * (0.031 + 0.0071 * variant) * k + 0.3), 2)


def table(rows, separator=",", head="", decimal=".", newline="\n"):
    """Rows of texts; points become the decimal mark."""
    lines = [separator.join(f.replace(".", decimal) for f in row) for row in rows]
    return (head + newline.join(lines) + newline).encode()


def stamped(values, step=0.01, form="{:.6f}"):
    return [(form.format(k * step), repr(float(v))) for k, v in enumerate(values)]


def decimal_comma_one_column(v):
    x = signal(v)
    fixed = [(f"{value:.{1 + v % 3}f}",) for value in x]
    truth = [float(row[0]) for row in fixed]
    head = "" if v % 2 else "amplitude\n"
    if v % 2 == 0 or any(row[0].startswith("-0.") or (v % 3 and ".0" in row[0]) for row in fixed):
        return Recorded(table(fixed, head=head, decimal=","), truth, 5.0, {"rate": 5.0})
    return Recorded(table(fixed, head=head, decimal=","), refused="decimal comma")


def decimal_comma_between_others(v):
    x = signal(v)
    separator = (";", "\t", " ", "|", ";  ")[v % 5]
    rows = stamped(x, 0.004, "{:.3f}")
    return Recorded(
        table(rows, separator, f"time{separator.strip() or ' ' if separator != chr(9) else separator}acc\n", ","),
        x,
        250.0,
        {"column": "acc"},
    )


def decimal_comma_in_comma_table(v):
    names = ",".join(["time", "a", "b", "c"][: 2 + v % 3])
    rows = [[str(k)] + [f"{value:.1f}"] * (1 + v % 3) for k, value in enumerate(np.abs(signal(v)) + 1)]
    return Recorded(table(rows, ",", names + "\n", ","), refused="names", options={"column": "a"})


def rounded_times(v):
    rate = (128.0, 1024.0, 300.0, 51200.0, 48.0, 6000.0, 44100.0, 1e3 / 3, 700.0, 12.8)[v]
    digits = (3, 4, 3, 6, 3, 5, 6, 4, 4, 3)[v]
    x = signal(v)
    rows = [(f"{k / rate:.{digits}f}", repr(float(y))) for k, y in enumerate(x)]
    return Recorded(table(rows, head="time,a\n"), x, rate, {"column": "a"})


def times_coarser_than_the_step(v):
    x = signal(v, 1000)
    rate = 20.0 + 10 * v
    rows = [(str(int(k / rate)), repr(float(y))) for k, y in enumerate(x)]
    return Recorded(table(rows, head="time [s],a\n"), x, rate, {"column": "a"}, warned="rounded")


def comment_lines(v):
    mark = ("#", "%", ";", "//", "# ", "% ", "; ", "!", "##", "#,")[v]
    x = signal(v)
    head = f"{mark}Title, logger {v}\n{mark} made by someone\n"
    body = table(stamped(x), ",", head + ("time,Ax\n" if v % 2 else f"{mark}time,Ax\n"))
    return Recorded(body, x, 100.0, {"column": "Ax"})


def rate_above_the_table(v):
    line, rate = (
        ("Rate,25600", 25600.0),
        ("SampleRate, 100,Hz", 100.0),
        ("Sampling frequency: 12.8 kHz", 12800.0),
        ("fs=2000", 2000.0),
        ("Sample Interval\t0.0005", 2000.0),
        ("dt = 2 ms", 500.0),
        ("Sampling Rate [Hz]: 51200", 51200.0),
        ("Delta_X 0.001", 1000.0),
        ("Sample rate (kHz);48", 48000.0),
        ("# sampling_rate: 1000", 1000.0),
    )[v]
    x = signal(v)
    return Recorded(table([(str(k), repr(float(y))) for k, y in enumerate(x)], head=line + "\n"), x, rate, {"column": "2"})


def numeric_header(v):
    x = signal(v)
    if v < 5:  # pandas: the index has no name
        return Recorded(
            table([(str(k), repr(float(y))) for k, y in enumerate(x)], head=",0\n"), x, 8.0, {"column": "0", "rate": 8.0}
        )
    many = v - 3
    names = ",".join(str(k) for k in range(many))
    rows = [[f"{y + j / 7:.5f}" for j in range(many)] for y in x]
    return Recorded(
        table(rows, head=names + "\n"),
        [float(r[1]) for r in rows],
        8.0,
        {"column": "2", "rate": 8.0},
        warned="names that are numbers",
    )


def missing_rows(v):
    x = np.sin(2 * np.pi * 0.02 * np.arange(600) + v)
    every = 11 + 3 * v
    rows = [row for k, row in enumerate(stamped(x, 0.5, "{:.1f}")) if k % every != 5 or k > 590]
    return Recorded(table(rows, head="time,a\n"), x, 2.0, {"column": "a"}, warned="line 7: the time in 'time' steps by 1 s")


def long_gap(v):
    x = signal(v)
    at = 60 + 20 * v
    rows = [(f"{(k + 500 * (k >= at)) * 0.5:.1f}", repr(float(y))) for k, y in enumerate(x)]
    longest = x[:at] if at >= 200 else x[at:]
    return Recorded(table(rows, head="time,a\n"), longest, 2.0, {"column": "a"}, warned=f"line {at + 2}: the time")


def restarted_times(v):
    x = signal(v)
    at = 50 + 20 * v
    rows = [(f"{(k - at * (k >= at)) * 0.5:.1f}", repr(float(y))) for k, y in enumerate(x)]
    return Recorded(
        table(rows, head="time,a\n"), refused=f"line {at + 2}: the time in 'time' goes back", options={"column": "a"}
    )


def doubled_stamps(v):
    x = signal(v)
    at = 50 + 20 * v
    rows = stamped(x, 0.5, "{:.1f}")
    rows.insert(at, rows[at])
    return Recorded(
        table(rows, head="time,a\n"),
        x,
        2.0,
        {"column": "a"},
        warned=f"line {at + 3}: the time in 'time' is that of the row before",
    )


def units_in_names(v):
    name, per_second = (
        ("t_ms", 1e3),
        ("time (s)", 1.0),
        ("Time [ms]", 1e3),
        ("t / s", 1.0),
        ("time_us", 1e6),
        ("Zeit in ms", 1e3),
        ("Time (msec)", 1e3),
        ("t[µs]", 1e6),
        ("elapsed (min)", 1 / 60),
        ("Timestamp [ns]", 1e9),
    )[v]
    x = signal(v)
    rows = [(f"{k * 0.002 * per_second:.9g}", repr(float(y))) for k, y in enumerate(x)]
    return Recorded(table(rows, ";", f"{name};acc [m/s^2]\n"), x, 500.0, {"column": "acc"})


def units_row(v):
    names, units = (
        ("Time,Acc", "s,g"),
        ("Time,Acc", "[s],[m/s^2]"),
        ("Time,Acc", "(s),(V)"),
        ("Time,Acc", "ms,m/s²"),
        ("t,Acc", "[ms],[g]"),
        ("Time,Acc", "s,"),
        ("Time,Acc", "s,mm"),
        ("Time,Acc", "us,Pa"),
        ("X_Value,Acc", "s,N"),
        ("Elapsed Time,Acc", "min,rpm"),
    )[v]
    scale = {"ms": 1e3, "us": 1e6, "min": 1 / 60}.get(units.split(",")[0].strip("[]()"), 1.0)
    x = signal(v)
    rows = [(f"{k * 0.02 * scale:.9g}", repr(float(y))) for k, y in enumerate(x)]
    return Recorded(table(rows, ",", f"{names}\n{units}\n"), x, 50.0, {"column": "Acc"})


def labview(v):
    x = signal(v)
    comma = v % 2
    head = (
        "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\n" + f"Decimal_Separator\t{',' if comma else '.'}\n"
        "Multi_Headings\tNo\n***End_of_Header***\t\n\t\nChannels\t1\t\nSamples\t400\t\nDate\t2024/02/03\t\n"
        "Delta_X\t0.001\t\n***End_of_Header***\t\t\nX_Value\tAcc\tComment\n"
    )
    times = v < 6
    rows = [(f"{k * 0.001:.6f}" if times else "", f"{y:.6f}", "") for k, y in enumerate(x)]
    return Recorded(
        table(rows, "\t", head, "," if comma else ".", "\r\n" if v % 3 else "\n"),
        x,
        1000.0,
        {"column": "Acc"},
        suffix=".lvm",
    )


def numpy_text(v):
    x = signal(v)
    made = io.BytesIO()
    forms = ("%.18e", "%g", "%.6f", "%10.4f", "%.3e")
    delimiter = (",", " ", "\t", ";", "  ")[v % 5]
    np.savetxt(made, np.c_[np.arange(400) / 25.0, x], delimiter=delimiter, fmt=forms[v // 2], header=f"time{delimiter}a")
    values = [float(forms[v // 2] % y) for y in x]
    return Recorded(made.getvalue(), values, 25.0, {"column": "a"}, suffix=".txt")


def encodings(v):
    name = ("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "latin-1", "cp1252", "utf-32", "latin-1", "utf-8")[v]
    x = signal(v)
    title = "Größe [µm]" if v % 2 else "Acc [m/s²]"
    text = f"time,{title}\n" + table(stamped(x)).decode()
    if v == 8:
        text = text.replace("\n", "\r")
    return Recorded(text.encode(name), x, 100.0, {"column": title})


def sentinels(v):
    x = 0.3 * np.sin(2 * np.pi * 0.05 * np.arange(500) + v)
    mark = ("-999", "-9999.0", "9999", "1e30", "-32768", "99999", "-1e+20", "9.96921e+36", "1e10", "-99.99")[v]
    at = 100 + 17 * v
    texts = [mark if k in (at, at + 200) else repr(float(y)) for k, y in enumerate(x)]
    values = [float(t) for t in texts]
    return Recorded(table([(t,) for t in texts], head="y\n"), values, 1.0, {"rate": 1.0}, warned=f"line {at + 2}: the value")


def missing_words(v):
    word = ("nan", "NaN", "", "NA", "n/a", "null", "-", "#N/A", "None", "?")[v]
    x = signal(v)
    rows = stamped(x)
    rows[77] = (rows[77][0], word)
    return Recorded(table(rows, head="time,a\n"), refused="line 79: found", options={"column": "a"})


def missing_words_declared(v):
    made = missing_words(v)
    x = 2 + np.sin(2 * np.pi * 0.01 * np.arange(400))
    rows = stamped(x)
    rows[77] = (rows[77][0], ("nan", "NaN", "", "NA", "n/a", "null", "-", "#N/A", "None", "?")[v])
    made.content, made.refused, made.values, made.rate = table(rows, head="time,a\n"), "", x, 100.0
    made.options = {"column": "a", "missing": ["nan"]}
    made.warned = "line 79: a value is missing"
    return made


def row_names(v):
    """write.table of R: one name less than fields."""
    x = signal(v)
    separator = (",", " ", "\t", ";", ",")[v % 5]
    quoted = v % 2
    rows = [(f'"{k + 1}"' if quoted else str(k + 1), repr(float(-y)), repr(float(y))) for k, y in enumerate(x)]
    return Recorded(table(rows, separator, separator.join(('"y1"', '"y2"')) + "\n"), x, 3.0, {"column": "y2", "rate": 3.0})


def pandas_index(v):
    x = signal(v)
    rows = [(str(k), f"{k / 40:.4f}", repr(float(y))) for k, y in enumerate(x)]
    return Recorded(table(rows, ",;"[v % 2], ",time,a\n".replace(",", ",;"[v % 2])), x, 40.0, {"column": "a"})


def ragged(v):
    rows = stamped(signal(v))
    at = 20 + 30 * v
    rows[at] = (*rows[at], "7") if v % 2 else rows[at][:1]
    found = "3 columns" if v % 2 else "1 column"
    return Recorded(table(rows, head="time,a\n"), refused=f"line {at + 2}: found {found}", options={"column": "a"})


def words_in_a_row(v):
    rows = stamped(signal(v))
    at = 5 + 37 * v
    rows[at] = (rows[at][0], ("OVER", "1.2.3", "12 g", "0x1F", "1,000.5", "err", "true?", "--.-", "12%", "on")[v])
    return Recorded(table(rows, ";", "time;a\n"), refused=f"line {at + 2}: found", options={"column": "a"})


def names_twice(v):
    rows = [(str(k), repr(float(y)), repr(float(-y))) for k, y in enumerate(signal(v))]
    if v % 2:
        return Recorded(table(rows, head="n,y,y\n"), refused="columns 2 and 3", options={"column": "y", "rate": 1.0})
    return Recorded(table(rows, head="n,y,y\n"), signal(v), 1.0, {"column": "2", "rate": 1.0})


def excel(v):
    x = signal(v)
    separator, decimal = ((";", ","), (",", "."), ("\t", "."), ("|", "."), (";", "."))[v % 5]
    return Recorded(
        table(stamped(x), separator, f"sep={separator}\n" + separator.join(("time", "a")) + "\n", decimal, "\r\n"),
        x,
        100.0,
        {"column": "a"},
    )


def dates(v):
    x = signal(v)
    form = ("{d}T{c}Z", "{d} {c}", "{d} {c}+00:00", "{e} {c}", "{u} {c}", "{c}", "{d}T{c}", "{w} {c}", "{d},{c}", "{e},{c}")[
        v
    ]
    rows = []
    for k, y in enumerate(x):
        milli = 86_390_000 + 50 * k  # over midnight after 10 s
        day, rest = divmod(milli, 86_400_000)
        s, ms = divmod(rest, 1000)
        clock = f"{s // 3600:02d}:{s // 60 % 60:02d}:{s % 60:02d}.{ms:03d}"
        d = 5 + day
        stamp = form.format(d=f"2024-02-{d:02d}", e=f"{d:02d}.02.2024", u=f"02/{d:02d}/2024", w=f"{d}.2.24", c=clock)
        rows.append((stamp, repr(float(y))))
    lines = "\n".join(",".join(row) for row in rows) + "\n"
    return Recorded(("Date,Time,a\n" if v >= 8 else "Time,a\n").encode() + lines.encode(), x, 20.0, {"column": "a"})


def epoch(v):
    x = signal(v)
    scale, digits = ((1, 3), (1e3, 0), (1e6, 0), (1e9, 0), (1, 6))[v % 5]
    rows = [(f"{(1_700_000_000 + k * 0.01) * scale:.{digits}f}", repr(float(y))) for k, y in enumerate(x)]
    return Recorded(
        table(rows, head=("timestamp,a\n", "time,a\n")[v % 2]),
        x,
        100.0,
        {"column": "a"},
        warned="" if v % 5 in (0, 4) else "stamps since 1970",
    )


def clock_columns(v):
    """A run-to-failure record: hour, minute, second, microsecond, horizontal, vertical, without names."""
    x = signal(v, 2560)
    separator = (",", ";")[v % 2]
    begin = 35_979_000_000 + 65_664 + v * 977_777
    rows = []
    for k, y in enumerate(x):
        t = round(begin + k * 1e6 / 25600)
        s, us = divmod(t, 1_000_000)
        micro = f"{us:.4e}" if v >= 8 else str(us)
        rows.append((str(s // 3600), str(s // 60 % 60), str(s % 60), micro, repr(float(y)), repr(float(-y / 2))))
    return Recorded(table(rows, separator), x, 25600.0, {"column": "5"})


def sample_count(v):
    x = signal(v)
    return Recorded(
        (f"{x.size}\n" + "\n".join(repr(float(y)) for y in x) + "\n").encode(),
        x,
        2.0,
        {"rate": 2.0},
        warned="number of samples",
    )


def footers(v):
    x = signal(v)
    foot = (
        "End of data",
        "***",
        "mean;0.5;",
        "# done",
        "",
        "END,1",
        "Total samples: 400",
        "--- 400 rows ---",
        "stop",
        "\x1a",
    )[v]
    return Recorded(table(stamped(x), head="time,a\n") + foot.encode() + b"\n", x, 100.0, {"column": "a"})


def cut_while_writing(v):
    rows = table(stamped(signal(v)), head="time,a,b\n").replace(b"\n", b",1\n").replace(b"time,a,b,1", b"time,a,b")
    lines = rows.split(b"\n")
    return Recorded(
        b"\n".join(lines[:300]) + b"\n" + lines[300].split(b",")[0] + b"," * (v % 2),
        signal(v)[:299],
        100.0,
        {"column": "a"},
        warned="line 301",
    )


def fortran(v):
    x = signal(v)
    rows = [(f"{k * 0.25:12.4f}", f"{y:18.9E}".replace("E", "D" if v % 2 else "E")) for k, y in enumerate(x)]
    return Recorded(table(rows, " ", "" if v % 3 else "  time    a\n"), x, 4.0, {"column": "2"}, suffix=".dat")


def uneven(v):
    x = signal(v)
    t = np.cumsum(np.random.default_rng(v).uniform(0.2, 1.8, x.size))
    rows = [(f"{s:.6f}", repr(float(y))) for s, y in zip(t, x, strict=True)]
    return Recorded(table(rows, head="time,a\n"), refused="equal steps", options={"column": "a"})


def jitter(v):
    x = signal(v)
    t = np.arange(x.size) * 0.1 + 0.002 * np.random.default_rng(v).uniform(-0.5, 0.5, x.size)
    rows = [(f"{s:.7f}", repr(float(y))) for s, y in zip(t, x, strict=True)]
    return Recorded(table(rows, head="time,a\n"), x, 10.0, {"column": "a"})


KINDS = [
    f
    for f in list(globals().values())
    if callable(f)
    and getattr(f, "__module__", "") == __name__
    and f.__name__ not in ("Recorded", "signal", "table", "stamped")
]
