"""Mean velocities that two independent programs agree on, both integrators, and any tolerance."""

import numpy as np
import pytest

from helpers import friction, run

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


def test_the_default_tolerance_agrees_with_a_fine_one_on_random_drives():
    # Events decide the motion: one that is missed changes it by percents.
    random = np.random.default_rng(20)
    worst = []
    for _ in range(150):
        drive = {
            "mode": random.choice(["IPP", "OPP"]).item(),
            "edge": random.choice(["rise", "fall"]).item(),
            "clamp": random.choice(["up", "down"]).item(),
            "frequency": random.uniform(10.0, 200.0),
            "base": random.uniform(0.0, 1e-3),
            "hold": random.uniform(0.5e-3, 3e-3),
            "pulses": 8,
        }
        static = random.uniform(0.1, 1.0)
        keys = friction(static, 0.725 * static)
        keys["contact.adhesion"] = random.uniform(0.0, 0.5e-6)
        default, fine = run(keys, **drive), run(keys, {"solver.rtol": 1e-11}, **drive)
        worst.append(abs(default.mean_velocity - fine.mean_velocity))
    # 2 um/s is a thousandth of a brisk walk; a run at a bifurcation may fall either way.
    assert np.sum(np.array(worst) > 2e-6) <= 1


def test_both_integrators_agree_on_random_drives():
    random = np.random.default_rng(7)
    for _ in range(50):
        drive = {
            "mode": random.choice(["IPP", "OPP"]).item(),
            "edge": random.choice(["rise", "fall"]).item(),
            "clamp": random.choice(["up", "down"]).item(),
            "frequency": random.uniform(5.0, 200.0),
            "base": random.uniform(-0.5e-3, 1.5e-3),
            "hold": random.uniform(0.5e-3, 3e-3),
            "pulses": 8,
        }
        static = float(np.exp(random.uniform(np.log(0.05), np.log(2.0))))
        keys = friction(static, static * random.uniform(0.3, 1.0))
        keys["contact.adhesion"] = random.uniform(0.0, 1e-6)
        keys["drag.linear"] = float(np.exp(random.uniform(np.log(1e-6), np.log(1e-4))))
        ours, theirs = (
            run(keys, {"solver.rtol": 1e-10, "solver.method": method}, **drive).mean_velocity
            for method in ("tsit5", "arkode")
        )
        # Two runs, each good to 1e-10 a step; a net motion that nearly cancels has an error of the
        # size of its parts.
        assert ours == pytest.approx(theirs, rel=2e-6, abs=1e-11), drive
