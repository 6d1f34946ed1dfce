"""The study's parts by themselves: survey, small changes, field, input."""

import subprocess
import sys

import numpy as np
import pytest

from stickslip import Coils, Drive, Scenario, ScenarioError, reproduce, simulate
from stickslip.reproduction.curves import MeasuredPoint, read_measured
from stickslip.reproduction.field_checks import field_checks
from stickslip.reproduction.points import variations
from stickslip.reproduction.settings import Grid, Setting
from stickslip.reproduction.strokes import strokes
from stickslip.reproduction.survey import stroke_scenario, survey


def test_the_survey_is_that_of_single_simulations():
    grid = Grid(("rise",), ("up",), (1e-3,), (2e-3,))
    found = survey(grid.settings(), 1, 2)["OPP"]
    (setting,) = found.settings
    assert setting == Setting("OPP", "rise", "up", 1e-3, 2e-3)
    run = simulate(stroke_scenario(setting))
    by_stroke = strokes(run)
    assert {name: getattr(found, name)[0] for name in by_stroke} == by_stroke
    start, stop = run.scenario.window
    summary = run.summary()
    # With the clamp up theta is negative: what rises in magnitude falls in theta.
    assert found.slip_up[0] == pytest.approx(summary["slip_down"] * (stop - start), rel=0.02)
    assert -found.tilt_high[0] == pytest.approx(summary["theta_min"], abs=0.1)
    still = simulate(
        Scenario(
            drive=Drive(
                mode="OPP", clamp="up", peak=1e-3, base=1e-3, hold=2e-3, frequency=10, pulses=13
            )
        )
    )
    assert found.still_tilt[0] == pytest.approx(abs(still.summary()["theta_max"]), abs=1e-4)


def test_small_changes_are_spread_and_begin_with_none():
    spread = variations(64)
    assert spread[0].tolist() == [0.0, 0.0, 0.0]
    assert np.abs(spread).max() <= 1.0
    assert np.abs(spread.mean(axis=0)).max() < 0.05
    assert np.abs(np.corrcoef(spread.T) - np.eye(3)).max() < 0.1


def test_the_field_by_hand():
    checks = field_checks()
    assert checks.torque == pytest.approx(1.625e-6 * 6.5e-3)
    assert checks.gradient_at_centre == pytest.approx(0.1214, abs=1e-4)
    assert checks.force_at_centre == pytest.approx(1.625e-6 * checks.gradient_at_centre)
    coils = Coils()
    current = [6.5e-3 / coils.centre_field_per_ampere, 0, 0, 0, 0]
    at = coils.gradient([checks.full_gradient_offset, 0, 0], current)[0, 0]
    assert at == pytest.approx(0.149, rel=1e-5)
    corner = coils.field([0.0125, 0.0125, 0.0125], [1, 0, 0, 0, 0])
    assert checks.fringe == pytest.approx(abs(corner[1] / corner[0]))
    assert checks.winding_flat == pytest.approx(0.0051, abs=1e-4)


def test_what_cannot_be_done_is_refused(tmp_path):
    with pytest.raises(ScenarioError, match=r'figure "fig3": allowed is .*fig2.*fig15'):
        reproduce(only=["fig8", "fig3"])
    with pytest.raises(ValueError, match="threads"):
        reproduce(threads=0)
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="not a folder"):
        reproduce(tmp_path / "file")


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("", "no row of data"),
        ("figure,mode,x\nfig12,IPP,1\n", 'column "y" is missing'),
        ("figure,mode,x,y\n", "no row of data"),
        ("figure,mode,x,y\nfig3,IPP,1,1\n", r'line 2: figure = "fig3": allowed is one of fig8'),
        ("figure,mode,x,y\n\nfig12,OPP,1,1\n", r'line 3: mode = "OPP": allowed in fig12 is IPP'),
        ("figure,mode,x,y\nfig12,IPP,ten,1\n", r'x = "ten": allowed is drive\.frequency'),
        ("figure,mode,x,y\nfig12,IPP,-1,0.1\n", r"x = \"-1\""),
        ("figure,mode,x,y\nfig12,IPP,10,nan\n", r'y = "nan": allowed is a velocity in m/s'),
        ("figure,mode,x,y\nfig12,IPP,10,1.5\n", r"y = \"1.5\""),
        ("figure,mode,x,y\nfig12,IPP,10\n", "line 2: 3 cells; allowed are 4"),
        ('figure,mode,x,y\n"fig12,IPP,10\n', "line 2: 1 cells"),
        ("figure,mode,x,y\nfig12,IPP,10,\xff\n".encode("latin-1"), "not UTF-8"),
    ],
)
def test_a_file_of_points_that_is_not_sound_is_refused(tmp_path, text, error):
    path = tmp_path / "points.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(ScenarioError, match=error) as caught:
        read_measured(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


def test_columns_may_come_in_any_order_and_with_others(tmp_path):
    path = tmp_path / "points.csv"
    path.write_text("﻿y,note, x ,mode,figure\n0.001,a,50,IPP,fig12\n\n", encoding="utf-8")
    assert read_measured(path) == [MeasuredPoint("fig12", "IPP", 50.0, 0.001)]


def test_importing_the_package_does_not_import_the_study():
    code = (
        "import sys, stickslip; assert not any('reproduction' in m for m in sys.modules); "
        "import stickslip.reproduction; assert callable(stickslip.reproduce)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
