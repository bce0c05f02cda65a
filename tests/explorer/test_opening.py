"""What a page is opened from: a store whose files are not whole is refused, before any of its points is shown."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import whirlmap
from whirlmap.errors import InputError
from whirlmap.explorer.exploration import opened


@pytest.fixture
def store(tmp_path: Path) -> Path:
    axes = {"gamma": np.linspace(0.2, 0.3, 2), "omega": np.linspace(1.15, 1.25, 2)}
    whirlmap.regime_map(whirlmap.load("duffing"), axes, lyapunov=0, store=tmp_path / "a.map")
    return tmp_path / "a.map"


def test_a_store_opens_with_all_its_points(store: Path) -> None:
    found = opened(str(store))
    assert found is not None
    assert found.overview is not None
    assert found.overview["period_T"].shape == (2, 2)


@pytest.mark.parametrize("damage", ["missing", "cut", "axis"])
def test_a_damaged_store_is_refused(store: Path, damage: str) -> None:
    (chunk,) = (p for p in (store / "regime" / "c").rglob("*") if p.is_file())
    if damage == "missing":
        chunk.unlink()
    elif damage == "cut":
        chunk.write_bytes(chunk.read_bytes()[:5])
    else:
        shutil.rmtree(store / "gamma")
    with pytest.raises(InputError, match=r"a\.map: (1 of 1 chunks|gamma) are damaged; .* --resume repairs the store"):
        opened(str(store))


def test_a_folder_that_is_no_store_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="found a folder that is no store"):
        opened(str(tmp_path))
