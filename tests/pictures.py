"""What the tests of pictures share: runs to draw, and whether a picture can be read."""

import functools
import itertools

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg

from stickslip import Drive, Scenario, State, Waveform, simulate

RATE = 10e3


def turning(to, pulses):
    """A walk whose field turns from +x to an angle, rad, after the ramp."""
    t, volts = Waveform.ipp(base=0.5e-3, pulses=pulses).points()
    angle = np.interp(t, [0.05, t[-1]], [0.0, to])
    x, y = volts[:, 0] * np.cos(angle), volts[:, 0] * np.sin(angle)
    coils = [np.maximum(x, 0), np.minimum(x, 0), np.maximum(y, 0), np.minimum(y, 0), volts[:, 4]]
    program = Waveform.from_points(t, np.column_stack(coils))
    return Scenario(drive=Drive(mode="program", program=program))


def walking(**drive):
    return Scenario(drive=Drive(**{"base": 0.5e-3, "pulses": 8, **drive}))


_OPP = {"mode": "OPP", "hold": 2.5e-3}
_SCENARIOS = {
    "walk": walking(frequency=30, pulses=12),
    "opp": walking(**_OPP, base=0.0, frequency=30, edge="rise", clamp="up", pulses=6),
    "forty pulses": walking(**_OPP, base=0.0, frequency=100, edge="fall", pulses=40),
    "along -x": walking(direction="-x", clamp="up", pulses=5),
    "at rest": walking(peak=0.0, base=0.0, hold=0.0, pulses=3),
    "a tumble": Scenario(
        drive=Drive(mode="program", program=Waveform.hold(0.07, {})),
        initial=State(z=0.8e-3, theta=0.3, vx=0.05, omega=40.0),
    ).replace({"robot.magnetization": 0.0, "contact.restitution": 0.8}),
    "a turn": turning(1.5 * np.pi, 40),
    "a turn to the right": turning(-1.1 * np.pi, 30),
    "210 degrees": walking(direction="-x", heading=np.radians(30.0)),
}
RUNS = tuple(_SCENARIOS)
"""Names of runs; the last three leave the plane y = 0."""


@functools.cache
def recorded(name):
    """One of `RUNS`, recorded at `RATE`."""
    return simulate(_SCENARIOS[name].replace({"record.rate": RATE}))


def heading_of(run):
    """Heading without jumps, rad, shape (n,)."""
    return np.unwrap(run.heading)


def way_of(run):
    """What has been gone along the heading from x = y = 0, by the trapezoidal rule, m."""
    psi = heading_of(run)
    speed = np.gradient(run.x, run.t) * np.cos(psi) + np.gradient(run.y, run.t) * np.sin(psi)
    return np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(run.t))])


def visible_text(figure):
    """Words and boxes of all text that is drawn; the boxes in pixels."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer = canvas.get_renderer()
    texts = []
    for part in (figure, *figure.subfigs):
        texts += [*part.texts, *filter(None, [part._suptitle, part._supxlabel, part._supylabel])]
        for legend in part.legends:
            texts += [*legend.get_texts(), legend.get_title()]
    for axes in figure.axes:
        texts += [*axes.texts, axes.title, axes._left_title]
        if axes.get_legend():
            texts += [*axes.get_legend().get_texts(), axes.get_legend().get_title()]
        if not axes.axison:
            continue
        texts += [axes.xaxis.label, axes.yaxis.label]
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            for tick in axis.get_major_ticks():
                if low <= tick.get_loc() <= high:
                    texts += [label for label in (tick.label1, tick.label2) if label.get_visible()]
    drawn = {id(text): text for text in texts if text.get_visible() and text.get_text()}
    return [(text.get_text(), text.get_window_extent(renderer)) for text in drawn.values()]


def _overlap(a, b):
    """Whether two boxes share more than a pixel each way."""
    width = min(a.x1, b.x1) - max(a.x0, b.x0)
    return width > 1 and min(a.y1, b.y1) - max(a.y0, b.y0) > 1


def assert_legible(figure, least=5):
    """All text lies on the page, no two texts overlap, and no legend lies on the curves."""
    drawn = visible_text(figure)
    assert len(drawn) >= least
    page = figure.bbox
    for words, box in drawn:
        assert page.x0 <= box.x0 <= box.x1 <= page.x1, words
        assert page.y0 <= box.y0 <= box.y1 <= page.y1, words
    for (one, a), (two, b) in itertools.combinations(drawn, 2):
        assert not _overlap(a, b), (one, two)
    legends = [axes.get_legend() for axes in figure.axes]
    legends += [each for part in (figure, *figure.subfigs) for each in part.legends]
    for legend, axes in itertools.product(filter(None, legends), figure.axes):
        assert not _overlap(legend.get_window_extent(), axes.bbox), "a legend on curves"
