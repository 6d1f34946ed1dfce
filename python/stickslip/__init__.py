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
    from stickslip.control.optimise import optimise
    from stickslip.control.optimum import Optimum
    from stickslip.control.predict import predict
    from stickslip.control.prediction import Prediction
    from stickslip.diagnosis.api import diagnose, diagnose_model
    from stickslip.diagnosis.model.problem import Cause, CauseParameter, Uncertain
    from stickslip.diagnosis.options import Options
    from stickslip.diagnosis.results import Diagnosis
    from stickslip.errors import ScenarioError, SimulationError
    from stickslip.measurement.reading import Measurement, read_measurement
    from stickslip.reproduction.study import reproduce
    from stickslip.scenario.named_effects import effects
    from stickslip.scenario.priors import Prior
    from stickslip.scenario.scenario import Scenario, load
    from stickslip.scenario.sections import (
        COIL_NAMES,
        Coil,
        Contact,
        Drag,
        Drive,
        Environment,
        Record,
        Robot,
        Solver,
    )
    from stickslip.scenario.state import STATE_COLUMNS, State
    from stickslip.scenario.uncertain import JointPrior
    from stickslip.scenario.user_effects import EffectParameter, register_effect, unregister_effect
    from stickslip.scenario.waveform import Waveform, volts_per_tesla
    from stickslip.simulation.coils import Coils
    from stickslip.simulation.rollout import STATE_UNITS, Rollout, rollout
    from stickslip.simulation.run import Run
    from stickslip.simulation.simulate import simulate, simulate_batch
    from stickslip.simulation.simulator import Simulator, Snapshot
    from stickslip.simulation.stored_run import open_run
    from stickslip.sweeping.run_sweep import sweep
    from stickslip.versions import show_versions

# No module may have the name of a function here: importing it would put it in the function's place.
_HOME = {
    name: module
    for module, names in {
        "_core": ("__version__",),
        "control.optimise": ("optimise",),
        "control.optimum": ("Optimum",),
        "control.predict": ("predict",),
        "control.prediction": ("Prediction",),
        "diagnosis.api": ("diagnose", "diagnose_model"),
        "diagnosis.model.problem": ("Cause", "CauseParameter", "Uncertain"),
        "diagnosis.options": ("Options",),
        "diagnosis.results": ("Diagnosis",),
        "errors": ("ScenarioError", "SimulationError"),
        "scenario.priors": ("Prior",),
        "measurement.reading": ("Measurement", "read_measurement"),
        "plot": ("plot",),
        "reproduction.study": ("reproduce",),
        "scenario.named_effects": ("effects",),
        "scenario.scenario": ("Scenario", "load"),
        "scenario.sections": (
            *("COIL_NAMES", "Coil", "Contact", "Drag", "Drive", "Environment", "Record", "Robot"),
            "Solver",
        ),
        "scenario.state": ("STATE_COLUMNS", "State"),
        "scenario.uncertain": ("JointPrior",),
        "scenario.user_effects": ("EffectParameter", "register_effect", "unregister_effect"),
        "scenario.waveform": ("Waveform", "volts_per_tesla"),
        "simulation.coils": ("Coils",),
        "simulation.rollout": ("STATE_UNITS", "Rollout", "rollout"),
        "simulation.run": ("Run",),
        "simulation.simulate": ("simulate", "simulate_batch"),
        "simulation.simulator": ("Simulator", "Snapshot"),
        "simulation.stored_run": ("open_run",),
        "sweeping.run_sweep": ("sweep",),
        "versions": ("show_versions",),
    }.items()
    for name in names
}

# Written out: type checkers read it.
__all__ = [
    "COIL_NAMES",
    "STATE_COLUMNS",
    "STATE_UNITS",
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
    "JointPrior",
    "Measurement",
    "Optimum",
    "Options",
    "Prediction",
    "Prior",
    "Record",
    "Robot",
    "Rollout",
    "Run",
    "Scenario",
    "ScenarioError",
    "SimulationError",
    "Simulator",
    "Snapshot",
    "Solver",
    "State",
    "Uncertain",
    "Waveform",
    "__version__",
    "diagnose",
    "diagnose_model",
    "effects",
    "load",
    "open_run",
    "optimise",
    "plot",
    "predict",
    "read_measurement",
    "register_effect",
    "reproduce",
    "rollout",
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
    return sorted(__all__)
