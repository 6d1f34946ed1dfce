"""What the files of runs and sweeps say beside their numbers."""

from __future__ import annotations

import contextlib
import importlib.metadata
import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip import _core
from stickslip.field.field_map import FieldMap
from stickslip.scenario.waveform import Waveform
from stickslip.simulation.note import notes_json

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario
    from stickslip.simulation.run import Run


def attributes(run: Run) -> dict[str, Any]:
    """What a file says of a run beside its record: all that makes it a `Run` again."""
    summary = run.summary()
    numbers = {name: value for name, value in summary.items() if not isinstance(value, dict | list)}
    return {
        "title": "stick-slip motion of a magnetic micro-robot",
        "source": f"stickslip {_core.__version__}",
        **origin(run.scenario),
        **numbers,
        "notes": notes_json(run.notes),
        "events": json.dumps(summary["events"]),
        "steps": json.dumps(summary["steps"]),
        "condition_met": int(run.condition_met),
        **({"condition": run.condition} if run.condition else {}),
        "final_state": json.dumps(run.final_state.as_dict()),
        "complete": int(run.complete),
        "recorded_until": run.recorded_until,
    }


def origin(scenario: Scenario) -> dict[str, str]:
    """What a file says of where its numbers come from: versions, scenario, voltages and map."""
    about = {"stickslip_version": _core.__version__, "numpy_version": np.__version__}
    with contextlib.suppress(importlib.metadata.PackageNotFoundError):  # it comes with an extra
        about["xarray_version"] = importlib.metadata.version("xarray")
    about["scenario"] = scenario.to_toml()
    program = scenario.drive.program
    if program is not None:  # a scenario's text names a file in place of the voltages
        blocks = [{"t": t.tolist(), "V": v.tolist(), "repeats": n} for t, v, n in program.blocks]
        about["voltage_blocks"] = json.dumps(blocks)
    if scenario.coil.map is not None:
        about["coil_map"] = scenario.coil.map.to_json()
    return about


def map_of(about: Mapping[str, Any]) -> FieldMap | None:
    """The field map of attributes that `origin` gave, if the scenario has one."""
    return FieldMap.from_json(about["coil_map"]) if "coil_map" in about else None


def program_of(about: Mapping[str, Any]) -> Waveform | None:
    """The program of attributes that `origin` gave, if the scenario has one."""
    if "voltage_blocks" not in about:
        return None
    blocks = json.loads(about["voltage_blocks"])
    return Waveform([(each["t"], each["V"], each["repeats"]) for each in blocks])
