"""Recipes: tasks with the exact commands, kept as data so that people, programs and tests read the same lines."""

import tomllib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from whirlmap.errors import InputError, nearest

FILE = Path(__file__).with_name("recipes.toml")


@dataclass(frozen=True)
class Recipe:
    """One task.

    Attributes
    ----------
    name : str
        What ``whirlmap recipes NAME`` takes.
    title : str
        What somebody wants.
    when : str
        What is given, or when this is the way.
    commands : tuple of str
        Lines for a shell, in their order, in one empty folder.
    answer : str
        Where the answer stands: lines and files.
    keys : tuple of str
        Where it stands for programs: keys of the object that ``--json`` prints.
    page : str
        Page of the documentation that explains more.
    long : bool
        Whether it takes more than a few seconds.
    """

    name: str
    title: str
    when: str
    commands: tuple[str, ...]
    answer: str
    keys: tuple[str, ...]
    page: str
    long: bool

    @property
    def text(self) -> str:
        """The recipe in Markdown."""
        lines = "\n".join(f"    {line}" for line in self.commands)
        took = " It takes up to a minute." if self.long else ""
        keys = ", ".join(self.keys)
        return (
            f"### {self.name}: {self.title}\n\n{self.when}{took}\n\n{lines}\n\n{self.answer}\n"
            f"Keys of JSON: {keys}. More: docs/{self.page}\n"
        )


@lru_cache(maxsize=1)
def recipes() -> dict[str, Recipe]:
    """All recipes by name, in the order of the file."""
    tables = tomllib.loads(FILE.read_text(encoding="utf-8"))
    made = {}
    for name, table in tables.items():
        commands, keys = (tuple(table.pop(key)) for key in ("commands", "keys"))
        made[name] = Recipe(name=name, commands=commands, keys=keys, **table)
    return made


def recipe(name: str) -> Recipe:
    """One recipe.

    Raises
    ------
    InputError
        Where there is none of that name.
    """
    known = recipes()
    if name not in known:
        raise InputError(f"recipes: there is no recipe {name!r}, expected one of {', '.join(known)}.{nearest(name, known)}")
    return known[name]
