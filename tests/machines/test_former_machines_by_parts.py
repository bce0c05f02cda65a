"""Machines that have declarations of their own, said by parts: the same rates at the same states."""

import numpy as np
import pytest
from tests.machines.pair_by_parts import STATES as OF_PAIR

import whirlmap
from whirlmap.models import family

OPERATION = {"speed": "rad/s", "g": "m/s^2"}


def inputs(case, **changes):
    """A stock case, and its inputs in SI; a symbol that is an input too stands among the values of the system."""
    system = whirlmap.load(case, **changes)
    return system, {k: float(v) for k, v in system.values.items()} | {k: v.value for k, v in system.machine.inputs.items()}


def table(head, numbers, **words):
    """A table of a case file, of numbers with their units and of words."""
    lines = [f'{key} = "{word}"' if isinstance(word, str) else f"{key} = {word}" for key, word in words.items()]
    lines += [f'{key} = "{value!r} {unit}"' if unit else f"{key} = {value!r}" for key, (value, unit) in numbers.items()]
    return "\n".join([head, *lines, ""])


def a_rotor(q):
    """A Jeffcott rotor by parts: one lumped rotor, and one bearing that stands for both."""
    bearing = {key: (q[key], "m") for key in "RLc"}
    return "\n".join([
        'model = "machine"',
        table("[operation]", {key: (q[key], unit) for key, unit in OPERATION.items()}),
        table("[lubricant]", {"mu": (q["mu"], "Pa*s")}),
        table("[[shaft]]", {"m": (q["M"], "kg"), "K": (2 * q["K"], "N/m"), "C": (q["C"], "N*s/m")}, name="rotor"),
        table("[[bearing]]", bearing, name="b", shaft="rotor", two_alike=2),
        table("[[unbalance]]", {"e": (q["e_u"], "m")}, name="u", shaft="rotor"),
    ])  # fmt: skip


OF_ROTOR = {"ux_b": "ux", "uy_b": "uy", "x_rotor": "x", "y_rotor": "y", "vx_rotor": "vx", "vy_rotor": "vy"}


def a_gearbox(q, stiffness, backlash):
    """The turbo gearbox by parts."""
    made = [
        'model = "machine"',
        table("[operation]", {key: (q[key], unit) for key, unit in OPERATION.items()}, reference="pinion", torsion="free"),
        table("[lubricant]", {"mu": (q["mu"], "Pa*s")}),
    ]
    for i, p, name in ((1, "p", "pinion"), (2, "g", "gear")):
        shaft = {
            "m": (q[f"m_{p}"], "kg"),
            "K": (q[f"K_{p}"], "N/m"),
            "C": (q[f"C_{p}"], "N*s/m"),
            "J": (q[f"J_{p}"], "kg*m^2"),
        }
        housing = {"m": (q[f"m_{i}"], "kg"), "k": (q[f"k_{i}1"], "N/m"), "c": (q[f"c_{i}"], "N*s/m")}
        bearing = {"R": (q[f"R_{i}"], "m"), "L": (q[f"L_{i}"], "m"), "c": (q["c"], "m")}
        holding = {"k_t": (q[f"k_t{p}"], "N*m/rad"), "c_t": (q[f"c_t{p}"], "N*m*s/rad")}
        made += [
            table("[[shaft]]", shaft, name=name),
            table("[[bearing]]", bearing, name=f"b{i}", shaft=name, support=f"h{i}", two_alike=2),
            table("[[support]]", housing, name=f"h{i}"),
            table("[[coupling]]", holding, name=f"to_{name}", shaft=name),
            table("[[unbalance]]", {"e": (q[f"e_u{p}"], "m")}, name=f"u{p}", shaft=name),
        ]
    units = {"module": "m", "alpha": "rad", "beta_c": "rad", "K_m": "N/m", "C_m": "N*s/m", "e_TE": "m"}
    teeth = {"T": (q["T_p"], "N*m"), **{key: (q[key], unit) for key, unit in units.items()}}
    needed = {"constant": (), "fourier": ("v_1",), "rectangular": ("CR",)}[stiffness]  # the others have defaults
    teeth |= {key: (q[key], "") for key in needed}
    teeth |= {"j_n": (q["j_n"], "m")} if backlash == "dead_zone" else {}
    z = [int(q["z_p"]), int(q["z_g"])]
    made.append(
        table("[[mesh]]", teeth, name="teeth", driver="pinion", driven="gear", z=z, stiffness=stiffness, backlash=backlash)
    )
    return "\n".join(made)


