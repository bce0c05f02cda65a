"""Damped eigenvalues, thresholds and film coefficients against ROSS, a finite-element code for rotors.

ROSS is no dependency. What it answered is kept in `ross_values.json`, with what it was asked; both are compared with
whirlmap here. Where the environment variable ROSS_PYTHON names a Python that has ROSS, it is asked again. To renew, here::

    python test_ross.py | $ROSS_PYTHON ross_rotors.py > ross_values.json
"""

import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import whirlmap

HERE = Path(__file__).parent
KEPT = HERE / "ross_values.json"
#: Speeds [rpm].
RIG_SPEEDS = (1200, 1800, 3000, 5000)
GEARBOX_SPEEDS = (3000, 6000, 9000)
APART_SPEEDS = (3000, 6000)
#: A stiffer shaft and a thicker oil put the rig's oil whip, at these parts of its threshold, within reach of the journals.
WHIP = {"arc": "fixed", "K": "5 kN/mm", "mu": "0.03 Pa*s"}
NEAR = (0.998, 1.002)


def rig(**changes):
    return whirlmap.load("machines/jeffcott-rig", **changes)


def gearbox(rpm):
    """As ROSS's pair of gears: no mesh damping, rigid housings, and next to nothing that holds the common rotation."""
    return whirlmap.load(
        "machines/turbo-gearbox", speed=f"{rpm} rpm", T_p="63.662 N*m", C_m="0 N*s/m", k_1="1e16 N/m", arc="fixed",
        k_tp="1 N*m/rad", k_tg="0 N*m/rad", c_tp="0 N*m*s/rad", c_tg="0 N*m*s/rad",
    )  # fmt: skip


def apart(rpm):
    """The two rotors of the reference machine without their mesh, each on its own."""
    return whirlmap.load(
        "gear-psfd/machine", speed=f"{rpm} rpm", K_m="0 N/m", C_m="0 N*s/m", suspension="linear", arc="fixed"
    )  # fmt: skip


def numbers(system):
    return {name: given.value for name, given in system.machine.inputs.items()}


def of_rig(system):
    q = numbers(system)
    omega = float(system.values["s"]) * np.sqrt(q["g"] / q["c"])
    return {"M": q["M"], "K": q["K"], "C": q["C"], "speed": omega, "film": whirlmap.ross_bearing(system)}


def rotor(system, side, i):
    q = numbers(system)
    r = side[0]
    inertia = {"J": q[f"J_{r}"]} if f"J_{r}" in q else {}
    return {
        "m": q[f"m_{r}"], "z": int(q[f"z_{r}"]), "K": q[f"K_{r}"], "C": q[f"C_{r}"], "k": q[f"k_{i}1"], "c": q[f"c_{i}"],
        "m_h": q[f"m_{i}"], "film": whirlmap.ross_bearing(system, i), "speed": q["speed"], **inertia,
    }  # fmt: skip


def of_gearbox(system):
    q = numbers(system)
    sides = {"pinion": rotor(system, "pinion", "1"), "gear": rotor(system, "gear", "2")}
    return {**sides, **{name: q[name] for name in ("K_m", "module", "alpha", "beta_c", "speed")}}


def of_bearing(system):
    q = numbers(system)
    return {name: q[name] for name in ("L", "R", "c", "mu", "speed")} | {"W": q["M"] * q["g"] / 2}


def threshold():
    system = rig(**WHIP)
    return system, whirlmap.stability_threshold(system, "s", (0.5, 6.0))


def systems():
    whip, limit = threshold()
    rigs = [rig(speed=f"{rpm} rpm") for rpm in RIG_SPEEDS]
    return {
        "jeffcott": [*rigs, *(whip.replace(s=limit * ratio) for ratio in NEAR)],
        "gearbox": [gearbox(rpm) for rpm in GEARBOX_SPEEDS],
        "on_housings": [apart(rpm) for rpm in APART_SPEEDS],
        "bearing": rigs,
    }


def asked():
    many = systems()
    return {
        "jeffcott": [of_rig(system) for system in many["jeffcott"]],
        "gearbox": [of_gearbox(system) for system in many["gearbox"]],
        "on_housings": [rotor(s, *side) for s in many["on_housings"] for side in (("pinion", "1"), ("gear", "2"))],
        "bearing": [of_bearing(system) for system in many["bearing"]],
    }


@pytest.fixture(scope="module")
def kept():
    return json.loads(KEPT.read_text())


def same(one, other, rtol):
    """Compare plain data, numbers to a relative tolerance."""
    if isinstance(one, dict):
        assert one.keys() == other.keys()
        for key in one:
            same(one[key], other[key], rtol)
    elif isinstance(one, list):
        assert len(one) == len(other)
        for a, b in zip(one, other, strict=True):
            same(a, b, rtol)
    else:
        assert one == pytest.approx(other, rel=rtol, abs=0.0)


def both(kept, name):
    """What was asked about the machines of one kind, and what was answered."""
    return kept["asked"][name], kept["answered"][name]


