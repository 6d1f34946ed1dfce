"""Stick-slip locomotion of magnetic micro-robots in the field of five square coils.

The public names are imported on first use, so that ``import stickslip`` stays quick.
"""

from __future__ import annotations

import importlib

# The one list of names. Type checkers read no computed one: tests/sections_stub.py makes a stub of
# it, which a packager may leave out.
_NAMES = {
    "stickslip": "models plot",
    "stickslip._core": "Snapshot __version__",
    "stickslip._util.note": "Note",
    "stickslip._util.prior": "Prior",
    "stickslip.design.optimise": "optimise",
    "stickslip.design.optimum": "Optimum",
    "stickslip.diagnosis.change": "diagnose_change",
    "stickslip.diagnosis.data.series": "Series",
    "stickslip.diagnosis.data.table": "Table",
    "stickslip.diagnosis.entry": "diagnose_model",
    "stickslip.diagnosis.result": "Diagnosis",
    "stickslip.diagnosis.terms": "events instruments",
    "stickslip.diagnosis.terms.cause": "Cause",
    "stickslip.diagnosis.terms.laws": "free_law",
    "stickslip.diagnosis.terms.parameter": "Parameter",
    "stickslip.errors": "ScenarioError SimulationError",
    "stickslip.field.coils": "Coils",
    "stickslip.field.field_map": "FieldMap",
    "stickslip.scenario.effects": "EffectParameter effects register_effect",
    "stickslip.scenario.keys": "COIL_NAMES",
    "stickslip.scenario.law": "Law",
    "stickslip.scenario.played_rows": "Accelerations Forces",
    "stickslip.scenario.scenario": "Scenario load",
    "stickslip.scenario.sections": "STATE_COLUMNS Coil Contact Drag Drive Environment Inner Record "
    "Robot Shake Solver State",
    "stickslip.scenario.uncertain": "JointPrior",
    "stickslip.scenario.waveform": "Waveform volts_per_tesla",
    "stickslip.simulation.rollout": "STATE_UNITS Rollout rollout",
    "stickslip.simulation.run": "Run open_run",
    "stickslip.simulation.simulate": "simulate simulate_batch",
    "stickslip.simulation.simulator": "Simulator",
    "stickslip.sweeping.predict": "predict",
    "stickslip.sweeping.run_sweep": "sweep",
    "stickslip.sweeping.sweep_table": "sweep_dataframe",
    "stickslip.versions": "show_versions",
    "stickslip.walker.diagnose": "diagnose",
    "stickslip.walker.experiments": "propose_experiments",
    "stickslip.walker.reading": "Measurement read_measurement",
    "stickslip.walker.track": "velocity_of_track",
}
_HOMES = {name: home for home, names in _NAMES.items() for name in names.split()}

# No module may have the name of a function here: importing it would put it in the function's place.
__all__ = sorted(_HOMES)


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'stickslip' has no attribute {name!r}")
    from stickslip.extras import check_extras

    check_extras(f"stickslip.{name}", name)
    home = importlib.import_module(_HOMES[name])
    if name in vars(home):
        value = vars(home)[name]
    else:  # a module
        value = importlib.import_module(f"{_HOMES[name]}.{name}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
