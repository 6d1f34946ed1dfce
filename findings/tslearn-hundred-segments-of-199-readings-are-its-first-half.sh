#!/usr/bin/env bash
# Expected: a hundred segments of a record of 199 readings are means of two readings or so, over the whole record.
# What happens: a segment has the whole part of 199 / 100 readings, one, and what is left over is dropped: the hundred
#   segments are the first hundred readings. Two records that differ by 5 from the hundredth on, 49.7 apart, are 0 apart
#   for PAA, and SAX and its kind with slopes give them the same symbols; `inverse_transform` has the right length and
#   ends in zeros. Of ten readings four segments leave two out. No warning. With 200 readings all is right.
# Package: tslearn 0.10.0, numpy 2.4.6, scikit-learn 1.9.1. Source: found by trying; the page has six readings in three.
# Who is hurt: whoever shortens runs of any length to one number of segments before they are compared or clustered.
# Instead: TimeSeriesResampler to a multiple of the number of segments first (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scikit-learn==1.9.1 tslearn==0.10.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
from tslearn.piecewise import (
    OneD_SymbolicAggregateApproximation,
    PiecewiseAggregateApproximation,
    SymbolicAggregateApproximation,
)
from tslearn.preprocessing import TimeSeriesResampler

print(*(f"{name} {version(name)}" for name in ("tslearn", "numpy", "scikit-learn")))


def compared(first, second):
    """Distance and differing symbols of two records, for a hundred segments of each."""
    means = PiecewiseAggregateApproximation(n_segments=100)
    shortened = means.fit_transform(first[None])
    distance = means.distance_paa(shortened[0], means.transform(second[None])[0])
    symbols = []
    for kind, options in ((SymbolicAggregateApproximation, {}), (OneD_SymbolicAggregateApproximation, {"alphabet_size_slope": 8})):
        words = kind(n_segments=100, alphabet_size_avg=8, **options)
        one = words.fit_transform(first[None])
        symbols.append(int((one != words.transform(second[None])).sum()))
    return shortened[0, :, 0], means.inverse_transform(shortened)[0, :, 0], float(distance), symbols


for number in (199, 200):
    first = np.sin(np.linspace(0.0, 4 * np.pi, number))[:, None] + 1.0
    second = first.copy()
    second[100:] += 5.0
    shortened, back, distance, symbols = compared(first, second)
    apart = float(np.linalg.norm(first - second))
    print(f"{number} readings: {apart:.1f} apart, by PAA {distance:.1f}, symbols that differ {symbols}, ends in {back[-2:]}")
    if number == 199:
        assert np.array_equal(shortened, first[:100, 0]) and len(back) == 199 and not back[100:].any()
        assert distance == 0.0 and apart > 49 and symbols == [0, 0]
    else:
        assert abs(distance / apart - 1) < 1e-6 and min(symbols) > 20
mended = [TimeSeriesResampler(200).fit_transform(record[None, :199])[0] for record in (first, second)]
_, _, distance, symbols = compared(*mended)
print(f"resampled to 200 first: by PAA {distance:.1f}, symbols that differ {symbols}")
assert abs(distance / 49.9 - 1) < 0.02 and min(symbols) > 20
few = PiecewiseAggregateApproximation(n_segments=4).fit_transform(np.arange(10.0)[None, :, None]).ravel()
print("0 to 9 in four segments:", few)
assert few.tolist() == [0.5, 2.5, 4.5, 6.5]
PROGRAM
