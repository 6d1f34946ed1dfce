"""Figures of the diagnosis: which readings are hollow, and what the legend says of them."""

import numpy as np
import pytest

from stickslip.diagnosis import write_model_report
from stickslip.diagnosis.report import figures
from toy_model import X, shared_diagnosis

HELD = "held out for the gain"


@pytest.fixture
def drawn(monkeypatch):
    """All figures that are drawn, in their order."""
    kept = []
    monkeypatch.setattr(figures, "png", lambda figure: kept.append(figure) or "")
    return kept


def hollow(frame):
    """Abscissae of hollow points, a list for each marker."""
    lines = {each.lines[0] for each in frame.containers}
    return [line.get_xdata().tolist() for line in lines if line.get_markerfacecolor() == "w"]


def said(frame):
    return [text.get_text() for text in frame.get_legend().get_texts()]


def against(held_out, **more):
    m = len(held_out)
    rows = np.zeros((m, len(more.get("names", ("",)))))
    held_out = np.array(held_out)
    figures.against_model(
        np.arange(m), rows, rows + 1.0, rows, rows, held_out, ("place", "value"), **more
    )


def test_readings_that_were_held_out_are_hollow(drawn):
    against([True, False, False, True])
    frame = drawn[0].axes[0]
    assert hollow(frame) == [[0, 3]]
    assert said(frame).count(HELD) == 1


def test_all_components_of_a_reading_are_hollow_and_the_legend_has_one_entry(drawn):
    against([False, True, False], names=("Bx", "By", "Bz"), joined=False)
    frame = drawn[0].axes[0]
    assert hollow(frame) == [[1]] * 3
    assert sorted(said(frame)) == sorted(
        [f"measured {name} (2 sd)" for name in ("Bx", "By", "Bz")]
        + ["recalibrated", "extended", HELD]
    )


def test_where_nothing_was_held_out_nothing_is_hollow(drawn):
    against([False] * 3)
    assert hollow(drawn[0].axes[0]) == []
    assert HELD not in said(drawn[0].axes[0])


def test_held_out_conditions_of_a_users_own_model_are_hollow(tmp_path, drawn):
    found = shared_diagnosis(3, wave=1.0)
    write_model_report(tmp_path, found, "Toy", place=X)
    (frame,) = (each for figure in drawn for each in figure.axes if each.get_legend())
    (points,) = hollow(frame)
    assert points == sorted(X[found.gain.held_out].tolist())
