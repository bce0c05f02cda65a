"""What an unknown key of a machine file probably means: by its spelling, by what a key is half of, by its meaning."""

import re
from collections.abc import Sequence

from whirlmap.errors import closest
from whirlmap.machines.fields import Field, Number

#: Keys that one hint names at most.
SHOWN = 3


def hint(key: str, fields: Sequence[Field], names: Sequence[str]) -> str:
    """Suggest a key for an unknown one: `` Did you mean 'm' (mass of a disk)?``, or nothing.

    Parameters
    ----------
    fields : sequence of Field
        Those of the table.
    names : sequence of str
        Keys that the table may say.
    """
    for one in fields:
        if isinstance(one, Number) and key in one.twice:
            return f" {one.key} ({one.meaning}) is half of it."
    near = closest(key, names)
    if near is None or near.casefold() != key.casefold():
        words = re.findall(r"[a-z]{4,}", key.casefold().replace("_", " "))
        meant = {one.key: _said(one, words) for one in fields}
        best = max(meant.values(), default=0)
        found = [one for one in fields if best and meant.get(one.key) == best][:SHOWN]
        if len(found) > 1:
            return f" Did you mean one of {', '.join(f'{one.key!r} ({one.meaning})' for one in found)}?"
        if found:
            return f" Did you mean {found[0].key!r} ({found[0].meaning})?"
    return f" Did you mean {near!r}?" if near is not None else ""


def _said(one: Field, words: Sequence[str]) -> int:
    """How many of these words the meaning of a key holds, and one more where it begins with one."""
    found = [word for word in words if re.search(rf"\b{re.escape(word)}\b", one.meaning.casefold())]
    return len(found) + one.meaning.casefold().startswith(tuple(found)) if found else 0
