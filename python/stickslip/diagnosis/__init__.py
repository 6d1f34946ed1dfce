"""From measured data to a named cause, an extended model and a measured gain.

`data` are tables with their errors, `terms` what may be in a model, `fitting` the problem, its
discrepancy and the fits of models, `decision` the verdict and all `Facts`; `report` shows them.
Names are imported on first use: `data` has readers that need no extra of the installation.
"""

from __future__ import annotations

import importlib

_NAMES = {
    "_util.prior": "Prior",
    "diagnosis.data.errors": "Errors",
    "diagnosis.data.series": "Series",
    "diagnosis.data.table": "Table",
    "diagnosis.decision.candidate": "Candidate",
    "diagnosis.decision.experiments": "Experiment",
    "diagnosis.decision.facts": "Findings",
    "diagnosis.decision.gain": "Gain",
    "diagnosis.decision.misfit_test": "MisfitTest",
    "diagnosis.decision.verdict": "Verdict",
    "diagnosis.change": "diagnose_change",
    "diagnosis.entry": "diagnose_model",
    "diagnosis.fitting.models": "Fit",
    "diagnosis.fitting.problem": "Problem",
    "diagnosis.fitting.search": "Models",
    "diagnosis.result": "Diagnosis",
    "diagnosis.terms.cause": "Cause",
    "diagnosis.terms.curve": "Curve",
    "diagnosis.terms.laws": "Curves free_law",
    "diagnosis.terms.parameter": "Parameter",
}
_HOMES = {name: home for home, names in _NAMES.items() for name in names.split()}

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'stickslip.diagnosis' has no attribute {name!r}")
    return getattr(importlib.import_module(f"stickslip.{_HOMES[name]}"), name)
