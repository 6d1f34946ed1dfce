"""Numbers of settings that are the same but for their last digits."""

import numpy as np
import pandas as pd
import pytest

from stickslip import Measurement, Scenario, ScenarioError
from stickslip._util.arrays import representatives
from stickslip.walker import read_measurement
from stickslip.walker.velocity import VelocityTable

NOMINAL = Scenario().replace({"drive.base": 0.5e-3, "drive.pulses": 6})


def test_groups_begin_at_their_smallest_value():
    # Neighbours in the chain are equal; the third is not equal to the first.
    chain = [1.0, 1.0 + 8e-7, 1.0 + 1.6e-6]
    found = representatives([*chain, 2.0])
    assert found == {chain[0]: 1.0, chain[1]: 1.0, chain[2]: chain[2], 2.0: 2.0}
    # Where the group is begun from below, the middle one is another's.
    found = representatives([chain[2], chain[1], 2.0])
    assert found == {**dict.fromkeys(chain[1:], chain[1]), 2.0: 2.0}


@pytest.mark.parametrize(
    ("values", "kept", "one"),
    [
        ([25.000000000000004, 25.0, 24.999999999999996], (), 25.0),
        ([7.0, np.nextafter(7.0, 8.0), 7.0 - 2e-15], (), 7.0),
        ([25.0, 1 / 0.04 + 4e-15], (25.00000000000001,), 25.00000000000001),
    ],
)
def test_what_stands_for_a_group(values, kept, one):
    assert set(representatives(values, kept).values()) == {one}


def test_numbers_that_a_person_tells_apart_stay_apart():
    # The size of the numbers, such as that of a unix time, says nothing.
    for apart in ([24.9999, 25.0, 25.0001], [1e-17, 2e-17], [1.7e9, 1.7e9 + 1e-3, 1.7e9 + 1.0]):
        assert representatives(apart) == {value: value for value in apart}
    assert len(set(representatives([0.0, 1e-7, 0.5, 0.5 + 1e-7, 1.0]).values())) == 4
    # Nor does the spread, of many decades or of a value that stands for none.
    for apart in (np.geomspace(1e-12, 1.0, 25).tolist(), [1.0, 2.0, 3.0, 1e9]):
        assert representatives(apart) == {value: value for value in apart}


def _table(last_bits):
    rows = [
        (mode, frequency, 1e-3 * frequency / 25 * (1 + 0.01 * trial))
        for mode in ("IPP", "OPP")
        for frequency in (25.0, 45.0, 70.0)
        for trial in range(3)
    ]
    table = pd.DataFrame(rows, columns=["mode", "frequency", "velocity"])
    if last_bits:
        toward = np.tile([0.0, 1e9, np.nan], 6)
        near = np.nextafter(table["frequency"], toward)
        table["frequency"] = np.where(np.isnan(toward), table["frequency"], near)
    return table


def test_trials_whose_settings_differ_in_the_last_bit_are_repeats():
    (clean,) = Measurement.from_dataframe(_table(False), NOMINAL).velocity
    found = Measurement.from_dataframe(_table(True), NOMINAL)
    (data,) = found.velocity
    assert data.conditions == clean.conditions
    np.testing.assert_array_equal(data.condition, clean.condition)
    np.testing.assert_array_equal(data.sweep, clean.sweep)
    (said,) = found.left_out  # once, not a line for each
    assert (said.code, said.value) == ("equal-settings", 6)
    assert said.text.startswith("DataFrame: frequency has 6 values within 1e-06 of another one")


def test_conditions_of_several_tables_and_of_the_scenario_are_the_same(tmp_path):
    last_bit = float(np.nextafter(NOMINAL.drive.peak, 1.0))
    second = _table(True).assign(peak=last_bit, hold=1e-3)
    second["velocity"] *= 1.001
    NOMINAL.to_toml(tmp_path / "nominal.toml")
    _table(False).to_csv(tmp_path / "a.csv", index=False)
    second.to_csv(tmp_path / "b.csv", index=False)
    entries = "".join(f'[[velocity]]\nfile = "{name}.csv"\n' for name in "ab")
    (tmp_path / "m.toml").write_text(
        f'stickslip_measurement = 1\nscenario = "nominal.toml"\n{entries}'
    )
    added = Measurement.from_dataframe(_table(False), NOMINAL).with_velocities(second)
    for found in (read_measurement(tmp_path / "m.toml"), added):
        conditions = VelocityTable(found).conditions
        assert len(conditions) == 6
        assert {each["drive.peak"] for each in conditions} == {NOMINAL.drive.peak}
        said = [each.text.split(": ")[1].split(" has ")[0] for each in found.left_out]
        assert said == ["frequency", "peak"]


def test_the_same_trials_again_are_refused_whatever_their_last_bits():
    found = Measurement.from_dataframe(_table(False), NOMINAL)
    with pytest.raises(ScenarioError, match="in the measurement already"):
        found.with_velocities(_table(True))
