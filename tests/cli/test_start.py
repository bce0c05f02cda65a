"""What a warm start imports: whatever is heavy and not needed would be paid for by every command."""

import os
import subprocess
import sys

import pytest

#: Nothing that diagnose prints needs these: Numba compiles loops that are kept, xarray and what it imports hold Datasets
#: that nobody asked for, and nothing is drawn.
HEAVY = ("numba", "xarray", "pandas", "dask", "pint", "scipy", "matplotlib", "netCDF4", "zarr", "jinja2")

CODE = f"""
import sys
sys.argv = ["whirlmap", *sys.argv[1:]]
from whirlmap.cli.main import run
try:
    run()
finally:
    print(*(name for name in {HEAVY} if name in sys.modules), file=sys.stderr)
"""


def imported(folder, command, program=CODE):
    environment = {**os.environ, "WHIRLMAP_CACHE": str(folder)}
    done = subprocess.run([sys.executable, "-c", program, *command.split()], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stderr.splitlines()[-1].split()


@pytest.fixture(scope="module")
def kernels(tmp_path_factory):
    """A cache of their own, which begins empty and is shared: what is compiled for one command is warm for the next."""
    return tmp_path_factory.mktemp("kernels")


@pytest.mark.parametrize(
    "command",
    [
        "diagnose duffing --set gamma=0.29",  # periodic: Floquet multipliers
        "diagnose duffing --section-points 600 --max-periods 64",  # chaotic: 0-1 test, recurrence, correlation dimension
        "diagnose lorenz --section-points 600 --max-periods 64 --json",  # not forced: crossings of a section
        "show gear-psfd/machine",
    ],
)
def test_a_warm_start_imports_nothing_that_it_does_not_need(command, kernels):
    imported(kernels, f"{command} --quiet" if command.startswith("diagnose") else command)
    assert imported(kernels, f"{command} --quiet" if command.startswith("diagnose") else command) == []


def test_a_dataset_is_made_where_it_is_written(kernels, tmp_path):
    """What the test above looks for can be seen."""
    assert "xarray" in imported(kernels, f"diagnose duffing --set gamma=0.29 --quiet --out {tmp_path / 'd.nc'}")


@pytest.mark.parametrize("command", ["--help", "--version"])
def test_the_list_of_commands_imports_no_command(command, tmp_path):
    program = f"{CODE}    print(*(n for n in sys.modules if n == 'sympy' or '.cli.commands.' in n), file=sys.stderr)"
    assert imported(tmp_path, command, program) == []
    assert "whirlmap.cli.commands.cases" in imported(tmp_path, "cases", program)
