"""The paper redone: statements on made-up walks, and data that are single simulations."""

import numpy as np
import pandas as pd
import pytest
from paper.__main__ import REFERENCE, STORED, differences
from paper.figures import curve_table, motion_table, reference_runs
from paper.statements import STATEMENTS, judge
from paper.walks import GRID, MODES, SCANS, Setting, settings_table, strokes, survey

from stickslip import Coils, Scenario, simulate

X = {name: np.array(scan.values) for name, scan in SCANS.items()}
CURVED = 40e-6 * X["frequency"] / (1 + (X["frequency"] / 150) ** 2)
# A setting of each mode that does all that the paper says: m/s over each scan, and its numbers.
IPP = {
    "over_frequency": CURVED, "over_friction": np.full_like(X["friction"], 2e-3),
    "over_adhesion": 2e-3 - 1e3 * X["adhesion"], "over_linear": 2e-3 / (1 + X["linear"] / 3e-5),
    "over_rotational": 2e-3 / (1 + X["rotational"] / 1e-14),
    "over_field": 0.6 * X["field"] - 20.0 * X["field"] ** 2,
    "slip_up": 1e-6, "slip_down": 99e-6, "slip_share_up": 0.01, "mean_tilt": 0.9, "still_tilt": 1.0,
    "normal_force_up": 1.1, "normal_force_down": 0.8, "still_velocity": 1e-9, "works": True,
}  # fmt: skip
OPP = IPP | {
    "over_friction": np.interp(X["friction"], [0.1, 0.2, 1.0, 1.2], [5e-3, 2e-3, 2e-3, 1e-3]),
    "over_adhesion": 3e-3 - 4e3 * X["adhesion"], "over_field": 0.6 * X["field"],
    "slip_up": 99e-6, "slip_down": 1e-6, "slip_share_up": 0.99, "mean_tilt": 0.4, "still_tilt": 0.5,
    "normal_force_up": 1.3, "normal_force_down": 0.9,
}  # fmt: skip


def made_up(count=1):
    """Walks of `count` such settings of each mode, which differ in their base alone."""
    walks = {}
    for mode, own in (("IPP", IPP), ("OPP", OPP)):
        data = pd.DataFrame({"mode": mode, "edge": "rise", "clamp": "down"}, index=range(count))
        data = data.assign(base=1e-3 * data.index, hold=2e-3).to_xarray().rename(index=mode)
        for name, value in own.items():
            dims = (mode, name.removeprefix("over_"))[: 1 + np.ndim(value)]
            data[name] = dims, np.repeat(np.array(value)[np.newaxis], count, axis=0)
        walks[mode] = data.assign_coords(X).drop_vars(mode)
    return walks


# What breaks one part of a statement alone: a number, or a part of a curve, times a factor.
BROKEN = [
    ("S1", "IPP slip_share_up", ..., 21.0), ("S1", "IPP slip_down", ..., -1.0),
    ("S2", "OPP slip_share_up", ..., 0.79), ("S2", "OPP slip_up", ..., -1.0),
    ("S3", "IPP normal_force_down", ..., 1.3), ("S3", "OPP normal_force_up", ..., 0.7),
    ("S4", "IPP still_tilt", ..., 0.6), ("S4", "IPP mean_tilt", ..., 0.5),
    ("S5", "IPP over_frequency", 5, 0.2), ("S5", "OPP over_frequency", 5, 0.2),
    ("S6", "OPP over_frequency", 11, 3.0), ("S7", "OPP over_friction", slice(0, 3), 0.39),
    ("S8", "OPP over_friction", slice(3, 10), 1.5), ("S9", "OPP over_friction", slice(10, 17), 2.1),
    ("S10", "OPP over_adhesion", ..., 0.5), ("S10", "OPP over_adhesion", slice(6, 9), 3.0),
    ("S11", "OPP over_linear", slice(1, 3), 0.8), ("S11", "OPP over_linear", 5, 2.5),
    ("S11", "OPP over_linear", 9, 30.0), ("S12", "OPP over_rotational", 1, 0.8),
    ("S12", "OPP over_rotational", 9, 11.0),
    ("S12", "OPP over_rotational", slice(5, 9), 0.4),  # loses more than IPP
    ("S13", "OPP over_field", ..., -1.0), ("S13", "OPP over_field", 4, 3.0),
    ("S13", "IPP over_field", slice(6, 11), 1.2),  # does not roll off
    ("S14", "OPP still_velocity", ..., 2e3),
]  # fmt: skip


@pytest.mark.parametrize(("name", "what", "part", "factor"), BROKEN)
def test_every_part_of_a_statement_counts(name, what, part, factor):
    walks, (mode, variable) = made_up(), what.split()
    holds, numbers = STATEMENTS[name](walks)
    assert holds.all()
    assert all(np.isfinite(each).all() for each in numbers.values())
    walks[mode][variable].values.T[part] *= factor
    assert not STATEMENTS[name](walks)[0].any()


def test_a_verdict_goes_by_the_share_of_working_pairs():
    walks = made_up(10)
    walks["OPP"]["edge"] = "OPP", ["rise"] * 8 + ["fall"] * 2
    for mode in MODES:
        walks[mode]["base"] = mode, np.zeros(10)
    walks["IPP"].slip_share_up[9], walks["OPP"].normal_force_up[8:] = 0.9, 0.9
    table = judge(walks)[0].set_index("statement")
    assert table["share"][:3].tolist() == [0.9, 1.0, 0.8]
    assert table["verdict"][:3].tolist() == ["reproduced", "reproduced", "depends"]
    assert table["settings"]["S3"] == "OPP edge rise (100%)"
    walks["IPP"].works[:9] = False
    assert judge(walks)[0]["share"][:3].tolist() == [0.0, 1.0, 0.8]
    assert judge(walks)[0]["verdict"][0] == "not reproduced"


