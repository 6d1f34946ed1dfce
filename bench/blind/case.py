"""One data set of the study, from its making to what is said of it."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

from blind.generator import write_case, write_more
from stickslip.diagnosis.api import diagnose
from stickslip.measurement import read_measurement


def sealed(folder: Path) -> Path:
    """File of a data set's answer, beside the data sets; no diagnosis reads it."""
    return folder.parent.with_name("sealed") / f"{folder.name}.json"


def make(folder: Path, kind: str, seed: int) -> dict[str, Any]:
    """Make one data set and return its answer, or read that of one that was made before."""
    path = sealed(folder)
    if not path.exists():
        answer = write_case(folder, kind, seed)
        path.parent.mkdir(parents=True, exist_ok=True)
        low_fidelity = path.with_suffix(".part")
        low_fidelity.write_text(json.dumps(answer) + "\n")
        low_fidelity.replace(path)
    # Numbers and lists as a reader of the file has them, whoever made it.
    result: dict[str, Any] = json.loads(path.read_text())
    if (result["kind"], result["seed"]) != (kind, seed):
        raise RuntimeError(f"{path} is the answer of {result['kind']} {result['seed']}")
    return result


def study(folder: Path, kind: str, seed: int) -> dict[str, Any]:
    """Make one data set, diagnose it from its files alone, and return what was said.

    Near twins are measured again at the experiments that the diagnosis proposes.
    """
    answer = make(folder, kind, seed)
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
    result = diagnose(measurement, threads=1)
    said, gain = result.as_dict(), result.gain
    return {
        "said": said,
        "gain": None if gain is None else {"p_value": gain.p_value, "choice": gain.choice},
        "cpu_seconds": time.process_time() - start,
        "simulations": result.posed.simulator.simulated,
    }
