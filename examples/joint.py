"""What is wrong with the model of a joint? Reads its log, prints the verdict and draws joint.png.

The log is simulated: an inertia of 0.0118 kg m^2, viscous friction of 0.025 N m s/rad and, unknown
to the model, dry friction of 0.03 N m. The speed is read with a noise of 0.03 rad/s.
"""

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from stickslip import diagnose_model, models

BLUE, VERMILION = "#0072B2", "#D55E00"

joint = models.joint(inertia=(0.012, 0.0005), viscous=(0.02, 0.01))
log = models.read_log(Path(__file__).with_name("joint.csv"), joint)
result = diagnose_model(joint, log)
print(result.summary())

figure = Figure(figsize=(6.4, 5.2), layout="constrained")
above, below = (part.subplots() for part in figure.subfigures(2, 1))
above.plot(log.t, log.y, ".", color="black", ms=4, label="the log")
fits = {"none": ("the model, refitted", BLUE), "coulomb": ("and with dry friction", VERMILION)}
for name, (label, colour) in fits.items():
    fitted = result.candidate(name).prediction["predicted"]
    above.plot(log.t, fitted, color=colour, label=label)
above.set(xlabel="time (s)", ylabel="speed (rad/s)", ylim=(-2.4, 1.9))
above.legend(frameon=False, ncols=3, loc="lower center", columnspacing=1.2)

words = {cause.name: cause.meaning or cause.name for cause in joint.terms(log)[1]}
words |= {"none": "no cause", "inertia": "another inertia", "viscous": "another viscous friction"}
off = {
    said: np.sqrt(np.mean(result.candidate(name).prediction.eval("reading - predicted") ** 2))
    for name, said in words.items()
}
left = pd.Series(off).sort_values(ascending=False)
chance = {words[name]: part for name, part in result.verdict.probabilities.items()}
below.tick_params(axis="y", labelsize="small")
below.barh(left.index, left, color=["0.6" if chance[k] < 0.95 else VERMILION for k in left.index])
best = left.index[-1]
below.annotate("named", (left[best], best), (6, -3), textcoords="offset points")
below.axvline(0.03, color="black", linestyle="--", linewidth=1)
below.set(xlabel="misfit with each cause alone (rad/s); dashed: noise")
figure.savefig("joint.png", dpi=110)
