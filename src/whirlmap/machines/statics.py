"""Where the search for the static equilibrium of a machine begins: each journal on the static locus of its film.

The modes of the shafts, pressed by weight and teeth and held by the journals, are one linear system, in which each journal
moves along the tangent of the locus on which its film carries its load. A few damped steps of this, Newton's method in the
loads, come near the equilibrium, which is then found from there.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sympy import Expr, lambdify

from whirlmap.films.porous_short import film_integrals
from whirlmap.machines.assembly import Machine
from whirlmap.machines.parts.coefficients import CoefficientBearing
from whirlmap.machines.parts.rotor import OMEGA_0_2, Rotor
from whirlmap.machines.parts.support import Support
from whirlmap.models import mesh

Array = NDArray[np.float64]

#: Steps in the loads, and how much of a step is taken.
TURNS, TAKEN = 30, 0.7
#: Halvings of an eccentricity, and the largest one.
HALVINGS, DEEPEST = 30, 0.97


def static_start(machine: Machine) -> Callable[[Mapping[str, Array]], dict[str, Array]]:
    """Return ``start(values) -> states``: positions by name for parameters by name, arrays of shape (point,)."""
    return Statics(machine)


@dataclass(frozen=True, eq=False)
class Statics:
    """Statics of a machine, for many points at once."""

    machine: Machine

    @cached_property
    def places(self) -> dict[tuple[str, str], slice]:
        """Rows of the modes of each shaft along x and y, and of its rotation."""
        found, n = dict[tuple[str, str], slice](), 0
        for rotor in self.machine.rotors:
            for axis in "xy":
                found[rotor.name, axis] = slice(n, n + rotor.numbers.mass.size)
                n = found[rotor.name, axis].stop
            found[rotor.name, "arc"] = slice(n, n + len(rotor.arcs))
            n += len(rotor.arcs)
        return found

    def _of(self, values: Mapping[str, Array], parameter: object, other: float = 0.0) -> Array:
        return np.asarray(values.get(getattr(parameter, "name", ""), np.full(next(iter(values.values())).shape, other)))

    def __call__(self, values: Mapping[str, Array]) -> dict[str, Array]:
        """Positions at each point."""
        points = next(iter(values.values())).size
        n = max(place.stop for place in self.places.values())
        K, F = np.zeros((points, n, n)), np.zeros((points, n))
        for rotor in self.machine.rotors:
            self._shaft(values, rotor, K, F)
        self._teeth(values, K, F)
        self._couplings(values, K)
        springs = {b.name: self._spring(values, b) for b in self.machine.coefficients}
        for b in self.machine.coefficients:
            across = self._across(b)
            K += b.alike * np.einsum("an,pab,bm->pnm", across, springs[b.name], across)
        loads = {b.name: np.zeros((points, 2)) for b in (*self.machine.supporting, *self.machine.rubs)}
        held = {one.name: np.zeros((points, 2)) for one in self.machine.supports}
        for _ in range(TURNS):
            q, found = self._pressed(values, K, F, loads, held)
            for name, load in found.items():
                loads[name] = loads[name] + TAKEN * (load - loads[name])
            for b in self.machine.coefficients:
                loads[b.name] = np.einsum("pab,pb->pa", springs[b.name], q @ self._across(b).T)
            for one in self.machine.supports:
                held[one.name] = self._sunk(values, one, loads)
        return self._named(q, self._on_loci(values, loads), held)

    def _across(self, b: CoefficientBearing) -> Array:
        """Displacement of the station of a bearing along x and y, by the unknowns."""
        rotor = next(one for one in self.machine.rotors if one.name == b.shaft)
        across = np.zeros((2, max(place.stop for place in self.places.values())))
        for i, axis in enumerate("xy"):
            across[i, self.places[b.shaft, axis]] = rotor.numbers.shapes[b.station]
        return across

    def _spring(self, values: Mapping[str, Array], b: CoefficientBearing) -> Array:
        """Stiffness of a bearing by coefficients in series with its support, shape (point, 2, 2)."""

        def of(e: Expr) -> Array:
            names = sorted(q.name for q in e.free_symbols)
            found = lambdify(sorted(e.free_symbols, key=str), e, "numpy")(*(values[name] for name in names))
            return np.broadcast_to(np.asarray(found, dtype=float), next(iter(values.values())).shape)

        stiff = b.stiffness(of)
        held = next((one for one in self.machine.supports if one.name == b.support), None)
        if held is None:
            return stiff
        soft = np.stack([1 / self._of(values, held.kappa(axis)) for axis in "xy"], axis=1)
        return np.asarray(np.linalg.solve(np.eye(2) + stiff * soft[:, None, :], stiff))

    def _sunk(self, values: Mapping[str, Array], one: Support, loads: Mapping[str, Array]) -> Array:
        """Where a support rests under the loads of its bearings and its own weight."""
        pushed = sum((loads[name] for name in one.bearings), np.zeros_like(loads[one.bearings[0]]))
        pushed[:, 1] -= self._of(values, one.nu) * values["f"]
        return np.asarray(pushed / np.stack([self._of(values, one.kappa(axis)) for axis in "xy"], axis=1))

    def _pressed(
        self, values: Mapping[str, Array], K: Array, F: Array, loads: Mapping[str, Array], held: Mapping[str, Array]
    ) -> tuple[Array, dict[str, Array]]:
        """Modes and loads with every journal on the tangent of its locus, u = u(load) + S (new load - load).

        The load is that of the residual flexibility and of S in series: with the new load on the left side and the last
        one on the right, ((kappa R)^-1 + S) load = Phi q - support - u + S load.
        """
        K, F, springs = K.copy(), F.copy(), list[tuple[Any, ...]]()
        by_name = {b.name: b for b in self.machine.bearings}
        points, tangents = F.shape[0], self._tangents(values, loads)
        for rotor in self.machine.rotors:
            m, numbers, kappa = len(rotor.bearings), rotor.numbers, self._of(values, rotor.kappa)
            soft, away = np.zeros((points, 2 * m, 2 * m)), np.zeros((points, 2 * m))  # x of all journals, then y
            flexibility = np.linalg.inv(numbers.residual)
            for i in (0, m):
                soft[:, i : i + m, i : i + m] += flexibility / kappa[:, None, None]
            for i, (name, alike) in enumerate(zip(rotor.bearings, rotor.alike, strict=True)):
                b, load = by_name[name], loads[name]
                u, S = tangents[name]
                rest = u - np.einsum("pij,pj->pi", S, load)
                if b.support:
                    rest = rest + held[b.support]
                for j in (0, 1):
                    away[:, i + j * m] = -rest[:, j]
                    for k in (0, 1):
                        soft[:, i + j * m, i + k * m] += S[:, j, k] / alike
            stiff = np.linalg.inv(soft)
            shapes = np.zeros((2 * m, F.shape[1]))
            for i, axis in enumerate("xy"):
                shapes[i * m : (i + 1) * m, self.places[rotor.name, axis]] = numbers.shapes[list(rotor.shaft.bearings)]
            K += np.einsum("an,pab,bm->pnm", shapes, stiff, shapes)
            F -= np.einsum("an,pab,pb->pn", shapes, stiff, away)
            springs.append((rotor, stiff, away, shapes))
        q = np.einsum("pij,pj->pi", np.linalg.pinv(K), F)
        found = {}
        for rotor, stiff, away, shapes in springs:
            m = len(rotor.bearings)
            force = np.einsum("pab,pb->pa", stiff, q @ shapes.T + away)
            for i, (name, alike) in enumerate(zip(rotor.bearings, rotor.alike, strict=True)):
                found[name] = np.stack([force[:, i], force[:, i + m]], axis=1) / alike
        return q, found

    def _tangents(self, values: Mapping[str, Array], loads: Mapping[str, Array]) -> dict[str, tuple[Array, Array]]:
        """Place of each journal on its locus, and its derivative by the load, by central differences."""
        tried, steps = {}, {}
        for b in self.machine.bearings:
            load = loads[b.name]
            unit = self._of(values, b.Gamma) * values["s"] / 2
            steps[b.name] = 1e-4 * (np.hypot(*load.T) + 1e-2 * unit)
            along = np.array([[0, 0], [1, 0], [0, 1], [-1, 0], [0, -1]])
            tried[b.name] = load + steps[b.name][:, None] * along[:, None, :]
        found = {}
        for name, (at, *moved) in self._on_loci(values, tried).items():
            ahead, behind = np.stack(moved[:2], axis=2), np.stack(moved[2:], axis=2)
            found[name] = at, (ahead - behind) / (2 * steps[name][:, None, None])
        return found

    def _shaft(self, values: Mapping[str, Array], rotor: Rotor, K: Array, F: Array) -> None:
        numbers, kappa = rotor.numbers, self._of(values, rotor.kappa)
        for axis in "xy":
            place = self.places[rotor.name, axis]
            K[:, place, place] += kappa[:, None, None] * np.diag(numbers.stiffness)
        weight = self._of(values, rotor.nu) * values["f"]
        F[:, self.places[rotor.name, "y"]] -= weight[:, None] * numbers.weight
        if rotor.base is not None:
            modes, arc = rotor.shaft.twisting, self.places[rotor.name, "arc"]
            part = modes.mass / rotor.shaft.inertia * modes.frequency**2
            unit = self._of(values, rotor.iota) / self._of(values, OMEGA_0_2, 1.0)
            K[:, arc, arc] += unit[:, None, None] * np.diag(part)

    def _couplings(self, values: Mapping[str, Array], K: Array) -> None:
        rotors = {rotor.name: rotor for rotor in self.machine.rotors}
        for one in self.machine.couplings:
            for axis, stiff in (("arc", one.kappa), ("x", one.kappa_r), ("y", one.kappa_r)):
                across = np.zeros(K.shape[1])
                for name, station, sign in one.ends():
                    shaft, numbers = rotors[name].shaft, rotors[name].numbers
                    if axis != "arc":
                        across[self.places[name, axis]] += sign * numbers.shapes[station]
                    elif rotors[name].base is not None:
                        across[self.places[name, axis]] += sign * shaft.twisting.shapes[shaft.turning_station(station)]
                K += self._of(values, stiff)[:, None, None] * np.outer(across, across)

    def _teeth(self, values: Mapping[str, Array], K: Array, F: Array) -> None:
        rotors = {rotor.name: rotor for rotor in self.machine.rotors}
        for one in self.machine.meshes:
            stiff = self._of(values, one.Lambda)
            phi = self._of(values, one.own[mesh.phi_m])
            whole, none = np.ones_like(phi), np.zeros_like(phi)
            line, both = [(np.cos(phi), np.sin(phi))], [(whole, none), (none, whole)]
            for direction in line if one.kind == "line" else both:
                across = np.zeros(F.shape)
                for wheel, way in ((one.driver, 1.0), (one.driven, -1.0)):
                    shape = rotors[wheel.shaft].numbers.shapes[wheel.station]
                    for axis, part in zip("xy", direction, strict=True):
                        across[:, self.places[wheel.shaft, axis]] += way * part[:, None] * shape
                if one.kind == "line":
                    F -= self._of(values, one.own[mesh.F_0])[:, None] * across  # the torques balance its moments
                if one.turning:
                    for wheel, way in ((one.driver, 1.0), (one.driven, -1.0)):
                        shaft = rotors[wheel.shaft].shaft
                        shape = shaft.twisting.shapes[shaft.turning_station(wheel.station)]
                        arm = way * self._of(values, one.tau) * self._of(values, wheel.ratio(one.name), 1.0)
                        across[:, self.places[wheel.shaft, "arc"]] += arm[:, None] * shape
                K += stiff[:, None, None] * across[:, :, None] * across[:, None, :]

    def _on_loci(self, values: Mapping[str, Array], loads: Mapping[str, Array]) -> dict[str, Array]:
        """Where films carry loads at rest, over c_0: arrays of shape (..., point, 2), by the bearing."""
        bearings = self.machine.bearings
        size = {b.name: np.hypot(loads[b.name][..., 0], loads[b.name][..., 1]) for b in bearings}
        strength = {b.name: self._of(values, b.Gamma) * values["s"] / 2 * np.abs(self._of(values, b.spin)) for b in bearings}
        eps, attitude = {}, {}
        films = [b for b in bearings if b.kind != "damper" and b.film != "printed"]
        if films:  # all of them in one search
            load = np.stack([size[b.name] / strength[b.name] for b in films])
            psi = np.stack([np.broadcast_to(self._of(values, b.psi), size[b.name].shape) for b in films])
            for b, *found in zip(films, *_carrying(load, psi), strict=True):
                eps[b.name], attitude[b.name] = found
        places = {}
        for b in bearings:
            name, gamma, way = b.name, self._of(values, b.gamma), np.sign(self._of(values, b.spin))
            if b.kind == "damper":
                stiff = np.broadcast_to(self._of(values, b.kappa_c), size[name].shape)
                sag = np.divide(size[name], stiff, out=np.zeros_like(size[name]), where=stiff > 0)
                eps[name], attitude[name] = np.minimum(sag / gamma, DEEPEST), 0.0
            elif b.film == "printed":
                far = self._of(values, b.psi) * size[name] / (np.pi / 2 * strength[name])
                eps[name], attitude[name] = np.minimum(far, DEEPEST), np.pi / 2
            toward = np.arctan2(loads[name][..., 1], loads[name][..., 0]) + way * attitude[name]
            places[name] = (gamma * eps[name])[..., None] * np.stack([np.cos(toward), np.sin(toward)], axis=-1)
        return places

    def _named(self, q: Array, u: Mapping[str, Array], held: Mapping[str, Array]) -> dict[str, Array]:
        made: dict[str, Array] = {}
        for rotor in self.machine.rotors:
            for axis in "xy":
                states = rotor.coordinates(axis)
                made |= {s.name: q[:, self.places[rotor.name, axis]][:, i] for i, s in enumerate(states)}
            made |= {s.name: q[:, self.places[rotor.name, "arc"]][:, i] for i, s in enumerate(rotor.arcs)}
        for b in self.machine.bearings:
            made |= {s.name: u[b.name][:, i] for i, s in enumerate(b.u)}
        for one in self.machine.supports:
            made |= {s.name: held[one.name][:, i] for i, s in enumerate(one.centre)}
        return made


def _carrying(load: Array, psi: Array) -> tuple[Array, Array]:
    """Eccentricity at which a half film carries a load over A omega, and its attitude from the load; by halving."""
    low, high = np.zeros_like(load), np.full_like(load, DEEPEST)
    for _ in range(HALVINGS):
        eps = (low + high) / 2
        _, B, D = film_integrals(eps, psi)
        more = eps * np.hypot(B, D) < load
        low, high = np.where(more, eps, low), np.where(more, high, eps)
    eps = (low + high) / 2
    _, B, D = film_integrals(eps, psi)
    return eps, np.arctan2(D, -B)
