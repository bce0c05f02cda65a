"""A long run is many calls of a kernel, so that Ctrl-C need not wait for it; where the calls begin changes no bit."""

import signal
import threading
import time

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.integrate import group
from whirlmap.integrate.workers import Workers, stop_if_given_up

#: Case, varied parameter, tangent vectors, method, T between saved states and in the run.
RUNS = [
    ("duffing", {"gamma": np.linspace(0.2, 0.5, 21)}, 0, "dop853", 1, 30),
    ("duffing", {"gamma": np.linspace(0.2, 0.5, 21)}, 1, "tsit5", 3, 30),
    ("duffing", {"gamma": np.linspace(0.2, 0.5, 9)}, 2, "rk4", 0, 25),
    ("gear_backlash", {"F_ah": np.linspace(0.1, 0.3, 9)}, 1, "dop853", 2, 20),
    ("gear-psfd/machine", {"s": np.linspace(0.3, 4, 3)}, 1, "dop853", 20, 40),
    ("lorenz", {"rho": np.linspace(20, 30, 9)}, 2, "dop853", 1, 20),
]


def run(case, vary, tangents, method, every, periods):
    ensemble, _ = make_ensemble(whirlmap.load(case), vary, tangents=tangents, method=method, workers=1)
    counted = []
    segment = ensemble.advance(periods, save_periods=every, extremes="between", progress=counted.append)
    arrays = {"x": ensemble.x, "vectors": ensemble.vectors, "status": ensemble.status, "end": ensemble.end_time,
              "saved": segment.saved, "growth": segment.growth, "grazings": ensemble.grazings,
              "crossings": ensemble.crossings, **segment.extremes}  # fmt: skip
    assert sum(counted) == periods * ensemble.points
    return arrays, len(counted)


@pytest.mark.parametrize("which", range(len(RUNS)))
def test_bits_do_not_depend_on_the_calls(which, monkeypatch):
    whole, few = run(*RUNS[which])
    for first in (700, 64):
        monkeypatch.setattr(group, "FIRST", first)
        monkeypatch.setattr(group, "CALL", 0.0)
        monkeypatch.setattr(group, "LEAST", first)
        parts, many = run(*RUNS[which])
        assert many > few or first > 64
        for name, array in whole.items():
            np.testing.assert_array_equal(array, parts[name], err_msg=name)


@pytest.mark.parametrize("workers", [1, 2])
def test_ctrl_c_ends_a_long_run_at_once(workers):
    signal.signal(signal.SIGINT, signal.default_int_handler)  # who starts the tests in the background has it ignored
    system = whirlmap.load("duffing")
    ensemble, _ = make_ensemble(system, {"gamma": np.linspace(0.2, 0.5, 256)}, workers=workers)
    ensemble.advance(1)
    threading.Timer(0.3, signal.pthread_kill, [threading.main_thread().ident, signal.SIGINT]).start()
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        ensemble.advance(1_000_000)
    assert time.monotonic() - begun < 2.0


def test_threads_stop_when_nobody_waits_for_them():
    stopped = threading.Event()

    def work():
        try:
            while True:
                stop_if_given_up()
                time.sleep(0.01)
        except KeyboardInterrupt:
            stopped.set()
            raise

    def outer():
        with Workers(1) as inside:  # a pool within a thread of another one
            inside.submit(work).result()

    with pytest.raises(ValueError, match="given up"), Workers(1) as pool:
        pool.submit(outer)
        time.sleep(0.05)
        raise ValueError("given up")
    assert stopped.is_set()
