"""Scenarios that are recorded into files, and the comparison of their records."""

import numpy as np

from stickslip import COIL_NAMES, Drive, Record, Scenario
from stickslip.simulation.quantities import COLUMNS, recorded_names

# 0.17 s at 500 kHz: 85 001 samples, a full block and a rest.
DENSE = Scenario(drive=Drive(base=0.5e-3, pulses=12), record=Record(rate=5e5))
COARSE = DENSE.replace({"record.rate": 2000.0})
# Minutes of work, and a record that does not fit into memory. By OPP the robot comes to a place
# where it stays; by IPP it reaches the coils after 44 s.
ENDLESS = DENSE.replace({"drive.mode": "OPP", "drive.pulses": 1_000_000, "record.rate": 5e4})


def assert_same_record(one, other, samples=slice(None)):
    """The arrays of two runs are the same bits; of `other` these samples."""
    assert recorded_names(one.scenario) == recorded_names(other.scenario)
    for name in recorded_names(one.scenario):
        expected = getattr(other, name)[samples]
        assert getattr(one, name).dtype == expected.dtype, name
        assert getattr(one, name).tobytes() == expected.tobytes(), name


def flat_columns(run):
    """Name, SI unit ("" for words) and values of each column that a table of a run has."""
    for name in recorded_names(run.scenario):
        values = getattr(run, name)
        if name == "current":
            yield from ((f"current_{coil}", "A", values[:, k]) for k, coil in enumerate(COIL_NAMES))
        elif name in ("contact", "event"):
            yield name, "", np.array(getattr(run, f"{name}_names"))[values]
        else:
            yield name, COLUMNS[name].unit, values
