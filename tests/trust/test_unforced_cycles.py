"""Cycles without forcing, smooth, stiff, with kinks and with sliding: period, returns, extremes, multipliers.

Truths: the closed form of Hopf's normal form and of the free bilinear oscillator; SciPy's crossings of the section for the
others, with Radau where they are stiff (`truth_cycles`); event location with sliding for the belt (`truth_orbits`).
A stiff one may be refused as stiff, in words or by its step verdict; a false label may not come out.
"""

import json
from dataclasses import dataclass, replace

import numpy as np
import pytest
from tests.trust import unforced_models
from tests.trust.asking import EXTREME, Refused, asked, diagram, label, some
from tests.trust.truth_cycles import Flow
from tests.trust.truth_orbits import Pieces, extremes
from tests.trust.unforced_models import FLOWS

import whirlmap
from whirlmap.integrate.accuracy import StepVerdict

RADAU = dict(method="Radau")


@dataclass(frozen=True)
class Known:
    """A cycle: its flow and values, period, returns to the section, and how SciPy finds it (None: a closed form)."""

    flow: str
    values: dict
    start: tuple
    period: float
    returns: int = 1
    scipy: dict | None = None
    extremes: tuple | None = None


#: The kept periods are those of `test_the_cycles_come_out_again`.
CYCLES = {
    "hopf": Known("hopf", dict(m=1.0, w=3.0), (0.5, 0.0), 2 * np.pi / 3, extremes=(-1.0, 1.0)),
    "hopf-fast": Known("hopf", dict(m=4.0, w=300.0), (0.5, 0.0), 2 * np.pi / 300, extremes=(-2.0, 2.0)),
    "hopf-slow": Known("hopf", dict(m=0.04, w=0.1), (0.05, 0.0), 20 * np.pi, extremes=(-0.2, 0.2)),
    "slaved": Known("slaved_hopf", dict(w=3.0, k=200.0), (0.5, 0.0, 0.0), 2 * np.pi / 3, extremes=(-1.0, 1.0)),
    "slaved-stiff": Known("slaved_hopf", dict(w=3.0, k=3000.0), (0.5, 0.0, 0.0), 2 * np.pi / 3, extremes=(-1.0, 1.0)),
    "van-der-pol-5": Known("van_der_pol", dict(mu=5.0), (2.0, 0.0), 11.612230667709, scipy=dict(time=200)),
    "van-der-pol-20": Known("van_der_pol", dict(mu=20.0), (2.0, 0.0), 34.682323311652, scipy=dict(time=300, **RADAU)),
    "rayleigh-10": Known("rayleigh", dict(mu=10.0), (2.0, 0.0), 19.078369566935, scipy=dict(time=200)),
    "fitzhugh-nagumo": Known("fitzhugh_nagumo", dict(e=0.08, a=0.7, b=0.8, I=0.5), (0.0, 0.0), 39.474414980191,
                             scipy=dict(time=600)),
    "fitzhugh-nagumo-stiff": Known("fitzhugh_nagumo", dict(e=0.002, a=0.7, b=0.8, I=0.5), (0.0, 0.0), 1031.9907201,
                                   scipy=dict(time=6000, **RADAU)),
    "brusselator": Known("brusselator", dict(a=1.0, b=3.0), (1.2, 1.0), 7.156919921187, scipy=dict(time=200)),
    "brusselator-stiff": Known("brusselator", dict(a=1.0, b=8.0), (1.2, 1.0), 22.912001761, scipy=dict(time=200, **RADAU)),
    "oregonator": Known("oregonator", dict(s=77.27, q=8.375e-6, w=0.161), (2.0, 2.0, 2.0), 302.858042,
                        scipy=dict(time=2500, **RADAU)),
    "predator-prey": Known("predator_prey", dict(r=1.0, k=3.0, a=1.0, m=0.3), (1.0, 1.0), 20.886789276901,
                           scipy=dict(time=800)),
    "roessler-1": Known("roessler", dict(a=0.2, b=0.2, c=2.5), (1.0, 1.0, 0.0), 5.748991183285,
                        scipy=dict(time=2000, near=1e-7)),
    "roessler-2": Known("roessler", dict(a=0.2, b=0.2, c=3.5), (1.0, 1.0, 0.0), 11.545218287766, 2,
                        scipy=dict(time=2000, near=1e-7)),
    "roessler-4": Known("roessler", dict(a=0.2, b=0.2, c=4.0), (1.0, 1.0, 0.0), 23.177001055981, 4,
                        scipy=dict(time=2000, near=1e-7)),
    "lorenz-100.5": Known("lorenz", dict(s=10.0, b=8 / 3, r=100.5), (1.0, 1.0, 1.0), 1.096238813586, 3,
                          scipy=dict(time=150, near=1e-7)),
    "lorenz-260": Known("lorenz", dict(s=10.0, b=8 / 3, r=260.0), (1.0, 1.0, 1.0), 0.451023258561, 2,
                        scipy=dict(time=150, near=1e-7)),
}  # fmt: skip
STIFF = {"van-der-pol-20", "fitzhugh-nagumo-stiff", "oregonator", "slaved-stiff", "rayleigh-10"}


