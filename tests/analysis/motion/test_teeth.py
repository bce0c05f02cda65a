"""Contact of teeth against the located crossings of a simulated motion, and the load of films against their law."""

import numpy as np
import pytest

import whirlmap
from whirlmap.films.porous_short import film_force
from whirlmap.sweep.speeds.safe_speeds import safe_speeds
from whirlmap.sweep.speeds.verdicts import Judge, Verdict, force_unit, shaft_speed

GEARBOX = "machines/turbo-gearbox"


def test_shares_agree_with_the_located_crossings():
    """With backlash the driving flanks are a declared surface, whose crossings `surface_crossings` times."""
    system = whirlmap.load(GEARBOX, stiffness="rectangular", backlash="dead_zone")
    at = np.array([3000.0, 5000.0, 9000.0]) * np.pi / 30 / shaft_speed(system)
    ds = Judge(system)({"s": at}, np.ones(3))
    assert [Verdict(int(v)).name for v in ds["verdict"].values] == ["safe", "separation", "safe"]
    assert ds["tooth_contact"].values[[0, 2]].tolist() == [1.0, 1.0]
    settled = dict(zip(system.states, ds["end_state"].values[1].tolist(), strict=True))
    parting = system.replace(start=settled, s=float(at[1]))
    series = whirlmap.simulate(parting, periods=system.common_multiple)
    share = float(whirlmap.surface_crossings(parting, series)["share"].sel(surface="drive_side"))
    assert 0.5 < share < 0.9 and float(ds["tooth_contact"][1]) == pytest.approx(share, abs=0.02)


def test_a_model_without_teeth_says_nothing_of_them():
    ds = safe_speeds(whirlmap.load("machines/jeffcott-rig"), [0.4, 0.5], 0.6, follow=False)
    assert np.isnan(ds["tooth_contact"].values).all() and (ds["verdict"] == Verdict.safe).all()


@pytest.mark.parametrize(
    ("case", "switches"),
    [
        ("gear-psfd/machine", {}), ("gear-psfd/machine", {"arc": "fixed"}),
        (GEARBOX, {"centring": "spring", "k_c1": "1e6 N/m", "k_c2": "2e6 N/m"}),
        ("machines/jeffcott-rig", {}), ("machines/jeffcott-rig", {"rotor": "rigid", "arc": "fixed"}),
        ("machines/jeffcott-rig", {"bearing": "damper", "K_c": "2e4 N/m"}),
    ],
)  # fmt: skip
def test_the_load_is_the_force_that_the_film_law_gives(case, switches):
    """Some 2000 loads over a common period equal the reference film's force at the same journal and its velocity."""
    system = whirlmap.load(case, **switches)
    series = whirlmap.simulate(system, transient=5 * system.common_multiple, periods=system.common_multiple)
    series = series.isel(time=slice(None, None, max(series.sizes["time"] // 2000, 1)))
    x, time = series["x"].values.T, series["time"].values
    rates = np.stack([system.rhs(t, column) for t, column in zip(time, x.T, strict=True)], axis=1)
    gears = "u1x" in system.states
    values = {name: float(v) for name, v in system.values.items()}
    for i, name in enumerate(("load_1", "load_2") if gears else ("load",)):
        u, v = x[2 * i : 2 * i + 2], rates[2 * i : 2 * i + 2]
        spin = values[("j_p", "j_g")[i]] if gears else float(switches.get("bearing") != "damper")
        gamma = values[f"Gamma_{i + 1}"] if gears else values["Gamma"]
        w = v[0] + spin * u[1] / 2, v[1] - spin * u[0] / 2
        force = film_force(*u, *w, values.get("psi", 0.0), arc=system.model.switches["arc"], sigma=np.sign(spin) or 1.0)
        # The gear pair's group counts the film's two integrals, the Jeffcott rotor's the force itself.
        expected = gamma * values["s"] * np.hypot(*force)
        np.testing.assert_allclose(series["outputs"].sel(output=name).values, expected / (2 if gears else 1), rtol=2e-6)


def test_loads_are_weights_at_rest():
    """The mean force on a bearing is the weight that it carries: half of the rotor's."""
    system = whirlmap.load("machines/jeffcott-rig", e_u="0.1 um")
    load = float(whirlmap.label_points(system, {"s": [1.5]})["max_load"][0, 0]) * force_unit(system)
    assert load == pytest.approx(0.8 * 9.81 / 2, rel=2e-2)


def test_teeth_that_hunt_part_too():
    """113 and 37 teeth repeat after 4181 T: their motion is locked, its teeth are judged over 8 turns of the slow shaft."""
    system = whirlmap.load(GEARBOX, stiffness="rectangular", backlash="dead_zone", z_p=37, z_g=113)
    ds = Judge(system)({"s": np.array([0.1, 0.15])}, np.ones(2))
    assert whirlmap.labels(ds).values.tolist() == ["locked"] * 2 and (ds["end_periods"] > 0).all()
    assert [Verdict(int(v)).name for v in ds["verdict"].values] == ["safe", "separation"]
    parting = system.replace(s=0.15)
    series = whirlmap.simulate(parting, transient=6000, periods=8 * 113)
    share = float(whirlmap.surface_crossings(parting, series)["share"].sel(surface="drive_side"))
    assert 0.3 < share < 0.9 and float(ds["tooth_contact"][1]) == pytest.approx(share, abs=0.02)
