"""A data set as a folder with what a laboratory would have, as a measurement file says it.

`python -m bench blind KIND SEED INTO` writes one as files, and its answer apart.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from blind.generator import Made, make
from blind.kinds import KINDS
from blind.noise import noisy_tables, trials
from blind.settings import (
    EXPOSURE,
    FILM_SD,
    FRAME_RATE,
    PULSES,
    Drive,
    films,
    held_fields,
    priors,
    probes,
)

KEYS = ("mode", "frequency", "peak", "base", "hold", "direction")
_PROBE = ("xp", "xm", "yp", "ym", "clamp", "x", "y", "z")
_HEAD = 'stickslip_measurement = 1\nname = "study"\nscenario = "nominal.toml"\n\n[uncertain]\n'


def write_case(folder: Path, kind: str, seed: int) -> dict[str, Any]:
    """Write one data set into `folder`; return the answer."""
    made = make(kind, seed)
    folder.mkdir(parents=True, exist_ok=True)
    tables = KINDS[kind].tables
    (folder / "nominal.toml").write_text(f"stickslip = 1\n\n[drive]\npulses = {PULSES}\n")
    stated = [f'"{name}" = {prior.stated}' for name, prior in priors(tables).items()]
    entries = [_HEAD + "\n".join(stated) + "\n"]
    if "velocity" in tables:
        entries.append(_write_velocities(folder / "velocity.csv", made))
    seen = noisy_tables(made.level, made.truth.correlation, made.random)
    if "angle" in tables:
        rows = np.column_stack([held_fields(), seen.angle])
        entries.append(_write(folder / "angle.csv", "angle", ("Bx", "Bz", "theta"), rows))
    if "field" in tables:
        rows = np.column_stack([probes(), seen.field])
        entries.append(_write(folder / "field.csv", "field", (*_PROBE, "Bx", "By", "Bz"), rows))
    for number, (drive, film) in enumerate(zip(films(), seen.films, strict=False)):
        path = folder / f"run{number}.csv"
        entries.append(_write(path, "tracking", tuple(film), np.column_stack(list(film.values()))))
        entries.append(_film_entry(drive))
    (folder / "measurement.toml").write_text("".join(entries))
    return {
        "seed": seed, "strength": made.strength, "tables": tables, **made.more,
        **made.truth.as_record(),
    }  # fmt: skip


def _write_velocities(path: Path, made: Made) -> str:
    noise = KINDS[made.truth.kind].noise
    values, setup = trials(
        made.level.velocity, made.drives, noise, made.truth.correlation, made.random
    )
    if made.truth.kind == "shuffled":
        values = made.random.permutation(values.ravel()).reshape(values.shape)
    head = ["velocity", "trial", *KEYS, *(["block"] if noise.setups else [])]
    rows = _rows(made.drives, values, setup if noise.setups else None, KEYS)
    path.write_text("\n".join([",".join(head), *rows]) + "\n")
    return _entry(path, "velocity")


def _rows(drives: Sequence[Drive], values: Any, setup: Any, keys: Sequence[str]) -> Iterable[str]:
    """Lines of a table of velocities, one a trial."""
    for at, (drive, row) in enumerate(zip(drives, values, strict=True)):
        for number, value in enumerate(row):
            cells = [repr(float(value)), str(number), *(str(drive[key]) for key in keys)]
            yield ",".join(cells + ([] if setup is None else [f"day{setup[at, number]}"]))


def _write(path: Path, table: str, columns: Sequence[str], rows: Any) -> str:
    lines = [",".join(repr(float(cell)) for cell in row) for row in rows]
    path.write_text("\n".join([",".join(columns), *lines]) + "\n")
    return _entry(path, table)


def _entry(path: Path, table: str) -> str:
    return f'\n[[{table}]]\nfile = "{path.name}"\n'


def _film_entry(drive: Drive) -> str:
    cells = [f'{key} = "{each}"' if isinstance(each, str) else f"{key} = {each}"
             for key, each in drive.items()]  # fmt: skip
    return (
        f"frame_rate = {FRAME_RATE}\nexposure = {EXPOSURE}\nnoise_x = {FILM_SD['x']}\n"
        f"noise_theta = {FILM_SD['theta']}\ndrive = {{ {', '.join(cells)} }}\n"
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser("python -m bench blind", description=__doc__)
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("seed", type=int)
    parser.add_argument("into", type=Path, help="folder; a strong cause is sought for minutes")
    asked = parser.parse_args()
    answer = write_case(asked.into / "data", asked.kind, asked.seed)
    (asked.into / "answer.json").write_text(json.dumps(answer, indent=2) + "\n")
