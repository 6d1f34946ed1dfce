"""The core beside motions that were measured; models and data of some are worked examples."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2] / "examples"))
