"""What crossings of surfaces cost and how good they are: the dead zone at several steps per T, against SciPy's events.

    python benchmarks/kinks.py [--points 256]

Processor time per point and T, the shortest of three, and the error after four T. For the cost of stepping over surfaces
instead, run an older version with 256 steps in turns with this one.
"""

import argparse
import time

import numpy as np
from scipy.integrate import solve_ivp

import whirlmap
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.kernels.methods import DOP853

VALUES = {"zeta": 0.05, "F_m": 0.1, "F_ah": 0.2, "Omega": 0.9}


def truth(system: whirlmap.System, end: float) -> np.ndarray:
    """State at ``end``, every contact located by SciPy."""
    zeta, mean, amplitude, omega = (float(system.values[name]) for name in VALUES)

    def rates(time: float, y: np.ndarray, side: int) -> list[float]:
        force = y[0] - side if side else 0.0
        return [y[1], mean + amplitude * omega**2 * np.cos(omega * time) - 2 * zeta * y[1] - force]

    def reaches(place: int, direction: int):
        def event(time: float, y: np.ndarray, side: int) -> float:  # noqa: ARG001
            return float(y[0] - place)

        event.terminal, event.direction = True, direction
        return event

    now, y, side = 0.0, np.array([1.1, 0.0]), 1
    while now < end - 1e-14:
        events = [reaches(1, 1), reaches(-1, -1)] if side == 0 else [reaches(side, -side)]
        s = solve_ivp(rates, (now, end), y, method="DOP853", rtol=1e-13, atol=1e-14, events=events, args=(side,))
        now, y = s.t[-1], s.y[:, -1]
        if s.status == 1:
            side = 0 if side else 1 if s.t_events[0].size else -1
    return y


def main() -> None:
    """Print error and time for each number of steps."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=256)
    points = parser.parse_args().points
    system = whirlmap.load("gear_backlash", **VALUES)
    expected = truth(system, 4 * system.period)
    values = np.repeat(system.vector[:, None], points, axis=1)
    start = np.repeat([[1.1], [0.0]], points, axis=1)
    for steps in (12, 16, 24, 32, 64, 256):
        e = Ensemble(system.model, values, start, orders=system.orders, steps=steps, method=DOP853, workers=1)
        e.advance(4)
        error = np.abs(e.x[:, 0] - expected).max()
        spent = []
        for _ in range(3):
            begin = time.process_time()
            e.advance(20)
            spent.append(time.process_time() - begin)
        print(f"{steps:4d} steps per T: error {error:.1e}, {min(spent) / 20 / points * 1e6:.2f} us per point and T")


if __name__ == "__main__":
    main()
