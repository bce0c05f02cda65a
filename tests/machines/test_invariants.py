"""What any machine from parts must keep: without gravity no direction is special, a mirror image moves alike, energy."""

import numpy as np
import pytest
from tests.machines.wrong_machines import GOOD

import whirlmap
from whirlmap.machines.shafts import reduced_numbers

TURNING = GOOD.replace('reference = "pinion"', 'reference = "pinion"\ntorsion = "free"') + """
[[coupling]]
name = "motor"
shaft = "gear"
at = 0
k_t = "2e4 N*m/rad"
c_t = "3 N*m*s/rad"
"""
MORE = {
    "plain": GOOD,
    "turning": TURNING,
    "fixed arcs, cubic, rubbing": GOOD.replace('c = "50 um"', 'c = "50 um"\narc = "fixed"')
    .replace('k = "1e8 N/m"', 'k = "1e8 N/m"\nk3 = "1e17 N/m^3"')
    .replace('at = 0\nR = "25 mm"', 'at = 0\ncontact = "rub"\nK_r = "1e8 N/m"\nh_r = "8 um"\nmu_r = 0.2\nR = "25 mm"'),
}


@pytest.fixture(params=MORE)
def system(request, tmp_path):
    file = tmp_path / "machine.toml"
    file.write_text(MORE[request.param], encoding="utf-8")
    return whirlmap.load(file)


def random_state(system, rng):
    """Journals inside their clearances, all else of their size."""
    x = rng.uniform(-0.4, 0.4, len(system.states))
    for journal, one in system.model.journals.items():
        size, angle = rng.uniform(0.2, 0.95) * float(system.values[f"gamma_{journal}"]), rng.uniform(-np.pi, np.pi)
        for q, part in zip(one.u, (np.cos(angle), np.sin(angle)), strict=True):
            x[system.states.index(q.name)] = size * part
    return x


def pairs(system):
    """Places of the coordinates along x and along y, and of their rates."""
    at = system.states.index
    of_x = [n for n in system.states if n.lstrip("v").startswith(("x", "ux"))]
    return np.array([at(n) for n in of_x]), np.array([at(n.replace("x", "y", 1)) for n in of_x])


def test_without_gravity_no_direction_is_special(system):
    rng = np.random.default_rng(4)
    system = system.replace(f=0.0)
    x_at, y_at = pairs(system)
    turn = 0.83
    phases = {n: float(system.values[n]) + turn for n in system.parameters if n.startswith("phi_m")}
    # Unbalances have the same phase in the turned machine once its clock began earlier: here they are left out.
    system = system.replace(**{n: 0.0 for n in system.parameters if n.startswith("b_")})
    turned = system.replace(**phases)
    x, t = random_state(system, rng), 1.7

    def rotated(v):
        out = v.copy()
        out[x_at] = np.cos(turn) * v[x_at] - np.sin(turn) * v[y_at]
        out[y_at] = np.sin(turn) * v[x_at] + np.cos(turn) * v[y_at]
        return out

    got, expected = turned.reference_rhs(t, rotated(x)), rotated(system.reference_rhs(t, x))
    if "cubic" in str(system.case) or any(n.startswith("a_x") for n in system.parameters):
        # a cubic spring in x and in y is no round one: all rates but those of the support agree
        free = [i for i, n in enumerate(system.states) if n not in ("vx_pedestal", "vy_pedestal")]
        got, expected = got[free], expected[free]
    np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_a_mirror_image_moves_alike(system):
    """x to -x: shafts turn the other way, forces of teeth and unbalances point to the other side, gravity stays."""
    rng = np.random.default_rng(5)
    x_at, _ = pairs(system)
    changes = {n: -float(system.values[n]) for n in ("r_pinion", "r_gear")}
    changes |= {n: np.pi - float(system.values[n]) for n in system.parameters if n.startswith("phi_m")}
    if "chi_u" in system.parameters:
        changes |= {"chi_u": np.pi - float(system.values["chi_u"])}
    else:  # without a phase the unbalance points along x at time zero: its image is half a turn away
        system = system.replace(b_u=0.0)
    image, x, t = system.replace(**changes), random_state(system, rng), 2.3

    def mirrored(v):
        out = v.copy()
        out[x_at] *= -1
        return out

    expected = mirrored(system.reference_rhs(t, x))
    np.testing.assert_allclose(
        image.reference_rhs(t, mirrored(x)), expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max()
    )


