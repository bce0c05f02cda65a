"""Largest multipliers of models with many states, against exponentials of eigenvalues."""

import numpy as np
import pytest

from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.analysis.variational import monodromy
from whirlmap.equations import Model, Parameter, State, cos, t
from whirlmap.integrate.system import System

w, d = Parameter("w", "1", "w", above=0), Parameter("d", "1", "damping of the first pair")
#: States of the model, two for each pair.
PAIRS = 22


def coupled_pairs(apart):
    """Pairs z' = (-d_k + i w_k) z, each driven by the one before and the first by cos(w t): multipliers exp(-d_k T)."""
    x, y = ([State(f"{name}{k}", "1", name, start=0.1) for k in range(PAIRS)] for name in "xy")
    rates = {}
    for k, (a, b) in enumerate(zip(x, y, strict=True)):
        damping, turn = d + apart * k, 0.3 + 0.11 * k
        before = cos(w * t) if k == 0 else x[k - 1] / 5
        rates[a], rates[b] = -damping * a - turn * b + before, turn * a - damping * b
    model = Model(name="pairs", states=(*x, *y), parameters=(w, d), harmonics=(w,), equations=rates, swing=tuple(x[:1]))
    return System(model, {"w": 1.0, "d": 0.05})


@pytest.mark.parametrize(("apart", "in_subspace"), [(0.3, True), (0.0, False)])
def test_largest_multiplier_of_many_states(apart, in_subspace, monkeypatch):
    ensemble, _ = make_ensemble(coupled_pairs(apart), {"d": np.array([0.05, 0.2, -0.02])}, steps=64)
    assert ensemble.model.dimension >= monodromy.MANY
    whole, went_whole = monodromy.monodromies, []

    def counted(ensemble, points, *more):
        went_whole.extend(points)
        return whole(ensemble, points, *more)

    monkeypatch.setattr(monodromy, "monodromies", counted)
    found = monodromy.largest_multipliers(ensemble, np.arange(3), np.ones(3, dtype=np.int64))
    assert found == pytest.approx(np.exp(-np.array([0.05, 0.2, -0.02]) * 2 * np.pi), rel=1e-3 if in_subspace else 1e-9)
    assert went_whole == ([] if in_subspace else [0, 1, 2])
    assert (found > 1).tolist() == [False, False, True]
