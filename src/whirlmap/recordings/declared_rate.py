"""The sampling rate that a line above a table declares: ``Rate,25600``, ``SampleRate, 100,Hz``, ``Delta_X 0.001``."""

import re
from collections.abc import Sequence

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
