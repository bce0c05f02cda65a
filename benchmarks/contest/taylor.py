"""heyoka: adaptive Taylor series in SIMD batches, fed the model in the form that suits it best.

What makes a difference to heyoka, measured on the gear pair (numbers in docs/performance.md): parameters hoisted into its
``par``; integer powers as products and quotients as one division; the film factored so that few products of variables are
left; and a batch of operating points of similar speed. Cosines and sines of the forcing are taken of its time, or as two
more states for each harmonic (c' = -w s, s' = w c); neither is always the faster.
"""

import time
from dataclasses import dataclass
from types import ModuleType
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from sympy import Expr, Symbol, sympify

from contest.film_fit import FilmFit, film_fit
from contest.problems import Problem
from contest.scalar_code import evaluate_inputs
from whirlmap.equations.model import Model
from whirlmap.errors import InputError, ModelError
from whirlmap.kernels.lowering.lower import Hoisted, hoist, split_harmonics

Array = NDArray[np.float64]
HarmonicsAs = Literal["states", "time"]

#: How far the film's fit may be off, in units of the tolerance asked of heyoka. A tenth of that is not more accurate after
#: 8T and takes a few per cent longer; ten times that loses a digit.
FIT_OVER_TOLERANCE = 0.3
#: Error of the film's fit that the reference solution uses.
FINEST_FIT = 3e-14
#: Room between the largest eccentricity of the orbits and the end of the fit.
MARGIN = 0.01


def heyoka() -> ModuleType:
    """Return heyoka, or raise `InputError` naming the extra that brings it."""
    try:
        import heyoka as module
    except ImportError:
        raise InputError(
            "heyoka is not installed, so there is nothing to compare with\n"
            "  to install it: pip install 'whirlmap[benchmarks]'"
        ) from None
    return module


@dataclass(frozen=True, eq=False)
class TaylorSystem:
    """A system of equations for heyoka.

    Attributes
    ----------
    equations : list of (variable, rate)
    hoisted : Hoisted
        What ``par`` holds.
    start : array, shape (state + extra,)
        Start values of the extra states, behind the model's (which are left zero here).
    fit : FilmFit or None
    """

    equations: list[tuple[Any, Any]]
    hoisted: Hoisted
    start: Array
    fit: FilmFit | None


def taylor_system(problem: Problem, *, harmonics_as: HarmonicsAs = "states", fit_error: float | None = None) -> TaylorSystem:
    """Translate a problem's equations.

    Parameters
    ----------
    harmonics_as : {"states", "time"}
        Harmonics as states of their own, or as cosines and sines of heyoka's time.
    fit_error : float, optional
        Largest error of the fitted film where psi > 0; `FINEST_FIT` where absent.
    """
    hy = heyoka()
    model = problem.model
    translate = _Translator(hy, model)
    fit = None
    equations: dict[Any, Any] = dict(model.equations)
    if model.name == "gear_pair" and model.switches["film"] == "porous" and model.switches["arc"] == "fixed":
        if problem.psi > 0:
            reach = float(problem.eccentricity[1].max()) + MARGIN
            fit = film_fit(problem.psi, reach, FINEST_FIT if fit_error is None else fit_error)
        equations = translate.with_film(fit)
    elif model.tables:
        raise ModelError(f"{model.name} reads tables, which have no form for heyoka here")
    extra = translate.harmonics(harmonics_as)
    rates = [(translate.variables[s.name], translate(equations[s])) for s in model.states]
    start = np.zeros(model.dimension + len(extra))
    start[model.dimension :: 2] = 1.0
    return TaylorSystem([*rates, *extra], translate.hoisted, start, fit)


