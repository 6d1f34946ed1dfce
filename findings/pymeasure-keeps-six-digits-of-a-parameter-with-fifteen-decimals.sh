#!/usr/bin/env bash
# Expected: a `FloatParameter`, 15 decimals by default, stands in the results' file with its value, as the readings do.
# What happens: the head of the file has it in six digits: a frequency of 1234567.891 Hz is "1.23457e+06 Hz", a start
#   at 1764385200.5 s is 80 minutes late. `Results.load` gives 1234570.0 and 1764390000.0, which a
#   repeated run then uses. Readings, and a VectorParameter or plain Parameter of the same numbers, keep all digits.
# Package: pymeasure 0.16.0. Source: found by trying; decimals are documented as "considered".
# Who is hurt: whoever sets a frequency in Hz, stores a time or an offset, or repeats a run from its file.
# Instead: Parameter, and float() of it, or a column of the readings (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.3.5 pandas==3.1.1 pint==0.25.3 pyvisa==1.16.2 pymeasure==0.16.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version
from pathlib import Path

from pymeasure.experiment import FloatParameter, Parameter, Procedure, Results, VectorParameter
from pymeasure.experiment.results import CSVFormatter

warnings.simplefilter("error")
print("pymeasure", version("pymeasure"))
FREQUENCY, START = 1234567.891, 1764385200.5


class Sweep(Procedure):
    frequency = FloatParameter("Frequency", units="Hz", default=FREQUENCY)
    start = FloatParameter("Start", units="s", maximum=1e10, default=START)
    both = VectorParameter("Both", length=2, default=[FREQUENCY, START])
    plain = Parameter("Plain", default=FREQUENCY)
    DATA_COLUMNS = ["Frequency"]


run = Sweep()
Results(run, "run.csv")
loaded = {name: each.value for name, each in Results.load("run.csv", procedure_class=Sweep).parameters.items()}
row = CSVFormatter(["Frequency"]).format({"Frequency": FREQUENCY})
print("set:", run.frequency, run.start, "; in the file:", [
    line.strip("#\t") for line in Path("run.csv").read_text().splitlines() if "Hz" in line or "Start" in line])
print("loaded:", loaded, "; a reading of the same number:", row)
assert run.frequency == FREQUENCY and float(row) == FREQUENCY
assert loaded["both"] == [FREQUENCY, START] and float(loaded["plain"]) == FREQUENCY
assert loaded["frequency"] == 1234570.0 and loaded["start"] == 1764390000.0
PROGRAM
