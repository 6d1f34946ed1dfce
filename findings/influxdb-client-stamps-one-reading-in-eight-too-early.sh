#!/usr/bin/env bash
# Expected: 1000 readings at whole milliseconds are at the precision "ms" 1000 points of the line protocol.
# What happens: times go through floating-point seconds and are cut: at "ms" and "us" 1250 of 10 000 readings are one
#   unit too early; at "ms" they share their instant with the reading before, and the database keeps the later of two
#   points of one instant. "ns" is right. With data frames it is alike. A `Point` drops NaN and Inf, a frame writes inf;
#   a point of NaN alone is an empty line. No warning.
# Package: influxdb-client 1.50.0, pandas 3.1.1, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever logs at 1 kHz: each eighth reading replaces another, and steps of time are 0, 1 and 2 ms.
# Instead: precision "ns" (tried), or whole numbers as times (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 influxdb-client==1.50.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import datetime
import warnings
from importlib.metadata import version

import numpy as np
import pandas
from influxdb_client import Point
from influxdb_client.client.write.dataframe_serializer import data_frame_to_list_of_points
from influxdb_client.client.write_api import PointSettings

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("influxdb-client", "pandas", "numpy")))
start, first, number = datetime.datetime(2026, 1, 1, tzinfo=datetime.timezone.utc), 1767225600, 10000
index = pandas.date_range(start, periods=number, freq="1ms")
frame = pandas.DataFrame({"x": np.arange(1.0 * number)}, index=index)


def stamp(line):
    return int(line.rsplit(" ", 1)[1])


for precision, unit in (("ns", 10**9), ("us", 10**6), ("ms", 10**3)):
    right = first * unit + np.arange(number) * unit // 1000
    points = np.array([
        stamp(Point("run").field("x", 1.0).time(start + datetime.timedelta(milliseconds=place), precision)
              .to_line_protocol()) for place in range(number)])
    lines = data_frame_to_list_of_points(frame, PointSettings(), precision, data_frame_measurement_name="run")
    frames = np.array([stamp(line) for line in lines])
    whole = np.array([stamp(Point("run").field("x", 1.0).time(int(time), precision).to_line_protocol())
                      for time in right])
    for name, found in (("Point", points), ("data frame", frames)):
        early = int(np.sum(found == right - 1))
        print(f"{precision}, {name}: {early} of {number} one unit early, {len(np.unique(found))} instants, steps "
              f"{np.unique(np.diff(found))}")
        assert early == (0 if precision == "ns" else 1250) and np.sum(found != right) == early
        assert len(np.unique(found)) == (number - 1250 if precision == "ms" else number)
    assert np.array_equal(whole, right)
line = Point("run").field("x", float("nan")).field("y", float("inf")).time(1).to_line_protocol()
lost = pandas.DataFrame({"x": [float("nan")], "y": [float("inf")]}, index=index[:1])
written = data_frame_to_list_of_points(lost, PointSettings(), "ns", data_frame_measurement_name="run")
print(f"NaN and Inf as a Point: {line!r}; as a data frame: {written}")
assert line == "" and "y=inf" in written[0] and "x=" not in written[0]
PROGRAM
