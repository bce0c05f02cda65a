"""`whirlmap.labels`: words in place of the codes of a Dataset, with its dimensions, also after a file."""

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import whirlmap
from whirlmap.errors import RangeError
from whirlmap.results.files import read, write
from whirlmap.results.regime import Regime
from whirlmap.results.schema import regime_variable, status_variable

CODES = [[1, 2, 3], [10, 6, 0]]


@pytest.fixture
def ds():
    made = {"regime": regime_variable(("psi", "s"), CODES), "status": status_variable(("psi", "s"), np.eye(2, 3, dtype=int))}
    return xr.Dataset(made, {"s": [1.0, 2.0, 3.0], "psi": [0.1, 0.2]})


def test_regimes_are_words(ds):
    said = whirlmap.labels(ds)
    assert said.values.tolist() == [["periodic", "quasi-periodic", "chaotic"], ["not-settled", "at-rest", "undecided"]]
    assert said.dims == ("psi", "s") and said.sel(s=3.0, psi=0.1).item() == "chaotic"


def test_the_words_are_those_of_the_commands(ds):
    assert whirlmap.labels(ds).values.tolist() == [[Regime(code).label for code in row] for row in CODES]
    assert whirlmap.labels(ds, "status").values[0, 0] == "contact"


def test_a_file_keeps_the_words(ds, tmp_path):
    assert whirlmap.labels(read(write(ds, tmp_path / "map.nc"))).equals(whirlmap.labels(ds))


def test_one_point_and_an_unknown_code(ds):
    one = ds.isel(s=0, psi=0)
    assert whirlmap.labels(one).item() == "periodic"
    one["regime"] = one["regime"].copy(data=np.int8(99))
    assert whirlmap.labels(one).item() == ""


def test_what_holds_no_codes_is_refused(ds):
    with pytest.raises(RangeError, match="regime, status"):
        whirlmap.labels(ds, "s")


def test_a_diagram_is_labelled_as_the_readme_says():
    diagram = whirlmap.bifurcation_diagram(whirlmap.load("duffing"), "gamma", [0.2, 0.29], lyapunov=0)
    assert whirlmap.labels(diagram).values[0] == "periodic"
    (lines,) = re.findall(r"```python\n(.*?)```", (Path(__file__).parents[2] / "README.md").read_text("utf-8"), re.DOTALL)
    assert "whirlmap.labels(diagram)" in lines
    assert len([line for line in lines.splitlines() if line]) <= 10
