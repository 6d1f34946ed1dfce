"""The walk of the README: simulated velocities, beside those of measured robots."""

from pathlib import Path

from real.score import Measured, Truth, of_files

FILES = Path(__file__).parents[4] / "examples" / "measurement.toml"
NAME = "effects.friction_anisotropy.fraction"

SETS = [
    Measured("walk of the README, simulated", (1e6, "um/s"),
             Truth(("friction_anisotropy",), values={NAME: (0.15, 0.0)}),
             of_files(FILES, "fraction"))
]  # fmt: skip
