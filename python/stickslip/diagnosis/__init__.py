"""From measured data to a named cause, or to an honest "none", "ambiguous" or "unexplained"."""

from __future__ import annotations

from stickslip.diagnosis.api import diagnose, diagnose_model
from stickslip.diagnosis.data.autoregression import ErrorCorrelation, Runs
from stickslip.diagnosis.data.trial_noise import NoiseModel
from stickslip.diagnosis.fit.fit_result import Candidate, Fit, Ranking
from stickslip.diagnosis.fit.profile_likelihood import Profile
from stickslip.diagnosis.fit.sensitivity import Sensitivities
from stickslip.diagnosis.inference.cross_validation import Gain
from stickslip.diagnosis.inference.detection import Detection
from stickslip.diagnosis.inference.discrimination import Separation, separate
from stickslip.diagnosis.inference.experiment_design import Experiment
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.formulas import Formula
from stickslip.diagnosis.inference.open_set import Curve, FreeShape, OpenSet
from stickslip.diagnosis.inference.smooth_residual import Settings
from stickslip.diagnosis.inference.verdict import Verdict
from stickslip.diagnosis.model.free_terms import Curves, FreeTerm, Term
from stickslip.diagnosis.model.problem import (
    AuxiliaryData,
    Cause,
    CauseParameter,
    Problem,
    Uncertain,
)
from stickslip.diagnosis.options import Options
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.results import Diagnosis, Plots
from stickslip.diagnosis.rounds import Round, diagnose_in_rounds
from stickslip.scenario.priors import Prior

__all__ = [
    "AuxiliaryData",
    "Candidate",
    "Cause",
    "CauseParameter",
    "Curve",
    "Curves",
    "Detection",
    "Diagnosis",
    "ErrorCorrelation",
    "Experiment",
    "Findings",
    "Fit",
    "Formula",
    "FreeShape",
    "FreeTerm",
    "Gain",
    "NoiseModel",
    "OpenSet",
    "Options",
    "Plots",
    "PosedProblem",
    "Prior",
    "Problem",
    "Profile",
    "Ranking",
    "Round",
    "Runs",
    "Sensitivities",
    "Separation",
    "Settings",
    "Term",
    "Uncertain",
    "Verdict",
    "diagnose",
    "diagnose_in_rounds",
    "diagnose_model",
    "separate",
]
