#!/usr/bin/env bash
# Expected: `as_dataframe(time_index=True)` has one row an instant, each channel at the time at which it was read.
# What happens: times are the increment times the number, compared to the last bit: of channels at 3000 and 1000 Hz that
#   started together each third row should hold both, 3333 rows, but 2172 do, and there are 11161 rows for 10000; at
#   1000 and 100 Hz all meet. A channel that started 5 s later stands beside the first from 0 on.
#   Instants as readings are cut to microseconds, some one too low: 1 us is 0. No warning.
# Package: nptdms 1.13.0, pandas 3.1.1, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever takes two rates of one DAQ file into a table, drops its gaps or differences its times.
# Instead: absolute_time=True for the starts, then the index rounded to 1 us and its rows grouped (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 npTDMS==1.13.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import datetime
import warnings
from importlib.metadata import version

import numpy as np
from nptdms import ChannelObject, TdmsFile, TdmsWriter

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("npTDMS", "pandas", "numpy")))


def table(*channels, **options):
    """A file of channels (rate, number, start in s), read back as a data frame."""
    with TdmsWriter("record.tdms") as writer:
        writer.write_segment([
            ChannelObject("run", str(place), np.arange(1.0 * number), {
                "wf_increment": 1 / rate, "wf_start_offset": 0.0,
                "wf_start_time": datetime.datetime(2026, 1, 1) + datetime.timedelta(seconds=start)})
            for place, (rate, number, start) in enumerate(channels)])
    return TdmsFile("record.tdms").as_dataframe(time_index=True, **options)


for slow, fast, right in ((100, 1000, 1000), (1000, 3000, 3333)):
    together = table((fast, 10000, 0), (slow, right, 0))
    steps = np.diff(together.index)
    print(f"{fast} and {slow} Hz: {len(together)} rows for 10000, {len(together.dropna())} with both for {right}, "
          f"least step {steps.min():.1g} s")
    if fast == 1000:
        assert len(together) == 10000 and len(together.dropna()) == right
    else:
        assert len(together) == 11161 and len(together.dropna()) == 2172 and steps.min() < 1e-15
mended = table((3000, 10000, 0), (1000, 3333, 0), absolute_time=True)
mended = mended.groupby(mended.index.round("us")).first()
print(f"absolute and rounded to 1 us: {len(mended)} rows, {len(mended.dropna())} with both")
assert len(mended) == 10000 and len(mended.dropna()) == 3333

plain, absolute = table((10, 30, 0), (10, 30, 5)), table((10, 30, 0), (10, 30, 5), absolute_time=True)
print(f"a channel that starts 5 s later: {len(plain.dropna())} rows with both; with absolute_time "
      f"{len(absolute.dropna())}")
assert len(plain.dropna()) == 30 and len(absolute.dropna()) == 0

instants = np.datetime64("2026-01-01", "ns") + np.arange(1000) * np.timedelta64(1, "us")
with TdmsWriter("record.tdms") as writer:
    writer.write_segment([ChannelObject("run", "at", instants)])
read = TdmsFile("record.tdms")["run"]["at"][:]
low = int(np.sum(read < instants))
print(f"of 1000 instants of whole microseconds {low} are read one too low, the second one {read[1]}")
assert 0 < low < 1000 and read[1] == instants[0]
PROGRAM
