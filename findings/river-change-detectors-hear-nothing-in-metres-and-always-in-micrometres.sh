#!/usr/bin/env bash
# Expected: a detector with a level of significance, as ADWIN with its delta, finds a change of three standard deviations
#   in any unit, as KSWIN does.
# What happens: beside the variance ADWIN adds an absolute term, as for readings between 0 and 1: a step of three
#   deviations after 1000 readings is found 24 readings later in units of 1, 344 later in units of 0.01, and never in
#   units of 0.001 or less, in 1e-6 not even one of a hundred. PageHinkley has an absolute delta and threshold: in units
#   of 0.01 it finds nothing, in 10 and above it rings 60 times, first after 30 readings. KSWIN is right. No warning.
# Package: river 0.26.1, numpy 2.4.6. Source: found by trying; the pages name no range of the readings, and the example
#   goes from 0 to 7.
# Who is hurt: whoever watches a machine's position, current or drift in SI units.
# Instead: divide by the deviation of a quiet stretch first (tried), or take KSWIN.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pandas==2.3.3 river==0.26.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
from river import drift

print(*(f"{name} {version(name)}" for name in ("river", "numpy")))
random = np.random.default_rng(1)
noise = random.normal(0.0, 1.0, 2000)


def rung(detector, readings):
    places = []
    for place, reading in enumerate(readings):
        detector.update(float(reading))
        if detector.drift_detected:
            places.append(place)
    return places


def tried(readings):
    return rung(drift.ADWIN(), readings), rung(drift.PageHinkley(), readings)


step = noise + 3.0 * (np.arange(2000) >= 1000)
for unit in (1e-6, 1e-3, 1e-2, 1.0, 10.0, 1e3):
    adwin, hinkley = tried(step * unit)
    print(f"in units of {unit:g}: ADWIN {adwin}, PageHinkley {len(hinkley)} from {hinkley[:1]} on")
    assert (adwin == []) if unit <= 1e-3 else (len(adwin) == 1)
    assert unit != 1e-2 or adwin[0] > 1300
    assert unit < 1 or adwin[0] < 1030
    assert (hinkley == []) if unit <= 1e-2 else (hinkley[0] > 1000 if unit == 1.0 else len(hinkley) > 50 and hinkley[0] < 50)
large = noise + 100.0 * (np.arange(2000) >= 1000)
adwin = rung(drift.ADWIN(), large * 1e-6)
print("a step of a hundred deviations in units of 1e-6: ADWIN", adwin)
assert adwin == []
for unit in (1e-6, 1e3):
    kswin = rung(drift.KSWIN(seed=1), step[800:1200] * unit)
    print(f"in units of {unit:g}, from the 800th on: KSWIN {kswin}")
    assert len(kswin) == 1 and 200 <= kswin[0] < 230
quiet = (step * 1e-6)[:200].std()
adwin, hinkley = tried(step * 1e-6 / quiet)
print(f"divided by the deviation of the first 200: ADWIN {adwin}, PageHinkley {hinkley}")
assert len(adwin) == 1 and adwin[0] < 1030 and hinkley and hinkley[0] > 1000
PROGRAM
