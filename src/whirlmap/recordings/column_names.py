"""Names of columns: the unit in a name, and which names are times."""

import re
from functools import lru_cache

from whirlmap.errors import CaseError
from whirlmap.units import factor, known

_BRACKETS = re.compile(r"(?P<name>.*?)[\s_]*[\[({<](?P<unit>[^\])}>]*)[\])}>]\s*")
_SLASH = re.compile(r"(?P<name>[^/]+?)\s*/\s*(?P<unit>[^/].*)")
_IN = re.compile(r"(?P<name>.+?)[\s_]+in[\s_]+(?P<unit>\S+)", re.IGNORECASE)
_SUFFIX = re.compile(r"(?P<name>.+?)[\s_,;:]+(?P<unit>\S+)")
#: Units that may follow a name after an underscore or a blank; other words there belong to the name.
_SUFFIXES = frozenset(
    {
        "s",
        "ms",
        "us",
        "µs",
        "μs",
        "ns",
        "sec",
        "secs",
        "second",
        "seconds",
        "msec",
        "usec",
        "min",
        "h",
        "hr",
        "hours",
        "milliseconds",
        "microseconds",
        "nanoseconds",
        "minutes",
        "Hz",
        "kHz",
        "rpm",
        "g",
        "mg",
        "mm",
        "um",
        "µm",
        "μm",
        "m",
        "mV",
        "V",
        "Pa",
        "kPa",
        "bar",
        "N",
        "kN",
        "Nm",
        "A",
        "mA",
        "degC",
        "mm/s",
        "m/s",
        "m/s2",
        "m/s^2",
        "m/s²",
    }
)
_TIMES = frozenset(
    {
        "t",
        "time",
        "times",
        "xvalue",
        "timestamp",
        "timestamps",
        "timestep",
        "zeit",
        "zeitstempel",
        "uhrzeit",
        "temps",
        "tiempo",
        "tempo",
        "tijd",
        "tid",
        "czas",
        "aika",
        "cas",
        "datum",
        "datetime",
        "date",
        "elapsed",
        "elapsedtime",
        "relativetime",
        "reltime",
        "seconds",
        "sec",
        "secs",
        "milliseconds",
        "msec",
        "epoch",
        "epochtime",
        "unixtime",
        "unix",
        "posixtime",
        "utc",
        "localtime",
        "clock",
        "sampletime",
        "timevector",
        "timeaxis",
        "tsec",
        "tms",
        "timems",
        "timesec",
        "timestampms",
        "testtime",
        "runtime",
        "totaltime",
    }
)
_OF_NAMES = {
    "milliseconds": "ms",
    "msec": "ms",
    "tms": "ms",
    "timems": "ms",
    "timestampms": "ms",
    "seconds": "s",
    "sec": "s",
    "secs": "s",
    "tsec": "s",
    "timesec": "s",
}
#: Parts of a clock that stand in columns of their own, each with its seconds.
CLOCK_PARTS = {
    "hour": 3600.0,
    "hours": 3600.0,
    "hh": 3600.0,
    "h": 3600.0,
    "minute": 60.0,
    "minutes": 60.0,
    "min": 60.0,
    "mm": 60.0,
    "second": 1.0,
    "seconds": 1.0,
    "sec": 1.0,
    "ss": 1.0,
    "millisecond": 1e-3,
    "milliseconds": 1e-3,
    "msec": 1e-3,
    "ms": 1e-3,
    "microsecond": 1e-6,
    "microseconds": 1e-6,
    "usec": 1e-6,
    "us": 1e-6,
    "µs": 1e-6,
    "nanosecond": 1e-9,
    "nanoseconds": 1e-9,
    "ns": 1e-9,
}


def split_unit(text: str) -> tuple[str, str]:
    """Split ``Acc [m/s^2]``, ``t_ms``, ``time (s)`` or ``a / (m/s²)`` into the name and the unit as written, or nothing."""
    text = text.strip()
    for pattern in (_BRACKETS, _SLASH, _IN, _SUFFIX):
        found = pattern.fullmatch(text)
        if not found:
            continue
        name, unit = found["name"].strip(" /,;:_"), found["unit"].strip()
        loose = pattern is not _BRACKETS
        if pattern is _SLASH:
            unit = unit.strip("()[] ")
        if (pattern in (_SUFFIX, _IN) and unit not in _SUFFIXES) or (loose and not is_unit(unit)):
            continue
        return name, unit if pattern is not _BRACKETS or is_unit(unit) else ""
    return text, ""


@lru_cache(maxsize=256)
def is_unit(text: str) -> bool:
    """Whether a text is a unit; ``m/s2``, ``m/s²`` and ``-`` count."""
    return text in _SUFFIXES or text in ("1", "-") or (bool(text) and known(plain_unit(text)))


def plain_unit(text: str) -> str:
    """Unit as pint reads it: ``m/s²`` and ``m/s2`` as ``m/s^2``."""
    for mark, power in (("²", "^2"), ("³", "^3")):
        text = text.replace(mark, power)
    return re.sub(r"(?<=[a-zA-Z])([23])\b", r"^\1", text)


def seconds_per(unit: str) -> float | None:
    """Seconds in one unit of time; None where the text is none."""
    try:
        return float(factor(unit.replace("µ", "u").replace("μ", "u"), "s"))
    except CaseError:
        return None


def is_time(name: str) -> bool:
    """Whether a name, without its unit, is one of the usual ones of a time column."""
    name = name.rpartition(".")[2]  # of a group in a binary file
    plain = _plain(name)
    return (
        plain in _TIMES
        or plain.startswith(("timestamp", "timein"))
        or bool(re.match(r"(?i)(time|zeit)[\s_.-]", name.strip()))
    )


def unit_of_time_name(name: str) -> str:
    """Unit that the name itself says: ``seconds``, ``time_in_ms``."""
    plain = _plain(name)
    found = re.fullmatch(r"timein(ms|us|ns|s|sec|seconds|min|minutes)", plain)
    return found[1] if found else _OF_NAMES.get(plain, "")


def _plain(name: str) -> str:
    return re.sub(r"[^a-zµμ]", "", name.lower())