def compared(case, parts, former):
    """Largest difference of the rates over max(1, |rate|), at random states, journals from the middle to the wall.

    ``former`` are names of states by those of the parts. Both count lengths in the same clearance and time in radians of
    the same shaft; arcs of rotation count along the rotation in one, along the force of the teeth in the other.
    """
    rng, worst = np.random.default_rng(11), 0.0
    assert sorted(former[n] for n in parts.states) == sorted(case.states)
    sense = np.array([float(parts.values.get("tau_teeth", 1.0)) if "q" in n else 1.0 for n in parts.states])
    order = [case.states.index(former[n]) for n in parts.states]
    for _ in range(40):
        t, x = rng.uniform(0, 50), rng.uniform(-0.6, 0.6, len(case.states))
        for i in (i for i, n in enumerate(case.states) if n.startswith("u") and n.endswith("x")):
            size, angle = 1 - 10 ** rng.uniform(-2, 0), rng.uniform(-np.pi, np.pi)
            x[i : i + 2] = size * np.cos(angle), size * np.sin(angle)
        expected = sense * case.reference_rhs(t, x)[order]
        got = parts.reference_rhs(t, sense * x[order])
        worst = max(worst, float(np.max(np.abs(got - expected) / np.maximum(1.0, np.abs(expected)))))
    return worst


#: The rotor on dampers by its former declaration; `machines/aero-damper` is the same by parts.
AERO = {
    "bearing": "damper", "M": "40 kg", "K": "2e7 N/m", "C": "400 N*s/m", "R": "60 mm", "L": "30 mm", "c": "120 um",
    "K_c": "4e6 N/m", "nu_40": "25 mm^2/s", "nu_100": "5 mm^2/s", "T_oil": "90 degC", "rho": "940 kg/m^3", "G": "2.5 mm/s",
    "speed": "12000 rpm", "speed_max": "15000 rpm", "g": "9.81 m/s^2",
}  # fmt: skip


@pytest.mark.parametrize("changes", [{}, {"arc": "fixed", "speed": "5400 rpm"}], ids=["as it is", "other arc"])
def test_the_rig_has_the_rates_of_its_declaration(tmp_path, changes):
    case, q = inputs("machines/jeffcott-rig", **changes)
    file = tmp_path / "rotor.toml"
    file.write_text(a_rotor(q), encoding="utf-8")
    parts = whirlmap.load(file, **{"bearing.b.arc": "fixed"} if "arc" in changes else {})
    assert compared(case, parts, OF_ROTOR) < 1e-12


@pytest.mark.parametrize("changes", [{}, {"G": "100 mm/s", "speed": "9000 rpm"}], ids=["as it is", "large unbalance"])
def test_the_rotor_on_dampers_has_the_rates_of_its_former_declaration(changes):
    case = whirlmap.load(family("jeffcott"), **AERO | changes)
    parts = whirlmap.load("machines/aero-damper", **{{"G": "unbalance.of_rotor.G"}.get(k, k): v for k, v in changes.items()})
    former = {name.replace("_b", "_ring"): other for name, other in OF_ROTOR.items()}
    assert compared(case, parts, former) < 1e-12


@pytest.mark.parametrize("stiffness", ["constant", "fourier", "rectangular"])
@pytest.mark.parametrize("backlash", ["none", "dead_zone"])
def test_the_turbo_gearbox_has_the_rates_of_its_declaration(tmp_path, stiffness, backlash):
    numbers = {"v_1": 0.3} if stiffness == "fourier" else {}
    case, q = inputs("machines/turbo-gearbox", stiffness=stiffness, backlash=backlash, **numbers)
    file = tmp_path / "gearbox.toml"
    file.write_text(a_gearbox(q, stiffness, backlash), encoding="utf-8")
    parts = whirlmap.load(file)
    assert compared(case, parts, OF_PAIR) < 1e-12
    assert (parts.period, parts.common_multiple) == (case.period, case.common_multiple)
