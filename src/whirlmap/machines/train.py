"""The gear train: speeds, senses of rotation and mesh phases of shafts that meshes join in a tree.

External wheels turn against each other: r_driven = -r_driver z_driver/z_driven. The phase of a mesh counts teeth: a wheel
of z teeth that turns in the sense S and meshes in the direction b from its centre has its tooth flanks there at the phase
z S (angle - b), a quarter of a period earlier or later for its front and its back flank. So meshes of one wheel differ in
phase by z S (b_1 - b_2), and by half a period where the wheel is driven in one and drives in the other.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

from sympy import Expr, Integer, Piecewise, pi

from whirlmap.equations.quantities import Parameter
from whirlmap.errors import CaseError


def driving(torque: Expr) -> Expr:
    """1 where the driver pushes with its front flanks, -1 where the driven shaft drives.

    An idle mesh, of torque zero, is the limit of a small positive torque: its flanks are those on which it would be loaded.
    """
    return Piecewise((Integer(1), torque >= 0), (Integer(-1), True))


@dataclass(frozen=True)
class Link:
    """A mesh as the train sees it: its name, its shafts, and inputs of its teeth, direction and torque."""

    name: str
    driver: str
    driven: str
    z_driver: Parameter
    z_driven: Parameter
    beta_c: Expr
    torque: Expr

    def other(self, shaft: str) -> str:
        """The shaft at the other side."""
        return self.driven if shaft == self.driver else self.driver

    def teeth(self, shaft: str) -> Parameter:
        """Teeth of the wheel on a shaft."""
        return self.z_driver if shaft == self.driver else self.z_driven

    def direction(self, shaft: str) -> Expr:
        """Direction from the centre of a shaft's wheel to the other wheel."""
        return self.beta_c + (0 if shaft == self.driver else pi)

    def flank(self, shaft: str) -> Expr:
        """1 where the wheel on a shaft touches with its front flanks, -1 for its back ones."""
        return driving(self.torque) * (1 if shaft == self.driver else -1)


@dataclass
class Train:
    """What follows from the teeth.

    Attributes
    ----------
    speeds : dict of str to Expr
        Speed of each shaft over that of the reference shaft, by the numbers of teeth.
    senses : dict of str to int
        1 where a shaft turns from x to y.
    phases : dict of str to Expr
        Phase of each mesh at time zero; zero of the first.
    """

    speeds: dict[str, Expr] = field(default_factory=dict)
    senses: dict[str, int] = field(default_factory=dict)
    phases: dict[str, Expr] = field(default_factory=dict)


def train(
    reference: str, shafts: Sequence[str], links: Sequence[Link], coupled: Sequence[tuple[str, str, str]] = ()
) -> Train:
    """Follow the meshes and couplings from the reference shaft.

    Couplings are a name and two shafts, which turn at one speed. The phase of a mesh behind a coupling is that of how it was
    put together, which is taken as zero.

    Raises
    ------
    CaseError
        A loop of meshes and couplings, or a shaft that none joins to the reference.
    """
    found = Train({reference: Integer(1)}, {reference: 1})
    reached_by: dict[str, Link] = {}
    waiting, left, joints = [reference], list(links), list(coupled)
    while waiting:
        shaft = waiting.pop(0)
        for joint in [one for one in joints if shaft in one[1:]]:
            joints.remove(joint)
            name, first, second = joint
            other = second if shaft == first else first
            if other in found.speeds:
                raise CaseError(
                    f"coupling {name}: found a loop, for its shafts {shaft} and {other} are joined by other meshes or"
                    " couplings already; expected a tree"
                )
            found.speeds[other], found.senses[other] = found.speeds[shaft], found.senses[shaft]
            waiting.append(other)
        for link in [one for one in left if shaft in (one.driver, one.driven)]:
            left.remove(link)
            other = link.other(shaft)
            if other in found.speeds:
                raise CaseError(
                    f"mesh {link.name}: found a loop, for its shafts {shaft} and {other} are joined by other meshes already;"
                    " expected meshes that form a tree"
                )
            found.speeds[other] = -found.speeds[shaft] * link.teeth(shaft) / link.teeth(other)
            found.senses[other] = -found.senses[shaft]
            found.phases[link.name] = _phase(found, link, shaft, reached_by.get(shaft))
            reached_by[other] = link
            reached_by.setdefault(shaft, link)  # later meshes of the reference count from its first
            waiting.append(other)
    alone = [shaft for shaft in shafts if shaft not in found.speeds]
    if alone:
        raise CaseError(
            f"shaft {alone[0]}: found no mesh or coupling that joins it to the reference shaft {reference}, expected"
            " one:"
            " its speed would not be known"
        )
    return found


def _phase(found: Train, link: Link, shaft: str, before: Link | None) -> Expr:
    if before is None:
        return Integer(0)
    turn = link.teeth(shaft) * found.senses[shaft] * (before.direction(shaft) - link.direction(shaft))
    return found.phases[before.name] + turn + pi / 2 * (link.flank(shaft) - before.flank(shaft))
