"""Estimates or divisions: which a processor gets, how that is overridden, and that it changes nothing but rounding."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from typer.testing import CliRunner

import whirlmap
from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.cli.main import app
from whirlmap.errors import InputError
from whirlmap.integrate import ensemble as ensembles
from whirlmap.kernels.running import machine, root_choice
from whirlmap.kernels.running.root_choice import Measured, RootChoice, by_estimates, chosen, own_choice, reason, using

ESTIMATES, DIVISIONS = (RootChoice(way, way) for way in ("estimates", "divisions"))
AVX512 = "+avx2,+avx512f,+avx512fp16,+fma"


def on(monkeypatch, name, features=AVX512, **variables):
    """Let the processor be another one."""
    had = {feature: True for level in machine.LEVELS.values() for feature in level}
    monkeypatch.setattr(machine, "_host", lambda: (name, had, features))
    for variable in ("WHIRLMAP_CPU", "WHIRLMAP_ROOTS"):
        monkeypatch.delenv(variable, raising=False)
    for variable, value in variables.items():
        monkeypatch.setenv(variable, value)


@pytest.mark.parametrize(
    ("name", "features", "choice", "why"),
    [
        ("emeraldrapids", AVX512, ESTIMATES, "measured: divisions take 1"),
        ("znver4", AVX512, RootChoice("divisions", "estimates"), "0.955 times as long, with tables 1.06"),
        ("znver7", AVX512, ESTIMATES, "znver7 has not been measured: the default"),
        ("znver3", "+avx2,+fma", DIVISIONS, "kernels for znver3 have no estimates"),
        ("apple-m1", "+neon", DIVISIONS, "no estimates"),
        # the features decide, not the name: a hypervisor may hide them
        ("emeraldrapids", "+avx2,+fma,-avx512f,+avx512fp16", DIVISIONS, "no estimates"),
    ],
)
def test_the_table_says_which_way(monkeypatch, name, features, choice, why):
    on(monkeypatch, name, features)
    assert own_choice() == chosen() == choice and why in reason()


def test_the_faster_way_is_taken(monkeypatch):
    on(monkeypatch, "new")
    monkeypatch.setattr(root_choice, "MEASURED", {"new": Measured(plain=1.01, tables=0.99)})
    assert own_choice() == RootChoice("estimates", "divisions") and str(own_choice()) == "estimates, with tables divisions"


def test_the_variable_overrides_the_table(monkeypatch):
    on(monkeypatch, "znver4", WHIRLMAP_ROOTS="estimates")
    assert own_choice() == ESTIMATES and reason() == "WHIRLMAP_ROOTS says so"
    on(monkeypatch, "emeraldrapids", WHIRLMAP_ROOTS="divisions")
    assert own_choice() == DIVISIONS
    on(monkeypatch, "emeraldrapids", WHIRLMAP_ROOTS="")
    assert own_choice() == ESTIMATES


@pytest.mark.parametrize(
    ("name", "features", "variables", "says"),
    [
        ("znver4", AVX512, {"WHIRLMAP_ROOTS": "guesses"}, "found 'guesses', expected estimates or divisions for znver4"),
        ("znver3", "+avx2", {"WHIRLMAP_ROOTS": "estimates"}, "found 'estimates', expected divisions for znver3"),
        # estimates of different makers need not agree, and a level is asked for in order to have the same bits everywhere
        ("znver4", AVX512, {"WHIRLMAP_ROOTS": "estimates", "WHIRLMAP_CPU": "x86-64-v4"}, "expected divisions for x86-64-v4"),
    ],
)
def test_what_cannot_be_had_is_refused(monkeypatch, name, features, variables, says):
    on(monkeypatch, name, features, **variables)
    with pytest.raises(InputError, match=says):
        own_choice()


@pytest.mark.parametrize("level", ["x86-64-v3", "x86-64-v4"])
def test_code_for_a_common_processor_divides(monkeypatch, level):
    on(monkeypatch, "emeraldrapids", WHIRLMAP_CPU=level)
    assert own_choice() == DIVISIONS


def test_kernels_with_tables_have_a_choice_of_their_own(monkeypatch):
    on(monkeypatch, "znver4")
    plain, porous = (whirlmap.load("gear-psfd/reference", psi=psi).plain_model() for psi in (0.0, 1e-3))
    assert not plain.tables and porous.tables
    assert not by_estimates(plain) and by_estimates(porous)


def test_a_choice_is_used_in_its_thread_alone(monkeypatch):
    on(monkeypatch, "znver4")
    with ThreadPoolExecutor(1) as pool, using(ESTIMATES):
        assert chosen() == ESTIMATES and pool.submit(chosen).result() == own_choice()
        with using(DIVISIONS):
            assert chosen() == DIVISIONS
        assert chosen() == ESTIMATES
    assert chosen() == own_choice()


def test_threads_of_an_ensemble_have_the_choice_of_who_asks_them(monkeypatch):
    """They compile kernels themselves where a step must be mended."""
    seen = []
    for place in ("ensemble", "division"):
        monkeypatch.setattr(f"whirlmap.integrate.{place}.SHORT", 0)
    monkeypatch.setattr(ensembles.Group, "advance", lambda *_, **__: seen.append(chosen()))
    with using(RootChoice("divisions", "estimates")):
        points, _ = make_ensemble(whirlmap.load("duffing"), {"gamma": np.linspace(0.2, 0.3, 64)}, steps=24, workers=2)
        points.advance(4)
    assert len(seen) > 1 and set(seen) == {RootChoice("divisions", "estimates")}


@pytest.mark.parametrize("arc", ["fixed", "positive"])  # the latter reads tables
def test_choices_differ_by_rounding_and_no_more(arc):
    """Rates of one film, both ways: within 100 units in the last place of the largest, and not the same bits."""
    if not machine.estimates():
        pytest.skip("this processor has no estimates of whole vectors")
    system = whirlmap.load("jeffcott", rotor="flexible", arc=arc)
    x = np.random.default_rng(2).uniform(-0.4, 0.4, (system.model.dimension, 400))
    found = []
    for choice in (ESTIMATES, DIVISIONS, ESTIMATES):
        with using(choice):
            found.append(system.rhs(0.3, x))
    np.testing.assert_array_equal(found[0], found[2])
    difference = np.abs(found[0] - found[1])
    assert difference.max() > 0
    assert (difference <= 100 * np.spacing(np.abs(found[1]).max(axis=0))).all()


def test_the_command_says_what_kernels_are_made_for(monkeypatch):
    on(monkeypatch, "znver7")
    told = CliRunner().invoke(app, ["cache"]).output
    assert "znver7, roots and reciprocals by estimates (znver7 has not been measured" in told.replace("\n", " ")
