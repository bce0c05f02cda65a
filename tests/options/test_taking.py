"""Options given whole or by their parts are the same; what is given twice, or is no option, is refused by a sentence."""

import inspect

import numpy as np
import pytest

import whirlmap
from whirlmap import Execution, Integration, Labelling, Settling, Storage
from whirlmap.errors import RangeError
from whirlmap.kernels.methods import METHODS as KERNELS
from whirlmap.options.computed import LABELLING
from whirlmap.options.execution import EXECUTION
from whirlmap.options.refused import METHODS
from whirlmap.options.taking import takes_options

#: Public functions that integrate, and whether they label.
LABEL = (
    "label_points", "bifurcation_diagram", "regime_map", "tolerance_sweep", "attractors", "basins", "safe_speeds", "improve",
    "diagnose",
)  # fmt: skip
INTEGRATE = ("simulate", "section", "lyapunov_spectrum", "waterfall")
RK4 = Labelling(integration=Integration("rk4"))
SHORT = Settling(transient=10, most=4, keep=8)


@takes_options()
def labelled(at, *, labelling=LABELLING, execution=EXECUTION, **_given):
    """Give what it got."""
    return at, labelling, execution


def test_nothing_given_is_the_default():
    assert labelled(1) == (1, Labelling(), Execution())
    nothing = dict.fromkeys(("settling", "lyapunov", "steps", "accuracy", "method", "workers", "progress", "labelling"))
    assert labelled(1, **nothing, execution=None) == (1, Labelling(), Execution())


def test_parts_make_the_whole():
    whole = Labelling(SHORT, 512, Integration("rk4", steps=24)), Execution(workers=2, progress=print)
    assert labelled(1, labelling=whole[0], execution=whole[1])[1:] == whole
    parts = {"settling": SHORT, "lyapunov": 512, "method": "rk4", "steps": 24, "workers": 2, "progress": print}
    assert labelled(1, **parts)[1:] == whole
    mixed = {"labelling": Labelling(SHORT, integration=Integration("rk4")), "lyapunov": 512, "steps": 24}
    assert labelled(1, **mixed, execution=Execution(2), progress=print)[1:] == whole
    assert labelled(1, integration=Integration("rk4", 24), settling=SHORT, lyapunov=512)[1] == whole[0]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"setling": SHORT}, "labelled: found the keyword 'setling'. Did you mean 'settling'?"),
        ({"cluster": "tcp://host:8786"}, "found the keyword 'cluster'"),  # only a map has a store that it needs
        ({"labelling": Labelling(SHORT), "settling": Settling()}, "found settling by itself and in labelling"),
        ({"labelling": RK4, "method": "tsit5"}, "found method by itself and in integration"),
        ({"labelling": RK4, "integration": Integration()}, "found integration by itself"),
        ({"execution": Execution(workers=1), "workers": 2}, "found workers by itself and in execution"),
    ],
)  # fmt: skip
def test_what_is_no_option_or_is_given_twice_is_refused(given, said):
    with pytest.raises(TypeError) as refused:
        labelled(1, **given)
    assert said in str(refused.value)


