"""Messages of the command line to people, on standard error."""

import codecs
import io
import sys
import unicodedata
from collections.abc import Sequence
from typing import Any

import typer

from whirlmap.errors import InputError, RangeError, nearest

#: What typer raises for a wrong command line; the base of its public BadParameter, in every version of typer.
UsageError: type[Exception] = typer.BadParameter.__mro__[1]

_EXPECTED = {
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "int_parsing_size": "a whole number of reasonable size",
    "int_type": "a whole number",
    "float_parsing": "a number",
    "float_type": "a number",
}
_LIMITS = {"greater_than_equal": ("ge", "at least"), "less_than_equal": ("le", "at most"),
           "greater_than": ("gt", "above"), "less_than": ("lt", "below")}  # fmt: skip


#: What stands for letters that an encoding does not have.
_PLAIN = {"•": "*", "·": "*", "×": "x", "°": "deg ", "–": "-", "—": "-", "…": "...", "≤": "<=", "≥": ">=", "±": "+-",
          "µ": "u", "μ": "u", "’": "'", "“": '"', "”": '"', "ß": "ss", "∆": "D", "→": "->"}  # fmt: skip


def plain_letters() -> None:
    """Have standard output and error write what stands nearest to a letter that their encoding does not have.

    Without this an ASCII terminal ends ``--help`` in a traceback.
    """
    codecs.register_error("whirlmap_plain", _nearest_letters)
    codecs.register(_meant_ascii)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and not stream.encoding.lower().startswith("utf"):
            ascii_alone = codecs.lookup(stream.encoding).name == "ascii"
            stream.reconfigure(encoding=MEANT if ascii_alone else stream.encoding, errors="whirlmap_plain")


#: ASCII by another name: typer takes an ASCII stream for a mistake, and writes UTF-8 into it.
MEANT = "whirlmap_ascii"


def _meant_ascii(name: str) -> codecs.CodecInfo | None:
    if name != MEANT:
        return None
    found = codecs.lookup("ascii")
    return codecs.CodecInfo(
        found.encode, found.decode, found.streamreader, found.streamwriter, found.incrementalencoder,
        found.incrementaldecoder, name,
    )  # fmt: skip


def _nearest_letters(error: UnicodeError) -> tuple[str, int]:
    assert isinstance(error, UnicodeEncodeError)
    made = []
    for letter in error.object[error.start : error.end]:
        bare = unicodedata.normalize("NFKD", letter).encode("ascii", "ignore").decode()
        made.append(_PLAIN.get(letter) or bare or "?")
    return "".join(made), error.end


def say(text: str) -> None:
    """Print a note on standard error."""
    sys.stderr.write(f"{text}\n")
    sys.stderr.flush()


def complain(text: str) -> None:
    """Print an error on standard error."""
    say(f"error: {text}")


def plain_words(error: Any) -> str:
    """Say what typer found wrong with a command line, and where to look.

    Typer reports values by way of pydantic, whose sentences speak to programmers; they are said again here.
    """
    context = getattr(error, "ctx", None)
    help_of = f"\n  try: {context.command_path} --help" if context is not None else ""
    problem = _problem(error)
    parameter = getattr(error, "param", None)
    if problem and parameter is not None:
        return f"{_name(parameter)}: found {str(problem.get('input'))!r}, expected {_expected(problem)}{help_of}"
    if type(error).__name__ == "NoSuchOption":
        known = [name for p in context.command.params for name in p.opts] if context else []
        return f"there is no option {error.option_name!r}.{nearest(error.option_name, known)}{help_of}"
    if type(error).__name__ == "MissingParameter" and parameter is not None:
        return f"missing {_name(parameter)}: {_first_sentence(parameter)}{help_of}"
    text = error.format_message().strip()
    return f"{text[:1].lower()}{text[1:]}{help_of}"


def _problem(error: BaseException) -> dict[str, Any] | None:
    cause = error.__cause__
    problems = cause.errors() if cause is not None and hasattr(cause, "errors") else []
    return dict(problems[0]) if problems else None


def _expected(problem: dict[str, Any]) -> str:
    kind = str(problem.get("type"))
    if kind in _EXPECTED:
        return _EXPECTED[kind]
    if kind in _LIMITS:
        key, words = _LIMITS[kind]
        return f"{words} {problem['ctx'][key]}"
    return str(problem.get("msg", "something else")).removeprefix("Value error, ")


def _name(parameter: Any) -> str:
    if getattr(parameter, "param_type_name", "") == "argument":
        return str(getattr(parameter, "metavar", None) or parameter.name).upper()
    return str(max(parameter.opts, key=len))


def _first_sentence(parameter: Any) -> str:
    return (getattr(parameter, "help", None) or "it must be given").partition(". ")[0].rstrip(".")


def taking_values(parameters: Sequence[Any]) -> set[str]:
    """Spellings of the options that take a value."""
    return {name for p in parameters if not getattr(p, "is_flag", False) for name in p.opts if name.startswith("-")}


def given_twice(parameters: Sequence[Any], args: Sequence[str]) -> None:
    """Refuse an option that takes one value but is given two different ones.

    Raises
    ------
    RangeError
        Naming the option and both values.
    """
    valued = taking_values(parameters)
    single = {name for p in parameters if not getattr(p, "multiple", False) for name in p.opts if name in valued}
    found: dict[str, str] = {}
    rest = iter(args)
    for word in rest:
        if word == "--":
            return
        name, equals, value = word.partition("=")
        if name in valued and not equals:
            value = next(rest, "")  # whatever it looks like
        if name not in single:
            continue
        if found.setdefault(name, value) != value:
            raise RangeError(f"{name} is given twice: found {found[name]!r} and {value!r}, expected one of them")


def choice(option: str, value: str, allowed: Sequence[str]) -> str:
    """Return the value where it is one of those allowed, else raise `InputError` with the nearest."""
    if value not in allowed:
        raise InputError(f"{option}: found {value!r}, expected {' | '.join(allowed)}.{nearest(value, allowed)}")
    return value
