"""Run-up and coast-down: against SciPy in seconds, energy with the driving torque, jumps of a labelled diagram."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.independent.test_ross_coefficients import response
from tests.machines.test_coefficients import CONSTANT, HEAD, TABLE, bearing, loaded

import whirlmap
from whirlmap.analysis.simulation.ramp import Ramp, ramp_of
from whirlmap.analysis.simulation.run_up import Running
from whirlmap.equations import Model, Parameter, State, Stop, cos, t
from whirlmap.equations.run_up import ACCELERATION, running_up
from whirlmap.errors import CaseError, InputError, RangeError
from whirlmap.integrate.system import System
from whirlmap.options.computed import Integration
from whirlmap.options.execution import EXECUTION

DUFFING = {"delta": 0.05, "alpha": 1, "beta": 0.1, "gamma": 0.18, "omega": 0.8}


def run_of(system, *given, time, accuracy=None):
    """A run that gives away its raw states."""
    ramp = ramp_of(system, *given, time)
    return ramp, Running(system, ramp, 0, 2, Integration(accuracy=accuracy), EXECUTION)


ROTOR = HEAD + bearing("a", 0, CONSTANT) + bearing("b", 4, CONSTANT)


def matrices(system):
    """M, G, K of the modes of one plane, in SI, shapes at the stations, and states of x and y."""
    (rotor,), given = system.machine.case.parts.machine.rotors, system.machine.given
    n, m, K = rotor.numbers, given["shaft.rotor.m"], given["shaft.rotor.K"]
    at = [[system.states.index(q.name) for q in rotor.coordinates(axis)] for axis in "xy"]
    return m * np.diag(n.mass), m * n.gyroscopic, K * np.diag(n.stiffness), n.shapes, at


@pytest.mark.parametrize(("begin", "end"), [(450.0, 750.0), pytest.param(750.0, 450.0, marks=pytest.mark.slow)])
def test_a_rotor_through_resonance_is_that_of_scipy_in_seconds(tmp_path, begin, end):
    """M q'' + (C + w G) q' + K q = U (w^2 cos phi + w' sin phi), over seconds, with the phase that has passed."""
    system, T, U = loaded(tmp_path, ROTOR), 0.2, 200e-6
    M, G, K, shapes, at = matrices(system)
    a, n, both = (end - begin) / T, len(M), shapes[[0, 4]]
    k, c = np.array([[9e6, 2e6], [-2e6, 14e6]]), np.diag([5e3, 6e3])
    held, damped = (np.kron(matrix, both.T @ both) for matrix in (k, c))
    stiff, mass = np.kron(np.eye(2), K) + held, np.linalg.inv(np.kron(np.eye(2), M))

    def rates(t, z):
        q, v, speed, phi = z[: 2 * n], z[2 * n :], begin + a * t, begin * t + a * t**2 / 2
        turned = np.array([speed**2 * np.cos(phi) + a * np.sin(phi), speed**2 * np.sin(phi) - a * np.cos(phi)])
        spin = np.kron([[0, 1], [-1, 0]], speed * G)
        return np.concatenate([v, mass @ (U * np.kron(turned, shapes[2]) - (damped + spin) @ v - stiff @ q)])

    ramp, run = run_of(system, "speed", f"{begin} rad/s", f"{end} rad/s", time=f"{T} s")
    ensemble, _ = run._start()
    steps, count = int(ensemble.point_steps[0]), run.before + run.windows * run.length
    x = ensemble.advance(count, save_every=1).saved[:, :, 0]
    phase = np.arange(1, count * steps + 1) * 2 * np.pi / steps
    seconds = ramp.elapsed(phase) * ramp.unit
    assert abs(seconds[-1] - T) < 2 * np.pi / min(begin, end)

    def slopes(t, z):
        spin = np.kron([[0, 1], [-1, 0]], (begin + a * t) * G)
        return np.block([[np.zeros((2 * n, 2 * n)), np.eye(2 * n)], [-mass @ stiff, -mass @ (damped + spin)]])

    span, rest = (0, seconds[-1]), np.zeros(4 * n)
    theirs = solve_ivp(rates, span, rest, "Radau", seconds, jac=slopes, rtol=1e-6, atol=1e-12).y[: 2 * n].T
    ours = 1e-4 * x[:, [*at[0], *at[1]]]
    largest = np.abs(theirs).max(axis=0)
    assert (np.abs(ours - theirs).max(axis=0) < 1e-4 * largest.max()).all()


def test_extremes_lie_between_the_steps():
    """A linear oscillator run up slowly: its amplitude at the faster end of each window, in closed form."""
    x, v = State("x", "1", "displacement"), State("v", "1", "velocity")
    W, c = Parameter("W", "1", "speed", above=0), Parameter("c", "1", "damping")
    model = Model(
        "slow", (x, v), (W, c), {x: v, v: cos(W * t) - c * v - x}, harmonics=(W,), clocks={"shaft": W}, swing=(x,), speed=W,
        angular_acceleration={},
    )  # fmt: skip
    ds = whirlmap.run_up(System(model, {"W": 0.3, "c": 0.1}), "W", 0.3, 0.302, time=20_000.0, transient=60, windows=20)
    at = ds["W"].values
    fastest = at + np.diff(at).mean() / 2
    largest = 1 / np.abs(1 - fastest**2 + 0.1j * fastest)
    of = ds.sel(quantity="x")
    np.testing.assert_allclose(of["maximum"][1:], largest[1:], rtol=4e-6)  # the last turn ends before the window
    np.testing.assert_allclose(of["minimum"][1:], -largest[1:], rtol=4e-6)


def test_energy_balance_with_the_driving_torque_closes(tmp_path):
    """The torque that keeps the speed does the work that the motion gains and the dampers take, to 1e-6.

    With the phase phi, T_drive = U (-x'' sin phi + y'' cos phi) beside the inertia J of the shaft, and the mechanical energy
    contains U phi' (-x' sin phi + y' cos phi). All in K_0 c_0^2 and 1/omega_0.
    """
    system = loaded(tmp_path, ROTOR.replace('k_xy = "2e6 N/m"\nk_yx = "-2e6 N/m"\n', ""))
    ramp, run = run_of(system, "speed", "300 rad/s", "800 rad/s", time="0.2 s", accuracy=1e-10)
    ensemble, _ = run._start()
    steps, count = int(ensemble.point_steps[0]), run.before + run.windows * run.length
    started = ensemble.x[:, 0].copy()
    x = np.vstack([started, ensemble.advance(count, save_every=1).saved[:, :, 0]])
    phase = np.arange(count * steps + 1) * 2 * np.pi / steps
    s, states = x[:, -1], system.states
    assert s == pytest.approx(ramp.speed(phase), rel=1e-10)
    (rotor,) = system.machine.case.parts.machine.rotors
    values, numbers = {k: float(v) for k, v in system.values.items()}, rotor.numbers
    slopes = np.array([run.moving.rhs(p, z) for p, z in zip(phase, x, strict=True)])
    energy, power = np.zeros(phase.size), np.zeros(phase.size)
    speed = []  # dx/dt, dy/dt and second derivatives at the unbalance
    for axis in "xy":
        q = x[:, [states.index(n.name) for n in rotor.coordinates(axis)]]
        at = [states.index(n.name) for n in rotor.rates_of(axis)]
        v = s[:, None] * x[:, at]
        # d(s v)/dt = s (s v' + s' v)
        gained = s[:, None] * (s[:, None] * slopes[:, at] + slopes[:, [-1]] * x[:, at])
        energy += v**2 @ numbers.mass / 2 + q**2 @ numbers.stiffness / 2 * values["kappa_rotor"]
        for i, name in ((0, "a"), (4, "b")):
            energy += values[f"kappa_{axis}{axis}_{name}"] * (q @ numbers.shapes[i]) ** 2 / 2
            power -= 2 * values[f"xi_{axis}{axis}_{name}"] * (v @ numbers.shapes[i]) ** 2
        speed.append((v @ numbers.shapes[2], gained @ numbers.shapes[2]))
    (vx, ax), (vy, ay) = speed
    energy += values["b_u"] * s * (-vx * np.sin(phase) + vy * np.cos(phase))
    drive = values["b_u"] * (-ax * np.sin(phase) + ay * np.cos(phase)) * s
    whole = [np.trapezoid(p / s, phase) for p in (drive, power)]  # dt = d phase/s
    # trapezoids of a periodic function converge fast; the ends are mended by their first derivative (Euler-Maclaurin)
    h = phase[1]
    for i, p in enumerate((drive, power)):
        f = p / s
        ends = np.gradient(f, h, edge_order=2)
        whole[i] -= h**2 / 12 * (ends[-1] - ends[0])
    assert whole[0] > 0 > whole[1]
    assert energy[-1] - energy[0] == pytest.approx(sum(whole), abs=1e-6 * abs(whole[0]))


@pytest.mark.parametrize("way", ["up", "down"])
def test_slow_run_up_meets_the_jumps_of_the_diagram(way):
    """Within one step of the diagram: a Duffing oscillator with a hardening spring hangs on each branch to its fold."""
    system, grid = whirlmap.load("duffing", **DUFFING), np.linspace(1.0, 1.4, 41)
    diagram = whirlmap.bifurcation_diagram(system, "omega", grid, follow=way)
    size = diagram["peak_to_peak"].sel(quantity="x").squeeze().values
    at = int(np.argmax(np.abs(np.diff(size))))
    ends = (1.0, 1.4) if way == "up" else (1.4, 1.0)
    run = whirlmap.run_up(system, "omega", *ends, time=60000.0, transient=100)
    found = (run["maximum"] - run["minimum"]).sel(quantity="x").values
    where = int(np.argmax(np.abs(np.diff(found))))
    jump = run["omega"].values[where : where + 2]
    step = grid[1] - grid[0]
    assert grid[at] - step < jump.min() and jump.max() < grid[at + 1] + step
    # before and after it the amplitude is that of the diagram
    w = run["omega"].values[[where - 8, where + 10]]
    sizes = np.interp(w, grid, size)
    assert found[[where - 8, where + 10]] == pytest.approx(sizes, rel=0.05)


@pytest.mark.slow
def test_amplitude_and_phase_are_those_of_the_response(tmp_path):
    """Slow run of a linear rotor: at each speed its response to the unbalance in closed form."""
    system = loaded(tmp_path, ROTOR)
    ds = whirlmap.run_up(system, "speed", "300 rad/s", "800 rad/s", time="20 s", transient=60, windows=40)
    unit = system.machine.quantities["omega_0"][0]
    for i in (0, 13, 26, -1):
        at = loaded(tmp_path, ROTOR, speed=f"{float(ds['s'].values[i]) * unit!r} rad/s")
        X = response(at)[at.states.index("x_rotor")]
        here = ds.sel(quantity="x_rotor", clock="rotor").isel(s=i)
        assert float(here["clock_amplitude"]) == pytest.approx(abs(X), rel=1e-2)
        assert float(np.angle(np.exp(1j * (here["clock_phase"] - np.angle(X))))) == pytest.approx(0, abs=1e-2)
    assert ds["elapsed"].attrs["units"] == "s"


def test_a_table_of_coefficients_follows_the_speed(tmp_path):
    """At a speed of the run the rates are those of the machine at that speed."""
    text = HEAD + bearing("a", 0, TABLE) + bearing("b", 4, CONSTANT)
    system, faster = loaded(tmp_path, text, speed="2000 rpm"), loaded(tmp_path, text, speed="6000 rpm")
    model = running_up(system.model, "s")
    values = {**{k: v for k, v in system.values.items() if k != "s"}, ACCELERATION: 0.0}
    moving, x = whirlmap.System(model, values), np.random.default_rng(3).normal(size=len(system.states)) * 1e-2
    ours = moving.rhs(0.7, np.append(x, float(faster.values["s"])))
    assert ours[:-1] == pytest.approx(faster.rhs(0.7, x), rel=1e-9, abs=1e-12)


def test_the_speed_by_the_phase_is_that_of_a_constant_acceleration():
    ramp = Ramp("s", 1.0, 3.0, 50.0, np.nan)
    time = np.linspace(0, 50, 7)
    phase = time + ramp.acceleration * time**2 / 2
    assert ramp.speed(phase) == pytest.approx(1 + ramp.acceleration * time) and ramp.elapsed(phase) == pytest.approx(time)
    assert phase[-1] == pytest.approx(ramp.phase)


@pytest.mark.parametrize(
    ("case", "given", "time", "said"),
    [
        ("duffing", ("omega", 1.0, 1.0), 100.0, "two different speeds"),
        ("duffing", ("gamma", 1.0, 2.0), 100.0, "gamma"),
        ("duffing", ("omega", 1.0, 2.0), "20 s", "no seconds"),
        ("duffing", ("omega", 1.0, 2.0), 10.0, "two windows"),
        ("lorenz", ("rho", 1.0, 2.0), 10.0, "not forced"),
        ("machines/jeffcott-rig", ("speed", "2000 rpm", "3000 rpm"), 20.0, "without a unit"),
        ("machines/jeffcott-rig", ("speed", "2000 rpm", "3000 mm"), "20 s", "unit"),
        ("machines/jeffcott-rig", ("speed", "2000 rpm", "3000 rpm"), "-3 s", "above zero"),
    ],
)
def test_wrong_runs_say_what_is_wrong(case, given, time, said):
    with pytest.raises((RangeError, InputError, CaseError), match=said):
        whirlmap.run_up(whirlmap.load(case), *given, time=time)


def test_a_run_that_ends_early_says_at_which_speed():
    """An oscillator that meets a wall on its way into resonance: windows beyond are NaN."""
    x, v = State("x", "1", "position"), State("v", "1", "velocity")
    w = Parameter("w", "1", "frequency", above=0)
    model = Model(
        name="walled", states=(x, v), parameters=(w,), equations={x: v, v: cos(w * t) - x - 0.02 * v}, harmonics=(w,),
        stops={"contact": Stop(4 - x, "the wall is met")}, clocks={"forcing": w}, angular_acceleration={},
    )  # fmt: skip
    ds = whirlmap.run_up(whirlmap.System(model, {"w": 0.5}), "w", 0.5, 1.5, time=3000.0, windows=30)
    reached = np.isfinite(ds["maximum"].sel(quantity="x").values)
    assert int(ds["status"]) == 1 and reached[0] and not reached[-1]
    # where the amplitude of the slow response, 1/|1 - w^2|, reaches the wall
    assert float(ds["end_speed"]) == pytest.approx(np.sqrt(1 - 1 / 4), abs=0.01)
    assert ds["w"].values[reached][-1] < float(ds["end_speed"]) < ds["w"].values[~reached][0] + np.diff(ds["w"].values)[0]