def matched(system, speed, answered, slowest=1.0):
    """Relative distance of each eigenvalue of whirlmap [rad/s] to one of ROSS's own, and how many there are."""
    theirs = np.array([complex(*z) for z in answered])
    ours = whirlmap.linear_analysis(system).eigenvalues * speed
    ours = ours[(np.abs(ours) > slowest) & (np.abs(ours) < 2e4)]  # the range that ross_rotors.py keeps
    away = np.abs(ours[:, None] - theirs)
    nearest = away.argmin(axis=1)
    assert np.unique(nearest).size == ours.size  # no two of them are the same one
    return away.min(axis=1) / np.abs(ours), ours.size


def test_ross_was_asked_about_the_machines_of_today(kept):
    """Films to the accuracy of the equilibrium, all else as it stands in the cases."""
    same(json.loads(json.dumps(asked())), kept["asked"], rtol=1e-7)


def test_jeffcott_rotors_have_the_eigenvalues_of_ross(kept, validate):
    for system, q, answered in zip(systems()["jeffcott"], *both(kept, "jeffcott"), strict=True):
        distance, count = matched(system, q["speed"], answered)
        assert count >= 5  # six, one of which is beyond the range where the shaft is stiff
        validate(f"Jeffcott rig at {q['speed']:.5g} rad/s: relative distance of its eigenvalues from ROSS's", distance, 0,
                 tier="independent", source="ROSS, finite elements", within=5e-6)  # fmt: skip


def test_rotors_in_flexible_housings_have_the_eigenvalues_of_ross(kept, validate):
    """Pinion and gear, of which the gear turns backwards, without their mesh: all 20 eigenvalues."""
    rotors = zip(*both(kept, "on_housings"), strict=True)
    for system, (q, pinion), (_, gear) in zip(systems()["on_housings"], rotors, rotors, strict=False):
        distance, count = matched(system, q["speed"], [*pinion, *gear])
        assert count == 20
        validate(f"rotors in flexible housings at {q['speed']:.5g} rad/s: relative distance of eigenvalues from ROSS's",
                 distance, 0, tier="independent", source="ROSS, finite elements", within=5e-6)  # fmt: skip


def test_the_gearbox_has_the_eigenvalues_of_ross(kept, validate):
    """Line of action, torsion, both senses of rotation: all but the common rotation and the rigid housings."""
    for system, q, answered in zip(systems()["gearbox"], *both(kept, "gearbox"), strict=True):
        distance, count = matched(system, q["speed"], answered, slowest=10.0)
        assert count == 14
        validate(f"turbo gearbox at {q['speed']:.5g} rad/s: relative distance of its eigenvalues from ROSS's", distance, 0,
                 tier="independent", source="ROSS, finite elements with gear elements", within=5e-5)  # fmt: skip


def test_the_oil_whip_threshold_is_that_of_ross(kept, validate):
    """ROSS's growth rate passes zero where `stability_threshold` finds it."""
    growth = [max(re for re, _ in answered) for answered in kept["answered"]["jeffcott"][-2:]]
    assert growth[0] < 0 < growth[1]
    validate("Jeffcott rig: threshold of oil whip, ROSS's over whirlmap's", np.interp(0.0, growth, NEAR), 1.0,
             tier="independent", source="ROSS, finite elements", within=1e-5)  # fmt: skip


def test_coefficients_are_those_of_the_short_bearing_of_ross(kept, validate):
    """A closed form of other authors, Friswell et al. 2010, p. 177."""
    for system, answered in zip(systems()["bearing"], kept["answered"]["bearing"], strict=True):
        assert whirlmap.film_coefficients(system)["1"].eccentricity == pytest.approx(answered["eccentricity"], rel=1e-9)
        ours = whirlmap.ross_bearing(system)
        validate(f"short bearing at s = {float(system.values['s']):.4g}: stiffness and damping in SI",
                 list(ours.values()), [answered[name] for name in ours], tier="independent",
                 source="ROSS; Friswell et al. 2010, p. 177", rel=1e-8)  # fmt: skip


@pytest.mark.skipif("ROSS_PYTHON" not in os.environ, reason="ROSS_PYTHON names no Python that has ROSS")
def test_ross_still_answers_what_is_kept(kept):
    command = [os.environ["ROSS_PYTHON"], str(HERE / "ross_rotors.py")]
    done = subprocess.run(command, input=json.dumps(kept["asked"]), capture_output=True, text=True, check=True)
    fresh = json.loads(done.stdout)["answered"]
    same(fresh["bearing"], kept["answered"]["bearing"], rtol=1e-9)
    for name in ("jeffcott", "on_housings", "gearbox"):  # axial motion, which nothing holds, is zero to rounding
        for one, other in zip(fresh[name], kept["answered"][name], strict=True):
            ours, theirs = ([complex(*z) for z in many if abs(complex(*z)) > 10.0] for many in (one, other))
            np.testing.assert_allclose(np.sort_complex(ours), np.sort_complex(theirs), rtol=1e-5, atol=0.1)


if __name__ == "__main__":
    print(json.dumps(asked()))
