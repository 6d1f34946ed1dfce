"""From measured data to a named cause, or to an honest "none", "ambiguous" or "unexplained"."""

from __future__ import annotations

from stickslip.diagnosis.engine import Diagnosis, diagnose_model
from stickslip.diagnosis.model import Cause, CauseParameter, Problem, Uncertain
from stickslip.measurement.priors import Prior

__all__ = [
    "Cause",
    "CauseParameter",
    "Diagnosis",
    "Prior",
    "Problem",
    "Uncertain",
    "diagnose_model",
]
