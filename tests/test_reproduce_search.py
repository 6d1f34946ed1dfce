"""The continuous search of the paper's settings: its space, its evidence, its command."""

import json

import numpy as np
import pandas as pd
import pytest

from command_line import stickslip
from stickslip import Scenario, ScenarioError
from stickslip.reproduction import setting_search
from stickslip.reproduction.criteria import NAMES, all_margins
from stickslip.reproduction.setting_search import evidence
from stickslip.reproduction.settings import AXES, MODES, Grid, Setting, pair_of, values_of
from stickslip.reproduction.survey import paired, survey

# A pair of the grid for which S1 to S4 hold.
SMALL = Grid(edges=("rise",), clamps=("down", "up"), bases=(0.5e-3, 1e-3), holds=(1.5e-3, 2.5e-3))
WORKING = (
    Setting("IPP", "rise", "down", 0.5e-3, 1.5e-3),
    Setting("OPP", "rise", "up", 1e-3, 2.5e-3),
)


@pytest.fixture(scope="module")
def found():
    return setting_search.search_settings(12, grid=SMALL, threads=2)


def test_a_pair_of_the_grid_is_one_of_the_space():
    pair = pair_of(values_of(WORKING))
    for mode, setting in zip(MODES, WORKING, strict=True):
        scenario = Scenario().replace(setting.keys())
        free = Scenario().replace(pair[mode].keys())
        for key in ("drive.mode", "drive.edge", "drive.clamp"):
            assert free.get(key) == scenario.get(key)
        for key in ("drive.base", "drive.hold", "drive.edge_time", "drive.ramp", "drag.linear"):
            assert free.get(key) == pytest.approx(scenario.get(key), rel=1e-12, abs=1e-15)


def test_a_free_setting_of_the_grid_is_judged_alike():
    pair = pair_of(values_of(WORKING))
    grid, free = (
        survey({m: [s] for m, s in zip(MODES, each, strict=True)}, 1, 2)
        for each in (WORKING, pair.values())
    )
    for found in (grid, free):
        assert all(each.works.all() for each in found.values())
    of_grid, of_free = (all_margins(paired(each["IPP"], each["OPP"])) for each in (grid, free))
    assert of_grid.shape == (14, 1)
    # The numbers may differ by rounding, which a chaotic run makes a part in a thousand or so.
    assert (of_grid >= 0.0).tolist() == (of_free >= 0.0).tolist()


def test_margins_and_counts_tell_what_excludes_what():
    margins = np.ones((4, len(NAMES)))
    s5, s6, s8 = (NAMES.index(name) for name in ("S5", "S6", "S8"))
    margins[0, [s5, s8]] = -0.1, -3.0
    margins[1, [s6, s8]] = -0.2, -2.0
    margins[2, [s5, s6, s8]] = -0.3
    margins[3, 0] = -1.0  # S1 fails: it does not count, though S8 holds
    said = evidence(margins)
    assert (said.kept, said.most) == (3, len(NAMES) - 2)
    assert said.failing == {("S5", "S8"): 1, ("S6", "S8"): 1}
    score = {each.name: each for each in said.scores}
    assert score["S8"][1:] == (0, -0.3, 0)
    assert score["S5"][1:] == (1, 1.0, len(NAMES) - 2)
    assert [(each.first, each.second) for each in said.conflicts] == [("S5", "S6")]
    # Of S5 where S6 holds, and of S6 where S5 holds.
    assert said.conflicts[0][2:] == (-0.1, -0.2)


def test_without_any_pair_that_keeps_s1_to_s4_there_is_no_evidence():
    said = evidence(np.full((2, len(NAMES)), -1.0))
    assert (said.kept, said.most, said.conflicts) == (0, 0, [])


@pytest.mark.nightly
def test_the_search_is_not_worse_than_the_grid_and_says_what_its_best_is(found):
    assert found.tried >= 12
    assert len(found.points) == found.tried
    # The search starts at the best pairs of the grid.
    assert {"S1", "S2", "S3", "S4"} <= {*found.holding}
    assert len(found.holding) >= found.grid_most >= 4
    again = survey({m: [s] for m, s in found.best.items()}, 3, 2)
    margins = all_margins(paired(again["IPP"], again["OPP"]))
    assert dict(zip(NAMES, margins[:, 0].tolist(), strict=True)) == found.margins


def test_every_pair_lies_within_its_ranges(found):
    for axis in AXES:
        values = found.points[axis.name]
        assert values.between(axis.low, axis.high).all()
        assert values.nunique() > 1


def test_the_command_writes_its_pairs(found, tmp_path, monkeypatch):
    monkeypatch.setattr(setting_search, "search_settings", lambda *_, **__: found)
    out = tmp_path / "out"
    done = stickslip("reproduce", "--search", "--pairs", 12, "--out", out)
    assert done.returncode == 0, done.stderr
    wanted = (f"{len(found.holding)} of 14 hold", "most that hold", f"{found.tried} pairs: {out}")
    for words in wanted:
        assert words in done.stdout
    table = pd.read_csv(out / "search.csv")
    assert len(table) == found.tried
    assert "linear (N s/m)" in table
    shown = json.loads(stickslip("reproduce", "--search", "--json", "--out", out).stdout)
    assert shown["holding"] == found.holding


@pytest.mark.parametrize(
    "options",
    [("--search", "--only", "fig8"), ("--pairs", 10), ("--seed", 1), ("--search", "--pairs", 0)],
)
def test_options_that_have_no_use_are_refused(options, tmp_path):
    done = stickslip("reproduce", *options, "--out", tmp_path / "out")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_wrong_numbers_are_refused():
    with pytest.raises(ScenarioError, match="pairs = 0"):
        setting_search.search_settings(0)
