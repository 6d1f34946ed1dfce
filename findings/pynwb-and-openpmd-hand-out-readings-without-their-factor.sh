#!/usr/bin/env bash
# Expected: readers of self-describing formats, which know each record's unit and its factor, hand out readings in that
#   unit.
# What happens: 2000 counts of 1 um with unit "m" are read as 2000 by pynwb (`data[:]`) beside `unit` "m", and by
#   openPMD's `load_chunk`; nixio gives 0.002. pynwb keeps the factor in `conversion` and `offset`, openPMD in
#   `unit_SI`, nixio in `polynom_coefficients`. No warning.
# Packages: pynwb 4.2.0, openpmd-api 0.17.1.post4, nixio 1.5.4. Source: each documents its factor; tried side by side.
# Who is hurt: whoever carries code from one to the other: readings are off by a million, or by an offset alone.
# Instead: get_data_in_units() of pynwb, the product with unit_SI of openPMD (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 h5py==3.16.0 pynwb==4.2.0 nixio==1.5.4 openpmd-api==0.17.1.post4 \
    packaging==26.4
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import datetime
import warnings
from importlib.metadata import version

import nixio
import numpy as np
import openpmd_api as openpmd
from pynwb import NWBHDF5IO, NWBFile, TimeSeries

warnings.simplefilter("ignore")
counts = np.array([1000, 2000, 3000], np.int16)
metres = counts * 1e-6

start = datetime.datetime(2026, 1, 1, tzinfo=datetime.timezone.utc)
file = NWBFile("a walk", "walk", start)
file.add_acquisition(TimeSeries(name="x", data=counts, unit="m", conversion=1e-6, rate=10.0, starting_time=0.0))
with NWBHDF5IO("log.nwb", "w") as io:
    io.write(file)
with NWBHDF5IO("log.nwb", "r") as io:
    record = io.read().acquisition["x"]
    by_pynwb, unit, scaled = record.data[:], record.unit, np.asarray(record.get_data_in_units())

file = nixio.File.open("log.nix", nixio.FileMode.Overwrite)
record = file.create_block("walk", "walk").create_data_array("x", "x", data=counts, unit="m")
record.polynom_coefficients = (0.0, 1e-6)
by_nixio = np.asarray(record[:])
file.close()

series = openpmd.Series("log.h5", openpmd.Access.create)
mesh = series.iterations[0].meshes["x"]
mesh.unit_dimension = {openpmd.Unit_Dimension.L: 1}
mesh.axis_labels, mesh.grid_spacing = ["t"], [0.1]
part = mesh[openpmd.Mesh_Record_Component.SCALAR]
part.reset_dataset(openpmd.Dataset(np.dtype("float64"), [3]))
part.unit_SI = 1e-6
part.store_chunk(counts.astype(float))
series.flush()
series.close()
series = openpmd.Series("log.h5", openpmd.Access.read_only)
part = series.iterations[0].meshes["x"][openpmd.Mesh_Record_Component.SCALAR]
by_openpmd = part.load_chunk()
series.flush()

print(*(f"{name} {version(name)}" for name in ("pynwb", "openpmd-api", "nixio", "numpy")))
print("pynwb", by_pynwb.tolist(), unit, "; openPMD", by_openpmd.tolist(), "; nixio", by_nixio.tolist())
assert by_pynwb.tolist() == [1000, 2000, 3000] and unit == "m"
assert by_openpmd.tolist() == [1000.0, 2000.0, 3000.0]
assert np.allclose(by_nixio, metres)
# instead
assert np.allclose(scaled, metres) and np.allclose(by_openpmd * part.unit_SI, metres)
PROGRAM
