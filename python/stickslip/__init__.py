"""Stick-slip locomotion of magnetic micro-robots in the field of five square coils.

The public names below are imported on first use, so that ``import stickslip`` stays quick.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stickslip import plot
    from stickslip._core import __version__
    from stickslip.diagnosis.api import diagnose, diagnose_model
    from stickslip.diagnosis.model.problem import Cause, CauseParameter, Uncertain
    from stickslip.diagnosis.options import Options
    from stickslip.diagnosis.results import Diagnosis
    from stickslip.errors import ScenarioError
    from stickslip.measurement.priors import Prior
    from stickslip.measurement.reading import Measurement, read_measurement
    from stickslip.reproduction.study import reproduce
    from stickslip.scenario.named_effects import effects
    from stickslip.scenario.scenario import Scenario, load
    from stickslip.scenario.sections import (
        Coil,
        Contact,
        Drag,
        Drive,
        Environment,
        Record,
        Robot,
        Solver,
    )
    from stickslip.scenario.user_effects import EffectParameter, register_effect, unregister_effect
    from stickslip.scenario.waveform import Waveform, volts_per_tesla
    from stickslip.simulation.coils import COIL_NAMES, Coils
    from stickslip.simulation.netcdf import open_run
    from stickslip.simulation.run import Run
    from stickslip.simulation.simulate import simulate, simulate_batch
    from stickslip.sweeping.run_sweep import sweep
    from stickslip.versions import show_versions

# No module may have the name of a function here: importing it would put it in the function's place.
_HOME = {
    "COIL_NAMES": "simulation.coils",
    "__version__": "_core",
    "Cause": "diagnosis.model.problem",
    "CauseParameter": "diagnosis.model.problem",
    "Coil": "scenario.sections",
    "Coils": "simulation.coils",
    "Contact": "scenario.sections",
    "Diagnosis": "diagnosis.results",
    "Drag": "scenario.sections",
    "Drive": "scenario.sections",
    "EffectParameter": "scenario.user_effects",
    "Environment": "scenario.sections",
    "Measurement": "measurement.reading",
    "Options": "diagnosis.options",
    "Prior": "measurement.priors",
    "Record": "scenario.sections",
    "Robot": "scenario.sections",
    "Run": "simulation.run",
    "Scenario": "scenario.scenario",
    "ScenarioError": "errors",
    "Solver": "scenario.sections",
    "Uncertain": "diagnosis.model.problem",
    "Waveform": "scenario.waveform",
    "diagnose": "diagnosis.api",
    "diagnose_model": "diagnosis.api",
    "effects": "scenario.named_effects",
    "load": "scenario.scenario",
    "open_run": "simulation.netcdf",
    "plot": "plot",
    "read_measurement": "measurement.reading",
    "register_effect": "scenario.user_effects",
    "reproduce": "reproduction.study",
    "show_versions": "versions",
    "simulate": "simulation.simulate",
    "simulate_batch": "simulation.simulate",
    "sweep": "sweeping.run_sweep",
    "unregister_effect": "scenario.user_effects",
    "volts_per_tesla": "scenario.waveform",
}

__all__ = [
    "COIL_NAMES",
    "Cause",
    "CauseParameter",
    "Coil",
    "Coils",
    "Contact",
    "Diagnosis",
    "Drag",
    "Drive",
    "EffectParameter",
    "Environment",
    "Measurement",
    "Options",
    "Prior",
    "Record",
    "Robot",
    "Run",
    "Scenario",
    "ScenarioError",
    "Solver",
    "Uncertain",
    "Waveform",
    "__version__",
    "diagnose",
    "diagnose_model",
    "effects",
    "load",
    "open_run",
    "plot",
    "read_measurement",
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
