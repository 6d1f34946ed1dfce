"""Mean velocities that two independent programs agree on, and the two integrators."""

import pytest

from helpers import run

# mode, frequency (Hz), base and hold (mT), edge, clamp, velocity (mm/s)
CHECK_NUMBERS = [
    ("IPP", 100.0, 0.5, 1.0, "rise", "down", 1.9128),
    ("IPP", 30.0, 0.5, 1.0, "fall", "up", 0.5986),
    ("OPP", 30.0, 0.5, 2.5, "fall", "down", 0.7186),
    ("OPP", 100.0, 0.0, 2.5, "rise", "up", 3.0680),
]


def _velocity(mode, frequency, base, hold, edge, clamp, **solver):
    """mm/s"""
    keys = {f"solver.{key}": value for key, value in solver.items()}
    drive = {"mode": mode, "frequency": frequency, "edge": edge, "clamp": clamp, "pulses": 20}
    return run(keys, base=base * 1e-3, hold=hold * 1e-3, **drive).mean_velocity * 1e3


@pytest.mark.parametrize("case", CHECK_NUMBERS, ids=lambda case: f"{case[0]}-{case[1]:.0f}Hz")
def test_check_number(case):
    # The numbers are given to four or five digits: 0.5e-4 / 0.5986 is 0.8e-4, and the programs
    # agree within 5e-4.
    assert _velocity(*case[:-1]) == pytest.approx(case[-1], rel=1e-3)


@pytest.mark.parametrize("case", CHECK_NUMBERS, ids=lambda case: f"{case[0]}-{case[1]:.0f}Hz")
def test_the_two_integrators_agree(case):
    one = _velocity(*case[:-1], method="tsit5")
    other = _velocity(*case[:-1], method="arkode")
    assert one == pytest.approx(other, rel=2e-4)
    assert one != other  # else one of them stands in for the other


@pytest.mark.parametrize("case", CHECK_NUMBERS, ids=lambda case: f"{case[0]}-{case[1]:.0f}Hz")
@pytest.mark.parametrize("method", ["tsit5", "arkode"])
def test_default_tolerance_is_tight_enough(case, method):
    fine = _velocity(*case[:-1], rtol=1e-11)
    assert _velocity(*case[:-1], method=method) == pytest.approx(fine, rel=1e-4)
    # A thousand times the tolerance moves the result, so that the one above means something.
    assert _velocity(*case[:-1], method=method, rtol=1e-4) != fine
