"""CPU time of reading 200 000 rows of six columns: a log, and a program of voltages.

It needs public names alone, so that ``PYTHONPATH=... python -m bench reading`` measures
any version: run it for two of them in turn.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np

import stickslip
from stickslip import Waveform, models

ROWS, REPEATS = 200_000, 3


def main() -> None:
    random, t = np.random.default_rng(0), 1e-3 * np.arange(ROWS)
    torque = np.where(np.sin(3.0 * t) > 0.0, 0.5, -0.5)
    speed = 1e-3 * np.cumsum(torque) + 0.01 * random.standard_normal(ROWS)
    beside = random.standard_normal((3, ROWS))
    joint = models.joint(inertia=0.1, viscous=0.2)
    files = {
        "log": ("t (s),torque (N m),speed (rad/s),a,b,c",
                lambda path: models.read_log(path, joint)),
        "voltages": ("t,xp,xm,yp,ym,clamp", Waveform.from_csv),
    }  # fmt: skip
    print(stickslip.__file__)
    with tempfile.TemporaryDirectory() as folder:
        for name, (head, read) in files.items():
            path = Path(folder) / f"{name}.csv"
            rows = np.column_stack([t, torque, speed, *beside])
            np.savetxt(path, rows, delimiter=",", header=head, comments="", fmt="%.8g")
            took = []
            for _ in range(REPEATS):
                begin = time.process_time()
                read(path)
                took.append(time.process_time() - begin)
            print(f"{name}: {min(took):.2f} s, of {', '.join(f'{each:.2f}' for each in took)}")


if __name__ == "__main__":
    main()
