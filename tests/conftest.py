"""What several test folders share: the independent machine of `independent/newton.py`, importable by name."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "independent"))
