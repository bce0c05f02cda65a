"""Forecast of the remaining time of work on operating points, from the points finished so far.

Points that do not return run far longer than those that do, and which they are is known only once they have settled.
So the two parts of the work are counted apart, in T and in seconds:

1. Points that have not settled yet take as many T to settle as those that have took in the mean, and so many of them will
   not return as of those.
2. A point that does not return runs as long as those that are finished ran in the mean, with `PRIOR` more among them that
   ran half of the longest run: the first to finish are the shortest. One that has run for longer is expected to run for as
   long again, up to the longest run.

The seconds left are those T over the rate of each part; as long as no point without a return has run, its T are taken to
cost `COSTLY` times as much, for it carries a tangent vector, and fewer points share the lanes.
"""

from dataclasses import dataclass, field

#: Cost of a T of a point that does not return over that of a settling one, until it is measured.
COSTLY = 3.0
#: Points without a return that are taken to have run half of the longest run, before any has finished.
PRIOR = 8
#: Part of the T in hand that is taken to be left at least: work that takes longer than expected is not at its end.
LEAST = 0.1


@dataclass
class Part:
    """T and seconds spent on one part of the work."""

    periods: float = 0.0
    seconds: float = 0.0

    @property
    def cost(self) -> float:
        """Seconds for each T; 0 where nothing is known."""
        return self.seconds / self.periods if self.periods else 0.0


@dataclass
class Forecast:
    """What is known of the work on some operating points.

    Attributes
    ----------
    points : int
        Points in all, as far as is known.
    each : float
        T that a point takes to settle at least.
    later : int
        Points of work that comes behind these.
    settled, opened, closed : int
        Points that have settled, those of them that do not return, and those of these that are finished.
    longest : float
        T that a point without a return runs at most.
    """

    points: int
    each: float
    later: int = 0
    settled: int = 0
    opened: int = 0
    closed: int = 0
    longest: float = 0.0
    settling: Part = field(default_factory=Part)
    running: Part = field(default_factory=Part)
    _hand: int = 0  # points that are settling now
    _left: int = 0  # points without a return in hand
    _ran: float = 0.0  # T that each of them has run
    _now: Part = field(default_factory=Part)  # since the part that is being worked on began

    def spend(self, periods: float, seconds: float) -> None:
        """Count T run, and seconds."""
        self._now.periods += periods
        self._now.seconds += seconds

    def come(self, points: int) -> None:
        """So many points begin to settle."""
        self.points = max(self.points, self.settled + points)
        self._hand = points

    def settle(self, points: int, opened: int, longest: float) -> None:
        """So many points have settled, of which some do not return, and will run ``longest`` T at most."""
        self._spent(self.settling)
        self.settled += points
        self.points = max(self.points, self.settled)
        self.opened, self.longest = self.opened + opened, longest
        self._hand, self._left, self._ran = 0, opened, 0.0

    def run(self, left: int, ran: float) -> None:
        """Of the points without a return in hand so many are left, and have run so many T."""
        self._left, self._ran = left, ran

    def close(self, points: int) -> None:
        """The points without a return in hand, so many, are finished."""
        self._spent(self.running)
        self.closed, self._left = self.closed + points, 0

    def _spent(self, part: Part) -> None:
        part.periods, part.seconds = part.periods + self._now.periods, part.seconds + self._now.seconds
        self._now = Part()

    def seconds_left(self) -> float | None:
        """Seconds that are left; None where nothing is known."""
        settling, running = self.settling, self.running
        if self._left:
            running = Part(running.periods + self._now.periods, running.seconds + self._now.seconds)
        else:
            settling = Part(settling.periods + self._now.periods, settling.seconds + self._now.seconds)
        if not settling.seconds:
            return None
        cost = running.cost or COSTLY * settling.cost
        to_come = self.points - self.settled + self.later
        each = self.settling.periods / self.settled if self.settled else self.each
        in_hand = 0 if self._left else min(self._hand or to_come, to_come)
        if in_hand:  # those behind take as long as these have taken already, if that is longer than expected
            each = max(each, self._now.periods / in_hand)
        left = to_come * each
        if in_hand:
            left -= min(self._now.periods, (1 - LEAST) * in_hand * each)
        run = (self.running.periods + PRIOR * self.longest / 2) / (self.closed + PRIOR)
        open_left = to_come * (self.opened / self.settled if self.settled else 0.0) * run
        if self._left:
            more = run - self._ran if self._ran < run else min(self._ran, self.longest - self._ran)
            open_left += self._left * max(more, LEAST * run)
        return left * settling.cost + open_left * cost
