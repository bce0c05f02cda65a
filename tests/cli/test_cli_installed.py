"""What an installed program lists: nothing that only a checkout has."""

import os
import subprocess
import sys
from pathlib import Path

import whirlmap

PACKAGE = Path(whirlmap.__file__).parent


def listed(search_path: Path) -> str:
    environment = {**os.environ, "PYTHONPATH": str(search_path), "COLUMNS": "100"}
    run = [sys.executable, "-m", "whirlmap", "--help"]
    return subprocess.run(run, capture_output=True, text=True, check=True, env=environment).stdout


def test_the_comparison_is_listed_in_a_checkout_alone(tmp_path):
    site = tmp_path / "lib" / "python" / "site-packages"
    site.mkdir(parents=True)
    (site / "whirlmap").symlink_to(PACKAGE)
    installed, checkout = listed(site), listed(PACKAGE.parent)
    assert "heyoka" in checkout and "heyoka" not in installed
    assert "improve" in checkout and "improve" in installed
