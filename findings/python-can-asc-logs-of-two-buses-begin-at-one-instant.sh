#!/usr/bin/env bash
# Expected: frames that one logger writes are read back with their times and channels, whatever the log's format.
# What happens: an .asc log has times since its first frame: of two buses whose logs began 5 s apart both begin at 0.0.
#   With relative_timestamp=False its start is cut to milliseconds, 0.456 ms early for times that end in 0.123456 s, and
#   stands there as local time: read in another zone it is hours off. Channel 0 is 1 in .trc and none in .csv and .db.
#   .blf keeps times and channel. The reader's class is chosen by the name alone, so that nothing shows it; no warning.
# Package: python-can 4.6.1. Source: relative_timestamp=True of the reader is documented.
# Who is hurt: whoever joins logs of two buses, or a log with a camera's times.
# Instead: .blf (tried), .log or .csv for times alone (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    python-can==4.6.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import os
import time
import warnings
from importlib.metadata import version

import can

warnings.simplefilter("error")
print("python-can", version("python-can"))
start = 1767225600.123456


def zone(name):
    os.environ["TZ"] = name
    time.tzset()


def log(name, first):
    writer = can.Logger(name)
    for after in (0.0, 1.5):
        writer.on_message_received(
            can.Message(timestamp=first + after, arbitration_id=0x100, data=[1], is_extended_id=False, channel=0))
    writer.stop()


def first(name, **options):
    with can.LogReader(name, **options) as reader:
        message = next(iter(reader))
    return message.timestamp, message.channel


zone("UTC0")
for kind in ("asc", "blf", "trc", "csv", "log", "db"):
    log(f"one.{kind}", start)
    log(f"two.{kind}", start + 5)
    (one, channel), (two, _) = first(f"one.{kind}"), first(f"two.{kind}")
    print(f".{kind}: the first frames at {one:.6f} and {two:.6f} s, {two - one:.3f} s apart, channel {channel}")
    if kind == "asc":
        assert one == two == 0.0
    else:
        assert abs(one - start) < 2e-6 and abs(two - start - 5) < 2e-6
    assert channel == {"trc": 1, "csv": None, "db": None, "log": "can0"}.get(kind, 0)
early = start - first("one.asc", relative_timestamp=False)[0]
zone("XXX-9")
log("east.asc", start)
log("east.blf", start)
zone("UTC0")
away = first("east.asc", relative_timestamp=False)[0] - start
print(f".asc with relative_timestamp=False: {1e3 * early:.3f} ms early; written nine hours east {away:.3f} s off, .blf "
      f"{first('east.blf')[0] - start:.6f} s off")
assert abs(early - 0.000456) < 2e-6 and abs(away - 9 * 3600) < 0.01
PROGRAM
