"""Operating points of the oscillators of `kinked_models`; what is right there stands in `numbers.json`.

Nearly all have one attractor, as several start states confirmed, with multipliers well inside the unit circle, so that the
label is beyond doubt; chaos and coexisting attractors are tested apart.
"""

from dataclasses import dataclass, field

from tests.trust import kinked_models as o
from tests.trust.truth_orbits import Pieces

from whirlmap import Settling
from whirlmap.models import family

GEAR = family("gear_backlash").model()


@dataclass(frozen=True)
class Case:
    """One operating point: its pieces for the truth, and every way in which its model is written.

    ``jumps`` says that the rates jump: exponents and multipliers may then be refused, in a sentence. ``settle`` and
    ``chaos`` are the periods that the truth settles and, where the motion is chaotic, measures its exponents over; ``wait``
    is the transient that whirlmap is given, where the default one is too short.
    """

    name: str
    pieces: Pieces
    models: tuple
    values: dict
    start: tuple
    jumps: bool = False
    settle: int = 200
    wait: int = 100
    chaos: int = 0
    known: dict = field(default_factory=dict)

    @property
    def settling(self):
        return Settling(transient=self.wait)

    @property
    def period(self):
        return self.pieces.at(**self.values).period


def cases(name, pieces, models, base, changes, start=(0.0, 0.1), **more):
    """One case for each change of a base."""
    models = tuple(models.values()) if isinstance(models, dict) else (models,)
    made = []
    for change in changes:
        values = {**base, **change}
        label = "-".join([name, *(f"{k}={v:g}" for k, v in change.items())])
        made.append(Case(label, pieces, models, values, start, **more))
    return made


STRICT = [
    *cases("dry", o.DRY_PIECES, o.DRY, dict(F=0.2, A=1, d=0), [dict(w=0.7)], jumps=True),
    *cases("dry", o.DRY_PIECES, {"when": o.DRY["when"], "sign": o.DRY["sign"]}, dict(A=1),
           [dict(F=0.5, d=0, w=0.6), dict(F=0.7, d=0.1, w=0.9)], jumps=True),
    *cases("dry-stops", o.DRY_PIECES, {"when": o.DRY["when"], "sign": o.DRY["sign"], "abs": o.DRY["abs"]}, dict(A=1),
           [dict(F=0.5, d=0, w=0.4), dict(F=0.7, d=0.1, w=0.6), dict(F=0.8, d=0, w=0.5)], jumps=True),
    *cases("uneven", o.UNEVEN_PIECES, o.UNEVEN, dict(F=0.2, G=0.5, A=1, d=0.05),
           [dict(w=0.4), dict(w=0.7), dict(w=1.2)], jumps=True),
    *cases("belt", o.BELT_PIECES, o.BELT, dict(F=1, b=0.5, d=0.1),
           [dict(A=0.4, w=0.4), dict(A=0.4, w=0.9), dict(A=1.2, w=1.3), dict(A=1.2, w=1.7)], jumps=True),
    *cases("pendulum", o.PENDULUM_PIECES, o.PENDULUM, dict(F=0.15, d=0.1, w=2 / 3), [dict(A=0.3), dict(A=0.5)], jumps=True),
    *cases("contact-friction", o.CONTACT_FRICTION_PIECES, o.CONTACT_FRICTION, dict(A=1, B=0.3, F=0.2, d=0.1, k=20),
           [dict(w=0.5), dict(w=0.8), dict(w=1.2)], jumps=True),
    *cases("bilinear", o.BILINEAR_PIECES, o.BILINEAR, dict(A=1, d=0.1),
           [dict(k=4, w=1.55), dict(k=4, w=2.55), dict(k=4, w=4.0), dict(k=10, w=0.6)]),
    *cases("stiff-stop", o.STOP_PIECES, o.STOP, dict(A=0.5, B=0, d=0.15, k=1000), [dict(w=0.8), dict(w=1.0)]),
    *cases("stop", o.STOP_PIECES, o.STOP["when"], dict(A=0.8, B=0, d=0.1, k=100), [dict(w=0.8), dict(w=1.0), dict(w=1.3)]),
    *cases("both-stops", o.BOTH_STOPS_PIECES, o.BOTH_STOPS, dict(A=1, d=0.2, k=30, B=0, a=0), [dict(w=0.5), dict(w=0.9)]),
    *cases("both-stops", o.BOTH_STOPS_PIECES, o.BOTH_STOPS, dict(A=1, d=0.1, k=10, B=0.2, a=1), [dict(w=0.8), dict(w=1.2)]),
    *cases("damped-wall", o.DAMPED_WALL_PIECES, o.DAMPED_WALL, dict(A=1, c=2, d=0.1, k=60),
           [dict(w=0.6), dict(w=0.9), dict(w=1.2)], jumps=True),
    *cases("preloaded", o.PRELOADED_PIECES, o.PRELOADED, dict(A=1, F=0.5, d=0.15, k=20),
           [dict(w=0.6), dict(w=0.9), dict(w=1.2)], jumps=True),
    *cases("relay", o.RELAY_PIECES, o.RELAY, dict(A=1.2, d=0.15), [dict(w=0.5), dict(w=1.0), dict(w=1.8)], jumps=True),
    *cases("half-wave", o.HALF_WAVE_PIECES, o.HALF_WAVE, dict(A=3, b=1, d=0.2), [dict(w=1.2), dict(w=1.6), dict(w=3.0)]),
    *cases("square-wave", o.SQUARE_WAVE_PIECES, o.SQUARE_WAVE, dict(A=2, b=1, d=0.2), [dict(w=0.9), dict(w=1.8)],
           jumps=True),
    *cases("meissner", o.MEISSNER_PIECES, o.MEISSNER, dict(A=1, a=1, b=0.3, d=0.1), [dict(w=0.7), dict(w=1.3)], jumps=True),
    *cases("friction-damper", o.FRICTION_DAMPER_PIECES, o.FRICTION_DAMPER, dict(A=1, F=0.4, d=0.05, k=0.3, m=0.5),
           [dict(w=0.7), dict(w=1.0), dict(w=1.4)], start=(0.0, 0.0, 0.1, 0.0), jumps=True),
    *cases("rub", o.RUB_PIECES, o.RUB, dict(e=0.3, F=0.02, G=0.1, d=0.2, k=10), [dict(w=0.9), dict(w=1.2)],
           start=(0.0, 0.0, 0.0, 0.0)),
    *cases("gap", o.GAP_PIECES, o.GAP, dict(A=1.5, d=0.1, k=30, c=0.5, m=0.5), [dict(w=0.6), dict(w=0.9), dict(w=1.3)],
           start=(0.0, 0.0, 0.1, 0.0)),
]  # fmt: skip

