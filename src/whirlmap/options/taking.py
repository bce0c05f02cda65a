"""How functions take options: as the two values, or by their parts as keywords, which is shorter to write."""

import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, Field, fields, replace
from functools import wraps
from inspect import Parameter, signature
from pathlib import Path
from typing import Any, ParamSpec, TypedDict, TypeVar, cast

from whirlmap.errors import nearest
from whirlmap.options.computed import INTEGRATION, LABELLING, Integration, Labelling, Settling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.storage import STORAGE, Storage
from whirlmap.progress import Progress

P = ParamSpec("P")
R = TypeVar("R")


class IntegrationParts(TypedDict, total=False):
    """Parts of `Integration` and `Execution`, as keywords of functions that label nothing."""

    steps: Any
    accuracy: float | None
    method: str | None
    workers: int | None
    progress: Any


class LabellingParts(IntegrationParts, total=False):
    """Parts of `Labelling` and `Execution`, as keywords of functions that label points."""

    settling: Settling | None
    lyapunov: int | None
    integration: Integration | None


class MapParts(LabellingParts, total=False):
    """The same with those of `Storage`, of functions that a cluster can compute and a store keeps."""

    cluster: Any
    store: str | Path | None
    resume: bool
    force: bool
    share: tuple[int, int] | None
    chunk: int | None


def _names(kind: type[Any]) -> list[str]:
    return [field.name for field in fields(kind)]


#: Keywords that stand for parts of each value.
PARTS = {
    "labelling": [n for n in _names(Labelling) if n != "integration"], "integration": _names(Integration),
    "execution": _names(Execution), "storage": _names(Storage),
}  # fmt: skip
DEFAULTS: dict[str, Any] = {"labelling": LABELLING, "integration": INTEGRATION, "execution": EXECUTION, "storage": STORAGE}


def takes_options(
    bar: str | None = None, *, former: Mapping[str, str] | None = None, **shown: str
) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Have a function take its options by their parts too, and ``progress=True`` show a bar of this name.

    The function has the keywords ``labelling`` or ``integration``, ``execution``, maybe ``storage``; it gets them whole,
    whatever was given, with a callable for ``progress``. ``shown`` are options of `Progress`. ``cluster`` goes with
    ``storage``. ``former`` are keywords that have another name now; the former one works for one release, with a warning.
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        own = signature(function)
        named = [p for p in own.parameters.values() if p.kind != Parameter.VAR_KEYWORD]
        held = [name for name in DEFAULTS if name in own.parameters]
        if "labelling" in held:
            held.insert(1, "integration")
        parts = [part for name in held for part in PARTS[name] if part != "cluster" or "storage" in held]
        known = [*(p.name for p in named), *held, *parts]

        @wraps(function)
        def taking(*args: P.args, **given: P.kwargs) -> R:
            for old, new in (former or {}).items():
                if old in given and new not in given:
                    told = f"{function.__name__}({old}=...) is {function.__name__}({new}=...) now"
                    warnings.warn(told, DeprecationWarning, stacklevel=2)
                    given[new] = given.pop(old)
            whole: dict[str, Any] = _resolved(function.__name__, given, held, known)
            execution = whole["execution"]
            if execution.cluster is not None and "storage" not in held:
                raise TypeError(f"{function.__name__}: only regime_map and tolerance_sweep run on a cluster")
            if execution.progress is not True:
                return cast(Any, function)(*args, **whole)
            with Progress(bar or function.__name__, None, **shown) as progress:  # type: ignore[arg-type]  # words all of them
                whole["execution"] = replace(execution, progress=progress)
                return cast(Any, function)(*args, **whole)

        extra = dict.fromkeys([*held, *parts]).keys() - {p.name for p in named}
        flat = [Parameter(name, Parameter.KEYWORD_ONLY, default=None) for name in [*held, *parts] if name in extra]
        cast(Any, taking).__signature__ = own.replace(parameters=[*named, *flat])
        return taking

    return decorate


def _resolved(function: str, given: dict[str, Any], held: Iterable[str], known: Iterable[str]) -> dict[str, Any]:
    """Keywords with the options as whole values.

    Raises
    ------
    TypeError
        A keyword that the function does not have, or a part that is given both by itself and in its whole.
    """
    for name in given:
        if name not in known:
            every = " ".join(dict.fromkeys(known))
            raise TypeError(f"{function}: found the keyword {name!r}.{nearest(name, known)}\n  keywords: {every}")
    out = dict(given)
    for name in held:
        parts = {part: out.pop(part) for part in PARTS[name] if part in out}
        whole = out.pop(name, None)
        if name == "integration" and "labelling" in out:  # a part of the labelling, with parts of its own
            labelling = _with(function, "labelling", out["labelling"], {"integration": whole})
            out["labelling"] = replace(labelling, integration=_with(function, name, labelling.integration, parts))
        else:
            out[name] = _with(function, name, DEFAULTS[name] if whole is None else whole, parts)
    return out


def _with(function: str, name: str, whole: Any, parts: dict[str, Any]) -> Any:
    """A value with some of its parts, None standing for one that is not given."""
    if type(whole) is not type(DEFAULTS[name]):
        raise TypeError(f"{function}: found {whole!r} as {name}, expected {type(DEFAULTS[name]).__name__}(...)")
    parts = {part: value for part, value in parts.items() if value is not None and (part, value) != ("progress", False)}
    for field in fields(whole):
        now = getattr(whole, field.name)
        if field.name in parts and now is not (usual := _usual(field)) and (type(now) is not type(usual) or now != usual):
            raise TypeError(f"{function}: found {field.name} by itself and in {name}, expected it in one of them")
    return replace(whole, **parts) if parts else whole


def _usual(field: "Field[Any]") -> Any:
    return field.default if field.default_factory is MISSING else field.default_factory()
