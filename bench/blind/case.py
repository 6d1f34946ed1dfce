"""One data set of the study, from its making to what is said of it."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from blind.generator import write_case, write_more
from stickslip.diagnosis.examination import diagnose
from stickslip.diagnosis.experiments import propose
from stickslip.diagnosis.summary import summary
from stickslip.measurement import read_measurement


def study(folder: Path, kind: str, seed: int) -> dict[str, Any]:
    """Make one data set, diagnose it from its files alone, and return what was said.

    Near twins are measured again at the experiments that the diagnosis proposes.
    """
    answer = write_case(folder, kind, seed)
    row = {"folder": folder.name, "answer": answer, **_diagnosed(folder)}
    drives = [each["drive"] for each in row["said"]["next_experiments"]]
    if kind == "near twins" and drives:
        more = folder.with_name(folder.name + "-more")
        write_more(folder, more, answer, drives)
        row["followed"] = _diagnosed(more)["said"]
    return row


def _diagnosed(folder: Path) -> dict[str, Any]:
    start = time.process_time()
    measurement = read_measurement(folder / "measurement.toml")
    examination = diagnose(measurement, threads=1)
    said = summary(examination, measurement, propose(examination))
    gain = examination.found.gain
    return {
        "said": said,
        "gain": None if gain is None else {"p_value": gain.p_value},
        "cpu_seconds": time.process_time() - start,
        "simulations": examination.simulator.simulated,
    }
