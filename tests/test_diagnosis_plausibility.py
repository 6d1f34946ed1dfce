"""Signs and zeros that no cause can explain are said before any cause is blamed."""

import numpy as np
import pytest

from stickslip.diagnosis.data.plausibility import standing_still, start_up_included, wrong_sign
from stickslip.facts import Code, Fact

WAYS = [
    {"drive.mode": mode, "drive.direction": way} for mode in ("IPP", "OPP") for way in ("+x", "-x")
] * 4
MODEL = np.array([1.0, -1.1, -0.6, 0.7] * 4) * np.linspace(0.8, 1.3, 16)


def reverse(setting, value):
    return Fact(Code.REVERSED, {"setting": setting, "value": value})


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda v: np.abs(v), Fact(Code.SPEEDS, {})),
        (lambda v: v * np.array([1.0, -1.0, 1.0, -1.0] * 4), reverse("direction", "-x")),
        (lambda v: v * np.array([1.0, 1.0, -1.0, -1.0] * 4), reverse("mode", "OPP")),
    ],
)
def test_signs_reversed_by_a_setting_are_a_problem_of_the_data(change, said):
    assert wrong_sign(WAYS, MODEL, 1.1 * change(MODEL)) == said


def test_signs_reversed_without_a_pattern_are_left_to_the_causes():
    assert wrong_sign(WAYS, MODEL, 1.1 * MODEL) is None
    # Six of sixteen, of all kinds; or a robot that slides one way at another speed.
    some = MODEL * np.where(np.arange(16) < 6, -1.0, 1.0)
    assert wrong_sign(WAYS, MODEL, some) is None
    assert wrong_sign(WAYS, MODEL, np.abs(MODEL) + 2.0) is None
    # A bias, such as a tilt's, reverses the smaller half and makes the other half three times it.
    assert wrong_sign(WAYS, np.sign(MODEL), np.sign(MODEL) + 2.1) is None


def test_zero_readings_where_the_model_walks_are_reported():
    paces = [{"drive.frequency": float(f)} for f in range(20, 30)]
    model = np.full(10, 1e-3)
    model[9] = 1e-6
    read = model.copy()
    assert standing_still(paces, model, read) is None
    # Where the model hardly moves either, zero is no news.
    read[9] = 0.0
    assert standing_still(paces, model, read) is None
    read[:6] = 0.0
    first = [f"frequency {pace} Hz" for pace in (20, 21, 22, 23)]
    still = {"count": 6, "speed": 1e-3, "conditions": first}
    assert standing_still(paces, model, read) == Fact(Code.STANDS_STILL, still)


def test_drives_that_measure_the_start_up_are_noted():
    fact = start_up_included([{"drive.pulses": 3}, {"drive.pulses": 4}, {"drive.pulses": 1}])
    assert fact.fields["count"] == 2
    assert start_up_included([{"drive.pulses": 4}]) is None
