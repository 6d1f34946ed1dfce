"""From measured data to a named cause, an extended model and a measured gain.

`data` are tables with their errors, `terms` what may be in a model, `fitting` the problem, its
discrepancy and the fits of models, `decision` the verdict and all `Facts`; `report` shows them.
"""

from __future__ import annotations

from stickslip.diagnosis.data.errors import Errors
from stickslip.diagnosis.data.series import Series
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.decision.candidate import Candidate
from stickslip.diagnosis.decision.experiments import Experiment
from stickslip.diagnosis.decision.facts import Findings
from stickslip.diagnosis.decision.gain import Gain
from stickslip.diagnosis.decision.test import Test
from stickslip.diagnosis.decision.verdict import Verdict
from stickslip.diagnosis.entry import diagnose, diagnose_model
from stickslip.diagnosis.fitting.models import Fit
from stickslip.diagnosis.fitting.problem import Problem
from stickslip.diagnosis.fitting.search import Models
from stickslip.diagnosis.result import Diagnosis
from stickslip.diagnosis.rounds import Round, diagnose_in_rounds
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.curve import Curve
from stickslip.diagnosis.terms.laws import Curves, free_law
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.scenario.uncertain import Prior

__all__ = [
    "Candidate",
    "Cause",
    "Curve",
    "Curves",
    "Diagnosis",
    "Errors",
    "Experiment",
    "Findings",
    "Fit",
    "Gain",
    "Models",
    "Parameter",
    "Prior",
    "Problem",
    "Round",
    "Series",
    "Table",
    "Test",
    "Verdict",
    "diagnose",
    "diagnose_in_rounds",
    "diagnose_model",
    "free_law",
]
