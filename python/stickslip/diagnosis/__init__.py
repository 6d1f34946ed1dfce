"""From measured data to a named cause, or to an honest "none", "ambiguous" or "unexplained"."""

from __future__ import annotations

from stickslip.diagnosis.engine import Diagnosis, diagnose_model
from stickslip.diagnosis.examination import Examination, diagnose
from stickslip.diagnosis.experiments import Experiment, propose
from stickslip.diagnosis.model import Cause, CauseParameter, Problem, Uncertain
from stickslip.diagnosis.model_report import write_model_report
from stickslip.diagnosis.report import write_report
from stickslip.diagnosis.separation import Separation, separate
from stickslip.diagnosis.summary import summary
from stickslip.diagnosis.words import headline
from stickslip.measurement.priors import Prior

__all__ = [
    "Cause",
    "CauseParameter",
    "Diagnosis",
    "Examination",
    "Experiment",
    "Prior",
    "Problem",
    "Separation",
    "Uncertain",
    "diagnose",
    "diagnose_model",
    "headline",
    "propose",
    "separate",
    "summary",
    "write_model_report",
    "write_report",
]
