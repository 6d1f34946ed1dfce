"""Made data of walkers, by the independent simulator of the tests, and of models of one's own."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2] / "tests"))
