"""Pictures of runs: what they show, and that all text can be read."""

import numpy as np
import pytest

from pictures import assert_legible
from stickslip import Drive, Record, Scenario, plot, simulate

DRIVES = {
    "IPP 30": Drive(mode="IPP", frequency=30, base=0.5e-3, pulses=12),
    "IPP 100": Drive(mode="IPP", frequency=100, base=0.5e-3, pulses=12),
    "OPP 30": Drive(mode="OPP", frequency=30, hold=2.5e-3, edge="fall", pulses=12),
    "OPP 100": Drive(mode="OPP", frequency=100, hold=2.5e-3, edge="fall", pulses=40),
    "backwards": Drive(direction="-x", base=0.5e-3, pulses=5, clamp="up"),
}


PATH = 3
"""Place of the panel of the position."""


@pytest.fixture(scope="module", params=DRIVES)
def run(request):
    return simulate(Scenario(drive=DRIVES[request.param], record=Record(rate=20e3)))


def curve(figure, panel):
    line = figure.axes[panel].get_lines()[0]
    return np.asarray(line.get_xdata()), np.asarray(line.get_ydata())


def test_panels_share_time_and_show_the_run(run):
    figure = plot.run(run)
    assert len(figure.axes) == 6  # none has a second axis at its right
    labels = [axes.get_ylabel() for axes in figure.axes]
    for label, unit in [("field", "mT"), ("contact velocity", "mm/s"), ("x", "m)")]:
        assert any(each.startswith(label) and unit in each for each in labels)
    assert any("tilt" in each and "degrees" in each for each in labels)
    assert any("normal force" in each and "µN" in each for each in labels)
    assert len({axes.get_xlim() for axes in figure.axes}) == 1

    t, tilt = curve(figure, 1)
    chosen = np.isin(run.t, t)
    np.testing.assert_allclose(tilt, np.degrees(run.theta[chosen]))
    np.testing.assert_allclose(curve(figure, 2)[1], run.slip_velocity[chosen] * 1e3)
    _, x = curve(figure, PATH)
    # Above 1000 µm, lengths are in mm.
    unit, factor = ("mm", 1e3) if run.x[chosen].max() > 1e-3 else ("µm", 1e6)
    assert figure.axes[PATH].get_ylabel() == f"x\n({unit})"
    np.testing.assert_allclose(x, run.x[chosen] * factor)
    sample = 1.5 / 20e3  # and half of one for rounding
    assert t[-1] == pytest.approx(run.scenario.window[1], abs=sample)
    # Forty pulses are too many to see: the last six of 10 ms.
    expected = 0.06 if run.scenario.drive.pulses == 40 else run.scenario.duration
    assert t[-1] - t[0] == pytest.approx(expected, abs=sample)


def test_text_is_neither_clipped_nor_overlapping(run):
    assert_legible(plot.run(run), least=30)


def test_the_contact_band_has_the_time_of_each_mode(run):
    figure = plot.run(run)
    band = next(axes for axes in figure.axes if axes.get_ylabel() == "contact")
    t, _ = curve(figure, PATH)
    chosen = run.contact[np.isin(run.t, t)]
    present = sorted(set(chosen.tolist()))
    # What is there for less than a dot's width is drawn, but not named.
    visible = [code for code in present if np.mean(chosen[:-1] == code) >= 1e-3]
    names = [run.contact_names[code].replace("_", " ") for code in visible]
    assert [text.get_text() for text in figure.legends[0].get_texts()] == names
    for code, bars in zip(present, band.collections, strict=True):
        widths = [path.get_extents().width for path in bars.get_paths()]
        share = np.mean(chosen[:-1] == code)
        assert sum(widths) == pytest.approx(share * (t[-1] - t[0]), abs=1e-9)


def test_a_stretch_can_be_chosen():
    run = simulate(Scenario(drive=DRIVES["IPP 100"], record=Record(rate=20e3)))
    t, _ = curve(plot.run(run, start=0.06, stop=0.08), PATH)
    assert (t[0], t[-1]) == (pytest.approx(0.06), pytest.approx(0.08))
    with pytest.raises(ValueError, match="less than two samples"):
        plot.run(run, start=0.08, stop=0.06)


def test_what_cannot_be_drawn_is_refused(tmp_path):
    silent = Scenario(drive=Drive(base=0.5e-3, pulses=2))
    with pytest.raises(AttributeError, match=r"set record\.rate"):
        plot.run(simulate(silent))
    with pytest.raises(ValueError, match=r"set record\.rate"):
        plot.run(simulate(silent.replace({"record.rate": "events"})))
    figure = plot.run(simulate(silent.replace({"record.rate": 1e4})))
    with pytest.raises(ValueError, match=r"\.png"):
        plot.save(figure, tmp_path / "a.docx")
    with pytest.raises(OSError, match="no folder"):
        plot.save(figure, tmp_path / "missing" / "a.png")
    plot.save(figure, tmp_path / "a.svg")
    assert [each.name for each in tmp_path.iterdir()] == ["a.svg"]


def test_a_failed_run_is_drawn_and_says_so():
    changes = {
        "effects.surface_tilt.angle": 1.4,
        "contact.static_friction": 0.0,
        "contact.kinetic_friction": 0.0,
        "drag.linear": 0.0,
        "record.rate": 1000.0,
    }
    run = simulate(Scenario().replace(changes))
    figure = plot.run(run)
    assert "left_workspace" in figure._suptitle.get_text()
    # Six pulses of 10 ms, up to where it ended.
    t, _ = curve(figure, PATH)
    assert t[-1] == run.t[-1]
    assert t[-1] - t[0] == pytest.approx(0.06, abs=1.5e-3)


def test_a_robot_that_stands_still_has_axes_that_can_be_read():
    drive = Drive(peak=0.0, hold=0.0, pulses=3)
    run = simulate(Scenario(drive=drive, record=Record(rate=2e3)))
    for draw in (plot.run, plot.trajectory, plot.phase_portrait):
        figure = draw(run)
        assert_legible(figure)
        for axes in figure.axes:
            for axis in (axes.xaxis, axes.yaxis):
                low, high = sorted(axis.get_view_interval())
                assert high - low >= 1e-3
                assert axis.get_offset_text().get_text() == ""


def test_the_measuring_window_is_shaded_where_it_is_a_part():
    run = simulate(Scenario(drive=DRIVES["IPP 100"], record=Record(rate=20e3)))
    start, end = run.scenario.window
    for axes in plot.run(run).axes[:5]:
        box = axes.patches[0].get_extents().transformed(axes.transData.inverted())
        assert (box.x0, box.x1) == pytest.approx((start, end))
    assert not plot.run(run, start + 0.01, end - 0.01).axes[0].patches
