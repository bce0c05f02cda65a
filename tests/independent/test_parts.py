"""Machines from parts against unreduced finite-element matrices of our own: eigenvalues and a nonlinear orbit."""

from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.independent.finite_elements import Bearing, Gearbox, Matrices, Mesh, Rotor
from tests.independent.parts_of import machine_file

import whirlmap

PINION = Rotor(
    pieces=(
        (0.1, 0.05, 0.0), (0.1, 0.05, 0.0), (0.05, 0.08, 0.0), (0.05, 0.08, 0.0), (0.1, 0.05, 0.0), (0.1, 0.05, 0.0),
        (0.08, 0.045, 0.0), (0.08, 0.045, 0.0),
    ),
    disks=((8, 6.0, 0.02, 0.036),),  # overhung
    bearings=(Bearing(1, 0.025, 0.0125, 40e-6, "fixed"), Bearing(6, 0.025, 0.016, 50e-6)),
    unbalances=((3, 4e-5, 0.3), (8, 3e-5, -1.0)),
)  # fmt: skip
GEAR = Rotor(
    pieces=(
        (0.15, 0.07, 0.0), (0.15, 0.07, 0.0), (0.05, 0.1, 0.0), (0.05, 0.1, 0.0), (0.15, 0.07, 0.02), (0.15, 0.07, 0.02),
        (0.15, 0.07, 0.02),
    ),
    disks=((3, 35.0, 0.18, 0.34),),
    bearings=(Bearing(0, 0.035, 0.02, 60e-6), Bearing(6, 0.035, 0.022, 70e-6, "positive", (25.0, 1.5e8, 2e4))),
    unbalances=((3, 2e-4, 0.7),),
)  # fmt: skip
TEETH = Mesh((3, 3), (31, 93), 3e-3, pi / 9, 0.2, 3e8, 5e3, 1e-6, 30.0)
TWO_SHAFTS = Gearbox((PINION, GEAR), TEETH, speed=900.0, mu=0.015)
#: The gear drives, uphill, at another speed, with softer teeth.
DRIVEN_BY_THE_GEAR = Gearbox(
    (PINION, GEAR), Mesh((3, 4), (37, 60), 3e-3, pi / 8, 2.4, 1e8, 2e3, 1e-6, -45.0), speed=700.0, mu=0.02
)
#: A slender rotor with three disks, one overhung and gyroscopic, above two of its bending modes.
SLENDER = Gearbox(
    (
        Rotor(
            pieces=((0.1, 0.035, 0.0),) * 12,
            disks=((3, 6.0, 0.02, 0.035), (6, 8.0, 0.03, 0.055), (12, 5.0, 0.025, 0.048)),
            bearings=(Bearing(0, 0.0175, 0.01, 30e-6), Bearing(10, 0.0175, 0.012, 35e-6, "fixed", (12.0, 4e7, 4e3))),
            unbalances=((6, 3e-5, 0.0),),
        ),
    ),
    None, speed=600.0, mu=0.01,
)  # fmt: skip
#: Shafts that twist: a motor behind a coupling on the gear's shaft, a load behind one on the pinion's.
TURNING = Gearbox((PINION, GEAR), TEETH, 900.0, 0.015, couplings=((1, 0, 6e3, 8.0), (0, 8, 2e3, 1.0)))
MACHINES = {"two shafts": TWO_SHAFTS, "turning": TURNING, "driven by the gear": DRIVEN_BY_THE_GEAR, "slender": SLENDER}


def loaded(folder, box, **more):
    file = folder / "machine.toml"
    file.write_text(machine_file(box, **more), encoding="utf-8")
    return whirlmap.load(file)


def spread(system, full, x):
    """Coordinates and rates of the matrices of a state of the reduced machine: modes, and what forces of journals bend."""
    state, machine = dict(zip(system.states, x, strict=True)), system.machine.case.parts.machine
    c, clock = full.box.rotors[0].bearings[0].c, full.box.speed
    q, v = np.zeros(full.n), np.zeros(full.n)
    supports = {b.name: b.support for b in machine.bearings}
    for i, rotor in enumerate(machine.rotors):
        modes = rotor.shaft.reduced
        rows = [rotor.shaft.freedom(station) for station in rotor.shaft.bearings]
        for axis, off in (("x", 0), ("y", 2)):
            moved = modes.shapes @ [state[s.name] for s in rotor.coordinates(axis)]
            rate = modes.shapes @ [state[s.name] for s in rotor.rates_of(axis)]
            at = [state[f"u{axis}_{b}"] + (state[f"{axis}_{supports[b]}"] if supports[b] else 0) for b in rotor.bearings]
            force = np.linalg.solve(modes.residual[np.ix_(rows, rows)], at - moved[rows])
            moved = moved + modes.residual[:, rows] @ force
            for k in range(rotor.shaft.stations):
                j = full.at(i, k) + off
                q[j : j + 2], v[j : j + 2] = c * moved[2 * k : 2 * k + 2], c * clock * rate[2 * k : 2 * k + 2]
        if full.angles:  # arcs on the base circle, along the rotation
            radius = TEETH.module * TEETH.z[i] / 2 * np.cos(TEETH.alpha)
            arcs = rotor.shaft.twisting.shapes @ [state[s.name] for s in rotor.arcs]
            q[full.angles[i] : full.angles[i] + arcs.size] = np.sign(full.box.speeds[i]) * c * arcs / radius
    for (i, b), j in full.pedestals.items():
        name = f"pedestal{full.box.rotors[i].bearings.index(b) + 1}_{['pinion', 'gear'][i]}"
        q[j : j + 2] = [c * state[f"{axis}_{name}"] for axis in "xy"]
        v[j : j + 2] = [c * clock * state[f"v{axis}_{name}"] for axis in "xy"]
    return q, v


