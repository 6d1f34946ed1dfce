"""Numbers of the code that stand on pages by their names, as in ``{{ verdict.DOMINANT }}``."""

from __future__ import annotations

import math
from dataclasses import asdict
from importlib import import_module
from typing import Any

MODULES = (
    *("decision.cannot_tell", "decision.experiments", "decision.misfit_test"),
    *("decision.posterior", "decision.verdict"),
    *("data.errors", "fitting.forms", "fitting.models", "fitting.options", "fitting.problem"),
    "terms.unlisted",
)
"""Modules of `stickslip.diagnosis` whose numbers pages may name."""


def constants() -> dict[str, Any]:
    """Numbers in capitals by module, without leading underscores, and numbers of each task."""
    tasks = import_module("stickslip.control.tasks").TASKS
    found: dict[str, Any] = {"tasks": {name: asdict(task) for name, task in tasks.items()}}
    for path in MODULES:
        module = import_module(f"stickslip.diagnosis.{path}")
        found[path.rpartition(".")[2]] = {
            name.lstrip("_"): value if isinstance(value, tuple | dict) else f"{value:.4g}"
            for name, value in vars(module).items()
            if name.isupper() and isinstance(value, int | float | tuple | dict)
        }
    hyper = found["forms"].pop("HYPER")  # of logarithms
    found["forms"] |= {
        name: {"sd": sd, "least": f"{math.exp(low):.2g}", "most": f"{math.exp(high):.2g}"}
        for name, (_, sd, low, high) in hyper.items()
    }
    return found
