"""The pictures of commands, imported when the first is drawn: matplotlib takes longer than many a command."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from whirlmap.cli.common.figures_of_commands import *  # noqa: F403


def __getattr__(name: str) -> Any:
    """Import a picture from its home."""
    if name.startswith("_"):
        raise AttributeError(name)
    return getattr(import_module("whirlmap.cli.common.figures_of_commands"), name)
