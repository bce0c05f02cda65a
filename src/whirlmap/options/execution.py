"""How work is run: options that change no number."""

from dataclasses import dataclass
from typing import Any

from whirlmap.errors import RangeError
from whirlmap.options.refused import refuse_count


@dataclass(frozen=True)
class Execution:
    """How work is run. No number depends on it, by a bit.

    Attributes
    ----------
    workers : int, optional
        Threads; all cores where absent.
    progress : callable or True, optional
        Called with the number of points x periods T done since the last call, of a map with the number of points; True shows
        a bar.
    cluster : str, dask cluster or client, optional
        Where a map is computed: the address of a Dask scheduler, or an object; threads of this process where absent.

    Raises
    ------
    RangeError
        A number of workers that makes no sense, or workers beside a cluster; a progress that cannot be told.
    """

    workers: int | None = None
    progress: Any = None
    cluster: Any = None

    def __post_init__(self) -> None:
        """Refuse no workers, and threads beside a cluster; ``progress=False`` is none."""
        if self.workers is not None:
            refuse_count("workers", self.workers, 1, 4096)
        if self.cluster is not None and self.workers is not None:
            raise RangeError("workers are threads of this process, and a cluster has its own: give one of them")
        if not (self.progress is None or isinstance(self.progress, bool) or callable(self.progress)):
            raise RangeError(f"progress must be True, False or a callable, not {self.progress!r}")
        if self.progress is False:
            object.__setattr__(self, "progress", None)


#: What holds where nothing is said: all cores, in silence.
EXECUTION = Execution()
