"""Instruments as suspects beside the physics of one's own model."""

import numpy as np
import pytest

from stickslip import Prior, ScenarioError, Uncertain, diagnose_model, instruments
from swinging_body import CAUSES, result

SEEDS = (0, 1, 2)
HIDDEN = {
    "marker_place": (4e-3, -3e-3),  # m
    "angle_offset": (0.03,),  # rad
    "scale": (0.03,),
    "offset": (3e-3,),  # m
    "delay": (0.05,),  # s
    "clipping": (0.45,),  # rad
}


def line(times, parameters):
    """Two observables at each of three times: p t, and then the angles p."""
    return np.concatenate([parameters[:, :1] * times, parameters[:, :1] + 0.0 * times], axis=1)


TIMES = np.array([0.0, 1.0, 2.0])


def read(instrument, *values, slope=0.5):
    vector = np.array([[slope, *values]])
    return instruments.with_instruments(line, [instrument])(TIMES, vector)[0]


# The demand on the whole is 90 % in the set and at most 2 % with a physical cause in its place. Of
# effects of three standard deviations of the noise and more in some dozens of readings, as here,
# hardly one in a thousand is missed, so every seed has to be right.
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("hidden", HIDDEN)
def test_a_hidden_instrument_is_found_beside_the_physics(hidden, seed):
    verdict = result(seed, hidden, HIDDEN[hidden]).verdict
    assert verdict.kind in ("named", "ambiguous")
    assert hidden in verdict.causes


@pytest.mark.parametrize("seed", SEEDS)
def test_a_leaning_swing_is_not_taken_for_a_turned_camera(seed):
    verdict = result(seed, "lean", (0.03,)).verdict
    assert "lean" in verdict.causes
    assert verdict.kind != "pair"


# A false alarm is allowed in 5 % of all data sets, and a name is given in fewer still: of four, all
# pass with a probability of more than 0.81. These seeds were not chosen by their result.
@pytest.mark.parametrize("seed", range(4))
def test_without_a_distortion_nothing_is_named(seed):
    assert result(seed).verdict.kind == "none"


def test_the_size_of_a_distortion_is_found():
    found = result(0, "delay", HIDDEN["delay"]).params
    row = found.loc["delay.time"]
    assert row["unit"] == "s"
    # Three standard deviations: 1 in 370.
    assert abs(row["value"] - 0.05) < 3.0 * row["sd"]
    assert row["sd"] < 0.01


def test_each_instrument_reads_by_its_law():
    truth = [0.0, 0.5, 1.0, 0.5, 0.5, 0.5]
    assert read(instruments.scale(), 0.0) == pytest.approx(truth, abs=0.0)
    assert read(instruments.scale(rows=[2]), 0.1) == pytest.approx([0, 0.5, 1.1, 0.5, 0.5, 0.5])
    mask = np.arange(6) < 3
    offset = instruments.offset("m", 1.0, rows=mask)
    assert read(offset, 0.2) == pytest.approx([0.2, 0.7, 1.2, 0.5, 0.5, 0.5])
    assert read(instruments.clipping("m", 2.0, 0.5), 0.4) == pytest.approx(np.minimum(truth, 0.4))
    assert read(instruments.clipping("m", 2.0, 0.5), 0.4, slope=-0.5) == pytest.approx(
        -np.minimum(truth, 0.4)
    )
    assert read(instruments.clipping("m", 2.0, 0.5), 0.0) == pytest.approx(truth, abs=0.0)
    late = instruments.delay(TIMES, 0.1, rows=slice(0, 3))
    # A line is its own spline, before the first time too.
    assert read(late, 0.5) == pytest.approx([-0.25, 0.25, 0.75, 0.5, 0.5, 0.5])
    marker = instruments.marker_place([0, 1, 2], None, 0.1, theta=[3, 4, 5])
    moved = 0.3 * np.cos(0.5) + 0.2 * np.sin(0.5)
    assert read(marker, 0.3, 0.2)[:3] == pytest.approx(np.array(truth[:3]) + moved)
    known = instruments.marker_place([0], [1], 0.1, angle=[np.pi / 2])
    assert read(known, 0.3, 0.2) == pytest.approx([0.2, 0.2, 1.0, 0.5, 0.5, 0.5])


def test_instruments_read_one_after_another_and_the_physics_is_predicted_once():
    calls = []

    def counted(times, parameters):
        calls.append(len(parameters))
        return line(times, parameters)

    meters = [instruments.offset("m", 1.0), instruments.clipping("m", 2.0, 0.5)]
    model = instruments.with_instruments(counted, meters)
    found = model(TIMES, np.array([[0.5, 0.3, 0.7], [0.5, 0.0, 0.0]]))
    assert found[0] == pytest.approx([0.3, 0.7, 0.7, 0.7, 0.7, 0.7])
    assert found[1] == pytest.approx([0.0, 0.5, 1.0, 0.5, 0.5, 0.5], abs=0.0)
    assert calls == [1]


def test_what_the_model_cannot_compute_stays_so():
    late = instruments.delay(TIMES, 0.1, rows=slice(0, 3))
    assert np.isnan(read(late, 0.5, slope=np.nan)).all()


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: instruments.delay([0.0, 0.0], 0.1), "times"),
        (lambda: instruments.delay([0.0, 1.0], 0.1, curve=[0]), "times, curve"),
        (lambda: instruments.marker_place([0], [1], 0.1), "theta, angle"),
        (lambda: instruments.scale(size=0.0), "scale.error"),
        (lambda: instruments.with_instruments(line, [CAUSES[0]]), "instruments"),
        (lambda: read(instruments.scale(rows=[6]), 0.1), "rows"),
        (lambda: read(instruments.scale(rows=[True, False]), 0.1), "rows"),
        (lambda: read(instruments.delay(TIMES, 0.1), 0.1), "one for each"),
        (lambda: read(instruments.marker_place([0], [1], 0.1, angle=[0, 1]), 1, 1), "one for each"),
    ],
)
def test_what_does_not_fit_is_refused(make, said):
    with pytest.raises(ScenarioError, match=said):
        make()


@pytest.mark.parametrize("order", [(1, 0), (0,), ()])
def test_causes_that_are_not_the_instruments_of_the_model_are_refused(order):
    meters = [instruments.scale(), instruments.offset("m", 1.0)]
    model = instruments.with_instruments(line, meters)
    slope = [Uncertain("slope", Prior("normal", 0.5, 0.1))]
    said = r"last ones are .*; allowed are, in this order, .*: scale, offset"
    with pytest.raises(ScenarioError, match=said):
        diagnose_model(model, TIMES, np.ones(6), slope, [meters[k] for k in order], sd=np.ones(6))
