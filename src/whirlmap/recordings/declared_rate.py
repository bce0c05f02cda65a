"""Sampling rates in words: of a line above a table (``SampleRate, 100,Hz``, ``Delta_X 0.001``), of a user (``25.6 kHz``)."""

import re
from collections.abc import Sequence

from whirlmap.errors import InputError
from whirlmap.recordings.column_names import seconds_per

_NUMBER = r"([+-]?(?:\d+(?:[.,]\d*)?|\.\d+)(?:[eE][+-]?\d+)?)"
_RATE = re.compile(
    r"^\W*(?:(?:sampl\w*|scan|acquisition|data|abtast)[\s_-]*(?:rate|frequency|freq\.?)|rate|fs|samples per "
    "second|abtastrate)"
    rf"\s*[\[(]?\s*(?P<before>[kM]?(?:Hz|S/s|Sa/s))?[\])]?\W*?{_NUMBER}\W*(?P<unit>[kM]?(?:Hz|S/s|Sa/s|1/s))?",
    re.IGNORECASE,
)
_STEP = re.compile(
    r"^\W*(?:delta[\s_-]?[xt]|dt|(?:sampl\w*|time|scan)[\s_-]*(?:interval|period|step|increment)|increment|time base "
    "step|hresolution)"
    rf"\s*[\[(]?\s*(?P<before>[munµ]?s(?:ec)?)?[\])]?\W*?{_NUMBER}\W*(?P<unit>[munµ]?s(?:ec|econds)?\b)?",
    re.IGNORECASE,
)
_GIVEN = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([kMG]?)(?:Hz|S/s|Sa/s|sps|/s|1/s)?\s*")


def samples_per_second(text: str) -> float:
    """Read a rate: a number, with a unit of frequency or none."""
    found = _GIVEN.fullmatch(text)
    if not found:
        raise InputError(f"--rate: found {text!r}, expected a number of samples per second, or such as '25.6 kHz'")
    return float(found[1]) * {"": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}[found[2]]


def declared_rate(lines: Sequence[str]) -> tuple[float | None, str]:
    """Samples per second that some line says, and what it says in words; None where none does."""
    for line in lines:
        if found := _RATE.match(line.strip()):
            value = _value(found[2])
            unit = (found["unit"] or found["before"] or "Hz").lower()
            scale = 1e3 if unit.startswith("k") else 1e6 if unit.startswith("m") else 1.0
            if value > 0:
                return value * scale, f"they say {value * scale:g} samples per second"
        elif found := _STEP.match(line.strip()):
            value = _value(found[2])
            step = value * (seconds_per(found["unit"] or found["before"] or "s") or 1.0)
            if step > 0:
                return 1.0 / step, f"they say a step of {step:g} s"
    return None, ""


def _value(text: str) -> float:
    try:
        return float(text.replace(",", ".", 1))
    except ValueError:
        return 0.0
