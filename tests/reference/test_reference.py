"""The reference simulator against answers that can be derived.

All else that it computes stands beside the core in `test_reference_agreement.py`, fields and angles
at rest in `test_blind_generator.py`.
"""

import numpy as np
import pytest

from . import coil_field, simulate_reference
from .effects import GRAVITY
from .field import CENTRE_FIELD_PER_AMPERE, COIL_NAMES
from .simulate import CONTACT_DEFAULTS, DRAG_DEFAULTS, ROBOT_DEFAULTS

NO_FIELD = {"peak": 0.0, "base": 0.0, "hold": 0.0, "frequency": 100.0, "ramp": 0.0}
MASS, ADHESION = ROBOT_DEFAULTS["mass"], CONTACT_DEFAULTS["adhesion"]


@pytest.mark.parametrize("name", COIL_NAMES)
def test_every_coil_gives_the_closed_centre_field_along_its_positive_axis(name):
    field = coil_field(name, (0.0, 0.0, 0.0))
    axis = {"x": 0, "y": 1, "c": 2}[name[0]]
    assert field[axis] == pytest.approx(CENTRE_FIELD_PER_AMPERE, rel=1e-12)
    assert np.delete(field, axis) == pytest.approx(0.0, abs=1e-18)
    assert pytest.approx(0.96258e-3, rel=1e-5) == CENTRE_FIELD_PER_AMPERE


@pytest.mark.nightly
def test_block_held_inside_the_friction_cone_does_not_creep():
    # sin(a) = 0.9 mu (cos(a) + adhesion / weight), solved to first order twice.
    angle = 0.0
    for _ in range(2):
        angle = np.arcsin(0.9 * 0.2 * (np.cos(angle) + ADHESION / (MASS * GRAVITY)))
    tilted = {"surface_tilt": {"angle": angle}}
    run = simulate_reference({**NO_FIELD, "pulses": 6000}, effects=tilted, dt=1e-4, rate=10.0)
    assert run.t[-1] == pytest.approx(60.0)
    assert np.all(run.x == 0.0)
    assert np.all(run.theta == 0.0)


@pytest.mark.nightly
def test_block_slides_down_a_steep_tilt_as_newton_says():
    angle, drag = 0.6, DRAG_DEFAULTS["linear"]
    tilted = {"surface_tilt": {"angle": angle}}
    run = simulate_reference({**NO_FIELD, "pulses": 2}, effects=tilted, dt=1e-6, rate=1000.0)
    load = MASS * GRAVITY * np.cos(angle) + ADHESION
    push = MASS * GRAVITY * np.sin(angle) - CONTACT_DEFAULTS["kinetic_friction"] * load
    slow = MASS / drag
    # The velocity at rest is the one half a step before t = 0.
    t = run.t + 0.5e-6
    exact = push / drag * (t - slow * (1 - np.exp(-t / slow)))
    assert run.x[1:] == pytest.approx(exact[1:], rel=1e-6)


@pytest.mark.parametrize(
    ("sections", "word"),
    [
        ({"drive": {"frequncy": 30.0}}, "frequncy"),
        ({"drive": {"edge": "up"}}, "edge"),
        ({"drive": {}, "contact": {"mu": 0.2}}, "mu"),
    ],
)
@pytest.mark.nightly
def test_words_that_are_not_known_are_refused(sections, word):
    with pytest.raises(ValueError, match=word):
        simulate_reference(**sections)
