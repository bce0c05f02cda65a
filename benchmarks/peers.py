"""Peers of the long comparison that work on one operating point at a time: JiTCODE and pynamicalsys."""

import tempfile
import time
from contextlib import chdir

import numpy as np
from sympy import Symbol, cos, sin, sympify

from contest.problems import Problem
from contest.scalar_code import evaluate_inputs, numba_rhs, scalar_code
from whirlmap.kernels.lowering.lower import Hoisted, hoist, split_harmonics


def jitcode_runs(problem: Problem, methods: tuple[str, ...], tolerances: tuple[float, ...]):
    """(method, tolerance, run) of JiTCODE: its own C code with shared terms, parameters hoisted."""
    import symengine
    from jitcode import jitcode, t, y

    model, hoisted = problem.model, Hoisted(problem.model.parameters)
    lowered = [hoist(split_harmonics(model.equations[s], model.harmonics), hoisted) for s in model.states]
    frequencies = [hoist(sympify(w), hoisted) for w in model.harmonics]
    clock = Symbol("clock", real=True)
    waves = {}
    for i, w in enumerate(frequencies):
        waves |= {Symbol(f"c{i}", real=True): cos(w * clock), Symbol(f"s{i}", real=True): sin(w * clock)}
    names = {symengine.Symbol(s.name): y(i) for i, s in enumerate(model.states)}
    inputs = [symengine.Symbol(q.name) for q in hoisted.symbols]
    plain = {s: Symbol(s.name) for s in (*model.states, *hoisted.symbols, clock)}
    rates = [symengine.sympify(e.xreplace(waves).xreplace(plain)) for e in lowered]
    rates = [e.subs({**names, symengine.Symbol("clock"): t}) for e in rates]
    ode = jitcode(rates, n=model.dimension, control_pars=inputs, verbose=False)
    ode.generate_f_C(do_cse=True)
    with tempfile.TemporaryDirectory() as folder, chdir(folder):  # its setuptools would read our pyproject.toml
        ode.compile_C()
    numbers = evaluate_inputs(hoisted, problem.values)

    def runner(method, tolerance):
        def run():
            out = np.full_like(problem.x0, np.nan)
            seconds = 0.0
            for i in range(problem.points):
                ode.set_parameters(numbers[:, i])
                ode.set_integrator(method, rtol=tolerance, atol=tolerance, nsteps=10**6)
                ode.set_initial_value(problem.x0[:, i], 0.0)
                begin = time.thread_time()
                out[:, i] = ode.integrate(problem.period[i] * problem.periods)
                seconds += time.thread_time() - begin
            return seconds, out

        return run

    for method in methods:
        for tolerance in tolerances:
            yield method, tolerance, runner(method, tolerance)


def pynamicalsys_runs(problem: Problem, tolerances: tuple[float, ...], steps: tuple[int, ...]):
    """(method, tolerance or steps, run) of pynamicalsys, on the same Numba right-hand side as SciPy.

    Its inner function is called: the method of its system class runs one initial step beyond the time that it is given.
    """
    from pynamicalsys.continuous_time.step import evolve_system
    from pynamicalsys.continuous_time.step_methods import rk4_step_wrapped, rk45_step_wrapped

    rhs = numba_rhs(problem.model)
    inputs = evaluate_inputs(scalar_code(problem.model).hoisted, problem.values)

    def runner(method, setting):
        def run():
            out = np.full_like(problem.x0, np.nan)
            begin = time.thread_time()
            for i in range(problem.points):
                x, p = np.ascontiguousarray(problem.x0[:, i]), np.ascontiguousarray(inputs[:, i])
                span = problem.period[i] * problem.periods
                if method == "rk4":
                    step = problem.period[i] / setting
                    out[:, i] = evolve_system(x, p, span, rhs, time_step=step, integrator=rk4_step_wrapped)
                else:
                    out[:, i] = evolve_system(
                        x, p, span, rhs, atol=setting, rtol=setting, integrator=rk45_step_wrapped
                    )
            return time.thread_time() - begin, out

        return run

    for tolerance in tolerances:
        yield "rk45", tolerance, runner("rk45", tolerance)
    for n in steps:
        yield "rk4", n, runner("rk4", n)
