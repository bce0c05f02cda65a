"""Labels do not depend on the coordinates: oscillators in scaled and rotated states are labelled like the plain ones."""

import numpy as np
import pytest
from sympy import Matrix

import whirlmap
from whirlmap.equations import Model, State
from whirlmap.integrate.system import System
from whirlmap.results.regime import Regime
from whirlmap.sweep.points.label_points import label_points

p, q = State("p", "1", "first coordinate"), State("q", "1", "second coordinate")
TURNED = Matrix([[np.cos(0.7) * 30, -np.sin(0.7) * 3], [np.sin(0.7) * 30, np.cos(0.7) * 3]])  # scaled, then turned
SCALED = Matrix([[1000.0, 0.0], [0.0, 0.01]])
SHEARED = Matrix([[1.0, 3.0], [0.0, 0.2]])


def transformed(system: System, matrix: Matrix) -> System:
    """The system in coordinates (p, q) = matrix (x, v)."""
    model = system.model
    x, v = model.states
    back = matrix.inv() * Matrix([p, q])
    plain = Matrix([model.equations[x], model.equations[v]]).subs({x: back[0], v: back[1]}, simultaneous=True)
    rates = matrix * plain
    made = Model(
        f"{model.name}-turned", (p, q), model.parameters, {p: rates[0].expand(), q: rates[1].expand()},
        harmonics=model.harmonics, clocks=model.clocks, swing=(p,), bound=1e9,
    )  # fmt: skip
    start = matrix * Matrix([s.start for s in model.states])
    return System(made, dict(system.values), start={"p": float(start[0]), "q": float(start[1])})


@pytest.mark.parametrize("matrix", [TURNED, SCALED, SHEARED], ids=["turned", "scaled", "sheared"])
@pytest.mark.parametrize(
    ("case", "values", "expected"),
    [
        ("duffing", {"gamma": [0.20, 0.28, 0.29, 0.37, 0.50, 0.65]}, [1, 2, 4, 5, "chaotic", 2]),
        ("van_der_pol", {"A": [0.3, 0.5, 2.0]}, None),
    ],
)
def test_labels_are_those_of_the_plain_coordinates(case, values, expected, matrix):
    system = whirlmap.load(case)
    plain = label_points(system, values, lyapunov=1024)
    other = label_points(transformed(system, matrix), values, lyapunov=1024)
    kinds = {Regime(int(k)).label for k in plain["regime"].values}
    assert len(kinds) > 1 and "undecided" not in kinds  # there is something to tell apart
    np.testing.assert_array_equal(other["regime"].values, plain["regime"].values)
    np.testing.assert_array_equal(other["period_T"].values, plain["period_T"].values)
    if expected:
        said = [int(n) if n else Regime(int(k)).label for n, k in zip(other["period_T"], other["regime"], strict=True)]
        assert said == expected
