"""Stick-slip locomotion of magnetic micro-robots in the field of five square coils.

The public names below are imported on first use, so that ``import stickslip`` stays quick.
"""

from __future__ import annotations

import importlib

# The name that type checkers know; `typing` itself takes 5 ms, in which Ctrl-C shows a traceback.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from typing import Any

    from stickslip import plot
    from stickslip._core import __version__
    from stickslip.coils import COIL_NAMES, Coils
    from stickslip.dataset import open_run
    from stickslip.errors import ScenarioError
    from stickslip.extensions import effects
    from stickslip.reproduction.study import reproduce
    from stickslip.run import Run
    from stickslip.scenario import Scenario, load
    from stickslip.sections import (
        Coil,
        Contact,
        Drag,
        Drive,
        Environment,
        Record,
        Robot,
        Solver,
    )
    from stickslip.simulation import simulate, simulate_batch
    from stickslip.sweeping.run_sweep import sweep
    from stickslip.user_effects import EffectParameter, register_effect, unregister_effect
    from stickslip.versions import show_versions
    from stickslip.waveform import Waveform, volts_per_tesla

# No module may have the name of a function here: importing it would put it in the function's place.
_HOME = {
    "COIL_NAMES": "coils",
    "__version__": "_core",
    "Coil": "sections",
    "Coils": "coils",
    "Contact": "sections",
    "Drag": "sections",
    "Drive": "sections",
    "EffectParameter": "user_effects",
    "Environment": "sections",
    "Record": "sections",
    "Robot": "sections",
    "Run": "run",
    "Scenario": "scenario",
    "ScenarioError": "errors",
    "Solver": "sections",
    "Waveform": "waveform",
    "effects": "extensions",
    "load": "scenario",
    "open_run": "dataset",
    "plot": "plot",
    "register_effect": "user_effects",
    "reproduce": "reproduction.study",
    "show_versions": "versions",
    "simulate": "simulation",
    "simulate_batch": "simulation",
    "sweep": "sweeping.run_sweep",
    "unregister_effect": "user_effects",
    "volts_per_tesla": "waveform",
}

__all__ = [
    "COIL_NAMES",
    "Coil",
    "Coils",
    "Contact",
    "Drag",
    "Drive",
    "EffectParameter",
    "Environment",
    "Record",
    "Robot",
    "Run",
    "Scenario",
    "ScenarioError",
    "Solver",
    "Waveform",
    "__version__",
    "effects",
    "load",
    "open_run",
    "plot",
    "register_effect",
    "reproduce",
    "show_versions",
    "simulate",
    "simulate_batch",
    "sweep",
    "unregister_effect",
    "volts_per_tesla",
]


# Hidden from type checkers, which would else take any name for an attribute.
if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        if name not in _HOME:
            raise AttributeError(f"module 'stickslip' has no attribute {name!r}")
        module = importlib.import_module(f"stickslip.{_HOME[name]}")
        value = module if name == _HOME[name] else getattr(module, name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
