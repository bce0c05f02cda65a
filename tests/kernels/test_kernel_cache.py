"""The source of a kernel is its identity, and the folder of compiled kernels does what the user says."""

import os
import subprocess
import sys
import textwrap

import pytest

from whirlmap.equations import Model, Output, Parameter, State, Stop, cos, t
from whirlmap.errors import CacheError
from whirlmap.integrate.system import System
from whirlmap.kernels import cache
from whirlmap.kernels.methods import RK4, Method
from whirlmap.kernels.source import kernel_source
from whirlmap.models import family

x, v = State("x", "1", "position"), State("v", "1", "velocity")
k, g, omega = (Parameter(n, "1", n) for n in ("k", "g", "omega"))


def oscillator(coefficient=1.0, *, name="cache-test", bound=1e6, gap=2, swapped=False, outputs=None):
    equations = {x: v, v: -k * x - coefficient * x**3 + g * cos(omega * t)}
    return Model(
        name, (v, x) if swapped else (x, v), (k, g, omega), equations, harmonics=(omega,), bound=bound,
        stops={"contact": Stop(gap - x, "wall")}, outputs=outputs or {},
    )  # fmt: skip


def text(model, method=RK4, *, tangents=False, kind="free"):
    return kernel_source(model, method, tangents=tangents, kind=kind).text


def test_equal_models_have_equal_source():
    assert text(oscillator()) == text(oscillator())
    both = [family("gear_pair").model(edition=e, arc="fixed", film="porous") for e in ("intended", "physical")]
    assert text(both[0]) == text(both[1])  # the same equations: nothing is compiled twice


@pytest.mark.parametrize(
    "changed",
    [
        {"coefficient": 1.5}, {"coefficient": 1.0000001}, {"name": "other"}, {"bound": 1e5}, {"gap": 3},
        {"swapped": True}, {"outputs": {"e": Output(x**2, "1", "energy")}},
    ],
    ids=str,
)  # fmt: skip
def test_any_change_of_the_model_is_another_kernel(changed):
    assert cache.key(text(oscillator())) != cache.key(text(oscillator(**changed)))


def test_method_tangents_and_kind_are_other_kernels():
    euler = Method("euler", 1, ((),), (1.0,), (0.0,), "")
    kinds = [
        text(oscillator()), text(oscillator(), euler), text(oscillator(), tangents=True),
        text(oscillator(), kind="locked"), text(oscillator(), tangents=True, kind="locked"),
    ]  # fmt: skip
    assert len({cache.key(source) for source in kinds}) == len(kinds)


def test_values_are_inputs_and_not_source():
    """Two operating points share a kernel, and each gets its own numbers."""
    model = oscillator(name="cache-values")
    one = System(model, {"k": 1.0, "g": 0.0, "omega": 1.0}).rhs(0.0, [1.0, 0.5])
    two = System(model, {"k": 3.0, "g": 0.5, "omega": 2.0}).rhs(0.0, [1.0, 0.5])
    assert one.tolist() == [0.5, -2.0]
    assert two.tolist() == [0.5, -3.5]


SCRIPT = """
from whirlmap.equations import Model, Parameter, State
from whirlmap.integrate.system import System
x, k = State("x", "1", "x"), Parameter("k", "1", "k")
print(System(Model("folder-test", (x,), (k,), {x: -k * x}), {"k": 2.0}).rhs(0.0, [1.5])[0])
"""


def run(folder):
    environment = {**os.environ, "WHIRLMAP_CACHE": str(folder)}
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(SCRIPT)], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return float(done.stdout)


def test_kernels_are_kept_in_the_chosen_folder_and_found_again(tmp_path):
    folder = tmp_path / "not there yet" / "kernels"
    assert run(folder) == -3.0
    first = {f: f.stat().st_mtime_ns for f in folder.rglob("*") if f.is_file()}
    assert any(f.suffix == ".nbc" for f in first), "nothing compiled was kept"
    assert run(folder) == -3.0
    assert {f: f.stat().st_mtime_ns for f in folder.rglob("*") if f.is_file()} == first


def test_size_and_clear_of_the_chosen_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("WHIRLMAP_CACHE", str(tmp_path / "k"))
    assert (cache.size(), cache.clear()) == (0, 0)
    (tmp_path / "k").mkdir()
    (tmp_path / "k" / "kernel_0123.py").write_text("pass\n")
    (tmp_path / "k" / "mine.txt").write_text("keep")
    assert cache.size() == 9
    assert cache.clear() == 1
    assert (tmp_path / "k" / "mine.txt").exists()


def test_a_damaged_module_is_written_again(tmp_path, monkeypatch):
    monkeypatch.setenv("WHIRLMAP_CACHE", str(tmp_path))
    source = "value = 42\n"
    path = tmp_path / f"kernel_{cache.key(source)}.py"
    path.write_text("value = 4")
    assert cache.module(source).value == 42
    sys.modules.pop(path.stem)
    assert path.read_text() == source


def test_a_folder_that_cannot_be_written_is_said_plainly(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("WHIRLMAP_CACHE", str(tmp_path / "file" / "below"))
    with pytest.raises(CacheError, match="WHIRLMAP_CACHE"):
        cache.module("value = 43\n")
