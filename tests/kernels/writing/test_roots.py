"""Square roots and reciprocals, by the processor's estimates and without: right to rounding, and at their limits."""

import numpy as np
import pytest
import sympy as sp

from whirlmap.equations import Model, State
from whirlmap.integrate.system import System
from whirlmap.kernels.running import machine
from whirlmap.kernels.running.root_choice import RootChoice, using

x, y, z = (State(name, "1", name) for name in "xyz")


def roots(name):
    """x' = sqrt(x), y' = 1/y, z' = 1/sqrt(z)."""
    return System(Model(name, (x, y, z), (), {x: sp.sqrt(x), y: 1 / y, z: 1 / sp.sqrt(z)}), {})


@pytest.fixture(params=[True, False], ids=["estimated", "divided"])
def system(request):
    if request.param and not machine.estimates():
        pytest.skip("this processor has no estimates of whole vectors")
    way = "estimates" if request.param else "divisions"
    with using(RootChoice(way, way)):
        yield roots(f"roots-{way}")


def expected(v):
    with np.errstate(all="ignore"):
        return np.stack([np.sqrt(v), 1 / v, 1 / np.sqrt(v)])


def test_last_places(system):
    """Two iterations from 14 bits end in rounding: within two units in the last place, over all of the range."""
    rng = np.random.default_rng(1)
    v = np.concatenate([rng.uniform(0, 2, 4000), 10.0 ** rng.uniform(-290, 290, 4000)])
    got, exact = system.rhs(0.0, np.stack([v, v, v])), expected(v)
    assert np.max(np.abs(got - exact) / np.spacing(exact)) <= 2


def test_limits(system):
    v = np.array([0.0, np.inf, np.nan, -1.0, 1.0, 4.0])
    got, exact = system.rhs(0.0, np.stack([v, v, v])), expected(v)
    np.testing.assert_array_equal(np.isnan(got), np.isnan(exact))
    np.testing.assert_allclose(got, exact, rtol=4e-16)
