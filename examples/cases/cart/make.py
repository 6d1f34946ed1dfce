"""Makes log.csv: a cart whose drive acts 40 ms after its command, by steps of 0.1 ms.

python make.py
"""

from math import copysign, exp
from pathlib import Path

import numpy as np

MASS, GAIN, VISCOUS, COULOMB = 2.0, 3.0, 4.0, 1.5  # kg, N/V, N s/m, N
STEP, FINE, COUNT, LATE = 0.02, 200, 180, 400  # s between readings, steps to each; steps late
NOISE = 2e-4  # m, of an encoder

t = STEP * np.arange(COUNT)
command = 2.5 * np.sign(np.sin(4.0 * t) + np.sin(2.3 * t + 1.0)) * (t > 0.1)

x = v = 0.0
dt = STEP / FINE
kept = exp(-VISCOUS / MASS * dt)  # of a speed, after a step
positions = []
for k in range(COUNT * FINE):
    if k % FINE == 0:
        positions.append(x)
    push = GAIN * command[max(k - LATE, 0) // FINE]
    if v == 0.0 and abs(push) <= COULOMB:
        continue
    way = copysign(1.0, v or push)
    last = (push - COULOMB * way) / VISCOUS  # speed at which forces balance
    faster = last + (v - last) * kept
    faster = 0.0 if faster * way < 0.0 else faster
    x += 0.5 * dt * (v + faster)
    v = faster
read = np.array(positions) + NOISE * np.random.default_rng(1).standard_normal(COUNT)

rows = [f"{a:.2f},{b:.1f},{c:.5f}" for a, b, c in zip(t, command, read, strict=True)]
text = "\n".join(["t (s),command (V),position (m)", *rows]) + "\n"
Path(__file__).with_name("log.csv").write_text(text)