class TaylorRun:
    """heyoka on a problem: compiled when made, then run as often as asked."""

    def __init__(
        self, problem: Problem, system: TaylorSystem, *, tolerance: float, batch: int, compact: bool = False,
        force_avx512: bool = False,
    ) -> None:  # fmt: skip
        hy = heyoka()
        self.problem, self.batch = problem, batch
        rows, inputs = system.start.size, len(system.hoisted.symbols)
        options = {"tol": tolerance, "compact_mode": compact, "force_avx512": force_avx512}
        shape: tuple[int, ...] = (batch,) if batch > 1 else ()
        make = hy.taylor_adaptive_batch if batch > 1 else hy.taylor_adaptive
        self.integrator = make(
            system.equations, state=np.zeros((rows, *shape)), pars=np.zeros((inputs, *shape)), **options
        )
        fill = -(-problem.points // batch) * batch - problem.points  # the last batch is filled with its last lane
        self.lanes = np.concatenate([np.arange(problem.points), np.full(fill, problem.points - 1)])
        self.inputs = evaluate_inputs(system.hoisted, problem.values)
        self.start = np.repeat(system.start[:, None], problem.points, axis=1)
        self.start[: problem.x0.shape[0]] = problem.x0

    def __call__(self) -> tuple[float, Array]:
        """Processor seconds of all lanes over the run, and their end states; NaN where heyoka gave up."""
        ta, dimension = self.integrator, self.problem.x0.shape[0]
        ends = self.problem.period * self.problem.periods
        out = np.empty_like(self.problem.x0)
        seconds = 0.0
        for first in range(0, self.lanes.size, self.batch):
            lanes = self.lanes[first : first + self.batch]
            if self.batch == 1:
                ta.time = 0.0
                ta.state[:], ta.pars[:], until = self.start[:, lanes[0]], self.inputs[:, lanes[0]], ends[lanes[0]]
            else:
                ta.set_time(0.0)
                ta.state[:], ta.pars[:], until = self.start[:, lanes], self.inputs[:, lanes], ends[lanes]
            begin = time.thread_time()
            ta.propagate_until(until)
            seconds += time.thread_time() - begin
            arrived = np.asarray(ta.time) == until
            out[:, lanes] = np.where(arrived, ta.state[:dimension].reshape(dimension, -1), np.nan)
        return seconds, out


class _Translator:
    """SymPy to heyoka, with everything that depends on parameters alone in ``par``."""

    def __init__(self, hy: ModuleType, model: Model) -> None:
        self.hy, self.model = hy, model
        self.hoisted = Hoisted(model.parameters)
        self.variables = {s.name: hy.expression(s.name) for s in model.states}
        self.symbols: dict[str, Any] = dict(self.variables)

    def __call__(self, expression: Expr) -> Any:
        """Translate an expression of states, parameters and harmonics."""
        return self.lowered(hoist(split_harmonics(sympify(expression), self.model.harmonics), self.hoisted))

    def harmonics(self, harmonics_as: HarmonicsAs) -> list[tuple[Any, Any]]:
        """Name the cosine and sine of each harmonic; returns the equations of those that became states."""
        hy, extra = self.hy, []
        for i, frequency in enumerate(self.model.harmonics):
            w = self(sympify(frequency))
            if harmonics_as == "time":
                c, s = hy.cos(w * hy.time), hy.sin(w * hy.time)
            else:
                c, s = hy.expression(f"wave_c{i}"), hy.expression(f"wave_s{i}")
                extra += [(c, -w * s), (s, w * c)]
            self.symbols[f"c{i}"], self.symbols[f"s{i}"] = c, s
        return extra

    def lowered(self, e: Expr) -> Any:
        """Translate an expression whose parameters are hoisted."""
        if e.is_Symbol:
            if e in self.hoisted.symbols:
                return self.hy.par[self.hoisted.symbols.index(e)]
            return self.symbols[e.name]
        if e.is_number:
            return self.hy.expression(float(e))
        if e.is_Add:
            return self.hy.sum([self.lowered(a) for a in e.args])
        if e.is_Pow:
            return self.power(e.base, e.exp)
        if e.is_Mul:
            return self.product(e)
        raise ModelError(f"no translation to heyoka for {e}")

    def product(self, e: Expr) -> Any:
        """Translate a product: constant factors first, one division for all that stands below."""
        inputs = set(self.hoisted.symbols)
        above, below = e.as_numer_denom()
        constants = [a for a in above.as_ordered_factors() if a.free_symbols <= inputs]
        factors = [a for a in above.as_ordered_factors() if not a.free_symbols <= inputs]
        made = None
        for a in factors:
            made = self.lowered(a) if made is None else made * self.lowered(a)
        for a in constants:
            made = self.lowered(a) if made is None else self.lowered(a) * made
        return made if below == 1 else made / self.lowered(below)

    def power(self, base: Expr, exponent: Expr) -> Any:
        """Integer powers as products, which stay finite at zero; others as one power."""
        b, n = self.lowered(base), float(exponent)
        if n == 0.5:
            return self.hy.sqrt(b)
        if n != int(n):
            return b**n
        made = b
        for _ in range(abs(int(n)) - 1):
            made = made * b
        return made if n > 0 else 1.0 / made

    def with_film(self, fit: FilmFit | None) -> dict[Any, Any]:
        """Equations of the gear pair with the film's velocity factored; its mobilities become symbols of this translator."""
        from whirlmap.films.law import FilmLaw
        from whirlmap.models.gear_pair import derived

        mobility = self.plain_film if fit is None else lambda e2: self.fitted_film(e2, fit)

        def velocity(ux: Expr, uy: Expr, qx: Expr, qy: Expr, psi: Expr, sigma: Expr) -> tuple[Expr, Expr]:  # noqa: ARG001
            x, y = self.variables[ux.name], self.variables[uy.name]
            names = [Symbol(f"{part}_{ux.name}", real=True) for part in ("radial", "excess", "coupling")]
            self.symbols |= dict(zip((n.name for n in names), mobility(x * x + y * y), strict=True))
            radial, excess, coupling = names
            along, across = qx * ux + qy * uy, qy * ux - qx * uy
            turned, drawn = excess * across - sigma * coupling * along, sigma * coupling * across
            return radial * qx - turned * uy - drawn * ux, radial * qy + turned * ux - drawn * uy

        return derived(FilmLaw(velocity))

    def plain_film(self, e2: Any) -> tuple[Any, Any, Any]:
        """Mobilities at psi = 0 with the fewest products: g = q^(3/2)/P, then 2 pi q g, 6 pi g and -8 g sqrt(q/e2)."""
        q = 1.0 - e2
        g = q**1.5 / (np.pi**2 + (2 * np.pi**2 - 16) * e2)
        return 2 * np.pi * (q * g), 6 * np.pi * g, -8.0 * (g * self.hy.sqrt(q / e2))

    def fitted_film(self, e2: Any, fit: FilmFit) -> tuple[Any, Any, Any]:
        """Mobilities from the fit: T_2n = 2 T_n^2 - 1 and T_2n+1 = 2 T_n T_n+1 - z, shared by all series."""
        z = (2.0 / fit.reach**2) * e2 - 1.0
        T = [self.hy.expression(1.0), z]
        for k in range(2, fit.degree + 1):
            n = k // 2
            T.append(2.0 * (T[n] * T[n]) - 1.0 if k % 2 == 0 else 2.0 * (T[n] * T[n + 1]) - z)
        D, GD, B = (self.series(row, T) for row in fit.above)
        if fit.below.size > 1:
            once = 1.0 / self.series(fit.below, T)
            D, GD, B = D * once, GD * once, B * once
        return D, GD, B / self.hy.sqrt(e2)

    def series(self, coefficients: Array, basis: list[Any]) -> Any:
        """Sum of the basis with constant factors."""
        return self.hy.sum([float(a) * term for a, term in zip(coefficients, basis, strict=False)])


def rates(problem: Problem, system: TaylorSystem, time: float, x: Array) -> Array:
    """Heyoka's rates of the model's states, shape (state, point), to hold against the reference kernel."""
    hy = heyoka()
    variables = [variable for variable, _ in system.equations]
    harmonics_as = np.zeros((system.start.size - x.shape[0], x.shape[1]))
    if harmonics_as.size:
        frequencies = [order * 2 * np.pi / problem.period for order in map(float, problem.orders)]
        for i, w in enumerate(frequencies):
            harmonics_as[2 * i], harmonics_as[2 * i + 1] = np.cos(w * time), np.sin(w * time)
    function = hy.cfunc([rate for _, rate in system.equations[: x.shape[0]]], vars=variables)
    inputs = evaluate_inputs(system.hoisted, problem.values)
    return np.asarray(function(np.concatenate([x, harmonics_as]), pars=inputs, time=np.full(x.shape[1], time)))
