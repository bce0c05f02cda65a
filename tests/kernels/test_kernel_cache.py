"""The source of a kernel is its identity, and the folder of compiled kernels does what the user says."""

import dataclasses
import os
import shutil
import subprocess
import sys
import textwrap
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import whirlmap
from whirlmap.equations import Model, Output, Parameter, State, Stop, Table, cos, t
from whirlmap.equations.identity import model_digest
from whirlmap.errors import CacheError, InputError
from whirlmap.integrate.system import System
from whirlmap.kernels import cache
from whirlmap.kernels.methods import RK4, Method
from whirlmap.kernels.running import machine
from whirlmap.kernels.running.source import kernel_source
from whirlmap.models import family

x, v = State("x", "1", "position"), State("v", "1", "velocity")
k, g, omega = (Parameter(n, "1", n) for n in ("k", "g", "omega"))


def oscillator(coefficient=1.0, *, name="cache-test", bound=1e6, gap=2, swapped=False, outputs=None):
    equations = {x: v, v: -k * x - coefficient * x**3 + g * cos(omega * t)}
    return Model(
        name, (v, x) if swapped else (x, v), (k, g, omega), equations, harmonics=(omega,), bound=bound,
        stops={"contact": Stop(gap - x, "wall")}, outputs=outputs or {},
    )  # fmt: skip


def text(model, method=RK4, *, slopes="none", kind="free"):
    return kernel_source(model, method, slopes=slopes, kind=kind, estimated=False, fused=False).text


def test_equal_models_have_equal_source():
    assert text(oscillator()) == text(oscillator())
    both = [family("gear_pair").model(edition=e, arc="fixed", film="porous") for e in ("intended", "physical")]
    assert text(both[0]) == text(both[1])  # the same equations: nothing is compiled twice


@pytest.mark.parametrize(
    "changed",
    [
        {"coefficient": 1.5}, {"coefficient": 1.0000001}, {"name": "other"}, {"gap": 3},
        {"swapped": True}, {"outputs": {"e": Output(x**2, "1", "energy")}},
    ],
    ids=str,
)  # fmt: skip
def test_any_change_of_the_model_is_another_kernel(changed):
    assert machine.key(text(oscillator())) != machine.key(text(oscillator(**changed)))


def test_method_tangents_and_kind_are_other_kernels():
    euler = Method("euler", 1, ((),), (1.0,), (0.0,), "")
    kinds = [
        text(oscillator()), text(oscillator(), euler), text(oscillator(), slopes="jacobian"),
        text(oscillator(), kind="locked"), text(oscillator(), slopes="jacobian", kind="locked"),
        text(oscillator(), slopes="along", kind="locked"),
    ]  # fmt: skip
    assert len({machine.key(source) for source in kinds}) == len(kinds)


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


def run(folder, script=SCRIPT, source=None):
    environment = {**os.environ, "WHIRLMAP_CACHE": str(folder)}
    if source:
        environment["PYTHONPATH"] = str(source)
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return float(done.stdout)


def test_kernels_are_kept_in_the_chosen_folder_and_found_again(tmp_path):
    folder = tmp_path / "not there yet" / "kernels"
    assert run(folder) == -3.0
    first = {f: f.stat().st_mtime_ns for f in folder.rglob("*") if f.is_file()}
    assert any(f.suffix == ".o" for f in first), "nothing compiled was kept"
    assert run(folder) == -3.0
    assert {f: f.stat().st_mtime_ns for f in folder.rglob("*") if f.is_file()} == first


def test_size_and_clear_of_the_chosen_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("WHIRLMAP_CACHE", str(tmp_path / "k"))
    assert (cache.size(), cache.clear()) == (0, (0, 0))
    (tmp_path / "k").mkdir()
    (tmp_path / "k" / "kernel_0123.o").write_text("pass\n")
    (tmp_path / "k" / "loop_it_0123.o").write_text("\n")
    (tmp_path / "k" / "lowered_0123.json").write_text("{}")
    (tmp_path / "k" / "table_0123.f8").write_text("1\n")
    (tmp_path / "k" / "mine.txt").write_text("keep")
    assert cache.size() == 14
    assert cache.counts() == (1, 1)
    assert cache.clear() == (1, 1)
    assert [f.name for f in (tmp_path / "k").iterdir()] == ["mine.txt"]
    assert (tmp_path / "k" / "mine.txt").exists()


