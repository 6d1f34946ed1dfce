"""What a notebook shows of a scenario: its drive, and what is not as by default."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip._util.html import html_table
from stickslip._util.units import handy
from stickslip.scenario.keys import Key, Value, is_of_one_coil, known_keys
from stickslip.scenario.path_keys import COIL_MAP, PROGRAM

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario


def scenario_html(scenario: Scenario) -> str:
    """A table of the keys of the drive, and of all others that have another value by default."""
    program = scenario.drive.program
    rows = [(PROGRAM, repr(program))] if program is not None else []
    if scenario.coil.map is not None:
        rows.append((COIL_MAP, str(scenario.coil.map)))
    own = scenario.coil.own_values()
    for name, key in known_keys().items():
        value = scenario.get(name)
        if is_of_one_coil(name) and name not in own:
            continue
        if (key.section == "drive" and program is None) or value != key.default:
            rows.append((name, _shown(key, value)))
    if scenario.uncertain is not None:
        rows.append(("uncertain", ", ".join(scenario.uncertain.names)))
    rows.append(("duration", f"{scenario.duration:.6g} s"))
    return html_table("Scenario; other keys are as by default", rows)


def _shown(key: Key, value: Value) -> str:
    if isinstance(value, str):
        return value
    factor, unit = handy(key.unit)
    return f"{value * factor:.6g} {unit}".rstrip()
