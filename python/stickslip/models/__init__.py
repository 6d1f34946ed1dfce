"""Models of logs in their users' words, with the usual causes of a misfit: for `diagnose_model`.

Each function makes a model of what is stated. A term that is stated is a constant, known as well as
it is said; each other effect of the model's table is a cause::

    joint = models.joint(inertia=(0.012, 0.001), viscous=(0.02, 0.01))
    result = diagnose_model(joint, log)
"""

from __future__ import annotations

from stickslip.models import kinds
from stickslip.models.kinds import *  # noqa: F403
from stickslip.models.log import read_log
from stickslip.models.model import Model
from stickslip.models.scalar import low_pass, own, vectorised

__all__ = ["Model", "low_pass", "own", "read_log", "vectorised"]
__all__ += kinds.__all__
