"""Many operating points of one model, integrated together in lanes with steps locked to the forcing's phase.

A lane never sees its neighbours: its numbers depend on its own parameters, start and steps alone, whatever block it is
in and however many threads run.
"""

from collections.abc import Callable
from fractions import Fraction
from math import ceil
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.errors import RangeError, counted
from whirlmap.integrate.division import SHORT, cores, tasks_of, variants
from whirlmap.integrate.group import Group, Record
from whirlmap.integrate.harmonics import common_multiple, periods, strobe
from whirlmap.integrate.scales import limits, tangent_sizes
from whirlmap.integrate.segment import Segment, statistics
from whirlmap.integrate.workers import Workers
from whirlmap.kernels.methods import RK4, Method
from whirlmap.kernels.running.lanes import UNKNOWN
from whirlmap.kernels.writing.routine import LANES
from whirlmap.results.status import Status

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


#: Longest common period, in T, that a run on a rung takes; where it is longer, it takes one turn of the slowest harmonic,
#: but at least `RUNG` of them.
LONG_RUNG, RUNG = 1000, 128

#: Comparing an array with a member of an enumeration takes five times as long.
OK = np.int8(Status.ok)

#: Arrays over points that a subset carries along.
_POINT_ARRAYS = ("status", "end_time", "end_stop", "turns", "ahead", "step_error", "step_verdict", "crossings", "grazings")


