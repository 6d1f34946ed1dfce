"""Measured velocities from a pandas DataFrame: what is read, left out and refused."""

import numpy as np
import pandas as pd
import pytest

from stickslip import Measurement, Scenario, read_measurement
from stickslip.errors import ScenarioError
from stickslip.measurement import Prior

TABLE = pd.DataFrame(
    {
        "velocity": [1e-3 * (1 + 0.01 * k) * (1 + n) for n in range(4) for k in (-1, 0, 1)],
        "mode": "IPP",
        "frequency": np.repeat([30, 50, 70, 90], 3),
        "trial": np.tile([0, 1, 2], 4),
        "block": np.tile(["a", "b", None], 4),
    }
)


def test_a_table_in_memory_is_read_like_a_file(tmp_path):
    nominal = Scenario().replace({"drive.base": 0.5e-3, "drive.pulses": 6})
    data = Measurement.from_dataframe(
        TABLE,
        nominal,
        {
            "contact.kinetic_friction": Prior("normal", 0.145, 0.01),
            "drag.linear": {"low": 1e-6, "high": 1e-4},
        },
    )
    nominal.to_toml(tmp_path / "nominal.toml")
    TABLE.to_csv(tmp_path / "velocity.csv", index=False)
    (tmp_path / "m.toml").write_text(
        'stickslip_measurement = 1\nscenario = "nominal.toml"\n[uncertain]\n'
        '"contact.kinetic_friction" = { mean = 0.145, sd = 0.01 }\n'
        '"drag.linear" = { low = 1e-6, high = 1e-4 }\n[[velocity]]\nfile = "velocity.csv"\n'
    )
    same = read_measurement(tmp_path / "m.toml")
    assert data.uncertain == same.uncertain
    (one,), (other,) = data.velocity, same.velocity
    assert one.conditions == other.conditions
    for name in ("velocity", "condition", "block", "order"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert one.block.tolist() == [0, 1, -1] * 4


@pytest.mark.parametrize("levels", [["frequency"], ["mode", "frequency", "trial"]])
def test_settings_in_the_index_are_read_as_columns(levels):
    nominal = Scenario().replace({"drive.base": 0.5e-3})
    (plain,) = Measurement.from_dataframe(TABLE, nominal).velocity
    (moved,) = Measurement.from_dataframe(TABLE.set_index(levels), nominal).velocity
    assert moved.conditions == plain.conditions
    np.testing.assert_array_equal(moved.velocity, plain.velocity)
    # A level of another name says what a row is called.
    named = TABLE.assign(velocity=[None, *TABLE["velocity"][1:]]).set_axis(
        pd.Index([f"film {k}" for k in range(12)], name="film")
    )
    assert "film 0" in str(Measurement.from_dataframe(named, nominal).left_out[-1])


def test_unusable_rows_are_left_out_and_reported():
    table = TABLE.astype({"velocity": object, "frequency": object})
    table.loc[1, "velocity"] = None
    table.loc[4, "velocity"] = "fast"
    table.loc[7, "frequency"] = -3.0
    data = Measurement.from_dataframe(table, Scenario().replace({"drive.base": 0.5e-3}))
    assert len(data.velocity[0].velocity) == 9
    said = "\n".join(map(str, data.left_out))
    assert 'DataFrame row 4: velocity "fast" is not a number.' in said
    assert "DataFrame row 7: drive.frequency = -3.0: allowed is" in said
    assert "DataFrame: 3 of 12 rows were left out" in said


@pytest.mark.parametrize(
    ("table", "more", "said"),
    [
        (TABLE.rename(columns={"velocity": "v"}), {}, 'column "velocity" is missing; there are'),
        (TABLE.rename(columns={"mode": "mod"}), {}, '"mod" is not known; did you mean "mode"'),
        (TABLE.assign(peak=0.5), {}, "rows 0, .*: peak of 0.5 T is above 0.1 T; if it is in mT"),
        (TABLE.assign(velocity="x"), {}, 'no row is sound. .*: velocity "x" is not a'),
        (TABLE.iloc[:0], {}, "has no row of data"),
        (pd.concat([TABLE, TABLE[["mode"]]], axis=1), {}, 'column "mode" is there twice'),
        ([1.0], {}, "allowed is a DataFrame"),
        (TABLE, {"uncertain": {"drag.liner": Prior("normal", 1e-5, 1e-6)}}, "drag.linear"),
        (TABLE, {"uncertain": {"drag.linear": {"mean": 1.0}}}, "allowed is { mean, sd }"),
        (TABLE, {"velocity_sd": 2.0}, "velocity_sd = 2.0: allowed is a number above 0"),
    ],
)  # fmt: skip
def test_a_table_that_cannot_be_used_is_refused_in_one_line(table, more, said):
    with pytest.raises(ScenarioError, match=said) as error:
        Measurement.from_dataframe(table, Scenario(), **more)
    assert "\n" not in str(error.value)


def test_the_order_of_trials_is_a_number_or_a_date():
    dates = pd.Timestamp("2026-01-05") + pd.to_timedelta(np.arange(12) * 60.0, "s")
    data = Measurement.from_dataframe(TABLE.assign(order=dates), Scenario())
    assert data.velocity[0].order.tolist() == [60.0 * k for k in range(12)]
    order = ["first", *range(1, 11), None]
    data = Measurement.from_dataframe(TABLE.assign(order=order), Scenario())
    assert 'DataFrame row 0: order "first" is not a number.' in map(str, data.left_out)
    assert np.isnan(data.velocity[0].order[-1])  # not known


def test_an_uncertain_parameter_of_an_effect_has_a_short_name():
    prior = Prior("normal", 0.0, 0.01)
    data = Measurement.from_dataframe(TABLE, Scenario(), {"surface_tilt.angle": prior})
    assert data.uncertain == {"effects.surface_tilt.angle": prior}
    twice = {"surface_tilt.angle": prior, "effects.surface_tilt.angle": prior}
    with pytest.raises(ScenarioError, match="is there twice"):
        Measurement.from_dataframe(TABLE, Scenario(), twice)


def test_rows_of_a_table_in_memory_have_their_index_label():
    table = TABLE.set_axis([f"r{k}" for k in range(12)])
    table.loc["r3", "velocity"] = np.nan
    data = Measurement.from_dataframe(table, Scenario())
    assert [str(each) for each in data.left_out] == ["DataFrame row r3: velocity is empty."]


def test_a_prior_that_no_scenario_allows_is_refused():
    for key, prior in (
        ("contact.kinetic_friction", Prior("normal", 0.5, 0.01)),
        ("robot.mass", Prior("normal", -1.0, 0.1)),
    ):
        with pytest.raises(ScenarioError, match=rf'\[uncertain\] "{key}" = normal.*: allowed'):
            Measurement.from_dataframe(TABLE, Scenario(), {key: prior})
    both = {
        "contact.kinetic_friction": Prior("normal", 0.5, 0.01),
        "contact.static_friction": Prior("normal", 0.6, 0.01),
    }
    assert len(Measurement.from_dataframe(TABLE, Scenario(), both).uncertain) == 2


def test_a_prior_whose_middle_no_scenario_has_is_told_of():
    wide = {"contact.kinetic_friction": Prior("log-uniform", 0.15, 0.3)}
    # The middle of a log-uniform prior is the root of 0.15 * 0.3 = 0.045.
    refusal = Measurement.from_dataframe(TABLE, Scenario(), wide).refusal()
    assert "contact.kinetic_friction = 0.2121" in refusal
    narrow = {"contact.kinetic_friction": Prior("log-uniform", 0.15, 0.19)}
    assert Measurement.from_dataframe(TABLE, Scenario(), narrow).refusal() is None
