"""Energy in fields that do not change."""

import numpy as np
import pytest

from free_shapes import shaped
from helpers import FLIGHT, MOMENT, QUICK_COILS, energy, program, run, volts
from stickslip import Waveform


def _steps(final):
    """Voltages that step at once and then stay, three times."""
    return sum((Waveform.hold(0.02, volts(*pair)) for pair in final[1:]),
               Waveform.hold(0.02, volts(*final[0])))  # fmt: skip


STEPS = [(2.5e-3, -1e-3), (0.5e-3, -2.5e-3), (2e-3, 1.5e-3)]


@pytest.mark.parametrize("restitution", [0.0, 0.5, 0.9, 1.0])
@pytest.mark.parametrize("friction", [0.0, 0.2, 1.0])
@pytest.mark.parametrize("drag", [0.0, 1e-5])
@pytest.mark.parametrize("knots", [(0.0,) * 5, (0.2, -0.15, 0.1, 0.2, -0.1)], ids=["", "beside"])
def test_energy_never_grows_in_constant_currents(knots, drag, friction, restitution):
    # Adhesion does no work: it holds what does not rise, is gone the moment that this leaves, and
    # acts again only on what has landed. What is left are conservative forces and losses, also
    # where the contact lies beside the corner, and rolls.
    keys = {
        **shaped("free_contact_place", knots),
        "contact.static_friction": friction,
        "contact.kinetic_friction": 0.7 * friction,
        "contact.restitution": restitution,
        "drag.linear": drag,
        "drag.rotational": 0.0,
        "solver.rtol": 1e-11,
        **QUICK_COILS,
    }
    moving = run(keys, program(_steps(STEPS)), rate=1e5)
    scale = MOMENT * 2.5e-3
    inside = (moving.t % 0.02 > 2e-5) & (moving.t % 0.02 < 0.02 - 1.5e-5)
    gain = np.diff(energy(moving))[inside[1:] & inside[:-1]]
    assert gain.max() < 1e-9 * scale
    if drag or (friction and restitution < 0.9):
        assert gain.sum() < -1e-3 * scale
    elif friction or restitution < 1.0:
        assert gain.sum() < 0.0  # a corner that sticks may rebound at the bound, without loss
    else:
        assert np.mean(moving.contact == FLIGHT) > 0.1
        assert np.abs(gain).max() < 1e-9 * scale
