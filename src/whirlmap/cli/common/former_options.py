"""Former spellings of options: accepted for one release, with a warning that names the new one."""

from collections.abc import Sequence

from whirlmap.cli.common.messages import say

#: New spelling by the former one, by command.
FORMER = {
    "diagnose": {"--points": "--section-points"},
    "speeds": {"--tolerance": "--input-tolerance"},
    "identify": {"--refine": "--generations"},
}


def with_new_spellings(command: str, args: Sequence[str]) -> list[str]:
    """Replace former spellings among the arguments of a command, up to ``--``; each is warned of once."""
    former = FORMER.get(command, {})
    told: set[str] = set()
    found: list[str] = []
    for k, word in enumerate(args):
        if word == "--":
            return [*found, *args[k:]]
        name, equals, value = word.partition("=")
        new = former.get(name)
        if new and name not in told:
            say(f"warning: {name} is now {new}; the former spelling works until the next release")
            told.add(name)
        found.append(f"{new}{equals}{value}" if new else word)
    return found
