#!/usr/bin/env bash
# Expected: whole numbers in a message of floats are written as floats, or refused, as float32 and other types are.
# What happens: only the number of bytes is looked at: int64 readings 1 to 4 in a `Float64MultiArray` are read as
#   4.9e-324 to 2.0e-323, floats in an `Int64MultiArray` as 4607182418800017408, int32 in `Float32` as 1.4e-45. An array
#   of the other byte order, as it comes from many instruments' files, has its bytes turned: 1, 2, 3 are 256, 512, 768.
#   Message, writer and reader all pass it. No warning.
# Package: rosbags 0.11.9, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever writes counts of an encoder or a file's big-endian readings into a bag.
# Instead: astype of the field's own type, as "<f8", before the message is made (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 rosbags==0.11.9
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from rosbags.rosbag2 import Reader, Writer
from rosbags.typesys import Stores, get_typestore

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("rosbags", "numpy")))
store = get_typestore(Stores.ROS2_HUMBLE)
layout = store.types["std_msgs/msg/MultiArrayLayout"]([], 0)


def through(name, field, kind, readings):
    """Readings after they went through a bag."""
    message = f"std_msgs/msg/{kind}MultiArray"
    with Writer(name, version=9) as writer:
        connection = writer.add_connection("/encoder", message, typestore=store)
        writer.write(connection, 1, store.serialize_cdr(store.types[message](layout, readings), message))
    with Reader(name) as reader:
        for connection, _, data in reader.messages():
            return store.deserialize_cdr(data, connection.msgtype).data


plain = np.arange(1, 5)
for place, (kind, dtype, expected) in enumerate((
        ("Float64", "<i8", plain.astype("<i8").view("<f8")), ("Int64", "<f8", plain.astype("<f8").view("<i8")),
        ("Float32", "<i4", plain.astype("<i4").view("<f4")), ("Int16", ">i2", 256 * plain),
        ("Float64", ">f8", plain.astype(">f8").view("<f8")), ("Float64", "<f8", plain), ("Int16", "<i2", plain))):
    found = through(f"bag{place}", "encoder", kind, plain.astype(dtype))
    print(f"{dtype} 1, 2, 3, 4 as {kind}: {found}")
    assert np.array_equal(found, expected)
    assert np.array_equal(found, plain) == (place > 4)
refused = 0
for kind, dtype in (("Float64", "<f4"), ("Int16", "<i8")):
    try:
        through(f"{kind}{dtype[1:]}", "encoder", kind, plain.astype(dtype))
    except ValueError:
        refused += 1
print(f"arrays of another size refused: {refused} of 2")
assert refused == 2
PROGRAM
