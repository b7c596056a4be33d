"""Makes the oracles and families beside the tests importable, and the cases of motion."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[2] / "bench")]
