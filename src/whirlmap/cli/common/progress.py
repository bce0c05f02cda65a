"""Progress of commands: `whirlmap.progress`, with the intervals of its lines."""

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
