"""The model of a case: a stock model, or one from the user's own Python file."""

import hashlib
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any

from whirlmap.equations.family import Family
from whirlmap.equations.model import Model
from whirlmap.errors import CaseError, WhirlmapError, nearest


def find(name: str, folder: Path, place: str) -> Family:
    """Return the family that a case names.

    Parameters
    ----------
    name : str
        A stock model, ``"duffing"``, or a model in a Python file, ``"my_rotor.py:MY_ROTOR"``, relative to
        ``folder``.
    place : str
        File and line of the case, for messages.

    Raises
    ------
    CaseError
        No such model, file or name in it; or the file fails when it is run.
    """
    if ".py" not in name:
        from whirlmap.models import family

        try:
            return family(name)
        except CaseError as error:
            raise CaseError(f"{place}: {error}, or a model of your own: 'my_rotor.py:MY_ROTOR'") from None
    file, _, attribute = name.rpartition(":")
    if not file.endswith(".py") or not attribute.isidentifier():
        raise CaseError(f"{place}: found model = {name!r}, expected file and name: 'my_rotor.py:MY_ROTOR'")
    path = (folder / file).resolve()
    try:
        text = path.read_text(encoding="utf-8-sig")  # editors of Windows begin a file with a mark
    except (OSError, UnicodeDecodeError) as error:
        raise CaseError(f"{place}: model file {path} cannot be read ({_reason(error)})") from None
    module = _run(path, text, hashlib.sha256(text.encode()).hexdigest())
    made = getattr(module, attribute, None)
    if isinstance(made, Family):
        return made
    if isinstance(made, Model):
        return _single(made)
    models = [key for key, value in vars(module).items() if isinstance(value, Family | Model)]
    found = f"it is a {type(made).__name__}" if hasattr(module, attribute) else "there is no such name"
    raise CaseError(
        f"{place}: {path} declares no model {attribute!r}: {found}, expected a Family or a Model."
        f"{nearest(attribute, models)}\n  models there: {', '.join(models) or 'none'}"
    )


@lru_cache(maxsize=64)
def _single(model: Model) -> Family:
    return Family(model.name, lambda: model)


@lru_cache(maxsize=64)
def _run(path: Path, text: str, digest: str) -> ModuleType:
    """Run a model file; the same text gives the same objects, so that its kernels are found again."""
    module = ModuleType(f"whirlmap_user_{path.stem}_{digest[:12]}")
    module.__file__ = str(path)
    try:
        exec(compile(text, str(path), "exec"), module.__dict__)
    except WhirlmapError as error:
        raise type(error)(f"{path}{_line(error, path)}: {error}") from None
    except Exception as error:
        raise CaseError(f"{path}{_line(error, path)}: {type(error).__name__}: {error}{_way_out(error)}") from error
    return module


#: What Python, NumPy and SymPy say where a formula is written with what knows numbers only, and what to write instead.
WAYS_OUT = {
    "cannot determine truth value": "a condition on a state is not known yet; expected when(condition, value, otherwise), or"
    " Max and Min in place of max and min",
    "Cannot convert expression to float": "the module math knows numbers only; expected functions of whirlmap.equations,"
    " such as sin(y)",
    "has no callable": "NumPy's functions know numbers only; expected functions of whirlmap.equations, such as sin(y)",
    "object arrays are not supported": "an interpolation knows numbers only; expected a formula, or a Table of"
    " whirlmap.equations",
    "and 'StrictLessThan'": "a condition is no number; expected when(condition, value, otherwise)",
    "and 'StrictGreaterThan'": "a condition is no number; expected when(condition, value, otherwise)",
}


def _way_out(error: Exception) -> str:
    return next((f": {way}" for said, way in WAYS_OUT.items() if said in str(error)), "")


def _line(error: Exception, path: Path) -> str:
    if isinstance(error, SyntaxError):
        return f", line {error.lineno}"
    trace, line = error.__traceback__, 0
    while trace:
        if trace.tb_frame.f_code.co_filename == str(path):
            line = trace.tb_lineno
        trace = trace.tb_next
    return f", line {line}" if line else ""


def _reason(error: Any) -> str:
    return error.strerror if isinstance(error, OSError) and error.strerror else type(error).__name__
