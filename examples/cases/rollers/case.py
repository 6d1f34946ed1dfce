"""Magnetic rollers: which causes bend v = k f, the speed over the frequency of the field?"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from stickslip import Cause, Parameter, Prior, Table, diagnose_model, free_law

table = np.genfromtxt(Path(__file__).with_name("roller.csv"), delimiter=",", skip_header=1)
bin_of, run = np.nonzero(np.isfinite(table[:, 1:]))
frequency, velocity = table[bin_of, 0], table[bin_of, run + 1]

rows = [velocity[bin_of == each] for each in np.unique(bin_of)]
squares = sum(np.sum((row - row.mean()) ** 2) for row in rows)
scatter = np.sqrt(squares / (len(velocity) - len(rows)))
print(len(velocity), "speeds, and from run to run", f"{scatter * 1e6:.0f} um/s")


def roller(table, p):
    """Speeds, m/s, shape (vectors, rows)."""
    f = table["frequency"]
    limit = 1.0 / np.maximum(p["period"], 1e-6)
    limit = limit / np.sqrt(1.0 + (2 * np.pi * f * p["lag"]) ** 2)
    return p["k"] * (f - np.sqrt(np.maximum(f**2 - limit**2, 0.0)))


settings = {"frequency": frequency, "run": run}
data = Table(settings, velocity, sd=scatter, run=run, name="speeds", unit="m/s")
k = Parameter("k", Prior("log-uniform", 5e-7, 1e-5), "m")
period = Parameter("period", unit="s", low=0.0, high=0.1, size=0.02)
lag = Parameter("lag", unit="s", low=0.0, high=0.05, size=1e-3)
step_out = Cause("step_out", period, "a rotor that falls behind its field")
coil_lag = Cause("coil_lag", lag, "a field of the coils that lags and weakens")

result = diagnose_model(roller, data, [k], [step_out, coil_lag])
print(result.verdict.kind, sorted(result.verdict.causes))
for name in ("none", "step_out", "coil_lag", "coil_lag + step_out"):
    off = result.candidate(name).prediction.eval("reading - predicted")
    print(f"{name:20} {1e6 * np.sqrt(np.mean(off**2)):.0f} um/s")


print({name: f"{value:.2g}" for name, value in result.extended.items()})
speed = result.predict({"frequency": np.array([60.0])})["extended"][0]
print(f"at 60 Hz {speed * 1e6:.0f} um/s")

for name in ("step_out", "coil_lag + step_out"):
    gain = result.candidate(name).gain
    before, after = 1e6 * gain.mae_before["speeds"], 1e6 * gain.mae_after["speeds"]
    print(f"{name:20} {before:.0f} -> {after:.0f} um/s")
left = result.candidate("step_out").left
size, length = left["size"]["speeds"], left["correlation"]["speeds"]
print(f"left by step_out: {1e6 * size:.0f} um/s, correlated over {length:.0f} readings")

worth = result.separate({"frequency": np.array([5.0, 20.0, 60.0, 90.0, 150.0, 250.0])})
print(worth[["frequency", "separation"]].round(1))


figure = Figure(figsize=(7, 3.6), layout="constrained")
axes = figure.subplots()
axes.plot(table[:, 0], 1e6 * table[:, 1:], ".", color="0.6", ms=4)
fine = np.linspace(2, 150, 500)
absent = {"period": 0.0, "lag": 0.0}
for name, label in (
    ("none", "v = k f"),
    ("step_out", "with step-out"),
    ("coil_lag + step_out", "with step-out and lag"),
):
    p = {**absent, **result.candidate(name).params["value"]}
    speeds = roller({"frequency": fine}, p)
    axes.plot(fine, 1e6 * speeds, label=label)
axes.set(xlabel="frequency (Hz)", ylabel="velocity (um/s)", ylim=(0, 170))
axes.legend(frameon=False)
figure.savefig("roller.png", dpi=110)


def rolling(table, p, curves):
    """Speeds, m/s, at the frequencies and runs of a table."""
    f, before = table["frequency"], table["run"]
    change = curves["way over frequency"](f) + curves["way over run"](before)
    return p["k"] * f * (1.0 + change)


laws = [
    free_law("way", "frequency", "Hz", 0.0, 150.0, knots=7, factor_of="k"),
    free_law("way", "run", "-", 0.0, 7.0, factor_of="k"),
]
free = diagnose_model(rolling, data, [k], laws)
print(free.verdict.kind)
law = free.candidate("way over frequency")
print(f"share {law.share:.0%}, held-out error", end=" ")
print(f"{law.gain.before:.1f} -> {law.gain.after:.1f} standard errors")
value = law.params["value"]
for knot, f in enumerate(range(0, 151, 25), start=1):
    way = value["k"] * (1 + value[f"way over frequency.knot_{knot}"])
    print(f"{f:3} Hz: {1e6 * way:.2f} um a turn")
