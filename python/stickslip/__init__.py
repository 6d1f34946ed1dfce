"""Stick-slip locomotion of magnetic micro-robots in the field of five square coils.

The public names below are imported on first use, so that ``import stickslip`` stays quick.
"""

from __future__ import annotations

import importlib

# The name that type checkers know; `typing` itself takes 5 ms, in which Ctrl-C shows a traceback.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from typing import Any

    from stickslip import plot as plot
    from stickslip._core import __version__ as __version__
    from stickslip.design.optimise import optimise as optimise
    from stickslip.design.optimum import Optimum as Optimum
    from stickslip.diagnosis.data.series import Series as Series
    from stickslip.diagnosis.data.table import Table as Table
    from stickslip.diagnosis.entry import diagnose as diagnose
    from stickslip.diagnosis.entry import diagnose_model as diagnose_model
    from stickslip.diagnosis.result import Diagnosis as Diagnosis
    from stickslip.diagnosis.rounds import diagnose_in_rounds as diagnose_in_rounds
    from stickslip.diagnosis.terms import events as events
    from stickslip.diagnosis.terms import instruments as instruments
    from stickslip.diagnosis.terms.cause import Cause as Cause
    from stickslip.diagnosis.terms.laws import free_law as free_law
    from stickslip.diagnosis.terms.parameter import Parameter as Parameter
    from stickslip.errors import ScenarioError as ScenarioError
    from stickslip.errors import SimulationError as SimulationError
    from stickslip.field.coils import Coils as Coils
    from stickslip.field.field_map import FieldMap as FieldMap
    from stickslip.measurement.reading import Measurement as Measurement
    from stickslip.measurement.reading import read_measurement as read_measurement
    from stickslip.measurement.track import velocity_of_track as velocity_of_track
    from stickslip.reproduction.study import reproduce as reproduce
    from stickslip.scenario.named_effects import effects as effects
    from stickslip.scenario.priors import Prior as Prior
    from stickslip.scenario.scenario import Scenario as Scenario
    from stickslip.scenario.sections import COIL_NAMES as COIL_NAMES
    from stickslip.scenario.sections import Coil as Coil
    from stickslip.scenario.sections import Contact as Contact
    from stickslip.scenario.sections import Drag as Drag
    from stickslip.scenario.sections import Drive as Drive
    from stickslip.scenario.sections import Environment as Environment
    from stickslip.scenario.sections import Record as Record
    from stickslip.scenario.sections import Robot as Robot
    from stickslip.scenario.sections import Solver as Solver
    from stickslip.scenario.state import STATE_COLUMNS as STATE_COLUMNS
    from stickslip.scenario.state import State as State
    from stickslip.scenario.toml_file import load as load
    from stickslip.scenario.uncertain import JointPrior as JointPrior
    from stickslip.scenario.user_effects import EffectParameter as EffectParameter
    from stickslip.scenario.user_effects import register_effect as register_effect
    from stickslip.scenario.user_effects import unregister_effect as unregister_effect
    from stickslip.scenario.waveform import Waveform as Waveform
    from stickslip.scenario.waveform import volts_per_tesla as volts_per_tesla
    from stickslip.simulation.note import Note as Note
    from stickslip.simulation.rollout import STATE_UNITS as STATE_UNITS
    from stickslip.simulation.rollout import Rollout as Rollout
    from stickslip.simulation.rollout import rollout as rollout
    from stickslip.simulation.run import Run as Run
    from stickslip.simulation.run import open_run as open_run
    from stickslip.simulation.simulate import simulate as simulate
    from stickslip.simulation.simulate import simulate_batch as simulate_batch
    from stickslip.simulation.simulator import Simulator as Simulator
    from stickslip.simulation.simulator import Snapshot as Snapshot
    from stickslip.sweeping.predict import predict as predict
    from stickslip.sweeping.run_sweep import sweep as sweep
    from stickslip.sweeping.sweep_table import sweep_dataframe as sweep_dataframe
    from stickslip.versions import show_versions as show_versions

# No module may have the name of a function here: importing it would put it in the function's place.
_HOME = {
    name: module
    for module, names in {
        "_core": ("__version__",),
        "design.optimise": ("optimise",),
        "design.optimum": ("Optimum",),
        "sweeping.predict": ("predict",),
        "diagnosis.data.series": ("Series",),
        "diagnosis.data.table": ("Table",),
        "diagnosis.entry": ("diagnose", "diagnose_model"),
        "diagnosis.result": ("Diagnosis",),
        "diagnosis.rounds": ("diagnose_in_rounds",),
        "diagnosis.terms.cause": ("Cause",),
        "diagnosis.terms.laws": ("free_law",),
        "diagnosis.terms.parameter": ("Parameter",),
        "errors": ("ScenarioError", "SimulationError"),
        "scenario.priors": ("Prior",),
        "measurement.reading": ("Measurement", "read_measurement"),
        "measurement.track": ("velocity_of_track",),
        "reproduction.study": ("reproduce",),
        "field.field_map": ("FieldMap",),
        "scenario.named_effects": ("effects",),
        "scenario.scenario": ("Scenario",),
        "scenario.sections": (
            *("COIL_NAMES", "Coil", "Contact", "Drag", "Drive", "Environment", "Record", "Robot"),
            "Solver",
        ),
        "scenario.state": ("STATE_COLUMNS", "State"),
        "scenario.toml_file": ("load",),
        "scenario.uncertain": ("JointPrior",),
        "scenario.user_effects": ("EffectParameter", "register_effect", "unregister_effect"),
        "scenario.waveform": ("Waveform", "volts_per_tesla"),
        "field.coils": ("Coils",),
        "simulation.note": ("Note",),
        "simulation.rollout": ("STATE_UNITS", "Rollout", "rollout"),
        "simulation.run": ("Run", "open_run"),
        "simulation.simulate": ("simulate", "simulate_batch"),
        "simulation.simulator": ("Simulator", "Snapshot"),
        "sweeping.run_sweep": ("sweep",),
        "sweeping.sweep_table": ("sweep_dataframe",),
        "versions": ("show_versions",),
    }.items()
    for name in names
}
# Modules that are public names themselves.
_MODULES = {
    "events": "diagnosis.terms.events",
    "instruments": "diagnosis.terms.instruments",
    "plot": "plot",
}

# Hidden from type checkers, which take the names from above: they read no computed list, and would
# take any name for an attribute.
if not TYPE_CHECKING:
    __all__ = sorted({*_HOME, *_MODULES})

    def __getattr__(name: str) -> Any:
        if name not in __all__:
            raise AttributeError(f"module 'stickslip' has no attribute {name!r}")
        from stickslip._util.extras import check_extras

        check_extras(f"stickslip.{name}", name)
        module = importlib.import_module(f"stickslip.{_MODULES.get(name) or _HOME[name]}")
        value = module if name in _MODULES else getattr(module, name)
        globals()[name] = value
        return value

    def __dir__() -> list[str]:
        return __all__
