"""Every public name can be the first that is used, and warns of nothing."""

import os
import subprocess
import sys

import pytest

import whirlmap

#: One process, whose children each import the package for one name alone; what is not ours was imported before.
CODE = """
import os, sys, traceback
import matplotlib.figure, numpy, pandas, scipy, sympy, xarray
for name in sys.argv[1:]:
    child = os.fork()
    if not child:
        try:
            import whirlmap
            assert getattr(whirlmap, name) is not None
        except BaseException:
            print(name, file=sys.stderr)
            traceback.print_exc()
            os._exit(1)
        os._exit(0)
    if os.waitpid(child, 0)[1]:
        sys.exit(f"import whirlmap; whirlmap.{name}")
print(len(sys.argv) - 1)
"""


@pytest.mark.slow  # a third of a second for each name
@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs processes that fork")
def test_every_name_is_imported_on_its_own_without_a_warning():
    names = [*whirlmap.__all__]
    done = subprocess.run([sys.executable, "-W", "error", "-c", CODE, *names], capture_output=True, text=True, timeout=280)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) == len(names) >= 30


def test_all_names_in_one_process_are_those_of_dir():
    code = "import whirlmap; print(*(n for n in dir(whirlmap) if getattr(whirlmap, n) is not None))"
    done = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, timeout=280)
    assert done.returncode == 0, done.stderr
    assert set(done.stdout.split()) == set(whirlmap.__all__)
    with pytest.raises(AttributeError, match="no attribute 'bifurcation'"):
        whirlmap.bifurcation  # noqa: B018
