"""Source of every generated kernel module: what does not depend on the model.

This file is never imported. `source.py` copies it behind the generated part of a module, which defines ``L`` (lanes),
``N`` (states), ``M`` (outputs), ``H`` (harmonics), ``NODES`` (distinct stage times) and the functions ``rates``,
``tangent``, ``step``, ``examine`` and ``observed``. Arrays are flat over rows and lanes, ``y[i * L + l]``: rows 0..N-1
are the state, the next N rows the first tangent vector, and so on.
"""
# ruff: noqa: F821
# mypy: ignore-errors


@inner
def orthonormalise(y, count, growth, active):
    """Modified Gram-Schmidt on the tangent vectors of active lanes; adds the logarithms of their lengths to growth.

    A lane that waits for its step to be redone keeps its vectors, and with them the growth since they were of length one.
    """
    length = np.empty(L)
    for a in range(1, count + 1):
        this = y[a * N * L : (a + 1) * N * L]
        for b in range(1, a):
            other = y[b * N * L : (b + 1) * N * L]
            for l in range(L):
                length[l] = 0.0
            for i in range(N):
                for l in range(L):
                    length[l] += this[i * L + l] * other[i * L + l]
            for l in range(L):
                length[l] = length[l] if active[l] != 0 else 0.0
            for i in range(N):
                for l in range(L):
                    this[i * L + l] -= length[l] * other[i * L + l]
        for l in range(L):
            length[l] = 0.0
        for i in range(N):
            for l in range(L):
                length[l] += this[i * L + l] * this[i * L + l]
        for l in range(L):
            length[l] = sqrt(length[l]) if active[l] != 0 else 1.0
            growth[(a - 1) * L + l] += log(length[l])
            length[l] = 1.0 / length[l]
        for i in range(N):
            for l in range(L):
                this[i * L + l] *= length[l]


@inner
def fold(v, before, rows, active, sums):
    """Fold ``rows`` rows of one step into the running minimum, maximum, sum and sum of squares, ``before`` rows on.

    States and outputs are folded by one call each: an index that chose between the two arrays would run outside of both,
    and LLVM's test that they do not overlap, hence rounding, would depend on where they happen to lie in memory.
    """
    W = (N + M) * L
    for i in range(rows):
        a = i * L
        at = (before + i) * L
        for l in range(L):
            d = v[a + l] - sums[at + l]
            on = active[l] != 0
            sums[W + at + l] = v[a + l] if (on and v[a + l] < sums[W + at + l]) else sums[W + at + l]
            sums[2 * W + at + l] = v[a + l] if (on and v[a + l] > sums[2 * W + at + l]) else sums[2 * W + at + l]
            sums[3 * W + at + l] += d if on else 0.0
            sums[4 * W + at + l] += d * d if on else 0.0


@kernel
def advance(
    y, h, p, tables, offsets, waves, starts, lengths, counters, steps, first, active, failed,
    save_every, saved, orth_every, growth, sums,
):  # fmt: skip
    """Take ``steps`` steps that are locked to the forcing's phase, in place.

    A lane stops, and keeps its last good state, before the step that ends at a closed gap, beyond the bound or at
    something that is not a number; ``failed`` then holds that step's index. Lane ``l`` starts at step ``first[l]``.
    All arrays are flat, so that every offset is a constant and the loops over lanes become vector code.

    Parameters
    ----------
    y : (N*(1+k) * L)     state and k tangent vectors
    h : (N * L)           step of each lane, repeated for every row
    p : (inputs * L)      hoisted parameters
    tables, offsets       table entries, and where each lane's begin: (tables * L)
    waves, starts, lengths, counters
                          cosine and sine of each harmonic at each stage time of its cycle of ``lengths`` steps
    first, active, failed : (L) integers
    save_every, saved     state after every so many steps: (saves, N * L)
    orth_every, growth    logarithmic growth between two orthonormalisations: (events, k * L)
    sums : (5 * (N+M) * L) reference, minimum, maximum, sum and sum of squares less reference; empty: not wanted
    """
    rows = y.size // L
    count = rows // N - 1
    x, z = np.empty(rows * L), np.empty(N * L)
    k = np.empty(STAGES * N * L)
    jac = np.empty(STAGES * ENTRIES * L)
    c = np.empty(2 * H + 1)
    scratch = np.zeros(SCRATCH * L)
    o = np.empty((M + 1) * L)
    good = np.empty(L, dtype=np.int64)
    running = 0
    waiting = 0
    for l in range(L):
        if active[l] != 0 and first[l] > 0:
            active[l] = 0
            waiting += 1
        else:
            first[l] = -1
            running += active[l]
    for n in range(steps):
        if waiting > 0:
            for l in range(L):
                if first[l] == n:
                    active[l] = 1
                    waiting -= 1
                    running += 1
        if running == 0 and waiting == 0:
            break
        step(y, h, p, tables, offsets, waves, starts, counters, x, z, k, jac, c, scratch, count)
        examine(x, p, good)
        bad = 0
        for l in range(L):
            bad += active[l] * (1 - good[l])
        if bad > 0:
            for l in range(L):
                if active[l] != 0 and good[l] == 0:
                    active[l] = 0
                    failed[l] = n
                    running -= 1
        if running == L:
            for i in range(rows * L):
                y[i] = x[i]
        else:
            for i in range(rows):
                a = i * L
                for l in range(L):
                    y[a + l] = x[a + l] if active[l] != 0 else y[a + l]
        for j in range(H):
            counters[j] += 1
            if counters[j] == lengths[j]:
                counters[j] = 0
        if count > 0 and (n + 1) % orth_every == 0:
            orthonormalise(y, count, growth[(n + 1) // orth_every - 1], active)
        if sums.size > 0:
            observed(y, p, o)
            fold(y, 0, N, active, sums)
            fold(o, N, M, active, sums)
        if (n + 1) % save_every == 0:
            at = (n + 1) // save_every - 1
            if at < saved.shape[0]:
                for i in range(N):
                    for l in range(L):
                        if active[l] != 0:
                            saved[at, i * L + l] = y[i * L + l]
