"""The default tolerance where drag is low: a robot that rocks remembers the errors of its steps."""

import numpy as np
import pytest

from stickslip import Scenario, simulate_batch

FINE = 1e-11
# Of velocities. The motions below may amplify a part in 1e9 to 1e-5; steps that are not tightened
# are off by up to 6e-4 at the default tolerance.
CLOSE = 2e-5

# mode, frequency (Hz), base (mT), edge, drag.linear (N s/m). They are from a grid of both modes,
# 1 to 15 Hz, two bases, both edges and drags of 0, 1e-8 and 1e-7 (the default is 1e-5), and such
# that a part in 1e9 of the mass moves the velocity by less than a part in 1e5 (checked below), but
# steps that are not tightened are not enough. Others, above all those that turn over in the ramp,
# amplify more.
CASES = [
    ("IPP", 1.0, 0.3, "rise", 0.0),
    ("IPP", 2.8, 0.3, "rise", 0.0),
    ("IPP", 4.0, 0.5, "fall", 0.0),
    ("IPP", 7.0, 0.3, "fall", 0.0),
    ("OPP", 1.0, 0.5, "fall", 0.0),
    ("OPP", 2.0, 0.5, "fall", 0.0),
    ("OPP", 2.8, 0.5, "fall", 0.0),
    ("OPP", 5.0, 0.3, "fall", 0.0),
    ("OPP", 10.0, 0.5, "rise", 0.0),
    ("OPP", 15.0, 0.5, "rise", 0.0),
    ("OPP", 2.0, 0.5, "fall", 1e-8),
    ("OPP", 5.0, 0.5, "fall", 1e-8),
    ("IPP", 2.8, 0.5, "fall", 1e-7),
    ("IPP", 7.0, 0.3, "fall", 1e-7),
    ("OPP", 2.8, 0.3, "rise", 1e-7),
    ("OPP", 4.0, 0.3, "fall", 1e-7),
]


def velocities(**solver_and_mass):
    scenarios = []
    for mode, frequency, base, edge, drag in CASES:
        keys = {
            "drive.mode": mode,
            "drive.hold": 1e-3 if mode == "IPP" else 2.5e-3,
            "drive.frequency": frequency,
            "drive.base": base * 1e-3,
            "drive.edge": edge,
            "drive.pulses": 5,
            "drag.linear": drag,
            "drag.rotational": 1e-10 * drag,
            "contact.static_friction": 0.2,
            "contact.kinetic_friction": 0.145,
        }
        scenarios.append(Scenario().replace({**keys, **solver_and_mass}))
    runs = simulate_batch(scenarios)
    assert all(run.ok for run in runs)
    return np.array([run.mean_velocity for run in runs])


@pytest.fixture(scope="module")
def fine():
    return velocities(**{"solver.rtol": FINE})


def test_the_motions_do_not_amplify_what_is_small(fine):
    mass = Scenario().robot.mass
    for part in (-1e-9, 0.6e-9):
        other = velocities(**{"solver.rtol": FINE, "robot.mass": mass * (1.0 + part)})
        np.testing.assert_allclose(other, fine, rtol=1e-5)


def test_the_default_tolerance_holds_where_drag_is_low(fine):
    np.testing.assert_allclose(velocities(), fine, rtol=CLOSE)


def test_without_a_tighter_tolerance_the_error_is_too_large(fine):
    # Without drag the tolerance is a thousandth of rtol, so that these give steps of 1e-8 and 1e-7:
    # else the test above would show nothing.
    undamped = np.array([drag == 0.0 for *_, drag in CASES])
    for rtol, error in ((1e-5, CLOSE), (1e-4, 1e-3)):
        off = np.abs(velocities(**{"solver.rtol": rtol}) / fine - 1.0)[undamped]
        assert np.count_nonzero(off > error) >= 3
