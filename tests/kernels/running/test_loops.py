"""Loops of the analyses: compiled once by Numba, and then called from their machine code alone."""

import os
import subprocess
import sys

import numpy as np
import pytest

from whirlmap.kernels.running.loops import compiled

LOOPS = '''
import sys
import numpy as np
from whirlmap.kernels.running.loops import compiled

FACTOR = {factor}

@compiled({{"x": "doubles", "n": "int", "out": "doubles"}})
def _scaled(x, n, out):
    for i in range(n):
        out[i] = {body}

x, out = np.arange(3.0), np.zeros(3)
_scaled(x=x, n=3, out=out)
print(out.tolist(), "numba" in sys.modules)
'''


def run(folder, factor=2.0, body="FACTOR * x[i]"):
    file = folder / "loops.py"
    file.write_text(LOOPS.format(factor=factor, body=body))
    environment = {**os.environ, "WHIRLMAP_CACHE": str(folder / "cache")}
    done = subprocess.run([sys.executable, str(file)], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_a_loop_is_compiled_once_and_then_read_without_numba(tmp_path):
    assert run(tmp_path) == "[0.0, 2.0, 4.0] True"
    assert run(tmp_path) == "[0.0, 2.0, 4.0] False"
    assert [f.name.rpartition("_")[0] for f in (tmp_path / "cache").iterdir()] == ["loop_scaled"]


def test_a_changed_loop_or_constant_of_its_file_is_compiled_again(tmp_path):
    run(tmp_path)
    assert run(tmp_path, factor=3.0) == "[0.0, 3.0, 6.0] True"
    assert run(tmp_path, factor=3.0, body="FACTOR + x[i]") == "[3.0, 4.0, 5.0] True"
    assert run(tmp_path) == "[0.0, 2.0, 4.0] False"


def test_the_key_holds_compiler_version_and_processor(monkeypatch):
    from whirlmap.analysis.indicators.recurrence import _diagonals
    from whirlmap.kernels.running import loops as module

    loop = _diagonals.__wrapped__
    keys = [module._key(loop)]
    with monkeypatch.context() as changed:
        changed.setattr(module, "package_version", lambda _: "0.0")
        keys.append(module._key(loop))
    with monkeypatch.context() as changed:
        changed.setattr(module, "platform", lambda: "another processor")
        keys.append(module._key(loop))
    assert len(set(keys)) == 3
    assert module._key(loop) == keys[0]


def test_a_loop_that_needs_numba_to_run_is_refused(tmp_path, monkeypatch):
    """Its code would call what only a process with Numba has, and loading it would end the program."""
    monkeypatch.setenv("WHIRLMAP_CACHE", str(tmp_path))

    @compiled({"n": "int", "out": "doubles"})
    def _reserves(n, out):
        room = np.empty(n)
        for i in range(n):
            room[i] = i
        out[0] = room.sum()

    with pytest.raises(RuntimeError, match=r"the loop reserves cannot run by itself: it needs .*NRT_"):
        _reserves(n=3, out=np.zeros(1))
    assert not list(tmp_path.iterdir())
