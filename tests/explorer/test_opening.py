"""What a page is opened from: a store whose files are not whole is refused, before any of its points is shown."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

import whirlmap
from whirlmap.errors import InputError
from whirlmap.explorer.encoding import decoded
from whirlmap.explorer.exploration import opened
from whirlmap.explorer.page import part
from whirlmap.explorer.session import Session
from whirlmap.sweep.store.zarr_store import Store


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


@pytest.fixture
def filling(tmp_path: Path) -> Path:
    """A store of four chunks of one point."""
    place = tmp_path / "b.map"
    axes = {"gamma": [0.2, 0.28], "omega": [1.15, 1.25]}
    whirlmap.regime_map(whirlmap.load("duffing"), axes, lyapunov=0, store=place, chunk=1)
    return place


def test_a_store_that_another_process_fills_says_how_far_it_is_and_is_read_again(filling: Path) -> None:
    whole = Store(filling)
    kept = {k: {n: np.asarray(a[whole.chunks.box(k)]) for n, a in whole.arrays.items()} for k in (1, 2)}
    for k in kept:
        data = {n: np.full_like(v, whole.arrays[n].fill_value) for n, v in kept[k].items()}
        whole.write(k, data)
        whole.group["chunks/receipt"][whole.chunks.cell(k)] = 0
    found = opened(str(filling))
    assert found is not None
    with Session(found) as session:
        first = session.data()
        assert first["grows"]
        assert first["overview"]["incomplete"] == "2 of 4 points computed"
        assert decoded(first["overview"]["regime"]).ravel().tolist().count(255) == 2
        whole.commit(1, kept[1])
        assert session.data()["overview"]["incomplete"] == "3 of 4 points computed"
        whole.commit(2, kept[2])
        last = session.data()["overview"]
        assert last["incomplete"] == ""
        assert 255 not in decoded(last["regime"])


def luminance(colour: str) -> float:
    """Relative luminance of #rrggbb (WCAG 2)."""
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    r, g, b = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b


@pytest.mark.parametrize("theme", [0, 1], ids=["light", "dark"])
def test_what_is_not_computed_looks_unlike_every_grey_of_a_regime(theme: int) -> None:
    sheet = part("explorer.css")
    own, *others = (
        luminance(re.findall(rf"--{name}: (#\w{{6}});", sheet)[theme]) for name in ("not_computed", "at_rest", "undecided")
    )
    for other in others:
        low, high = sorted((own, other))
        assert (high + 0.05) / (low + 0.05) > 2