NOTHING = "define void @nothing() {\n  ret void\n}\n"


def test_a_damaged_kernel_is_compiled_again_with_a_warning(tmp_path, monkeypatch):
    monkeypatch.setenv("WHIRLMAP_CACHE", str(tmp_path))
    path = tmp_path / f"kernel_{machine.key(NOTHING)}.o"
    machine.Code.of(NOTHING).function("nothing", {})()
    sound = path.read_bytes()
    for damage in (b"", sound[:-1], sound[:-200] + bytes(200)):
        path.write_bytes(damage)
        with pytest.warns(UserWarning, match="damaged"):
            machine.Code.of(NOTHING).function("nothing", {})()
        assert path.read_bytes() == sound


def test_a_folder_that_cannot_be_written_is_said_plainly(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("WHIRLMAP_CACHE", str(tmp_path / "file" / "below"))
    with pytest.raises(CacheError, match="WHIRLMAP_CACHE"):
        machine.Code.of(NOTHING)


# --- what lowering gave ------------------------------------------------------------------------------------

EVERYTHING = """
import numpy as np
from whirlmap.equations import Model, Output, Parameter, State, Stop, cos, t
from whirlmap.integrate.equilibrium import start_states
from whirlmap.integrate.system import System
from whirlmap.kernels.running.reference import reference_outputs
x, k, w = State("x", "1", "x"), Parameter("k", "1", "k"), Parameter("w", "1", "w")
model = Model("folder-test", (x,), (k, w), {x: 1 - k * x + cos(w * t)}, harmonics=(w,), start="equilibrium",
              outputs={"o": Output(x**2, "1", "o")}, stops={"wall": Stop(9 - x, "wall")})
system = System(model, {"k": 2.0, "w": 1.0})
start = start_states(model, system.vector[:, None])[0]
numbers = [system.rhs(0.0, [1.5])[0], system.jacobian(0.0, [1.5])[0, 0], system.period, start[0, 0],
           system.reference_rhs(0.0, [1.5])[0], reference_outputs(model)(start, system.vector[:, None])[0, 0]]
print(sum(10**i * number for i, number in enumerate(numbers)))
"""


def test_what_was_lowered_is_read_again_without_lowering(tmp_path):
    """The second process must neither print an expression nor derive a Jacobian."""
    first = run(tmp_path, EVERYTHING)
    assert len(list(tmp_path.glob("lowered_*.json"))) >= 6
    forbidden = """
    import whirlmap.kernels.lowering.formulas as formulas, whirlmap.kernels.running.source as source
    def refuse(*_, **__): raise SystemExit("lowered again")
    formulas.lambdify = source.straight = source.jacobian_code = refuse
    """
    assert run(tmp_path, textwrap.dedent(forbidden) + EVERYTHING) == first


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """A copy of the source, the cache that it filled, and its number."""
    folder = tmp_path_factory.mktemp("sound")
    package = Path(whirlmap.__file__).parent
    shutil.copytree(package, folder / "src" / "whirlmap", ignore=shutil.ignore_patterns("__pycache__"))
    return folder, run(folder / "kernels", EVERYTHING, folder / "src")


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("kernels/writing/vector.py", "return number(_real(e))", "return number(_real(e) + 1)"),
        ("kernels/lowering/formulas.py", "[normal_form(e) for e in", "[2 * normal_form(e) for e in"),
        ("integrate/step_retry.py", "[getattr(stop, field) for", "[-getattr(stop, field) for"),
        ("equations/identity.py", "Known = dict", "Known  = dict"),
    ],
    ids=lambda text: text if text.endswith(".py") else "",
)
def test_a_change_of_the_source_that_writes_gives_new_numbers(sound, tmp_path, file, old, new):
    """An entry of yesterday's source would be a wrong number that nobody can explain."""
    whole, before = sound
    shutil.copytree(whole, tmp_path, ignore=shutil.ignore_patterns("__pycache__"), dirs_exist_ok=True)
    folder = tmp_path / "kernels"
    entries = set(folder.glob("lowered_*.json"))
    changed = tmp_path / "src" / "whirlmap" / file
    text = changed.read_text()
    assert old in text
    changed.write_text(text.replace(old, new))
    after = run(folder, EVERYTHING, tmp_path / "src")
    assert (after == before) == (file == "equations/identity.py")  # a change of layout alone: new entries, old numbers
    assert len(set(folder.glob("lowered_*.json"))) >= 2 * len(entries) - 1


