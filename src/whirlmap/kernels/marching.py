"""Source of the kernel modules in which every lane has its own time: single evaluations and short runs.

Like `stepping.py` this file is never imported, only copied behind the generated part. It serves what the phase-locked
kernel cannot: the right-hand side at a given time, shorter steps where a step failed, and the bracketing of events.
"""
# ruff: noqa: F821
# mypy: ignore-errors


@kernel
def march(y, time, h, p, tables, offsets, steps, good):
    """Take ``steps`` steps of ``h`` from ``time``, in place; ``good`` says which lanes ended every step at open gaps.

    ``h`` has N * L entries: that of each lane, repeated for every row.
    """
    rows = y.size // L
    count = rows // N - 1
    x, z = np.empty(rows * L), np.empty(N * L)
    k = np.empty(STAGES * N * L)
    jac = np.empty(STAGES * ENTRIES * L)
    c = np.empty((2 * H + 1) * L)
    scratch = np.zeros(SCRATCH * L)
    flag = np.empty(L, dtype=np.int64)
    for l in range(L):
        good[l] = 1
    for _ in range(steps):
        step(y, time, h, p, tables, offsets, x, z, k, jac, c, scratch, count)
        examine(x, p, flag)
        for l in range(L):
            good[l] *= flag[l]
            time[l] += h[l]
        for i in range(rows * L):
            y[i] = x[i]


@kernel
def evaluate(y, time, p, tables, offsets, dy, jac, o):
    """Evaluate rates, Jacobian entries (where compiled with tangents) and outputs, each flat over rows and lanes."""
    c = np.empty((2 * H + 1) * L)
    scratch = np.zeros(SCRATCH * L)
    phases(time, p, c)
    rates(y, c, p, tables, offsets, scratch, dy, jac)
    observed(y, p, o)
