"""Edges of windows at bifurcation points: their values, known in closed form."""

import json
from dataclasses import replace

import numpy as np
import pytest
from tests.sweep.branches.exact_systems import cubic_rotor, forced_hopf

from whirlmap.equations import Parameter
from whirlmap.integrate.system import System
from whirlmap.sweep.speeds.edge_events import moved
from whirlmap.sweep.speeds.safe_speeds import safe_speeds
from whirlmap.sweep.speeds.verdicts import Verdict
from whirlmap.sweep.speeds.windows import Edge


def running_at(system, displacement):
    """The same oscillator with its forcing declared as a shaft's speed."""
    speed = next(p for p in system.model.parameters if isinstance(p, Parameter) and p.name == "Omega")
    shown = [s for s in system.model.states if s.name in displacement]
    model = replace(system.model, clocks={"shaft": speed}, swing=tuple(shown), speed=speed)
    return System(model, dict(system.values), dict(system.start))


def windows(system, speeds, limit):
    return json.loads(safe_speeds(system, speeds, limit).attrs["windows"])


@pytest.mark.parametrize("points", [15, 29])
def test_a_window_begins_where_the_large_motion_folds(points):
    """The small motion is safe from 1.1547, but beside the large one, which folds at 1.295061081428043 (Cardano)."""
    system = running_at(cubic_rotor(Omega=1.0), "xy")
    (window,) = [w for w in windows(system, np.linspace(1.1, 1.5, points), 3.0) if w["end"] == 1.5]
    assert window["start"] == pytest.approx(1.295061081428043, rel=1e-9)
    assert (window["below"], window["below_event"]) == ("coexisting", "fold")
    assert 0 < window["gap_start"] < 0.4 / points


def test_a_window_ends_where_the_periodic_motion_becomes_a_torus():
    """Neimark-Sacker at |z|^2 = 1/2: g^2 = (d^2 + 1/4)/2."""
    system = running_at(forced_hopf(g=0.8, Omega=2.9), "xy")
    (window,) = windows(system, np.linspace(2.9, 3.2, 7), 5.0)
    assert window["end"] == pytest.approx(2 + np.sqrt(2 * 0.64 - 0.25), rel=1e-9)
    assert window["above"] in ("quasi_periodic", "undecided")  # so near the threshold a torus is hard to tell
    assert window["above_event"] == "neimark-sacker"
    assert window["below_event"] == ""


def test_an_edge_where_the_amplitude_crosses_the_limit_is_no_event():
    """Below the resonance of the cubic rotor the amplitude grows without a jump."""
    system = running_at(cubic_rotor(Omega=0.6), "xy")
    (window,) = windows(system, np.linspace(0.6, 0.9, 7), 0.3)
    assert (window["above"], window["above_event"]) == ("amplitude", "")


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(
    ("lost", "at", "kind"),
    [
        ([(1, (1.02, "fold"))], 1.02, "fold"),
        ([(1, (0.95, "fold"))], 0.95, "fold"),  # it lives farther into the window than steps carried it
        ([(0, (1.03, "neimark-sacker"))], 1.03, "neimark-sacker"),
        ([(0, (1.03, "neimark-sacker")), (1, (1.02, "fold"))], 1.02, "fold"),
        ([(1, (1.02, "fold")), (0, (1.03, "neimark-sacker"))], 1.02, "fold"),
        ([(0, (1.03, "fold")), (1, None)], 1.0, ""),  # beside a motion that is not safe and goes on
        ([(0, None)], 1.0, ""),
        ([], 1.0, ""),
    ],
)
def test_the_innermost_loss_counts(lost, at, kind, way):
    """A window that ends at 1 as far as was judged, with a speed that is not safe at 1.1; and its mirror image."""
    turned = [(side, found and (way * found[0], found[1])) for side, found in lost]
    found = moved(Edge(way * 1.0, way * 1.1, Verdict.coexisting), turned)
    assert (found.safe, found.beyond, found.event) == (way * at, way * 1.1, kind)