def loaded(name):
    known = CYCLES[name]
    model, names, *_ = FLOWS[known.flow]
    return whirlmap.load(model, **known.values, start=dict(zip(names.split(), known.start, strict=True)))


def says_stiff(ds):
    verdict = np.asarray(ds["step_verdict"]).reshape(-1) if "step_verdict" in ds else np.array([0])
    return bool((verdict == StepVerdict.stiff).any()) or "stiff" in json.dumps({k: str(v) for k, v in ds.attrs.items()})


@pytest.mark.parametrize("name", CYCLES)
def test_label(name):
    ds = asked(diagram, loaded(name))
    if isinstance(ds, Refused):
        assert name in STIFF and "stiff" in ds.sentence
        return
    said = label(ds, 0)
    allowed = {f"{CYCLES[name].returns}T"}
    if name in STIFF and says_stiff(ds):
        allowed |= {"undecided", "unresolved", "stiff"}
    assert said in allowed


@pytest.mark.parametrize("name", some(CYCLES, ["hopf", "roessler-2"]))
def test_diagnosis(name):
    ds = asked(whirlmap.diagnose, loaded(name))
    if isinstance(ds, Refused):
        assert name in STIFF and "stiff" in ds.sentence
        return
    said = label(ds)
    if name in STIFF and says_stiff(ds) and said in ("undecided", "unresolved", "stiff"):
        return
    assert said == f"{CYCLES[name].returns}T" and float(ds["confidence"]) > 0.5
    assert abs(float(ds["lyapunov"][0])) <= 3 * float(ds["lyapunov_error"][0]) + 1e-5 / CYCLES[name].period
    votes = json.loads(ds.attrs["indicators"])
    if "floquet" in votes:
        assert votes["floquet"]["vote"] != "unstable"


@pytest.mark.parametrize("name", some([n for n in CYCLES if n not in STIFF], ["hopf-fast", "van-der-pol-5", "lorenz-260"]))
def test_period_and_extremes(name, validate):
    """Crossings of the section, as far apart as the truth's; extremes of the first state."""
    known, system = CYCLES[name], loaded(name)
    given = {"steps": 2048} if name == "brusselator-stiff" else {}  # what begins far from a fast turn says nothing of it
    found = whirlmap.section(system, points=120, transient=400, **given)
    times = found["crossing_time"].values[0]
    times = times[np.isfinite(times)]
    tier, source = ("exact", "normal form in closed form") if known.scipy is None else ("independent", "SciPy, events")
    validate(f"{name}: period of the cycle", times[-1] - times[-1 - known.returns], known.period, tier=tier, source=source,
             rel=2e-6)  # fmt: skip
    if known.extremes is not None:
        ds = diagram(system)
        here = ds.sel(quantity="x")
        np.testing.assert_allclose([float(here["minimum"][0]), float(here["maximum"][0])], known.extremes, rtol=0,
                                   atol=EXTREME * np.ptp(known.extremes))  # fmt: skip


@pytest.mark.parametrize("factor", some([0.1, 0.31, 3.0, 10.0], [0.1, 10.0]))
def test_a_typical_time_that_is_wrong_by_ten(factor):
    """The declared typical time only guides: the label does not hang on it."""
    model = FLOWS["van_der_pol"][0]
    other = replace(model, name=f"vdp_time_{factor:g}".replace(".", "_"), typical_time=6.663 * factor)
    ds = diagram(whirlmap.load(other, mu=1.0, start={"x": 2.0}))
    assert label(ds, 0) == "1T"


@pytest.mark.parametrize("mu", some([1.0, 5.0], [5.0]))
def test_an_orbit_that_does_not_close_has_no_multipliers(mu):
    """Given a wrong duration, the trivial multiplier or the closure says so; given the right one, both are good."""
    model, names, rates, cut = FLOWS["van_der_pol"]
    cycle = Flow(names, rates, cut, mu=mu).cycle((2.0, 0.0), 150)
    system = whirlmap.load(model, mu=mu)
    found = whirlmap.floquet_multipliers(system, cycle.z, cycle.period, steps=400)
    assert float(found["trivial_error"]) < 1e-5 and float(found["closure"]) < 1e-5
    other = found["log_modulus"].values[1 - int(found["trivial"])]
    assert other == pytest.approx(cycle.divergence * cycle.period, rel=1e-4, abs=1e-4)
    wrong = asked(whirlmap.floquet_multipliers, system, cycle.z, 0.9 * cycle.period, steps=400)
    if not isinstance(wrong, Refused):
        assert float(wrong["closure"]) > 1e-2


# --- kinks, stops and sliding ------------------------------------------------------------------------------------------