def test_a_public_function_refuses_a_misspelt_option():
    with pytest.raises(TypeError, match=r"bifurcation_diagram: found the keyword 'folow'\. Did you mean 'follow'"):
        whirlmap.bifurcation_diagram(whirlmap.load("duffing"), "gamma", [0.3], folow="up")


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Integration(steps=24, accuracy=1e-6), "steps per T or an accuracy, not both"),
        (lambda: Integration(method="euler"), r"there is no method 'euler'"),
        (lambda: Integration(method="rk5"), r"Did you mean 'rk4'"),
        (lambda: Integration(steps=0), "steps per T must lie between 1 and 1000000, not 0"),
        (lambda: Integration(steps=np.array([16, 0])), "steps per T must lie between 1 and 1000000, not 0"),
        (lambda: Integration(steps=[16, 2.5]), r"steps per T must be a whole number, not 2\.5"),
        (lambda: Integration(steps="16"), "steps per T must be a whole number, not '16'"),
        (lambda: Integration(accuracy=-1e-6), "accuracy must lie between 1e-13 and 1, not -1e-06"),
        (lambda: Integration(accuracy=1.0), r"accuracy must lie between 1e-13 and 1, not 1\.0"),
        (lambda: Integration(accuracy=float("nan")), "accuracy must lie between 1e-13 and 1, not nan"),
        (lambda: Integration(accuracy="fine"), "accuracy must be a number, not 'fine'"),
        (lambda: Labelling(lyapunov=8), "lyapunov must be 0, or from 16"),
        (lambda: Labelling(lyapunov=-256), "lyapunov must lie between 0 and 10000000, not -256"),
        (lambda: Labelling(lyapunov=512.5), r"lyapunov must be a whole number, not 512\.5"),
        (lambda: Labelling(settling=Integration()), "expected Settling"),
        (lambda: Execution(workers=0), "workers must lie between 1 and 4096, not 0"),
        (lambda: Execution(workers=1.5), r"workers must be a whole number, not 1\.5"),
        (lambda: Execution(progress="bar"), "progress must be True, False or a callable, not 'bar'"),
        (lambda: Storage(chunk=0), "chunk must lie between 1 and 10000000, not 0"),
        (lambda: Storage("maps", share=(3, 2)), "share 3/2: expected i/n with i from 1 to n"),
        (lambda: Storage("maps", share=(0, 2)), "share .* must lie between 1 and 10000000, not 0"),
        (lambda: Storage("maps", share=3), "share: found 3, expected"),
        (lambda: Settling(transient=-1), "transient must lie between 0 and 10000000, not -1"),
        (lambda: Settling(transient=1.5), r"transient must be a whole number, not 1\.5"),
        (lambda: Settling(first_window=1), "first_window must lie between 2"),
        (lambda: Settling(most=0), "most must lie between 1"),
        (lambda: Settling(keep=True), "keep must be a whole number, not True"),
        (lambda: Settling(tolerance=0.0), "tolerance must lie between 0 and 1"),
        (lambda: Settling(tolerance="1e-6"), "tolerance must be a number, not '1e-6'"),
        (lambda: Execution(workers=2, cluster="tcp://host:8786"), "a cluster has its own"),
        (lambda: Settling(tolerance=2.0), "tolerance must lie between 0 and 1"),
    ],
)
def test_values_that_make_no_sense_are_refused(make, said):
    with pytest.raises(RangeError, match=said):
        make()


def test_the_methods_that_options_name_are_those_that_there_are():
    assert tuple(KERNELS) == METHODS


@pytest.mark.parametrize("name", [*LABEL, *INTEGRATE])
def test_help_shows_the_values_and_every_part(name):
    function = getattr(whirlmap, name)
    shown = inspect.signature(function).parameters
    parts = {"method", "steps", "accuracy", "workers", "progress", "execution", "integration"}
    parts |= {"settling", "lyapunov", "labelling"} if name in LABEL else set()
    assert parts <= set(shown) and not [p for p in shown.values() if p.kind == p.VAR_KEYWORD]
    assert ("settling" in shown) == (name in LABEL)
    whole = "labelling" if name in LABEL else "integration"
    assert f"{whole} : {whole.title()}" in function.__doc__ or f"{whole}, execution" in function.__doc__


def test_labels_are_the_same_whole_or_by_parts():
    duffing, gamma = whirlmap.load("duffing"), np.array([0.2, 0.5])
    whole = whirlmap.label_points(
        duffing, {"gamma": gamma}, labelling=Labelling(SHORT, 0, Integration(steps=24)), execution=Execution(workers=2)
    )
    parts = whirlmap.label_points(duffing, {"gamma": gamma}, settling=SHORT, lyapunov=0, steps=24, workers=1)
    assert whole.equals(parts)
    assert not whole.equals(whirlmap.label_points(duffing, {"gamma": gamma}, settling=SHORT, lyapunov=0, steps=16))


def test_progress_true_shows_a_bar_and_tells_it(capsys, monkeypatch):
    monkeypatch.setattr("whirlmap.progress.EVERY", 0.0)
    whirlmap.simulate(whirlmap.load("duffing"), periods=4, execution=Execution(progress=True))
    assert "simulate: " in capsys.readouterr().err
    whirlmap.simulate(whirlmap.load("duffing"), periods=4, progress=False)
    assert not capsys.readouterr().err


def test_values_of_another_kind_and_clusters_are_refused_by_a_sentence():
    duffing = whirlmap.load("duffing")
    with pytest.raises(TypeError, match=r"simulate: found .*Labelling\(.* as integration, expected Integration"):
        whirlmap.simulate(duffing, periods=1, integration=Labelling())
    with pytest.raises(TypeError, match=r"found \{'steps': 64\} as integration"):
        whirlmap.simulate(duffing, periods=1, integration={"steps": 64})
    with pytest.raises(TypeError, match="simulate: only regime_map and tolerance_sweep run on a cluster"):
        whirlmap.simulate(duffing, periods=1, execution=Execution(cluster="tcp://1.2.3.4:1"))
