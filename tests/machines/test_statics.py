"""Static equilibria of machines from parts are found, from the static locus of each film."""

import numpy as np
import pytest
from tests.machines.wrong_machines import GOOD

import whirlmap
from whirlmap.integrate.equilibrium import start_states

#: Half films of both kinds, a journal that hardly carries anything, a shaft that turns clockwise, torsion.
TURNING = GOOD.replace('reference = "pinion"', 'reference = "pinion"\ntorsion = "free"').replace(
    'at = 0\nR = "25 mm"', 'at = 0\narc = "fixed"\nR = "25 mm"'
) + '[[coupling]]\nname = "motor"\nshaft = "gear"\nat = 0\nk_t = "2e4 N*m/rad"\n'


@pytest.mark.parametrize("text", [GOOD, pytest.param(TURNING, marks=pytest.mark.slow)], ids=["uniform", "turning"])
def test_equilibria_are_found_over_speeds_and_loads(tmp_path, text):
    file = tmp_path / "machine.toml"
    file.write_text(text, encoding="utf-8")
    system = whirlmap.load(file)
    model, n = system.model, 40
    values = np.repeat(system.vector[:, None], n, axis=1)
    rng, row = np.random.default_rng(2), system.parameters.index
    values[row("s")] *= np.geomspace(0.1, 4.0, n)
    values[row("F_0_teeth")] *= 10 ** rng.uniform(-2, 0.5, n)
    x, found = start_states(model, values)
    assert found.all()
    near = model.near_equilibrium({p: values[i] for i, p in enumerate(system.parameters)})
    for journal, one in model.journals.items():
        rows = [system.states.index(q.name) for q in one.u]
        apart = np.hypot(*(near[q.name] - x[i] for q, i in zip(one.u, rows, strict=True)))
        eccentricity = np.hypot(*x[rows]) / values[row(f"gamma_{journal}")]
        assert np.median(apart) < 0.01 and eccentricity.max() > 2 * eccentricity.min()


def test_a_single_rotor_has_the_loads_of_a_beam_on_two_supports(tmp_path, validate):
    """Reactions by the lever rule: the films carry the weight of shaft and disk, each its share."""
    at = [GOOD.index(text) for text in ('[[shaft]]\nname = "gear"', "[[disk]]", '[[bearing]]\nname = "gear_end"')]
    alone = GOOD[: at[0]] + GOOD[at[1] : at[2]]
    file = tmp_path / "alone.toml"
    file.write_text(alone.replace('support = "pedestal"\n', ""), encoding="utf-8")
    system = whirlmap.load(file)
    x, found = start_states(system.model, system.vector[:, None])
    assert found[0]
    force, shaft = system.machine.quantities["force_unit"][0], system.machine.case.parts.machine.rotors[0].shaft
    numbers = dict(zip(system.model.states, x[:, 0], strict=True))
    numbers |= {p: float(system.values[p.name]) for p in system.model.parameters}
    loads = [force * float(system.model.outputs[f"load_{b}"].expression.subs(numbers)) for b in ("drive_end", "free_end")]
    weight = 9.81 * shaft.mass
    right = weight * shaft.centre / 0.2
    validate("rotor from parts on two films: loads at rest in N", loads, [weight - right, right], tier="exact",
             source="lever rule", rel=1e-4)  # fmt: skip
