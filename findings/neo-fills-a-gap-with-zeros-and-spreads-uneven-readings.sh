#!/usr/bin/env bash
# Expected: `before.concatenate(after)` of two pieces 300 ms apart is refused, as it pads nothing by default (so its
#   documentation), or holds NaN between them.
# What happens: the gap is filled with zeros: 700 readings become 1000, the mean of 5 mV becomes 3.5 mV. And `resample`
#   of an IrregularlySampledSignal takes the readings as evenly spaced (Fourier): a ramp read at 0, 1, 2 and 10 s is
#   0.48 at 2.5 s and 0.72 at 5 s. No warning of either.
# Packages: neo 0.14.6, quantities 0.16.4. Source: found by trying; the docstring names scipy's function.
# Who is hurt: whoever joins pieces of a record, or sets readings on a common clock.
# Instead: padding=True, which is NaN; numpy.interp (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 quantities==0.16.4 neo==0.14.6
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import neo
import numpy as np
import quantities as pq

warnings.simplefilter("error")
whole = neo.AnalogSignal((5.0 + np.sin(np.arange(1000) / 10.0))[:, None] * pq.mV, sampling_rate=1 * pq.kHz)
before, after = whole.time_slice(0 * pq.s, 0.1 * pq.s), whole.time_slice(0.4 * pq.s, 1 * pq.s)
joined = before.concatenate(after)
marked = before.concatenate(after, padding=True)
print("neo", neo.__version__, "quantities", pq.__version__, "numpy", np.__version__)
print(f"{len(before)} and {len(after)} readings, 300 ms apart, become {len(joined)}; at 0.25 s "
      f"{joined[250].item():.3f} mV; mean {joined.magnitude.mean():.3f} mV "
      f"(of the readings there are: {np.nanmean(marked.magnitude):.3f} mV)")
assert len(joined) == 1000 and joined.t_stop == whole.t_stop
assert np.all(joined.magnitude[100:400] == 0.0)
assert np.array_equal(joined.magnitude[400:], whole.magnitude[400:])
assert joined.magnitude.mean() < 3.6 < 4.9 < np.nanmean(marked.magnitude)
# instead
assert np.all(np.isnan(marked.magnitude[100:400])) and not np.any(np.isnan(marked.magnitude[400:]))

ramp = np.array([0.0, 1.0, 2.0, 10.0])
uneven = neo.IrregularlySampledSignal(ramp * pq.s, ramp[:, None] * pq.mV)
seen = uneven.resample(5)
times, values = seen.times.rescale("s").magnitude, seen.magnitude[:, 0]
print("a ramp of 1 mV/s, read at 0, 1, 2, 10 s, at", times.tolist(), "s:", values.round(2).tolist(), "mV")
assert np.allclose(times, [0.0, 2.5, 5.0, 7.5, 10.0])
assert abs(values[1] - 0.48) < 0.01 and abs(values[2] - 0.72) < 0.01
# instead
assert np.allclose(np.interp(times, ramp, ramp), times)
PROGRAM