class Energies:
    """Energy of a machine, and the power of what is no potential, from its parts: over K_0 c_0^2."""

    def __init__(self, system):
        self.system, self.v = system, {n: float(v) for n, v in system.values.items()}
        self.machine = system.machine.case.parts.machine

    def moved(self, state, rotor, station, kind=""):
        shapes = reduced_numbers(rotor.shaft).shapes[station]
        names = rotor.rates_of if kind else rotor.coordinates
        return np.array([shapes @ [state[q.name] for q in names(axis)] for axis in "xy"])

    def loads(self, state, rotor):
        """Force of the shaft on its journals, and what it is away from them."""
        n, held = reduced_numbers(rotor.shaft), {b.name: b.support for b in self.machine.bearings}
        away = []
        for station, b in zip(rotor.shaft.bearings, rotor.bearings, strict=True):
            at = np.array([state[f"u{a}_{b}"] + (state[f"{a}_{held[b]}"] if held[b] else 0) for a in "xy"])
            away.append(self.moved(state, rotor, station) - at)
        return self.v[f"kappa_{rotor.name}"] * n.residual @ np.array(away), np.array(away)

    def pressed(self, state):
        (m,), v = self.machine.meshes, self.v
        n = np.array([np.cos(v["phi_m_teeth"]), np.sin(v["phi_m_teeth"])])
        by_name = {r.name: r for r in self.machine.rotors}
        delta = rate = 0.0
        for wheel, way in ((m.driver, 1), (m.driven, -1)):
            rotor = by_name[wheel.shaft]
            delta += way * n @ self.moved(state, rotor, wheel.station)
            rate += way * n @ self.moved(state, rotor, wheel.station, "rate")
            if rotor.base is not None:
                shapes = rotor.shaft.twisting.shapes[rotor.shaft.turning_station(wheel.station)]
                delta += way * v["tau_teeth"] * shapes @ [state[q.name] for q in rotor.arcs]
        return delta, rate

    def energy(self, x):
        state, v, s2 = dict(zip(self.system.states, x, strict=True)), self.v, self.v["s"] ** 2
        total = 0.0
        for rotor in self.machine.rotors:
            n, name = reduced_numbers(rotor.shaft), rotor.name
            for axis in "xy":
                q = np.array([state[k.name] for k in rotor.coordinates(axis)])
                rate = np.array([state[k.name] for k in rotor.rates_of(axis)])
                total += v[f"nu_{name}"] * s2 * (n.mass * rate**2).sum() / 2
                total += v[f"kappa_{name}"] * (n.stiffness * q**2).sum() / 2
            total += v[f"nu_{name}"] * v["f"] * (n.weight * [state[k.name] for k in rotor.coordinates("y")]).sum()
            load, away = self.loads(state, rotor)
            total += (load * away).sum() / 2
            if rotor.base is not None:
                modes, J = rotor.shaft.twisting, rotor.shaft.inertia
                q, rate = (np.array([state[k.name] for k in some]) for some in (rotor.arcs, rotor.arc_rates))
                squares = s2 * rate**2 + modes.frequency**2 / v["omega_0_2"] * q**2
                total += v[f"iota_{name}"] * (modes.mass / J * squares).sum() / 2
        for one in self.machine.supports:
            nu = v[f"nu_{one.name}"]
            for axis in "xy":
                q, rate = state[f"{axis}_{one.name}"], state[f"v{axis}_{one.name}"]
                total += nu * s2 * rate**2 / 2 + v[f"kappa_{axis}_{one.name}"] * q**2 / 2
                total += v.get(f"a_{axis}_{one.name}", 0.0) * nu * q**4 / 4
            total += nu * v["f"] * state[f"y_{one.name}"]
        for one in self.machine.couplings:
            rotor = next(r for r in self.machine.rotors if r.name == one.shaft)
            arc = rotor.shaft.twisting.shapes[one.station] @ [state[k.name] for k in rotor.arcs]
            total += v[f"kappa_t_{one.name}"] * arc**2 / 2
        delta, _ = self.pressed(state)
        total += v["Lambda_teeth"] * delta**2 / 2
        return total + self.transmitted(state)

    def transmitted(self, state):
        """Potential of the transmitted load, which presses the teeth and has its moments balanced by the torques."""
        n = np.array([np.cos(self.v["phi_m_teeth"]), np.sin(self.v["phi_m_teeth"])])
        (m,), by_name = self.machine.meshes, {r.name: r for r in self.machine.rotors}
        apart = self.moved(state, by_name[m.driver.shaft], m.driver.station)
        return self.v["F_0_teeth"] * n @ (apart - self.moved(state, by_name[m.driven.shaft], m.driven.station))

    def power(self, t, x, rates):
        """Of films, dampers and unbalance, per clock radian."""
        state, rate_of, v = (dict(zip(self.system.states, a, strict=True)) for a in (x, rates)), None, self.v
        state, rate_of = state
        total = 0.0
        for rotor in self.machine.rotors:
            load, _ = self.loads(state, rotor)
            for one, b in zip(load, rotor.bearings, strict=True):
                total -= one @ [rate_of[f"u{a}_{b}"] for a in "xy"]  # the film takes what the shaft gives to the journal
        for one in self.machine.supports:
            for a in "xy":
                total -= 2 * v[f"xi_{a}_{one.name}"] * v["s"] * state[f"v{a}_{one.name}"] ** 2
        for one in self.machine.couplings:
            rotor = next(r for r in self.machine.rotors if r.name == one.shaft)
            total -= 2 * v[f"xi_t_{one.name}"] * v["s"] * (
                rotor.shaft.twisting.shapes[one.station] @ [state[k.name] for k in rotor.arc_rates]
            ) ** 2  # fmt: skip
        for one in self.machine.unbalances:
            rotor = next(r for r in self.machine.rotors if r.name == one.shaft)
            r = v[f"r_{one.shaft}"]
            force = v[f"nu_{one.shaft}"] * v[f"b_{one.name}"] * r**2 * v["s"] ** 2 * np.array([np.cos(r * t), np.sin(r * t)])
            total += force @ self.moved(state, rotor, one.station, "rate")
        return total


def test_energy_balances(system):
    """Rate of kinetic and elastic energy is the power of films, dampers and unbalance: forces act in opposite pairs."""
    rng, both = np.random.default_rng(6), Energies(system)
    for _ in range(4):
        x, t = random_state(system, rng), rng.uniform(0, 30)
        rates = system.reference_rhs(t, x)
        step = 0.1 / np.abs(rates).max()
        ends = [both.energy(x + sign * k * step * rates) for k in (1, 2) for sign in (1, -1)]
        change = (8 * (ends[0] - ends[1]) - (ends[2] - ends[3])) / (12 * step)
        expected = both.power(t, x, rates)
        rounding = 1e-16 * max(map(abs, ends)) / step  # differences of a polynomial of degree four are exact
        assert change == pytest.approx(expected, rel=1e-10, abs=30 * rounding)
        assert abs(expected) > 1e6 * rounding
