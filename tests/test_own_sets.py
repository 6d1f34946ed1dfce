"""Sets of models of one's own: their plan, and the size of their model errors."""

from collections import Counter

import numpy as np
import pytest
from blind import own


def test_sets_of_models_of_ones_own_have_all_kinds_alike():
    logs = Counter(own.plan(place) for place in range(1, 2 * 3 * 80, 2))
    assert len(logs) == 4 * 5 * 3
    assert all(logs[kind, "listed", errors] == 2 * logs[kind, "none", errors] == 6
               for kind in own.MACHINES for errors in own.ERRORS)  # fmt: skip


@pytest.mark.nightly
@pytest.mark.parametrize("errors", own.MODEL_ERRORS)
def test_model_errors_have_the_share_that_is_asked_for(errors):
    """By the fit of the library's own model to readings without noise, beside one without error."""
    left = []
    for part in (0.0, 0.3):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(own, "ERROR_SHARE", (part, part))
            patch.setattr(own, "NOISE", 1e-9)
            patch.setattr(own, "STRENGTH", (1e7, 1e7))
            drawn = own.drawn(3, "thermal", "listed", errors)
            found = drawn.diagnosed()
        left.append(found.problem.y)
    null = found.findings.models.null
    basis = np.linalg.qr(null.slopes)[0]
    error, effect = (each - basis @ (basis.T @ each) for each in (left[1] - left[0], drawn.effect))
    # The slopes are those where this fit ends: of an effect of a hundredth of the readings, near
    # the truth. Constants undo half of it, and less of the errors, which would be 0.45 and more of
    # it if they were counted before a refit.
    assert np.linalg.norm(error) == pytest.approx(0.3 * np.linalg.norm(effect), rel=0.05)
