"""Former spellings of options: accepted for one release, with a warning that names the new one."""

from collections.abc import Callable, Collection, Sequence
from itertools import islice

from whirlmap.cli.common.messages import say

#: New spelling by the former one, by command.
FORMER = {
    "diagnose": {"--points": "--section-points"},
    "speeds": {"--tolerance": "--input-tolerance"},
    "identify": {"--refine": "--generations"},
}
#: Former spellings that another option has now: which values were those of the former one.
SHARED: dict[tuple[str, str], Callable[[str], bool]] = {("speeds", "--tolerance"): lambda value: "=" in value}


def with_new_spellings(command: str, args: Sequence[str], valued: Collection[str]) -> list[str]:
    """Replace former spellings among the arguments of a command, up to ``--``; each is warned of once.

    ``valued`` are its options that take a value: the word behind one is that value, whatever it looks like.
    """
    former = FORMER.get(command, {})
    told: set[str] = set()
    found: list[str] = []
    words = iter(args)
    for word in words:
        if word == "--":
            return [*found, word, *words]
        name, equals, value = word.partition("=")
        new, following = former.get(name), list[str]()
        if not equals and {name, new} & set(valued):
            following = list(islice(words, 1))
            value = "".join(following)
        meant = SHARED.get((command, name))
        if new and (meant is None or meant(value)):
            if name not in told:
                say(f"warning: {name} is now {new}; the former spelling works until the next release")
                told.add(name)
            word = word.replace(name, new, 1)
        found += [word, *following]
    return found
