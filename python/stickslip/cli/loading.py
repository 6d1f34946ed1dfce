"""The scenario that a file, ``--set`` and ``--uncertain`` describe.

It stands apart from the options, as lists of keys need no scenario and no numpy.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.held import PATHS, with_files
from stickslip.scenario.keys import FILE, PROGRAM
from stickslip.scenario.scenario import Scenario, loaded, with_uncertain_of


def load_with(path: Path, set: Mapping[str, Any]) -> tuple[Scenario, list[Path]]:
    """The scenario of a file with other values, and all files that it was read from.

    Voltages replace the whole drive but its direction.
    """
    scenario, files = loaded(path)
    changes = dict(set)
    with prefixed("--set"):
        if FILE in changes:
            changes.setdefault("drive.mode", "program")
        elif changes.get("drive.mode", "program") != "program":
            changes[PROGRAM] = None
        files += with_files(changes, Path())
        scenario = scenario.replace(changes)
    return scenario, files


def load_uncertain(
    path: Path, set: Mapping[str, Any], uncertain: Path | None
) -> tuple[Scenario, list[Path]]:
    """The same, with the uncertain parameters of another file, if there is one.

    A ScenarioError names a value of ``--set`` that has no influence, as the key is uncertain.
    """
    scenario, read = load_with(path, set)
    drawn = scenario if uncertain is None else with_uncertain_of(scenario, uncertain)
    priors = {} if drawn.uncertain is None else drawn.uncertain.priors
    for key in set:
        if key not in PATHS and (key in priors or drawn.get(key) != scenario.get(key)):
            raise ScenarioError(f"--set {key}: has no influence, as it is uncertain")
    return drawn, read if uncertain is None else [*read, uncertain]
