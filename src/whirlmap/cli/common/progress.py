"""Progress of commands: `whirlmap.progress`, whose lines come as often as is said here."""

from whirlmap import progress
from whirlmap.progress import clock as clock

#: Seconds between lines where standard error is no terminal.
EVERY = progress.EVERY


class Progress(progress.Progress):
    """Progress of a command."""

    @property
    def every(self) -> float:
        """Seconds between lines."""
        return EVERY