#: name -> model, pieces, height whose fall cuts the cycle, values, start, whether the rates jump; period, low, high, slides
PIECEWISE = {
    "bilinear": (unforced_models.BILINEAR_CYCLE,
                 Pieces("x v", ("x",), ("v", "mu*(1-x**2)*v - x*(1+s0)/2 - k*x*(1-s0)/2"), frequency="1"),
                 lambda z: z[1], dict(mu=0.5, k=9.0), (0.5, 0.0), False,
             4.316591730456, (-0.79601706, -2.15651922), (2.28258208, 2.85886512), 0),
    "stopped": (unforced_models.STOPPED_CYCLE,
                Pieces("x v", ("x - 1",), ("v", "mu*(1-x**2)*v - x - k*(x-1)*(1+s0)/2"), frequency="1", parts=200),
                lambda z: -z[0], dict(mu=0.4, k=200.0), (0.5, 0.0), False,
             4.310179178655, (-2.33030021, -2.81402761), (1.14976039, 2.28538144), 0),
    "belt": (unforced_models.BELT_CYCLE,
             Pieces("x v", ("v - b",), ("v", "-d*v - x - F*s0/(1 + (v-b)**2)"), frequency="1"),
             lambda z: z[1], dict(F=1.0, b=0.5, d=0.1), (1.5, 0.5), True,
             7.751589936748, (-0.48815317, -0.9576046), (1.43991523, 0.5), 1),
    "belt-slow": (unforced_models.BELT_CYCLE,
                  Pieces("x v", ("v - b",), ("v", "-d*v - x - F*s0/(1 + (v-b)**2)"), frequency="1"),
                  lambda z: z[1], dict(F=1.0, b=0.2, d=0.05), (1.5, 0.2), True,
             7.610385121007, (0.46556912, -0.35486213), (1.18845827, 0.2), 1),
    "relay": (unforced_models.RELAY_CYCLE,
              Pieces("x v", ("x - c*v",), ("v", "-d*v - s0"), frequency="1"),
              lambda z: -z[0], dict(d=0.3, c=0.15), (1.0, 0.0), True,
             4.921088377073, (-0.74020244, -1.17729387), (0.74020244, 1.17729387), 0),
}  # fmt: skip


def cycle_by_events(pieces, values, cut, start, rounds=60):
    """Period, extremes and slides of a cycle, from one fall of the cut to the next; the cut is none of the surfaces."""
    motion, z = pieces.at(**values), start
    sides = None
    for k in range(rounds + 1):
        away = motion.run(0.0, z, 0.05, keep=k == rounds, sides=sides)
        sides = motion.last_sides
        back = motion.run(0.05, away.z, 500.0, keep=k == rounds, sides=sides, stop=lambda _, s: cut(s))
        sides, before, z = motion.last_sides, z, back.z
    assert np.abs(np.subtract(z, before)).max() < 1e-9, "no cycle"
    slides = [kind for *_, kind in [*away.events, *back.events]].count("slides")
    low, high = extremes([*away.arcs, *back.arcs], motion.n)
    return back.ended, low, high, slides


@pytest.mark.parametrize("name", PIECEWISE)
def test_cycles_with_kinks_and_jumps(name):
    model, _, _, values, start, jumps, period, low, high, slides = PIECEWISE[name]
    system = whirlmap.load(model, **values, start=dict(zip("xv", start, strict=True)))
    ds = asked(diagram, system)
    if isinstance(ds, Refused):
        assert jumps and ds.names_the_jump
        return
    said = label(ds, 0)
    if slides and said == "sticks":
        return
    assert said == "1T"
    found = np.array([ds[q].values[0] for q in ("minimum", "maximum")])
    np.testing.assert_allclose(found, [low, high], rtol=0, atol=EXTREME * np.ptp([low, high], axis=0).max())
    times = whirlmap.section(system, points=60, transient=100)["crossing_time"].values[0]
    times = times[np.isfinite(times)]
    assert times[-1] - times[-2] == pytest.approx(period, rel=1e-5)


def test_the_free_bilinear_oscillator_keeps_time(validate):
    """Without damping every motion has the period pi + pi/sqrt(k), whatever its size: time between crossings, 40 turns."""
    system = whirlmap.load(unforced_models.BILINEAR_CYCLE, mu=0.0, k=9.0, start={"x": 0.7, "v": 0.0})
    times = whirlmap.section(system, points=30, transient=1)["crossing_time"].values[0]
    times = times[np.isfinite(times)]
    validate("free bilinear oscillator, k 9: times between crossings", np.diff(times), np.pi * (1 + 1 / 3), tier="exact",
             source="pi + pi/sqrt(k)", rel=1e-6)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", PIECEWISE)
def test_the_cycles_with_kinks_and_jumps_come_out_again(name):
    _, pieces, cut, values, start, _, *truth = PIECEWISE[name]
    for again, kept in zip(cycle_by_events(pieces, values, cut, start), truth, strict=True):
        np.testing.assert_allclose(again, kept, rtol=0, atol=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("name", [n for n, c in CYCLES.items() if c.scipy is not None])
def test_the_cycles_come_out_again(name):
    known = CYCLES[name]
    _, names, rates, cut = FLOWS[known.flow]
    cycle = Flow(names, rates, cut, **known.values).cycle(known.start, multipliers=name not in STIFF, **known.scipy)
    assert cycle.returns == known.returns and cycle.period == pytest.approx(known.period, rel=1e-7)
