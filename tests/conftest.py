"""What several test folders share, importable by name: `independent/newton.py` and the maps of `analysis/maps.py`."""

import sys
from pathlib import Path

for _folder in ("independent", "analysis"):
    sys.path.insert(0, str(Path(__file__).parent / _folder))
