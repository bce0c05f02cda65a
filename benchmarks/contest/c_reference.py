"""RK4 of the same generated right-hand side in plain C: what a compiler makes of the lines we generate.

One function advances ``L`` operating points side by side, L a constant: 1 is the loop everybody writes, more leave the
vectors to the compiler. Harmonics come from the same tables as in whirlmap's kernels.
"""

import ctypes
import shutil
import subprocess
import tempfile
import time
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from contest.problems import Problem
from contest.scalar_code import ScalarCode, evaluate_inputs, scalar_code
from whirlmap.errors import InputError
from whirlmap.kernels.methods import RK4
from whirlmap.kernels.running.lanes import HarmonicTables

Array = NDArray[np.float64]

#: What the compiler is told. Wider vectors (-mprefer-vector-width=512) made no difference.
FLAGS = ("-O3", "-march=native", "-ffast-math", "-fPIC")

SOURCE = """#include <math.h>
#include <string.h>
enum {{ L = {lanes}, N = {states}, P = {inputs}, H = {harmonics} }};

static inline void rates(const double *restrict y, const double *restrict c, const double *restrict p,
                         double *restrict dy) {{
{waves}
    for (int l = 0; l < L; l++) {{
{body}
    }}
}}

void run(double *restrict y, const double *restrict p, const double *restrict h, const double *restrict waves,
         const long *restrict starts, const long *restrict lengths, long steps, long blocks) {{
    double x[N * L], k[N * L], sum[N * L], c[2 * H + 1];
    const double share[4] = {{1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6}}, reach[4] = {{0.5, 0.5, 1.0, 0.0}};
    const int node[4] = {{0, 1, 1, 2}};
    for (long b = 0; b < blocks; b++, y += N * L, p += P * L, h += L) {{
        long at[H + 1];
        memset(at, 0, sizeof at);
        for (long n = 0; n < steps; n++) {{
            for (int i = 0; i < N * L; i++) {{
                x[i] = y[i];
                sum[i] = 0.0;
            }}
            for (int stage = 0; stage < 4; stage++) {{
                for (int j = 0; j < H; j++) {{
                    const double *w = waves + starts[j] + 2 * (3 * at[j] + node[stage]);
                    c[2 * j] = w[0];
                    c[2 * j + 1] = w[1];
                }}
                rates(x, c, p, k);
                for (int i = 0; i < N; i++)
                    for (int l = 0; l < L; l++) {{
                        sum[i * L + l] += share[stage] * k[i * L + l];
                        x[i * L + l] = y[i * L + l] + reach[stage] * h[l] * k[i * L + l];
                    }}
            }}
            for (int i = 0; i < N; i++)
                for (int l = 0; l < L; l++) y[i * L + l] += h[l] * sum[i * L + l];
            for (int j = 0; j < H; j++)
                if (++at[j] == lengths[j]) at[j] = 0;
        }}
    }}
}}
"""


def compiler() -> str:
    """Path of a C compiler, or raise `InputError`."""
    found = shutil.which("gcc") or shutil.which("cc")
    if found is None:
        raise InputError("there is no C compiler (gcc or cc), so there is no C kernel to compare with")
    return found


def source(made: ScalarCode, lanes: int) -> str:
    """Text of the C module for so many lanes."""
    waves = [
        f"    const double {kind}{i} = c[{2 * i + part}];"
        for i in range(len(made.frequencies))
        for part, kind in enumerate("cs")
    ]
    body = [f"const double {name} = {array}[{i} * L + l];" for name, array, i in made.inputs(made.lines.names())]
    body += [f"const double {name} = {value};" for name, value in made.assignments()]
    body += [f"dy[{i} * L + l] = {value};" for i, value in enumerate(made.results())]
    return SOURCE.format(
        lanes=lanes, states=made.model.dimension, inputs=len(made.hoisted.symbols), harmonics=len(made.frequencies),
        waves="\n".join(waves), body="\n".join(f"        {line}" for line in body),
    )  # fmt: skip


class CRun:
    """The C kernel on a problem: compiled when made, then run as often as asked."""

    def __init__(self, problem: Problem, *, steps: int, lanes: int) -> None:
        made = scalar_code(problem.model)
        self.problem, self.steps, self.lanes = problem, steps, lanes
        self._function = _compiled(source(made, lanes))
        self.waves = HarmonicTables.of(problem.orders, np.array([steps]), tuple(sorted({float(c) for c in RK4.c})))
        fill = np.minimum(np.arange(-(-problem.points // lanes) * lanes), problem.points - 1)
        self.start = self._blocks(problem.x0[:, fill])
        self.p = self._blocks(evaluate_inputs(made.hoisted, problem.values)[:, fill])
        self.h = (problem.period / steps)[fill]

    def _blocks(self, rows: Array) -> Array:
        """(row, point) to (block, row, lane)."""
        return np.ascontiguousarray(rows.reshape(rows.shape[0], -1, self.lanes).swapaxes(0, 1))

    def __call__(self) -> tuple[float, Array]:
        """Processor seconds of all lanes over the run, and their end states."""
        y, pointer = self.start.copy(), ctypes.c_void_p
        arrays = (y, self.p, self.h, self.waves.table, self.waves.starts, self.waves.lengths)
        arguments = [a.ctypes.data_as(pointer) for a in arrays]
        begin = time.thread_time()
        self._function(*arguments, ctypes.c_long(self.problem.periods * self.steps), ctypes.c_long(y.shape[0]))
        seconds = time.thread_time() - begin
        return seconds, y.swapaxes(0, 1).reshape(y.shape[1], -1)[:, : self.problem.points]


@lru_cache(maxsize=8)
def _compiled(text: str) -> "ctypes._NamedFuncPointer":
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder, "kernel.c")
        place.write_text(text, encoding="utf-8")
        # Linked apart from -ffast-math, with which gcc adds code that flushes tiny numbers to zero in all of this thread.
        subprocess.run([compiler(), *FLAGS, "-c", "-o", str(place.with_suffix(".o")), str(place)], check=True)
        subprocess.run(
            [compiler(), "-shared", "-o", str(place.with_suffix(".so")), str(place.with_suffix(".o")), "-lm"], check=True
        )
        return ctypes.CDLL(str(place.with_suffix(".so"))).run
