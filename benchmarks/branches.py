"""A branch of the 20-state gear pair with all its multipliers, against Newton's method over SciPy's ``solve_ivp``.

Both find the same periodic orbits to 1e-10. SciPy integrates state and tangent vectors together, with the compiled rates and
Jacobian of whirlmap, for each Newton iteration at each of a few speeds; whirlmap follows the whole branch. Printed: seconds
for each point, and their ratio.

    python benchmarks/branches.py [POINTS]
"""

import sys
import time

import numpy as np
from scipy.integrate import solve_ivp

import whirlmap

CASE, RANGE, CLOSED = "gear-psfd/reference", (3.0, 3.3), 1e-9


def by_scipy(system, x):
    """Newton's method on the stroboscopic map, its derivative from the variational equations; orbit and multipliers."""
    n, end = x.size, system.common_period

    def rates(t, y):
        state, vectors = y[:n], y[n:].reshape(n, n)
        return np.concatenate([system.rhs(t, state), (system.jacobian(t, state) @ vectors).ravel()])

    for _ in range(10):
        start = np.concatenate([x, np.eye(n).ravel()])
        last = solve_ivp(rates, (0, end), start, method="DOP853", rtol=1e-10, atol=1e-13).y[:, -1]
        matrix, miss = last[n:].reshape(n, n), last[:n] - x
        if np.abs(miss).max() < CLOSED:
            break
        x = x + np.linalg.solve(np.eye(n) - matrix, miss)
    return x, np.linalg.eigvals(matrix)


def main():
    """Print the comparison."""
    points = int(sys.argv[1]) if len(sys.argv) > 1 else 2
    system = whirlmap.load(CASE)
    whirlmap.continue_orbit(system, "s", (RANGE[0], RANGE[0] + 1e-3))  # compile
    begun = time.perf_counter()
    branch = whirlmap.continue_orbit(system, "s", RANGE, longest=(RANGE[1] - RANGE[0]) / 60)
    ours = (time.perf_counter() - begun) / branch.sizes["point"]
    at = np.linspace(1, branch.sizes["point"] - 1, points).astype(int)
    begun = time.perf_counter()
    apart = 0.0
    for k in at:
        x, multipliers = by_scipy(system.replace(s=float(branch["s"].values[k])), branch["section"].values[k - 1, 0])
        apart = max(apart, np.abs(x - branch["section"].values[k, 0]).max())
        largest = np.abs(multipliers).max() - np.exp(branch["log_modulus"].values[k, 0])
        apart = max(apart, abs(largest))
    theirs = (time.perf_counter() - begun) / points
    print(f"whirlmap: {branch.sizes['point']} points, {ours:.3g} s each, settling included")
    print(f"SciPy: {points} points, {theirs:.3g} s each; orbits and largest multipliers within {apart:.1g}")
    print(f"ratio: {theirs / ours:.3g}")


if __name__ == "__main__":
    main()
