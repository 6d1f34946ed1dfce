"""A tumbling magnetic robot at rest: its angle over the field (`examples/cases/tumbler`).

A moment along the body cannot rest near 55 degrees; that can be said from the same data alone, so a
claim is at best not contradicted.
"""

from pathlib import Path

from real.sets import Measured, Truth, of_files

FILES = Path(__file__).parents[4] / "examples" / "cases" / "tumbler" / "measurement.toml"

SETS = [
    Measured(
        "tumbler",
        Truth(("misalignment",), ("angle_offset", "surface_tilt", "ambient_field")),
        of_files(FILES, "angle"),
    )
]  # fmt: skip
