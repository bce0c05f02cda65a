"""One assumption that does not hold, and the numbers of a system by which that is decided."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from sympy import sympify

from whirlmap.equations.groups import Bearing
from whirlmap.equations.parts import OfMachine
from whirlmap.integrate.equilibrium import rest_state
from whirlmap.integrate.harmonics import frequencies
from whirlmap.integrate.system import System

if TYPE_CHECKING:
    from collections.abc import Iterable

    import xarray as xr

Results = Union["xr.Dataset", Mapping[Any, "xr.Dataset"], "Iterable[xr.Dataset]", None]


@dataclass(frozen=True)
class Violation:
    """One assumption of the model that does not hold.

    Attributes
    ----------
    name : str
        What is violated: ``"slenderness_1"``, ``"mesh_load"``, ...; ``"not_evaluated"`` stands for all that
        could not be looked at.
    value, limit : float
        What was found, and where the assumption ends; NaN where there is no number.
    sentence : str
        What it means, for people.
    """

    name: str
    value: float
    limit: float
    sentence: str

    @property
    def text(self) -> str:
        """Name and sentence, as commands print them."""
        return f"{self.name}: {self.sentence}"


@dataclass(frozen=True)
class BearingNumbers:
    """Dimensions and oil of one bearing in SI, and the speed of its journal over the clock's.

    ``name`` is what violations end in: ``"_1"``, or nothing where all bearings are alike. ``words`` name it in a sentence.
    ``oil`` are the other numbers that the case has of its oil, such as its grade, by their names without the oil's own.
    """

    name: str
    words: str
    R: float
    L: float
    c: float
    mu: float
    spin: float
    eccentricity: str
    rho: float | None
    oil: Mapping[str, float]


@dataclass(frozen=True)
class JournalName:
    """Name of the output that is a journal's eccentricity, what violations of it end in, and what a sentence calls it."""

    output: str
    name: str
    words: str


@dataclass(frozen=True)
class Facts:
    """Numbers of one system, and of the results that were computed with it.

    Attributes
    ----------
    system : System
    values, switches, inputs, quantities : mapping
        Parameters; choices; dimensional inputs and results in SI, where the case has them.
    s : float
        The largest speed ratio that was run; 1 of a model that declares no speed.
    """

    system: System
    values: Mapping[str, float]
    switches: Mapping[str, str]
    inputs: Mapping[str, float]
    quantities: Mapping[str, float]
    s: float

    @classmethod
    def of(cls, system: System, runs: "list[xr.Dataset]") -> "Facts":
        """Read a system, and the largest speed of its results."""
        settled, name = system.machine, system.speed
        values = {name: float(value) for name, value in system.values.items()}
        speeds = [float(run[name].max()) for run in runs if name in run.coords]
        return cls(
            system=system,
            values=values,
            switches=dict(system.model.switches),
            inputs={name: given.value for name, given in settled.inputs.items()} if settled else {},
            quantities={name: value for name, (value, _) in settled.quantities.items()} if settled else {},
            s=max([values.get(name, 1.0), *speeds]),
        )

    @property
    def clock(self) -> float | None:
        """Speed of the clock in rad/s."""
        unit = next(iter(self.results("unit_speed").values()), None)
        return None if unit is None else self.s * unit

    def results(self, role: OfMachine) -> Mapping[str, float]:
        """Dimensional results of the case that have a role, by the bearing of each."""
        return self.system.machine.results(role) if self.system.machine else {}

    @property
    def shaft_speed(self) -> float | None:
        """Speed of the first shaft in rad/s at s = 1."""
        settled, name = self.system.machine, self.system.speed
        if not (settled and name):
            return None
        return next((value / float(settled.values[name]) for value in self.results("shaft_speed").values()), None)

    @property
    def fastest(self) -> float:
        """Angular frequency of the fastest harmonic over the clock's."""
        return float(np.abs(frequencies(self.system.model, self.system.vector[:, None])).max())

    @property
    def declared(self) -> Mapping[str, Bearing]:
        """Bearings that the case's family declares."""
        return self.system.machine.bearings if self.system.machine else {}

    @property
    def plain(self) -> bool:
        """Whether no bearing has a porous ring that oil flows through."""
        rings = [*(b.psi for b in self.declared.values()), *(film.psi for film in self.system.model.films.values())]
        return all(self.value(psi) == 0.0 for psi in rings)

    @cached_property
    def bearings(self) -> tuple[BearingNumbers, ...]:
        """Bearings whose dimensions the case gives."""
        declared, found = self.declared, []
        for name, b in declared.items():
            if not {q.name for q in (b.R, b.L, b.c, b.mu)} <= self.inputs.keys():
                continue
            ending, words = ("", "The bearing") if len(declared) == 1 else (f"_{name}", f"Bearing {name}")
            R, L, c, mu = (self.inputs[q.name] for q in (b.R, b.L, b.c, b.mu))
            rho = self.inputs.get(b.rho.name)
            of = b.mu.name.removesuffix("mu")  # "" or "lubricant.", before every number of that oil
            oil = {n.removeprefix(of): v for n, v in self.inputs.items() if n.startswith(of)}
            found.append(BearingNumbers(ending, words, R, L, c, mu, self.value(b.spin), b.eccentricity, rho, oil))
        return tuple(found)

    def value(self, expression: Any) -> float:
        """Evaluate an expression of parameters."""
        return float(sympify(expression).subs({p: self.values[p.name] for p in self.system.model.parameters}))

    @cached_property
    def rest(self) -> Mapping[str, float] | None:
        """States of the static equilibrium at the system's own speed; None where there is none."""
        return rest_state(self.system)

    @cached_property
    def rest_at_speed(self) -> Mapping[str, float] | None:
        """The same at the largest speed that was run."""
        name = self.system.speed
        return self.rest if self.s == self.values.get(name, 1.0) else rest_state(self.system.at_speed(self.s))

    @property
    def at(self) -> str:
        """The largest speed that was run, as sentences say it: ``s = 1.5``."""
        return f"{self.system.speed or 's'} = {self.s:.4g}"

    def output(self, name: str, rest: Mapping[str, float]) -> float:
        """Evaluate an output of the model at rest."""
        model = self.system.model
        at = {state: rest[state.name] for state in model.states}
        at |= {p: self.values[p.name] for p in model.parameters}
        return float(model.outputs[name].expression.subs(at))

    def eccentricities(self) -> dict[str, float]:
        """Eccentricity of every journal at rest, by the name of its output."""
        rest = self.rest
        return {one.output: self.output(one.output, rest) for one in self.journals} if rest is not None else {}

    @property
    def journals(self) -> list[JournalName]:
        """Journals whose eccentricity the model declares."""
        found = self.system.model.outputs_of("eccentricity")
        if len(found) == 1:
            return [JournalName(output, "", "The journal") for output in found.values()]
        return [JournalName(output, f"_{bearing}", f"Journal {bearing}") for bearing, output in found.items()]
