"""Floquet multipliers of a periodic orbit, down to the smallest, from the tangent dynamics of the compiled kernel."""

from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.variational.periodic_schur import eigenvalues_of_products
from whirlmap.errors import RangeError
from whirlmap.integrate.scales import scales, unit_sizes
from whirlmap.integrate.system import System
from whirlmap.kernels.methods import DOP853
from whirlmap.kernels.running.lanes import HarmonicTables, LaneKernel, blocked, lane_kernel, unblocked
from whirlmap.kernels.writing.event_location import FINE
from whirlmap.kernels.writing.routine import LANES
from whirlmap.results.findings import Findings, gives_dataset

Array = NDArray[np.float64]

#: Segments of the orbit per T to begin with: within one of them no direction may shrink by more than doubles hold. An
#: orbit of more than `LONG` T begins with one per T, for its T are short beside its motion, and each costs a pass of all
#: frames.
SEGMENTS, LONG = 4, 16
#: Largest change of a logarithm, over the larger of it and one, with which segments are short enough; most doublings.
CLOSE, DOUBLINGS = 1e-9, 6  # of long orbits two more, so that segments are as short in the end
#: Logarithm of a modulus below which a multiplier is zero as a number: no segments are halved for its sake.
VANISHES = float(np.log(np.finfo(float).tiny))
#: Least steps of the eighth-order method per T.
STEPS = 64


@gives_dataset
def floquet_multipliers(
    system: System, x: ArrayLike, duration: float, *, steps: int = STEPS
) -> Findings:
    """Multipliers of small disturbances over one round of a periodic orbit.

    Parameters
    ----------
    system : System
        Whose orbit it is.
    x : array, shape (state,)
        A point of the orbit; of a forced system at phase zero, as its section points are.
    duration : float
        Length of the orbit [model's time]: a whole number of T, or the time between returns of an unforced orbit.
    steps : int
        Steps of DOP853 per T to begin with, rounded up to a whole number in each segment.

    Returns
    -------
    xr.Dataset
        Over ``multiplier``, largest modulus first: ``log_modulus`` and ``log_modulus_error``, ``argument`` [rad],
        ``real`` and ``imaginary``.
        ``trivial``, index of the multiplier of an unforced orbit's own time direction (the one nearest 1; -1 for a
        forced system, which has none), with ``trivial_error`` its distance from 1; ``stable``, whether all others lie
        inside the unit circle; ``closure``, how far the orbit misses its start, over its size (cyclic states apart).

    Raises
    ------
    RangeError
        Shapes, a duration that is not positive (or of a forced system not a whole number of T), or a run that left the
        model's limits.

    Notes
    -----
    The orbit is cut into segments, whose transition matrices come from the kernel, one column in each lane. Their
    product is never formed: its smallest multipliers would drown in the rounding of the largest. Orthonormal frames are
    carried round the orbit (QR) until the subspaces they span return to themselves; the multipliers are the
    eigenvalues of the diagonal blocks, each a product of triangular blocks with its own scale [lust2001]. Each is good to
    rounding relative to itself, as long as no direction shrinks by more than about 1e-12 within one segment. So
    segments, and the steps with them, are doubled until no logarithm of a modulus above `VANISHES` changes by more than
    `CLOSE`; ``log_modulus_error`` is the last change.
    Multipliers of moduli within some percent of each other share a block and are good relative to the largest in it.
    An unstable orbit must be given precisely: an error of its start grows along it.

    References
    ----------
    [lust2001] multipliers from the factors of a product that is never formed.
    [prince1981] DOP853, with which the transition matrices are integrated.
    """
    start = np.asarray(x, dtype=np.float64)
    n = system.model.dimension
    if start.shape != (n,) or not np.isfinite(start).all() or not 0 < duration < np.inf:
        raise RangeError(f"x has shape {start.shape}, duration is {duration}: ({n},) and a positive time are needed.")
    turns = duration / system.period
    if system.model.forced and abs(turns - round(turns)) > 1e-9:
        raise RangeError(f"duration is {turns:g} T: an orbit of a forced system lasts a whole number of T")
    whole = ceil(round(turns, 9))
    segments = 1 if whole > LONG else SEGMENTS
    each, doublings = ceil(steps / segments), DOUBLINGS + (2 if whole > LONG else 0)
    orbit, log_modulus, argument = _round(system, start, duration, segments * whole, each)
    error = np.full(n, np.inf)
    for _ in range(doublings):
        segments *= 2
        orbit, finer, argument = _round(system, start, duration, segments * whole, each)
        with np.errstate(invalid="ignore"):  # multipliers of zero, of a motion that sticks, stay what they are
            found = np.where(finer == log_modulus, 0.0, np.abs(finer - log_modulus))
        stalled = not (found < error).any()
        log_modulus, error = finer, found
        close = found <= CLOSE * np.maximum(1.0, np.abs(finer))
        if stalled or (close | (finer < VANISHES)).all():
            break
    segments *= whole
    value = np.exp(log_modulus + 1j * argument)
    trivial = -1 if system.model.forced else int(np.abs(value - 1).argmin())
    others = np.delete(log_modulus, trivial) if trivial >= 0 else log_modulus
    plain = [s.cyclic is None for s in system.model.states]
    period = np.array([system.period])
    size = scales(system.model, period, np.ptp(orbit, axis=1)[:, None], np.abs(orbit).max(axis=1)[:, None])[plain, 0]
    units = {"units": "1"}
    return Findings(
        {
            "log_modulus": ("multiplier", log_modulus, {**units, "long_name": "logarithm of the multiplier's modulus"}),
            "log_modulus_error": (
                "multiplier", error, {**units, "long_name": "its change with the last doubling of steps and segments"}
            ),
            "argument": ("multiplier", argument, {"units": "rad", "long_name": "argument of the multiplier"}),
            "real": ("multiplier", value.real, {**units, "long_name": "real part of the multiplier"}),
            "imaginary": ("multiplier", value.imag, {**units, "long_name": "imaginary part of the multiplier"}),
            "trivial": ((), trivial, {**units, "long_name": "index of the time direction's multiplier, -1: none"}),
            "trivial_error": (
                (), float(abs(value[trivial] - 1)) if trivial >= 0 else np.nan,
                {**units, "long_name": "its distance from 1"},
            ),
            "stable": ((), np.int8((others < 0).all()), {**units, "long_name": "whether all others shrink"}),
            "closure": (
                (), float(np.max(np.abs(orbit[plain, -1] - orbit[plain, 0]) / size)) if any(plain) else np.nan,
                {**units, "long_name": "distance by which the orbit misses its start, over its size"},
            ),
        },
        attrs={"duration": duration, "segments": segments, "steps_per_segment": each, "algorithm": "lust2001"},
    )  # fmt: skip