@pytest.mark.parametrize("damage", [b"", b"{}", b"\xff\xfe", b"0123\n[1, 2]"], ids=["empty", "cut", "binary", "altered"])
def test_a_damaged_entry_is_worked_out_again_with_a_warning(tmp_path, monkeypatch, damage):
    monkeypatch.setenv("WHIRLMAP_CACHE", str(tmp_path))
    asked = []

    def answer():
        asked.append(1)
        return [1.5, "text"]

    def remembered():
        return cache.remembered("question", answer, lambda data: isinstance(data, list))

    assert [remembered(), remembered(), len(asked)] == [[1.5, "text"], [1.5, "text"], 1]
    (entry,) = tmp_path.iterdir()
    sound = entry.read_bytes()
    entry.write_bytes(damage)
    with pytest.warns(UserWarning, match="damaged"):
        assert remembered() == [1.5, "text"]
    assert entry.read_bytes() == sound
    assert [remembered(), len(asked)] == [[1.5, "text"], 2]
    assert cache.remembered("another question", lambda: 3, lambda data: data == 3) == 3


def test_an_entry_of_another_form_is_no_answer(tmp_path, monkeypatch):
    monkeypatch.setenv("WHIRLMAP_CACHE", str(tmp_path))
    cache.remembered("question", lambda: 1, lambda data: True)
    with pytest.warns(UserWarning, match="damaged"):
        assert cache.remembered("question", lambda: [2], lambda data: isinstance(data, list)) == [2]


def test_many_threads_may_fill_the_same_entry_at_once(tmp_path, monkeypatch):
    monkeypatch.setenv("WHIRLMAP_CACHE", str(tmp_path))
    together = threading.Barrier(8)

    def answer():
        together.wait()
        return list(range(20_000))

    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda _: cache.remembered("question", answer, lambda data: True), range(8)))
    assert all(data == list(range(20_000)) for data in found)
    assert [f.suffix for f in tmp_path.iterdir()] == [".json"]


def table(coordinates=("z",), outputs=("f",), degree=3):
    def line(p, *z):
        return (z[0],) * len(outputs)

    return Table("curve", coordinates, outputs, line, line, lambda p: (np.linspace(0, 1, 9),) * len(coordinates), degree)


def declared(**changed):
    """Oscillator whose whole declaration can be changed, one part at a time."""
    parts = {
        "name": "identity", "states": (x, v), "parameters": (k, g, omega), "harmonics": (omega,), "bound": 1e6,
        "equations": {x: v, v: -k * x + g * cos(omega * t)}, "outputs": {"e": Output(x**2, "1", "energy")},
        "stops": {"contact": Stop(2 - x, "wall")}, "clocks": {"forcing": omega}, "defaults": {g: 1},
        "tables": (table(),),
    }  # fmt: skip
    return Model(**{**parts, **changed})


