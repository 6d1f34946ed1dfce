#!/usr/bin/env bash
# Expected: uneven times written to a UFF file (set 58) in double precision are read back to far more digits than the
#   readings need; of 100.0001, 100.0002 and 100.0007 s three are left.
# What happens: times have six digits (1.00001e+02), readings of both precisions twelve: from 100 s on times stand in
#   steps of 1 ms, from 1000 s of 10 ms, and several readings share one. A speed from them is infinite. No warning.
# Package: pyuff 2.5.8. Source: the format's text gives times the form E13.5 for uneven ordinates; that the writer does
#   not tell was found by trying.
# Who is hurt: whoever hands an unevenly read log to a modal analysis.
# Instead: times from 0, with the start in abscissa_min or the text (tried: 0.1 us at 0.1 s), or even spacing (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pyuff==2.5.8
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
import pyuff

warnings.simplefilter("error", UserWarning)


def back(times, readings, even=False):
    made = pyuff.prepare_58(
        binary=0, func_type=1, rsp_node=1, rsp_dir=1, ref_dir=1, ref_node=1, rsp_ent_name="a", ref_ent_name="a",
        id1="a", id2="a", id3="a", id4="a", id5="a", ver_num=1, load_case_id=0, abscissa_spec_data_type=17,
        ordinate_spec_data_type=12, orddenom_spec_data_type=13, ord_data_type=4, data=readings, x=times,
        num_pts=times.size, abscissa_spacing=int(even), abscissa_min=float(times[0]),
        abscissa_inc=float(times[1] - times[0]))
    pyuff.UFF("log.uff").write_sets(made, "overwrite")
    read = pyuff.UFF("log.uff").read_sets()
    read = read[0] if isinstance(read, list) else read
    return np.asarray(read["x"]), np.asarray(read["data"])


print("pyuff", version("pyuff"), "numpy", np.__version__)
lags = np.array([0.0, 1e-4, 2e-4, 7e-4, 1e-3, 2e-3, 4e-3, 5e-3, 6e-3, 1e-2])
readings = 20.0 + 1e-6 * np.arange(10)
for start, step in ((1.0, 1e-5), (100.0, 1e-3), (1000.0, 1e-2)):
    times, seen = back(start + lags, readings)
    off = np.abs(times - start - lags).max()
    print(f"from {start:g} s: {np.unique(times).size} different times of 10, off by up to {off:.1e} s; readings off by "
          f"{np.abs(seen - readings).max():.1e}")
    assert np.abs(seen - readings).max() < 1e-9
    assert off < 0.51 * step
    assert (np.unique(times).size < 10) == (start > 1.0) and (off > 1e-4) == (start > 1.0)
# instead
assert np.abs(back(10.0 * lags, readings)[0] - 10.0 * lags).max() < 1e-7
even = 100.0 + 1e-4 * np.arange(10)
assert np.abs(back(even, readings, even=True)[0] - even).max() < 1e-9
PROGRAM