#: Those that take longest are slow tests.
SHORTER = pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow) if n in ("turning", "driven by the gear") else n for n in MACHINES]
)


@SHORTER
def test_eigenvalues_are_those_of_the_full_matrices(tmp_path, name, validate):
    """Every mode below 2.5 times the highest shaft speed: to 1 % where it is lightly damped, else to 3 %."""
    box = MACHINES[name]
    system, full = loaded(tmp_path, box), Matrices(box)
    linear = whirlmap.linear_analysis(system)
    rest = full.equilibrium(spread(system, full, linear.equilibrium)[0])
    expected = full.eigenvalues(rest, 1e-5)
    highest = max(map(abs, box.speeds))
    expected = expected[(np.abs(expected) < 2.5 * highest) & (expected.imag > -1e-6)]
    assert (expected.imag > 1e-3 * highest).sum() >= 5  # there are modes to compare
    ours = linear.eigenvalues * box.speed
    nearest = np.abs(ours[None] - expected[:, None])
    error, damping = nearest.min(axis=1) / np.abs(expected), -expected.real / np.abs(expected)
    assert np.unique(nearest.argmin(axis=1)).size == expected.size
    validate(f"machine from parts, {name}: relative error of its eigenvalues by reduction", error, 0, tier="independent",
             source="full finite-element matrices, written for this test",
             within=np.where(damping < 0.3, 0.01, 0.03))  # fmt: skip


@SHORTER
def test_journals_rest_where_those_of_the_full_matrices_do(tmp_path, name):
    box = MACHINES[name]
    system, full = loaded(tmp_path, box), Matrices(box)
    q = spread(system, full, whirlmap.linear_analysis(system).equilibrium)[0]
    rest = full.equilibrium(q)
    for rows, held, b, _ in full.journals():
        ours, theirs = (at[rows] - (at[held] if held is not None else 0) for at in (q, rest))
        assert 0.05 < np.hypot(*theirs) / b.c < 0.95
        np.testing.assert_allclose(ours, theirs, atol=1e-4 * b.c)


@pytest.mark.slow
@pytest.mark.timeout(1500)
def test_a_nonlinear_orbit_is_that_of_the_full_matrices(tmp_path):
    """Unbalances on both shafts, transmission error and four different films: one turn of the pinion.

    SciPy begins at the settled state of the reduced machine and integrates the full matrices with all their modes. Over six
    turns of the pinion, two of the gear, the largest difference was 0.37 % of the clearance (measured by hand; 2 minutes).
    """
    box = TWO_SHAFTS
    system, full = loaded(tmp_path, box), Matrices(box)
    turn = TEETH.z[0]
    motion = whirlmap.simulate(system, transient=12 * turn, periods=turn, every=4)
    x, n, c = motion["x"].values, full.n, box.rotors[0].bearings[0].c
    q, v = spread(system, full, x[0])
    end = turn * system.period / box.speed

    def rates(t, z):
        return np.concatenate([z[n:], full.acceleration(t, z[:n], z[n:])])

    sizes = np.concatenate([np.full(n, c), np.full(n, c * box.speed * TEETH.z[0])])
    z = solve_ivp(
        rates, (0, end), np.concatenate([q, v]), method="Radau", jac=lambda t, z: full.jacobian(z[:n], z[n:]),
        t_eval=np.linspace(0, end, x.shape[0]), rtol=1e-5, atol=1e-6 * sizes,
    ).y  # fmt: skip
    bearings = [f"bearing{i}_{shaft}" for shaft in ("pinion", "gear") for i in (1, 2)]
    for (rows, held, b, _), bearing in zip(full.journals(), bearings, strict=True):
        theirs = z[rows] - (z[held] if held is not None else 0)
        ours = c * np.stack([x[:, system.states.index(f"u{axis}_{bearing}")] for axis in "xy"])
        assert np.ptp(theirs, axis=1).min() > 0.03 * b.c  # it moves
        assert np.abs(ours - theirs).max() < 0.01 * b.c
