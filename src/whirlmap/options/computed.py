"""What is computed: options that decide numbers, and so belong to provenance, to manifests and to what a store is."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from whirlmap.errors import RangeError
from whirlmap.options.refused import refuse_count, refuse_method, refuse_number, refuse_steps

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

#: Blocks of an exponent's run whose means give its error: fewer T give none.
BLOCKS = 16
#: T, and common periods, over which the exponent of a point that does not return is measured at most, the longer of both.
LONGEST, LONGEST_COMMON = 16384, 1024


@dataclass(frozen=True)
class Settling:
    """How long to wait and how sure to be.

    Attributes
    ----------
    transient : int
        Common periods that a point which does not return runs before its longest window begins. Points that return
        earlier stop there.
    first_window : int
        Common periods of the first window; a return is sought up to half of it.
    most : int
        Largest return that is sought, in common periods.
    keep : int
        Least number of T that are recorded once settled (`record_length.record_periods`).
    tolerance : float
        Largest difference that counts as a return, relative to the range of each state.
    accelerate : bool
        Whether slow approaches may be accelerated (`acceleration`).

    Raises
    ------
    RangeError
        A count or a tolerance that makes no sense.
    """

    transient: int = 100
    first_window: int = 8
    most: int = 64
    keep: int = 64
    tolerance: float = 1e-6
    accelerate: bool = True

    def __post_init__(self) -> None:
        """Refuse counts that make no sense, naming the one."""
        for name, least in (("transient", 0), ("first_window", 2), ("most", 1), ("keep", 1)):
            refuse_count(name, getattr(self, name), least, 10_000_000)
        refuse_number("tolerance", self.tolerance, 0, 1)

    @property
    def longest(self) -> int:
        """Common periods after which a point is given up."""
        return self.transient + max(2 * self.most, self.first_window)


@dataclass(frozen=True)
class Integration:
    """The steps that a motion is integrated with.

    Attributes
    ----------
    method : str, optional
        ``dop853``, ``tsit5`` or ``rk4``; ``dop853`` where absent.
    steps : int, or array of int of shape (point,), optional
        Steps per T. Where absent, each point gets those that the accuracy asks for.
    accuracy : float, optional
        Largest error over one common period, of an unforced model over one typical time, that the steps are chosen for;
        where absent 1e-6, of an unforced model 1e-9. 1e-13 or more, which is what rounding allows.

    Raises
    ------
    RangeError
        A method that there is not; steps or an accuracy that make no sense, or both.
    """

    method: str | None = None
    steps: "int | NDArray[np.int64] | None" = None
    accuracy: float | None = None

    def __post_init__(self) -> None:
        """Refuse what cannot be integrated with, and two answers to one question."""
        if self.method is not None:
            refuse_method(self.method)
        if self.steps is not None:
            refuse_steps(self.steps)
        if self.accuracy is not None:
            refuse_number("accuracy", self.accuracy, 1e-13, 1)
        if self.steps is not None and self.accuracy is not None:
            raise RangeError("give steps per T or an accuracy, not both")


@dataclass(frozen=True)
class Labelling:
    """How operating points are measured and labelled.

    Attributes
    ----------
    settling : Settling
        Transient, windows and tolerance.
    lyapunov : int, optional
        T over which points that do not return have their largest exponent measured and their section recorded, at most:
        each stops when it has a label and the error of its exponent is small enough (`nonperiodic_points.ENOUGH`). Less than
        256 leave them undecided, 0 measures nothing. Where absent: as long as labels may need (`LONGEST`).
    integration : Integration
        Method, and steps or accuracy.

    Raises
    ------
    RangeError
        Fewer T than give an exponent's error, or parts of another kind.
    """

    settling: Settling = field(default_factory=Settling)
    lyapunov: int | None = None
    integration: Integration = field(default_factory=Integration)

    def __post_init__(self) -> None:
        """Refuse a length of the exponent's run that gives no error, and parts of another kind."""
        if not (isinstance(self.settling, Settling) and isinstance(self.integration, Integration)):
            raise RangeError(
                f"found {self.settling!r} and {self.integration!r} in labelling, expected Settling(...) and Integration(...)"
            )
        if self.lyapunov is not None:
            refuse_count("lyapunov", self.lyapunov, 0, 10_000_000)
        if self.lyapunov and self.lyapunov < BLOCKS:
            raise RangeError(f"lyapunov must be 0, or from {BLOCKS} to 10000000 T, not {self.lyapunov}")

    def longest(self, strobe: int) -> int:
        """T over which exponents are measured at most, with this many T between section points that show returns."""
        return max(LONGEST, LONGEST_COMMON * strobe) if self.lyapunov is None else self.lyapunov


#: What holds where nothing is said, in Python and on the command line alike.
LABELLING, INTEGRATION = Labelling(), Integration()