def _round(system: System, start: Array, duration: float, segments: int, each: int) -> tuple[Array, Array, Array]:
    """Orbit (state, segment) from a state on, and logarithms of the moduli and arguments of its multipliers, in order."""
    n = start.size
    orbit, matrices = np.empty((n, segments + 1)), np.empty((segments, n, n))
    orbit[:, 0] = start
    run = _Segment.of(system, duration / segments / each, each, round(segments * each * system.period / duration))
    for k in range(segments):
        orbit[:, k + 1], matrices[k] = run.transition(orbit[:, k], k * each)
    # In units of their sizes, for frames that are orthonormal in units that differ by 1e9 are rounding.
    # A state that is zero by chance, or held, has the size of those that it is alike to.
    period, magnitude = np.array([system.period]), np.abs(orbit).max(axis=1)[:, None]
    size = unit_sizes(system.model, period, scales(system.model, period, magnitude, magnitude, share=1.0))[:, 0]
    log_modulus, argument = eigenvalues_of_products((matrices * (size / size[:, None]))[None])
    return orbit, log_modulus[0], argument[0]


@dataclass(frozen=True)
class _Segment:
    """What the run of every segment needs: one lane for each column of its transition matrix."""

    name: str
    kernel: LaneKernel
    harmonic_tables: HarmonicTables
    inputs: dict[str, Any]
    per_T: int
    steps: int

    @classmethod
    def of(cls, system: System, h: float, steps: int, per_T: int) -> "_Segment":
        """Prepare segments of so many steps, of which one T has ``per_T``."""
        n = system.model.dimension
        kernel = lane_kernel(system.plain_model(), DOP853, slopes="along", kind="locked")
        inputs = kernel.inputs(np.repeat(system.vector[:, None], n, axis=1)).blocks(np.arange(n))
        waves = HarmonicTables.of(system.orders or (), np.array([per_T]), kernel.source.nodes)
        inputs |= {name: blocked(rows) for name, rows in waves.rows(np.full(n, per_T)).items()}
        return cls(system.model.name, kernel, waves, {"h": blocked(np.full((1, n), h)), **inputs}, per_T, steps)

    def transition(self, x: Array, begin: int) -> tuple[Array, Array]:
        """End of the run from a state, and its transition matrix; ``begin`` counts steps from phase zero."""
        n, steps = x.size, self.steps
        run = blocked(self.kernel.with_sides(np.concatenate([np.repeat(x[:, None], n, axis=1), np.eye(n)])))
        blocks = run.shape[0]
        first, active, failed, cause, last, never, pieces = (
            np.full((blocks, 1, LANES), value, dtype=np.int64) for value in (0, 1, -1, 0, steps, steps + 1, FINE)
        )
        phases = self.harmonic_tables.begin(np.full(n, self.per_T), np.zeros(n, dtype=np.int64), np.full(n, begin))
        self.kernel.advance(
            blocks=blocks, count=1, y=run, **self.inputs, waves=self.harmonic_tables.table, begin=blocked(phases),
            first=first, last=last, active=active, failed=failed, save_every=never, saves=0, saved=np.zeros(0),
            orth_every=never, events=0, growth=np.zeros(0), folded=0, sums=np.zeros(0), cause=cause,
            reached=np.zeros((blocks, 1, LANES)),
            tally=np.zeros((blocks, 2, LANES)), pieces=pieces, work=self.kernel.work(),
        )  # fmt: skip
        if (failed >= 0).any():
            raise RangeError(f"the orbit of {self.name} leaves the model's limits: it is no periodic orbit")
        end = unblocked(run, n)
        return end[:n, 0], end[n : 2 * n]
