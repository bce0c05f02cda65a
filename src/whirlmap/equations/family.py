"""A family: models that differ by declared switches."""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from itertools import islice, product

from whirlmap.equations.groups import Groups
from whirlmap.equations.model import Model
from whirlmap.equations.quantities import Parameter
from whirlmap.errors import ModelError, nearest
from whirlmap.results.listing import Listed, Listing, Rows

#: Quantities that one hint names.
SHOWN = 4
#: Choices of switches that `Family.symbols` declares at most.
TRIED = 64


@dataclass(frozen=True, repr=False)
class Family(Listed):
    """Models that differ by declared switches, so that their difference can be read in one place.

    Attributes
    ----------
    name : str
        Name of the model in case files.
    declare : callable
        ``declare(**switches) -> Model``.
    switches : mapping of str to tuple of str
        Choices for each switch, the default first; a callable default depends on the switches before it.
    meanings : mapping of str to str
        What each switch chooses.
    groups : Groups, optional
        Dimensional inputs, and the parameters that follow from them.
    vocabulary : tuple of Parameter
        Parameters that only some of the models have. Needed where the switches have more choices together than are
        worth declaring (`TRIED`); found by declaring all of them otherwise.
    absent : mapping of str to str
        Beginnings of words for what users look for and the model does not have, and a sentence that says so.
    """

    name: str
    declare: Callable[..., Model]
    switches: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    meanings: Mapping[str, str] = field(default_factory=dict)
    default: Callable[[Mapping[str, str]], Mapping[str, str]] = lambda _: {}
    groups: Groups | None = None
    vocabulary: tuple[Parameter, ...] = ()
    absent: Mapping[str, str] = field(default_factory=dict)
    _made: dict[tuple[tuple[str, str], ...], Model] = field(default_factory=dict, repr=False, compare=False)

    def model(self, **chosen: str) -> Model:
        """Declare the model for these switches; those that are not given take their defaults.

        Raises
        ------
        ModelError
            Where a switch or a choice is unknown, or the groups say something of what the model does not have.
        """
        for name, value in chosen.items():
            if name not in self.switches:
                raise ModelError(f"model {self.name!r} has no switch {name!r}.{self.hint(name, self.switches, value)}")
            if value not in self.switches[name]:
                allowed = " | ".join(self.switches[name])
                raise ModelError(
                    f"switch {name!r} of {self.name!r} cannot be {value!r}; it is one of {allowed}."
                    f"{self.hint_of_choice(name, value)}"
                )
        settled = {name: choices[0] for name, choices in self.switches.items()}
        settled |= self.default(settled | chosen)
        settled |= chosen
        key = tuple(sorted(settled.items()))
        if key not in self._made:  # equal switches are the same object, so that kernels are found again
            made = self.declare(**settled)
            if self.groups:
                self.groups.refuse_unknown(made)
            self._made[key] = made
        return self._made[key]

    def listing(self) -> Listing:
        """Its switches, for a terminal and a notebook."""
        rows = [(name, " | ".join(choices), self.meanings.get(name, "")) for name, choices in self.switches.items()]
        return Listing(f"Family {self.name}", (), [Rows("Switches", ("name", "choices, default first", "meaning"), rows)])

    def hint(self, name: str, known: Iterable[str], value: object = "") -> str:
        """Say that the model lacks what an unknown name or its value asks for, else suggest the nearest known name."""
        asked = re.findall(r"[a-z]+", f"{name} {value}".casefold().replace("_", " "))
        for word in asked:
            for begins, sentence in self.absent.items():
                if word.startswith(begins) if len(begins) > 1 else word == begins and "_" not in name:
                    return f" {sentence[:1].upper()}{sentence[1:]}."
        return nearest(name, known)

    def hint_of_choice(self, switch: str, value: object) -> str:
        """Say which choice of a switch is near to one that it does not have, or which inputs take the number given."""
        if not re.match(r"\s*[-+.]?\d", str(value)) or self.groups is None:
            return self.hint(str(value), self.switches[switch])
        words = re.findall(r"[a-z]{4,}", self.meanings.get(switch, ""))  # of the mesh: its stiffness before the shafts'
        meant = [q for q in self.groups.inputs if q.says(switch)]
        meant = sorted(meant, key=lambda q: -sum(q.says(word) for word in words))[:SHOWN]
        return " It is a switch, and takes no number" + "".join(f"; {q.name}: {q.meaning}" for q in meant) + "."

    def symbols(self) -> frozenset[str]:
        """Names of the parameters of all its models, whatever the switches."""
        found = {p.name for p in (*self.model().parameters, *self.vocabulary)}
        for choices in islice(product(*self.switches.values()), 0 if self.vocabulary else TRIED):
            try:
                found |= {p.name for p in self.model(**dict(zip(self.switches, choices, strict=True))).parameters}
            except ModelError:  # a combination that the family itself refuses
                continue
        return frozenset(found)
