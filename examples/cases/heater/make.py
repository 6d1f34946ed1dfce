"""Makes log.csv: a heated block that is warmed through its heater, by steps of 10 ms.

python make.py
"""

from pathlib import Path

import numpy as np

CAPACITY, LOSS = 200.0, 2.0  # J/K, W/K
HEATER, COUPLING = 20.0, 2.5  # J/K, W/K: a store of its own, 8 s
STEP, FINE, COUNT = 4.0, 400, 120  # s between readings, steps to each, readings
NOISE = 0.3  # K, of a thermometer

t = STEP * np.arange(COUNT)
rng = np.random.default_rng(2)
power = np.repeat(np.round(rng.uniform(0.0, 120.0, COUNT // 12)), 12)

body = heater = 5.0
temperatures = []
for k in range(COUNT):
    temperatures.append(body)
    for _ in range(FINE):
        flow = COUPLING * (heater - body)
        heater += STEP / FINE * (power[k] - flow) / HEATER
        body += STEP / FINE * (flow - LOSS * body) / CAPACITY
read = np.array(temperatures) + NOISE * rng.standard_normal(COUNT)

rows = [f"{a:.0f},{b:.0f},{c:.2f}" for a, b, c in zip(t, power, read, strict=True)]
text = "\n".join(["t (s),power (W),temperature (K)", *rows]) + "\n"
Path(__file__).with_name("log.csv").write_text(text)
