"""From measured data to a named cause, or to an honest "none", "ambiguous" or "unexplained"."""

from __future__ import annotations

from stickslip.diagnosis.api import Examination, diagnose
from stickslip.diagnosis.inference.discrimination import Separation, separate
from stickslip.diagnosis.inference.experiment_design import Experiment, propose
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.model.problem import Cause, CauseParameter, Problem, Uncertain
from stickslip.diagnosis.pipeline import diagnose_model
from stickslip.diagnosis.report.html import write_report
from stickslip.diagnosis.report.json_keys import summary
from stickslip.diagnosis.report.messages import headline
from stickslip.diagnosis.report.model_report import write_model_report
from stickslip.measurement.priors import Prior

__all__ = [
    "Cause",
    "CauseParameter",
    "Examination",
    "Experiment",
    "Findings",
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