def test_the_field_by_hand():
    table, coils = judge(made_up())[0].set_index("statement"), Coils()
    torque, force, force_beside = table["numbers"]["S15"].values()
    current = [6.5e-3 / coils.centre_field_per_ampere, 0, 0, 0, 0]
    at_centre = coils.gradient([0, 0, 0], current)[0, 0]
    expected = [1625 * each for each in (6.5e-3, at_centre, 0.149)]  # of 1625 nA m^2
    assert [torque, force, force_beside] == pytest.approx(expected)
    corner = coils.field([0.0125, 0.0125, 0.0125], [1, 0, 0, 0, 0])
    wide, _ = table["numbers"]["S17"].values()
    assert wide == pytest.approx(100 * abs(corner[1] / corner[0]))


@pytest.mark.parametrize(("share", "verdict"), [(0.02, "depends"), (0.0, "reproduced")])
def test_another_share_or_verdict_is_a_difference(share, verdict):
    rows = [(name, *stored) for name, stored in STORED.items()]
    table = pd.DataFrame(rows, columns=["statement", "verdict", "share"])
    assert differences(table, REFERENCE) == []
    table.loc[0, ["share", "verdict"]] = table["share"][0] + share, verdict
    said = differences(table, REFERENCE | {"IPP": "another"})
    assert [each[:4] for each in said] == ["IPP:", "S1: "]


SETTINGS = {
    "IPP": Setting("IPP", "rise", "down", 1e-3, 1.5e-3),
    "OPP": Setting("OPP", "rise", "up", 0.0, 2.5e-3),
}


SLOW, FAST, STILL = (
    {"drive.pulses": pulses, "drive.frequency": frequency}
    for pulses, frequency in ((12, 30.0), (20, 100.0), (13, 10.0))
)


def single(setting, changes):
    """A run of a setting by itself."""
    return simulate(Scenario().replace({**setting.keys(), "solver.rtol": 1e-6, **changes}))


def test_a_setting_is_judged_by_single_simulations():
    tried = [each for each in GRID if each.edge == "rise" and (each.base, each.hold) == (0.0, 2e-3)]
    table = settings_table(survey(tried, 1))
    for setting, row in zip(tried, table.to_dict("records"), strict=True):
        runs = single(setting, SLOW), single(setting, FAST)
        speeds = [run.mean_velocity for run in runs]
        assert [row["velocity_30_hz"], row["velocity_100_hz"]] == speeds
        ends = [run.summary()[name] for run in runs for name in ("theta_min", "theta_max")]
        tilts = np.array(ends) * (1.0 if setting.clamp == "down" else -1.0)
        upright = tilts.min() > -0.02 and tilts.max() < 0.5 * np.pi
        assert row["works"] == (min(speeds) > 2e-5 and upright)
        still = single(setting, STILL | {"drive.peak": setting.base})
        assert row["still_tilt"] == abs(still.summary()["theta_max"])
    assert 0 < table["works"].sum() < len(tried)


FIELDS = ("drive.peak", "drive.base", "drive.hold")
POINTS = [
    ("fig8", "OPP", -1, {"contact.static_friction": 2.4, "contact.kinetic_friction": 0.7 * 2.4}),
    ("fig9", "OPP", -1, {"contact.adhesion": 0.8e-6}),
    ("fig11", "IPP", 0, {"drag.rotational": 1e-18}),
    ("fig13", "OPP", -1, {"drive.frequency": 150.0}),
    ("fig14", "IPP", 25, {**SLOW, "drive.peak": 6.5e-3}),
    ("fig14", "IPP", -1, {**SLOW, **dict(zip(FIELDS, (6.5e-3, 2.6e-3, 3.9e-3), strict=True))}),
]


@pytest.mark.parametrize(("figure", "mode", "place", "changes"), POINTS)
def test_a_point_of_a_curve_is_a_single_simulation(figure, mode, place, changes):
    row = curve_table(figure, SETTINGS, 1, None).iloc[place]
    velocity = single(SETTINGS[mode], FAST | changes).mean_velocity
    assert (row["mode"], row["velocity"]) == (mode, pytest.approx(velocity, rel=1e-9))


def test_the_film_and_the_strokes_of_opp():
    run = reference_runs(SETTINGS, None)["OPP"]
    span = run.scenario.window[1] - run.scenario.window[0]
    # With the clamp up theta is negative: what rises in magnitude falls in theta.
    expected = run.summary()["slip_down"] * span
    assert strokes(run)["slip_up"] == pytest.approx(expected, rel=0.02)
    table = motion_table("fig2", run)
    assert 0.0 < table["t"].iloc[-1] - table["t"].iloc[0] < 2.0 / 30.0
    tilt = np.abs(table["theta"])
    assert tilt[0] > tilt[1] < tilt[2] < tilt[3]
    assert table["contact_x"][3] > table["contact_x"][0]
    heights = table[[f"corner{number}_z" for number in range(1, 5)]].min(axis=1)
    assert np.abs(heights).max() < 1e-5
