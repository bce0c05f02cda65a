"""Kernels for a browser: what a module imports and exports, and what is refused."""

import subprocess

import pytest
from sympy import erf, exp, log
from tests.explorer.saved.node import needs_node

from whirlmap.equations import Model, State
from whirlmap.errors import ModelError
from whirlmap.kernels.methods import DOP853, RK4
from whirlmap.kernels.webassembly.browser_kernel import ALWAYS, browser_kernel, compile_webassembly
from whirlmap.kernels.webassembly.object_file import HEAD, Reader, imported, leb, loadable

x, y = State("x", "1", "x", start=0.3), State("y", "1", "y")


def model(rate):
    return Model("browsed", (x, y), (), {x: rate, y: -x})


def test_a_module_needs_memory_stack_and_the_functions_of_its_rates():
    kernel = browser_kernel(model(exp(-x) + log(2 + y)), RK4)
    assert set(imported(kernel.locked)) == {*ALWAYS, "exp", "log"}


def test_functions_that_browsers_do_not_have_are_refused_by_name():
    with pytest.raises(ModelError, match="'browsed' cannot run in a browser: its rates call erf, which browsers do not"):
        browser_kernel(model(erf(x)), RK4)


@needs_node
def test_node_accepts_the_modules(tmp_path):
    kernel = browser_kernel(model(exp(-x)), DOP853)
    for module, names in ((kernel.locked, "advance"), (kernel.free, "march,evaluate")):
        (tmp_path / "k.wasm").write_bytes(module)
        code = "const m = new WebAssembly.Module(require('fs').readFileSync(process.argv[1]));"
        code += "console.log(String(WebAssembly.Module.exports(m).map((e) => e.name)))"
        done = subprocess.run(["node", "-e", code, str(tmp_path / "k.wasm")], capture_output=True, text=True, check=True)
        assert done.stdout.strip() == names


def test_an_object_file_with_data_is_refused():
    text = "@table = constant [3 x double] [double 1.0, double 2.0, double 4.0]\n"
    text += "define double @read(i32 %i) { %p = getelementptr [3 x double], [3 x double]* @table, i32 0, i32 %i\n"
    text += "%v = load double, double* %p\n ret double %v }"
    with pytest.raises(RuntimeError, match="holds data of its own"):
        loadable(compile_webassembly(text), ["read"])


def test_what_is_exported_must_be_there():
    made = compile_webassembly("define double @twice(double %x) { %y = fadd double %x, %x\n ret double %y }")
    assert loadable(made, ["twice"]).startswith(HEAD)
    with pytest.raises(RuntimeError, match="no function thrice"):
        loadable(made, ["thrice"])


@pytest.mark.parametrize("number", [0, 1, 127, 128, 300, 16384, 2**31])
def test_whole_numbers_are_read_as_written(number):
    assert Reader(leb(number) + b"rest").number() == number
