"""Texts ``name=value`` of repeatable options."""

from collections.abc import Sequence

from whirlmap.errors import InputError, RangeError
from whirlmap.integrate.ranges import Range

#: What the text of an option looks like, where it is not that of --set.
EXAMPLES = {
    "--start": "--start x=0.5", "--box": "--box x=-2:2", "--input-tolerance": "--input-tolerance c=5%",
    "--threshold": "--threshold s=0.5:4", "--draw": "--draw xi_m=normal:0.1:0.01",
}  # fmt: skip


def assignments(texts: Sequence[str] | None, option: str) -> dict[str, str]:
    """Read ``name=value`` texts of a repeatable option.

    Raises
    ------
    InputError
        Where a text has another form, or a name is given two different values.
    """
    example = EXAMPLES.get(option, '--set gamma=0.3, --set "speed=1500 rpm"')
    found: dict[str, str] = {}
    for text in texts or ():
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise InputError(f"{option}: found {text!r}, expected name=value, as in {example}")
        if found.setdefault(name, value) != value:
            raise InputError(f"{option}: {name} is given twice: found {found[name]!r} and {value!r}, expected one of them")
    return found


def brackets(texts: Sequence[str] | None, option: str) -> dict[str, tuple[float, float]]:
    """Read ``name=low:high`` texts of a repeatable option.

    Raises
    ------
    InputError
        Where a text has another form, or a name is given two different values.
    RangeError
        Where a low end is not below its high end.
    """
    found = {}
    for name, text in assignments(texts, option).items():
        try:
            low, high = (float(part) for part in text.split(":"))
        except ValueError:
            raise InputError(f"{option}: found {name}={text}, expected name=low:high, as in {EXAMPLES[option]}") from None
        if not low < high:
            raise RangeError(f"{option}: found {name}={text}, but ranges ascend: swap the ends")
        found[name] = (low, high)
    return found


def tolerances_of(texts: Sequence[str] | None) -> dict[str, float]:
    """Half widths of ranges over their middle, by name."""
    found = {}
    for name, text in assignments(texts, "--input-tolerance").items():
        try:
            half = float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
        except ValueError:
            half = -1.0
        if not 0 < half < 1:
            raise InputError(f"--input-tolerance: found {name}={text}, expected a tolerance between 0 and 100 %, as in c=5%")
        found[name] = half
    return found


def ranges(texts: Sequence[str] | None, option: str) -> dict[str, Range]:
    """Read ``name=low:high`` texts of a repeatable option, whose ends may have a unit.

    Raises
    ------
    InputError, RangeError
        As `brackets` and `Range.parse`.
    """
    found = {}
    for name, text in assignments(texts, option).items():
        try:
            found[name] = Range.parse(f"{name}={text}:2", option)
        except RangeError:
            brackets([f"{name}={text}"], option)  # says what is wrong with it as a bracket
            raise
    return found
