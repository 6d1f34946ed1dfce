"""Instruments as causes: what each reads."""

import numpy as np
import pytest

from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.terms import instruments
from stickslip.walker.instruments import of_fields, of_films, of_velocities

# At three times the places p t, and then the angles p.
TIMES = np.array([0.0, 1.0, 2.0])
TRUTH = np.array([0.0, 0.5, 1.0, 0.5, 0.5, 0.5])


def read(cause, *values, truth=TRUTH):
    p = {each.name: np.array([[v]]) for each, v in zip(cause.parameters, values, strict=True)}
    return cause.read(truth[None, :], truth[None, :], p, Table({}, TRUTH))[0]


def test_each_instrument_reads_by_its_law():
    assert read(instruments.scale(), 0.0) == pytest.approx(TRUTH, abs=0.0)
    assert read(instruments.scale(rows=[2]), 0.1) == pytest.approx([0, 0.5, 1.1, 0.5, 0.5, 0.5])
    offset = instruments.offset("m", 1.0, rows=np.arange(6) < 3)
    assert read(offset, 0.2) == pytest.approx([0.2, 0.7, 1.2, 0.5, 0.5, 0.5])
    clipped = instruments.clipping("m", 2.0, 0.5)
    assert read(clipped, 0.4) == pytest.approx(np.minimum(TRUTH, 0.4))
    assert read(clipped, 0.4, truth=-TRUTH) == pytest.approx(-np.minimum(TRUTH, 0.4))
    assert read(clipped, 0.0) == pytest.approx(TRUTH, abs=0.0)
    # No limit at the coordinate 0, and one size below the highest at 1.
    assert clipped.parameters[0].value(np.array([0.0, 1.0])).tolist() == [0.0, 1.5]
    # A line is its own spline, before the first time too.
    late = instruments.delay(TIMES, 0.1, rows=slice(0, 3))
    assert read(late, 0.5) == pytest.approx([0.0, 0.25, 0.75, 0.5, 0.5, 0.5])
    assert np.isnan(read(late, 0.5, truth=np.full(6, np.nan))).all()
    marker = instruments.marker_place([0, 1, 2], None, 0.1, theta=[3, 4, 5])
    moved = 0.3 * np.cos(0.5) + 0.2 * np.sin(0.5)
    assert read(marker, 0.3, 0.2)[:3] == pytest.approx(TRUTH[:3] + moved)
    known = instruments.marker_place([0], [1], 0.1, angle=[np.pi / 2])
    assert read(known, 0.3, 0.2) == pytest.approx([0.2, 0.2, 1.0, 0.5, 0.5, 0.5])


def test_several_curves_are_late_each_by_itself():
    # Two lines whose rows are mixed: of slope 1, and of slope -2 from 5.
    times, curve = [0.0, 1.0, 1.0, 3.0, 2.0, 0.0], [0, 1, 0, 1, 0, 1]
    truth = np.array([0.0, 3.0, 1.0, -1.0, 2.0, 5.0])
    late = instruments.delay(times, 0.1, curve=curve)
    assert read(late, 0.5, truth=truth) == pytest.approx([0.0, 4.0, 0.5, 0.0, 1.5, 5.0])


# Causes of measured tables.

VELOCITIES = np.array([1e-3, -2e-3, 3e-3])


def test_an_offset_and_a_limit_act_one_after_the_other_on_one_prediction():
    *_, offset, limit = of_velocities(VELOCITIES)
    names = ["velocity_clipping.limit", "drag.linear", "velocity_offset.shift"]
    asked = []

    def physics(known, values):
        asked.append((list(known), values.tolist()))
        return values[:, :1] * VELOCITIES

    values = np.array([[0.0, 2.0, 0.0], [2.2e-3, 1.0, 5e-4], [0.0, 1.0, 5e-4], [0.0, 1.0, 0.0]])
    seen = instruments.read_by((offset, limit), names, values, physics, Table({}, VELOCITIES))
    assert seen[0] == pytest.approx(2.0 * VELOCITIES, rel=1e-15)
    assert seen[1] == pytest.approx([1.5e-3, -1.5e-3, 2.2e-3], rel=1e-15)
    assert seen[2] == pytest.approx(VELOCITIES + 5e-4, rel=1e-15)
    assert np.array_equal(seen[3], VELOCITIES)
    # Vectors that differ in the instruments alone share the physics.
    assert asked == [(["drag.linear"], [[2.0], [1.0]])]
    # Without their parameters instruments read what is there.
    alone = instruments.read_by(
        (offset, limit), names[1:2], values[:1, 1:2], physics, Table({}, VELOCITIES)
    )
    assert np.array_equal(alone[0], 2.0 * VELOCITIES)
    assert of_velocities(np.zeros(3)) == ()


@pytest.mark.parametrize(("length", "clock"), [(0.05, 0.0), (0.0, 0.05), (-0.1, 0.2)])
def test_scales_of_length_and_clock_are_one_factor_of_velocities(length, clock):
    names = ["length_scale.fraction", "clock_scale.fraction"]
    seen = instruments.read_by(
        of_velocities(VELOCITIES), names, np.array([[length, clock], [0.0, 0.0]]),
        lambda _, values: np.tile(VELOCITIES, (len(values), 1)), Table({}, VELOCITIES),
    )  # fmt: skip
    assert seen[0] == pytest.approx((1.0 + length) / (1.0 + clock) * VELOCITIES, rel=1e-15)
    assert np.array_equal(seen[1], VELOCITIES)


def test_a_turned_probe_reads_the_field_in_its_own_axes():
    turned, _ = of_fields(np.ones((1, 3)))
    fields = np.array([1e-3, 0.0, 0.0, 0.0, 2e-3, 0.0])
    # After a quarter turn about z the probe's x axis is the coils' y, and its y axis their -x;
    # rounding of the sines is 1e-16 of the field.
    seen = read(turned, 0.0, 0.0, 0.5 * np.pi, truth=fields)
    assert seen == pytest.approx([0.0, -1e-3, 0.0, 2e-3, 0.0, 0.0], abs=1e-18)


def test_a_wild_frame_does_not_hide_a_limit():
    # All of 300 angles are cut off at 1.1, but for one that went wrong.
    angles = np.clip(1.4 * np.sin(np.arange(300.0)), -1.1, 1.1)
    angles[17] = 3.0
    causes = {each.name: each for each in of_films(angles)}
    (limit,) = causes["film_clipping"].parameters
    assert limit.high == pytest.approx(1.2 * 1.1)
    # One size below it, where the search begins, is near the limit.
    assert limit.high - limit.size == pytest.approx(1.08 * 1.1)
    assert all(each.read is None for each in causes.values())
