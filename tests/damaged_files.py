"""Files of runs, sweeps and maps with one damage each: bits flipped, bytes zeroed, the end cut off.

``python tests/damaged_files.py N SEED`` damages N and says how many were read, how many refused,
and the longest time. It fails if one is read as what was not written, or hangs.
"""

import faulthandler
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from measured_maps import formula_map
from recorded_runs import COARSE
from stickslip import FieldMap, ScenarioError, open_run, simulate, sweep

POINTS = {"drive.frequency": np.linspace(20.0, 200.0, 150)}
SWEPT = COARSE.replace({"drive.pulses": 4})
HANG = 20.0  # s


def opened_run(path):
    run = open_run(path)
    data = run.to_xarray()
    arrays = {name: each.values.tobytes() for name, each in data.variables.items()}
    return arrays, repr(data.attrs), repr(run), run.scenario


def resumed(path):
    data = sweep(SWEPT, POINTS, out=path, resume=True)
    return {name: each.values.tobytes() for name, each in data.variables.items()}, data.attrs


def read_map(path):
    return repr(FieldMap.from_file(path).to_json())


KINDS = {
    "run.nc": (lambda path: simulate(COARSE, out=path), opened_run),
    "sweep.nc": (lambda path: sweep(SWEPT, POINTS, out=path), resumed),
    "map.json": (lambda path: path.write_text(formula_map().to_json()), read_map),
}


def damaged(whole, random):
    """The bytes with one damage, often near an end, where files say what they are."""
    data, how = bytearray(whole), random.integers(3)
    near = int(random.integers(len(data) if random.random() < 0.5 else 600))
    at = near if random.random() < 0.5 else len(data) - near
    if how == 0:
        return data[:at]
    if how == 1:
        end = min(at + int(random.choice([1, 64, 4096])), len(data))
        data[at:end] = bytes(end - at)
        return data
    for place in random.integers(len(data), size=random.choice([1, 10])):
        data[place] ^= 1 << int(random.integers(8))
    return data


def outcomes(folder, count, random):
    """Outcomes of `count` damages of each kind of file, and the longest time, s."""
    found, longest = {}, 0.0
    for name, (write, read) in KINDS.items():
        path = folder / name
        write(path)
        whole, content = path.read_bytes(), read(path)
        found[name] = {"read": 0, "refused": 0}
        for _ in range(count):
            data = damaged(whole, random)
            path.write_bytes(data)
            faulthandler.dump_traceback_later(HANG, exit=True)
            start = time.monotonic()
            try:
                right, line = read(path) == content, "read"
            except ScenarioError as error:
                right, line = "damaged" in str(error), str(error)
            assert right, (name, line)
            assert line.isprintable()
            found[name]["read" if line == "read" else "refused"] += 1
            longest = max(longest, time.monotonic() - start)
            faulthandler.cancel_dump_traceback_later()
            assert path.read_bytes() == data, name
    return found, longest


if __name__ == "__main__":
    count, seed = map(int, sys.argv[1:])
    with tempfile.TemporaryDirectory() as folder:
        found, longest = outcomes(
            Path(folder), -(-count // len(KINDS)), np.random.default_rng(seed)
        )
    print(found)
    print(f"the longest took {longest:.1f} s", file=sys.stderr)