CHANGES = {
    "name": {"name": "other"},
    "equation": {"equations": {x: v, v: -k * x - x**3 + g * cos(omega * t)}},
    "coefficient": {"equations": {x: v, v: -1.0000001 * k * x + g * cos(omega * t)}},
    "float for integer": {"equations": {x: 1.0 * v, v: -k * x + g * cos(omega * t)}},
    "order of states": {"states": (v, x)},
    "start": {"states": (State("x", "1", "position", start=2.0), v), "clocks": {}},
    "cyclic": {"states": (State("x", "1", "position", cyclic=6.28), v), "clocks": {}},
    "order of parameters": {"parameters": (g, k, omega)},
    "harmonic": {"harmonics": (omega, 2 * omega)},
    "output": {"outputs": {"e": Output(x**4, "1", "energy")}},
    "output's name": {"outputs": {"f": Output(x**2, "1", "energy")}},
    "stop": {"stops": {"contact": Stop(3 - x, "wall")}},
    "stop reachable": {"stops": {"contact": Stop(2 - x, "wall", k)}},
    "bound": {"bound": 1e5},
    "teeth": {"teeth": x - 1},
    "clock": {"clocks": {"forcing": omega / 2}},
    "default": {"defaults": {g: 2}},
    "likeness": {"alike": ((x, v),)},
    "table's coordinates": {"tables": (table(coordinates=("z", "u")),)},
    "table's outputs": {"tables": (table(outputs=("f", "g")),)},
    "table's degree": {"tables": (table(degree=5),)},
}


@pytest.mark.parametrize("change", list(CHANGES))
def test_the_digest_changes_with_every_part_of_a_declaration(change):
    """What the digest does not see, the cache would answer with another model's numbers."""
    assert model_digest(declared()) == model_digest(declared())
    parts = dict(CHANGES[change])
    if parts.get("states", (x, v))[0] is not x and "equations" not in parts and change != "order of states":
        other = parts["states"][0]
        parts |= {"equations": {other: v, v: -k * other + g * cos(omega * t)}, "stops": {}, "outputs": {}}
        base = declared(stops={}, outputs={}, clocks={})
    else:
        base = declared()
    assert model_digest(declared(**parts)) != model_digest(base)


def test_no_part_of_a_declaration_is_forgotten():
    """A new field of a model is either part of its digest or is said here not to reach any cached answer."""
    digested = {
        "name", "states", "parameters", "equations", "harmonics", "defaults", "outputs", "stops", "section",
        "typical_time", "start", "bound", "tables", "clocks", "switchings", "teeth", "alike",
    }  # fmt: skip
    read_when_running = {
        "start_where_none", "plain", "checks", "switches", "swing", "sources", "films", "bodies", "equilibrium",
        "speed", "journals", "unbalances", "assumptions", "near_equilibrium", "stations", "angular_acceleration",
    }  # fmt: skip
    assert {f.name for f in dataclasses.fields(Model)} == digested | read_when_running


def test_digests_of_stock_models_differ_and_are_the_same_in_every_process():
    script = "import whirlmap.models as m\nfrom whirlmap.equations.identity import model_digest\n"
    script += "for f in m.FAMILIES.values(): print(model_digest(f.model()))"
    found = []
    for seed in ("1", "2"):
        environment = {**os.environ, "PYTHONHASHSEED": seed}
        done = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=True)
        found.append(done.stdout.split())
    assert found[0] == found[1]
    assert len(set(found[0])) == len(found[0]) == 8


TARGET = """
import numpy as np
from whirlmap.equations import Model, Parameter, State
from whirlmap.integrate.system import System
x, k = State("x", "1", "x"), Parameter("k", "1", "k")
print(System(Model("target-test", (x,), (k,), {x: -k / x**3}), {"k": 2.0}).rhs(0.0, np.full((1, 9), 2.0))[0, 8])
"""


def test_code_for_a_common_processor_is_another_file_with_the_same_numbers(tmp_path, monkeypatch):
    if not machine.llvm.get_host_cpu_features().get("avx2"):
        pytest.skip("this processor has no level x86-64-v3")
    assert run(tmp_path, TARGET) == -0.25
    first = set(tmp_path.glob("*.o"))
    monkeypatch.setenv("WHIRLMAP_CPU", "x86-64-v3")
    assert run(tmp_path, TARGET) == -0.25
    assert first < set(tmp_path.glob("*.o"))


def test_a_processor_that_is_none_is_refused(monkeypatch):
    monkeypatch.setenv("WHIRLMAP_CPU", "pentium-9")
    with pytest.raises(InputError, match="x86-64-v3" if machine.llvm.get_host_cpu_features().get("avx2") else "pentium-9"):
        machine.processor()
