"""A measurement that the simulator made: IPP, both directions, three trials of eight settings."""

import numpy as np
import pandas as pd

from stickslip import load, simulate_batch
from stickslip.walker import problem as measured

NOMINAL = """stickslip = 1

[drive]
base = 0.5e-3
pulses = 6

[solver]
rtol = 1e-6
"""

MEASUREMENT = """stickslip_measurement = 1
name = "test bench"
scenario = "nominal.toml"

[uncertain]
"contact.kinetic_friction" = { mean = 0.145, sd = 0.01 }
"drag.linear" = { low = 3e-6, high = 3e-5 }

[[velocity]]
file = "velocity.csv"
"""


def few_causes(patch, names):
    """Diagnoses in this process try some of the effects and no law, which is quicker."""
    every = measured.library
    patch.setattr(
        measured, "library", lambda *known: tuple(c for c in every(*known) if c.name in names)
    )
    patch.setattr(measured, "_laws", lambda *_: ())


def write(folder, changes, seed=0, change=None):
    """A measurement of a robot with `changes`: IPP, both directions, three trials.

    `change` turns the lines of the table into others.
    """
    (folder / "nominal.toml").write_text(NOMINAL)
    (folder / "m.toml").write_text(MEASUREMENT)
    base = load(folder / "nominal.toml").replace(
        {"contact.kinetic_friction": 0.151, "drag.linear": 1.3e-5, **changes}
    )
    drives = [(way, f) for way in ("+x", "-x") for f in (25.0, 40.0, 60.0, 90.0)]
    runs = simulate_batch(
        [base.replace({"drive.direction": way, "drive.frequency": f}) for way, f in drives]
    )
    random = np.random.default_rng(seed)
    lines = ["direction,frequency,trial,velocity"]
    for (way, f), run in zip(drives, runs, strict=True):
        for trial in range(3):
            velocity = run.mean_velocity * (1 + 0.02 * random.standard_normal())
            lines.append(f"{way},{f},{trial},{velocity!r}")
    lines = lines if change is None else change(lines)
    (folder / "velocity.csv").write_text("\n".join(lines) + "\n")
    return folder / "m.toml"


def write_files(folder, nominal, toml, **tables):
    """The file of a measurement beside its scenario and tables, each as text or columns."""
    (folder / "nominal.toml").write_text(nominal)
    (folder / "m.toml").write_text(toml)
    for name, table in tables.items():
        text = (
            table
            if isinstance(table, str)
            else pd.DataFrame(table).to_csv(index=False, na_rep="nan")
        )
        (folder / f"{name}.csv").write_text(text)
    return folder / "m.toml"
