"""Stationarity of a record: level, frequency and mean of its parts, compared with their scatter."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.signals.line_fit import line_amplitudes

Array = NDArray[np.float64]

#: Blocks into which a record is cut at most, and swings that one holds at least.
BLOCKS, SWINGS = 60, 2
#: Wald statistic from which a change is no chance: of a motion whose level differs little from block to block, and of one
#: that scatters or has half of the blocks only; scatter of the logarithm between neighbouring blocks that tells them apart.
CLEAN, SCATTERED, SCATTER = 30.0, 60.0, 0.15
#: Ratio of the rms of two thirds that counts as a change, and that no beat of two equal lines makes; change of the mean
#: frequency in units of the record's frequency step, and relative; spread of the means of the thirds over the rms of the
#: motion.
LEVEL, BURST, STEPS, FREQUENCY, MEAN = 1.1, 3.5, 3.0, 2e-3, 0.25
#: Parts in which the phase of the strongest line is followed, scatter of its amplitude up to which it has one, and
#: departure of the phase from a straight line that counts [rad].
PARTS, AMPLITUDE, PHASE = 12, 0.1, 0.25
#: Frequency steps around the strongest line in which no other may lie where its phase is followed.
APART = 24
#: Frequency steps between lines whose amplitudes can be told apart in a third of the record.
TOLD_APART = 6
#: Share of the power of a line whose amplitude must be the same in all thirds, and factor by which it may change.
STRONG, EXCHANGED = 0.02, 1.15
#: Share of the power of a line whose period a block must hold; shares outside of lines up to which lines are checked in this
#: way.
SEEN, FEW, NONE_ELSE = 5e-3, 0.1, 0.01


@dataclass(frozen=True)
class Steadiness:
    """How the three thirds of a record differ.

    Attributes
    ----------
    rms, frequency, mean : array, shape (3,)
        About the mean of each block; cycles per sample, of the strongest line where that is followed, else root mean square
        over the spectrum; and the mean.
    changes : tuple of str
        What changes beyond chance: ``level``, ``frequency``, ``mean``; empty for a steady record.
    statistics : dict
        Statistic of each.
    followed : bool
        Whether the frequency is that of the strongest line.
    """

    rms: Array
    frequency: Array
    mean: Array
    changes: tuple[str, ...]
    statistics: dict[str, float]
    followed: bool


def steadiness(x: Array, swing: float, lines: Array, share: Array, broad: float) -> Steadiness:
    """Compare level, frequency and mean of the thirds of a record with their scatter within.

    Parameters
    ----------
    x : array, shape (time,)
        Finite.
    swing : float
        Samples per swing.
    lines, share : array, shape (line,)
        Frequencies of its lines, cycles per sample, the strongest first, and their shares of the power.
    broad : float
        Share of the power outside of lines.

    Notes
    -----
    1. The record is cut into 60 blocks, of two swings and one and a half periods of the slowest line at least. The
       logarithm of their rms, the logarithm of their mean frequency (rms of differences over rms) and their mean are three
       series whose mean may change once (`trend_statistic`). A change counts where it is beyond chance and the thirds
       differ by an amount that matters: a factor of 1.1 in rms, three frequency steps of the record, a quarter of the rms
       in the mean. A factor of 3.5 counts whatever the statistic says: a burst in the middle comes and goes.
    2. Where lines hold nearly all of the power, their amplitudes are fitted to each third, and the sum of their squares is
       held to the same factor of 1.1: growth of a motion whose slow lines leave few blocks.
    3. The phase of the strongest line, where no other is near, is followed over twelve parts. Where it has one amplitude,
       but its phase leaves the straight line by 0.25 rad, the frequency moves: a chirp too slow to be seen in blocks.
    """
    slow = lines[(share > SEEN) & (broad < FEW)]
    length = max(SWINGS * swing, 1.5 / float(slow.min()) if slow.size else 0.0, 16)
    count = int(min(BLOCKS, x.size // length))
    count = max(count - count % 3, 9)
    blocks = x[: x.size // count * count].reshape(count, -1)
    mean, power = blocks.mean(axis=1), blocks.var(axis=1)
    if power.max() > power.sum() / 2 and count > BLOCKS // 3:  # one event, such as a wrong value, is no change of the motion
        event = int(power.argmax())
        power[event], mean[event] = np.median(power), np.median(mean)
    whole = float(power.mean()) or 1.0
    known = power > 1e-6 * whole
    fast = (np.diff(blocks, axis=1) ** 2).mean(axis=1)  # of a sine: 4 power sin(pi f)^2
    sine = np.clip(np.divide(fast, 4 * power, out=np.zeros(count), where=known), 1e-12, 1.0)
    level = np.log(np.maximum(power, 1e-6 * whole)) / 2
    weight = np.where(known, power, 0.0)
    squares = _thirds(weight * sine) / np.maximum(_thirds(weight), 1e-300)
    frequency = np.arcsin(np.sqrt(squares)) / np.pi
    rms, means = np.sqrt(_thirds(power)), _thirds(mean)
    statistics = {
        "level": trend_statistic(level),
        "frequency": trend_statistic(np.log(sine)[known]) if known.sum() >= 9 else 0.0,
        "mean": trend_statistic(mean),
    }
    critical = CLEAN if float(np.median(np.abs(np.diff(level)))) < SCATTER and count > BLOCKS // 2 else SCATTERED
    changes, followed = [], False
    ratio = float(rms.max()) / max(float(rms.min()), 1e-300)
    if (statistics["level"] > critical and ratio > LEVEL) or ratio > BURST:
        changes.append("level")
    moves = statistics["frequency"] > critical and float(np.ptp(frequency)) > max(
        STEPS / x.size, FREQUENCY * float(frequency.mean())
    )
    if lines.size and broad < NONE_ELSE and (np.diff(np.sort(lines)) * x.size > TOLD_APART).all():
        amplitudes = _amplitudes(x, lines)
        sizes = np.sqrt((amplitudes**2).sum(axis=1))
        if not changes and sizes.max() > LEVEL * sizes.min():
            rms = sizes / np.sqrt(2)
            changes.append("level")
        strong = amplitudes[:, share > STRONG]  # their frequency moves only where one gains on another
        moves = moves and bool((strong.max(axis=0) > EXCHANGED * strong.min(axis=0)).any())
    if moves:
        changes.append("frequency")
    elif _alone(lines, x.size) and "level" not in changes and (moved := _followed(x, float(lines[0]))) is not None:
        frequency, followed = moved, True
        changes.append("frequency")
    if statistics["mean"] > critical and float(np.ptp(means)) > MEAN * np.sqrt(whole):
        changes.append("mean")
    return Steadiness(rms, frequency, means, tuple(changes), statistics, followed)


def _thirds(values: Array) -> Array:
    return np.asarray(values.reshape(3, -1).mean(axis=1))


def _alone(lines: Array, n: int) -> bool:
    """Whether no other line lies so near to the strongest that both are one in a twelfth of the record."""
    return lines.size > 0 and bool((np.abs(lines[1:] - lines[0]) * n > APART).all())


def _amplitudes(x: Array, lines: Array) -> Array:
    """Amplitudes of the lines in each third, shape (3, line)."""
    length = x.size // 3
    parts = [x[k * length : (k + 1) * length] for k in range(3)]
    return np.array([np.abs(line_amplitudes(part, lines * length)) for part in parts])


def _followed(x: Array, frequency: float) -> Array | None:
    """Frequency of a line in each third, where its phase says that it moves; else None."""
    length = x.size // PARTS
    k = np.arange(PARTS * length)
    turned = (x[: k.size] - x.mean()) * np.exp(-2j * np.pi * ((frequency * k) % 1.0))
    parts = turned.reshape(PARTS, length) @ np.hanning(length)
    size = np.abs(parts)
    if not size.min() > 0 or size.std() > AMPLITUDE * size.mean():
        return None
    phase = np.unwrap(np.angle(parts))
    at = np.arange(PARTS) - (PARTS - 1) / 2
    rest = phase - phase.mean() - at * float(at @ phase) / float(at @ at)
    if float(np.sqrt((rest**2).mean())) < PHASE:
        return None
    slopes = np.array([np.polyfit(at[p], phase[p], 1)[0] for p in (slice(0, 4), slice(4, 8), slice(8, 12))])
    return np.asarray(frequency + slopes / (2 * np.pi * length))


def trend_statistic(series: Array, lags: int = 4, least: int = 4) -> float:
    """Largest Wald statistic for one change of the mean [andrews1993].

    The squared difference of the means before and after, over its variance, at the place where it is largest; the long-run
    variance, with Bartlett weights, is that of what is left when both means are taken off, so that a change does not hide
    itself.
    """
    size = float(np.abs(series).max())
    if size == 0 or np.ptp(series) <= 1e-9 * size:
        return 0.0
    e = (series - series.mean()) / np.ptp(series)
    n = e.size
    at = np.arange(least, n - least + 1)
    sums = np.cumsum(e)[at - 1]
    apart = (sums / at + sums / (n - at)) ** 2 * (at * (n - at) / n)  # the whole sums to zero
    after = np.arange(n) >= at[:, None]
    rest = e - np.where(after, (-sums / (n - at))[:, None], (sums / at)[:, None])
    variance = (rest**2).mean(axis=1)
    long_run = variance.copy()
    for k in range(1, lags + 1):
        long_run += 2 * (1 - k / (lags + 1)) * (rest[:, k:] * rest[:, :-k]).sum(axis=1) / n
    return float((apart / np.maximum(long_run, np.maximum(0.2 * variance, 1e-6))).max())