#: The dead zone: its orbits of 2T, 4T and 8T at one point, each from near itself, and the 4T that was called 8T.
TEETH = [
    *cases("gear-2T", o.GEAR_PIECES, GEAR, dict(zeta=0.05, F_m=0.1, F_ah=0.2), [dict(Omega=1.0)], start=(1.12, 0.077)),
    *cases("gear-4T", o.GEAR_PIECES, GEAR, dict(zeta=0.05, F_m=0.1, F_ah=0.2), [dict(Omega=1.0)], start=(0.249, 0.382)),
    *cases("gear-8T", o.GEAR_PIECES, GEAR, dict(zeta=0.05, F_m=0.1, F_ah=0.2), [dict(Omega=1.0)], start=(-0.007, -0.011),
           wait=2000),
    *cases("gear", o.GEAR_PIECES, GEAR, dict(zeta=0.02, F_m=0.1, F_ah=0.1), [dict(Omega=1.38), dict(Omega=1.39)],
           start=(1.1, 0.0), settle=1500, wait=2000),
    *cases("gear", o.GEAR_PIECES, GEAR, dict(zeta=0.05, F_m=0.1), [dict(F_ah=0.05, Omega=0.8), dict(F_ah=0.2, Omega=0.9)],
           start=(1.1, 0.0), settle=400),
]  # fmt: skip

#: Chaos across kinks and jumps; exponents by saltation over 1600 periods.
CHAOS = [
    Case("chaos-pendulum", o.PENDULUM_PIECES, (o.PENDULUM,), dict(F=0.15, d=0.1, w=2 / 3, A=1.0), (0.0, 0.1), jumps=True,
         chaos=1600),
    Case("chaos-stop", o.STOP_PIECES, (o.STOP["when"], o.STOP["max"]), dict(A=0.8, B=0, d=0.1, k=100, w=0.6), (0.0, 0.1),
         chaos=1600),
    Case("chaos-belt", o.BELT_PIECES, (o.BELT,), dict(F=1, A=0.4, b=0.5, d=0.02, w=1.3), (0.0, 0.1), jumps=True, chaos=1600),
]  # fmt: skip

#: Points where several orbits attract: the box of the starts, of which the truth draws 16.
COEXISTING = [
    Case("two-stop", o.STOP_PIECES, (o.STOP["when"],), dict(A=0.5, B=0, d=0.15, k=1000, w=1.3), (0.0, 0.1),
         settle=120, known={"box": ((-1.5, 1.05), (-2, 2))}),
    Case("two-both-stops", o.BOTH_STOPS_PIECES, (o.BOTH_STOPS["nested"],),
         dict(A=1, B=0.2, a=1, d=0.1, k=10, w=1.7), (0.0, 0.1), settle=120, known={"box": ((-1.5, 1.5), (-3, 3))}),
    Case("two-gap", o.GAP_PIECES, (o.GAP,), dict(A=1.5, d=0.1, k=30, c=0.5, m=0.5, w=2.3), (0.0, 0.0, 0.1, 0.0),
         settle=120, known={"box": ((-1.5, 1.5), (-1.5, 1.5), (-1.5, 1.5), (-1.5, 1.5))}),
]  # fmt: skip

ALL = [*STRICT, *TEETH, *CHAOS, *COEXISTING]
BY_NAME = {case.name: case for case in ALL}
assert len(BY_NAME) == len(ALL)
