"""Programs that measure: a file per question, ``python -m bench.NAME``. They need a checkout; studies are shared with tests."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