class Ensemble:
    """Points of one model, each at a whole number of T after phase zero, or so many steps ahead of that.

    Parameters
    ----------
    model : Model
    values : array, shape (parameter, point)
    x : array, shape (state, point)
        Start states, at phase zero.
    orders : tuple of Fraction
        Orders of the harmonics over the fastest.
    steps : int or array of int, shape (point,)
        Steps per T; one number for all points, or one for each.
    method : Method
    tangents : int
        Tangent vectors carried along, started from a fixed random set, orthonormal in units of ``sizes``.
    orthonormal : bool
        Whether the tangent vectors are orthonormalised. Where not, they start from the first unit vectors.
    orth : int or array of int, shape (point,)
        Orthonormalisations per T, of which the steps are a multiple; more than one where the vectors' growths in one T
        differ by more than doubles hold (`analysis.variational.tangent_accuracy`).
    workers : int, optional
        Threads; all cores where absent. The numbers do not depend on it.
    redo : bool
        Whether steps that failed are redone with shorter ones. Where not, a point ends at its first failed step, as
        unresolved unless the step plainly ended behind a stop: enough for a run on a rung.
    accuracy : float, optional
        What the steps were chosen for (`choose_steps`); absent where they were given.
    beyond : array, shape (state, point), optional
        Sizes beyond which states have diverged; those of the start where absent (`scales.limits`).
    turn : array, shape (point,), optional
        T of each point of an unforced model, in place of its typical time.
    ahead : array of int, shape (point,), optional
        Steps that each point stands ahead of phase zero: the segments of an orbit begin at phases of their own.
    sizes : array, shape (state, point), optional
        Sizes of the states, in which lengths of tangent vectors are measured: with speeds in nanometres per second beside
        lengths in metres, vectors would turn out parallel. Those of the start where absent (`scales.tangent_sizes`).

    Attributes
    ----------
    x : array, shape (state, point)
        State at the present step, or the last good one of a point that has ended.
    status : array of int, shape (point,)
        `Status` of each point.
    end_time : array, shape (point,)
        When a point ended (NaN while it runs), in the model's time.
    end_stop : array of int, shape (point,)
        Which of the model's stops ended it, or behind them which pole of its equations (`step_retry.end_named`); else -1.
    turns, ahead : array of int, shape (point,)
        Periods T that each point has run, and steps that it stands ahead of them.
    point_steps, point_orth : arrays of int, shape (point,)
        Steps, and orthonormalisations, per T of each point.
    limits : array, shape (state, point)
        Sizes beyond which states have diverged.
    step_error, step_verdict : arrays, shape (point,)
        Measured error of these steps, or of the fewer that would do once settled, and whether it meets the accuracy; NaN
        and zero where the steps were given.
    crossings, grazings : arrays, shape (point,)
        Crossings of surfaces at which the rates have a kink or a jump, and those of them that were grazing.
    """

    def __init__(
        self,
        model: Model,
        values: Array,
        x: Array,
        *,
        orders: tuple[Fraction, ...],
        steps: int | Integers,
        method: Method = RK4,
        tangents: int = 0,
        orthonormal: bool = True,
        orth: int | Integers = 1,
        workers: int | None = None,
        redo: bool = True,
        accuracy: float | None = None,
        beyond: Array | None = None,
        turn: Array | None = None,
        sizes: Array | None = None,
        ahead: Integers | None = None,
    ) -> None:
        n = values.shape[1]
        if np.min(steps, initial=1) < 1:
            raise RangeError(f"steps per T must be at least 1, not {np.min(steps)}")
        if x.shape != (model.dimension, n):
            raise RangeError(f"start states have shape {x.shape}, expected {(model.dimension, n)}")
        self.model, self.method, self.redo, self.accuracy = model, method, redo, accuracy
        self.tangents, self.orthonormal = tangents, orthonormal
        self.point_steps = np.broadcast_to(np.asarray(steps, dtype=np.int64), (n,)).copy()
        self.point_orth = np.broadcast_to(np.asarray(orth, dtype=np.int64), (n,)).copy()
        if (self.point_steps % self.point_orth).any():
            raise RangeError("steps per T must be a multiple of the orthonormalisations per T")
        self.orders, self.workers = orders, workers or cores()
        self.points = n
        self.period = periods(model, values) if turn is None else np.array(turn, dtype=float)
        self.values, self.limits = values, limits(model, self.period, x) if beyond is None else beyond
        self.sizes = (tangent_sizes(model, self.period, x) if tangents else np.ones_like(x)) if sizes is None else sizes
        self.status = np.zeros(n, dtype=np.int8)
        self.end_time = np.full(n, np.nan)
        self.end_stop = np.full(n, -1, dtype=np.int8)
        self.turns = np.zeros(n, dtype=np.int64)
        self.ahead = np.zeros(n, dtype=np.int64) if ahead is None else np.array(ahead, dtype=np.int64)
        self.step_error, self.step_verdict = np.full(n, np.nan), np.zeros(n, dtype=np.int8)
        self.crossings, self.grazings = np.zeros(n), np.zeros(n)
        self._groups: list[Group] = []
        self._group()
        sides = np.full((max((g.kernel.source.sizes.surfaces for g in self._groups), default=0), n), UNKNOWN)
        self._y = np.concatenate([x, _tangent_start(self.sizes, tangents, orthonormal), sides])

    def _group(self) -> None:
        """Group the points by kernel and orthonormalisations per T."""
        self._groups = [
            Group(self, m, members[self.point_orth[members] == orth], int(orth))
            for m, members in variants(self.model, self.values)
            for orth in np.unique(self.point_orth[members])
        ]

    @property
    def x(self) -> Array:
        """Present states, shape (state, point)."""
        return self._y[: self.model.dimension]

    @property
    def vectors(self) -> Array:
        """Present tangent vectors, shape (vector, state, point)."""
        n = self.model.dimension
        return self._y[n : n * (1 + self.tangents)].reshape(self.tangents, n, self.points)

    def put(self, points: NDArray[np.intp], x: Array) -> None:
        """Put points at other states, shape (state, point), without tangent vectors."""
        n = self.model.dimension
        self._y[:n, points] = x
        self._y[n * (1 + self.tangents) :, points] = UNKNOWN

    @property
    def steps(self) -> int:
        """Steps per T, where all points take the same; else `RangeError`."""
        counts = np.unique(self.point_steps)
        if counts.size != 1:
            raise RangeError(f"points take different steps per T, from {counts[0]} to {counts[-1]}")
        return int(counts[0])

    @property
    def running(self) -> NDArray[np.bool_]:
        """Which points have not ended."""
        return self.status == OK

    @property
    def sliding(self) -> NDArray[np.bool_]:
        """Which points slide on a surface at which their rates jump."""
        return np.asarray((self._y[self.model.dimension * (1 + self.tangents) :] == 0).any(axis=0))

    @property
    def common_multiple(self) -> int:
        """Number of T in the common period."""
        return common_multiple(self.orders)

    @property
    def strobe(self) -> int:
        """Number of T between section points that show returns: the common period, or one T where that is too long."""
        return strobe(self.orders)

    @property
    def returns(self) -> bool:
        """Whether a return can be seen: the forcing itself repeats within a reasonable time, or there is none."""
        return self.strobe == self.common_multiple

    @property
    def rung_periods(self) -> int:
        """Number of T that a run on a rung takes: the common period, where that is not too long."""
        if self.common_multiple <= LONG_RUNG:
            return self.common_multiple
        slowest = max(ceil(1 / abs(order)) for order in self.orders if order)
        return min(max(slowest, RUNG), LONG_RUNG)

    def limit(self, limits: Array) -> None:
        """Set the sizes beyond which states have diverged, shape (state, point)."""
        self.limits = limits
        self._group()

    def subset(
        self, members: NDArray[np.intp], *, steps: int | Integers | None = None, orth: int | Integers | None = None,
        plain: bool = False,
    ) -> "Ensemble":  # fmt: skip
        """Return an ensemble of some of the points, at their present states; `absorb` takes it back.

        ``steps`` gives it other steps per T, ``orth`` other orthonormalisations; a ``plain`` one has no tangent vectors.
        """
        part = Ensemble(
            self.model, self.values[:, members], self.x[:, members], orders=self.orders,
            steps=self.point_steps[members] if steps is None else steps, method=self.method,
            tangents=0 if plain else self.tangents, orthonormal=self.orthonormal,
            orth=self.point_orth[members] if orth is None else orth, workers=self.workers, redo=self.redo,
            accuracy=self.accuracy, beyond=self.limits[:, members], turn=self.period[members],
            sizes=self.sizes[:, members],
        )  # fmt: skip
        if not (plain and self.tangents):
            part._y = self._y[: part._y.shape[0], members].copy()
        for name in _POINT_ARRAYS:
            setattr(part, name, getattr(self, name)[members].copy())
        return part

    def copy_states(self, other: "Ensemble") -> None:
        """Take the states and tangent vectors of an ensemble of the same points, at the same phase."""
        self._y[:] = other._y

    def absorb(self, part: "Ensemble", members: NDArray[np.intp]) -> None:
        """Take over the states of a subset that has run on, by whole common periods, and its steps."""
        self._y[: part._y.shape[0], members] = part._y
        for name in _POINT_ARRAYS:
            getattr(self, name)[members] = getattr(part, name)
        old, new = (np.stack([e.point_steps[at], e.period[at]]) for e, at in ((self, members), (part, slice(None))))
        if not np.array_equal(old, new):
            self.point_steps[members], self.period[members] = part.point_steps, part.period
            self._group()

    def advance(
        self,
        n_periods: int | Integers,
        *,
        members: NDArray[np.intp] | None = None,
        parts: int | Integers = 1,
        save_every: int = 0,
        save_periods: int | Fraction = 0,
        extremes: bool | Literal["between"] = False,
        progress: Callable[[int], None] | None = None,
    ) -> Segment:
        """Run points for some T; those that run are packed into full blocks, wherever they stand.

        Parameters
        ----------
        n_periods : int or array of int, shape (member,)
            T that they run: one number for all, or one for each.
        parts : int or array of int, shape (member,)
            Parts into which these T are divided, of which each point runs one: a whole number of its steps.
        members : array of int, optional
            Indices of the points; all of them where absent.
        save_every : int
            Steps between saved states, where all points take the same steps; zero saves none.
        save_periods : int or Fraction
            T between saved states, instead; a whole number of steps of every point.
        extremes : bool or "between"
            Whether to track extremes, mean and rms of every state and output over the ends of all steps; or extremes
            between them too, by cubic Hermite interpolation from values and rates. It misses a cosine's peak by
            (2 pi/N)^4/384 of it, N the steps in its period.
        progress : callable, optional
            Called with the number of points x periods done since the last call.

        Returns
        -------
        Segment
            Of the members, in their order, as long as the longest run: rows beyond a shorter one are NaN, of growths zero.
        """
        members = np.arange(self.points) if members is None else members
        periods = np.broadcast_to(np.asarray(n_periods, dtype=np.int64), members.shape)
        longest = int(periods.max(initial=0)) if np.ndim(n_periods) else int(n_periods)
        if save_every and save_periods:
            raise RangeError("save_every and save_periods exclude each other")
        save = save_periods if save_periods else Fraction(save_every, self.steps) if save_every else Fraction(0)
        if isinstance(save, Fraction) and any((save * int(n)) % 1 for n in np.unique(self.point_steps[members])):
            raise RangeError(f"states every {save} T are not a whole number of steps apart")
        rows = self.model.dimension + len(self.model.outputs)
        segment = Record(
            saved=np.full((int(longest // save) if save else 0, self.model.dimension, members.size), np.nan),
            growth=np.zeros((longest if self.tangents and self.orthonormal else 0, self.tangents, members.size)),
            sums=np.zeros((5, rows if extremes else 0, members.size)),
        )
        place = np.full(self.points, -1, dtype=np.intp)
        place[members] = np.arange(members.size)
        running = self.running
        to_do = np.zeros(self.points, dtype=np.int64)  # steps
        to_do[members] = periods * self.point_steps[members] // parts
        if (to_do[members] * parts != periods * self.point_steps[members]).any():
            raise RangeError("a part of the periods to run is no whole number of steps")
        tasks = [
            (group, local)
            for group in self._groups
            for local in tasks_of(
                np.flatnonzero((place[group.members] >= 0) & running[group.members]), to_do[group.members], self.workers
            )
        ]

        def work(task: tuple[Group, NDArray[np.intp]]) -> None:
            group, local = task
            own = to_do[group.members[local]]
            group.advance(local, own, save, segment, place, between=extremes == "between", progress=progress)

        work_in_all = sum(int(to_do[group.members[local]].sum()) // LANES for group, local in tasks)
        if self.workers == 1 or len(tasks) == 1 or work_in_all < SHORT:
            for task in tasks:
                work(task)
        else:
            with Workers(self.workers) as pool:
                for _ in pool.map(work, tasks):
                    pass
        still = self.running[members]
        done = self.ahead[members[still]] + to_do[members[still]]
        whole, self.ahead[members[still]] = np.divmod(done, self.point_steps[members[still]])
        self.turns[members[still]] += whole
        told = statistics(segment.sums, to_do[members], still) if extremes else None
        return Segment(segment.saved, segment.growth, told)


def _tangent_start(sizes: Array, count: int, random: bool) -> Array:
    """Tangent vectors: the same random set, orthonormal in units of ``sizes``, or the same unit vectors for every point."""
    n, points = sizes.shape
    if count == 0:
        return np.zeros((0, points))
    if count > n:
        raise RangeError(f"{counted(count, 'tangent vector')} in {counted(n, 'dimension')}")
    if not random:
        return np.repeat(np.eye(n, count).T.reshape(n * count, 1), points, axis=1)
    q = np.linalg.qr(np.random.default_rng(20240101).normal(size=(n, count)))[0]
    return np.asarray(q.T[:, :, None] * sizes).reshape(n * count, points)
