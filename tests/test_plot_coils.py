"""The picture of the coils: field, directions of the currents, and the robot in its inset."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Polygon

from measured_maps import formula_fields, grid
from pictures import assert_legible
from stickslip import COIL_NAMES, Coil, Coils, Drive, FieldMap, Scenario, State, Waveform, plot

FIVE = [2.0, -1.0, 0.5, 0.0, -3.0]


def words(axes):
    return [text.get_text() for text in axes.texts]


def inset(axes):
    return axes.child_axes[0]


def test_the_map_is_the_field_of_the_coils():
    figure = plot.coils(Scenario(), FIVE)
    axes, bar = figure.axes
    mesh = axes.collections[0]
    corners = mesh.get_coordinates()
    x, z = (0.5 * (corners[:-1, :-1, k] + corners[1:, 1:, k]) * 1e-3 for k in (0, 1))
    points = np.stack([x, np.zeros_like(x), z], axis=-1)
    expected = np.linalg.norm(Coils().field(points, FIVE), axis=-1) * 1e3
    # The corners are half way between the places where the field is computed.
    np.testing.assert_allclose(np.asarray(mesh.get_array()), expected, rtol=1e-9)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x (mm)", "z (mm)")
    assert bar.get_ylabel() == "$|B|$ (mT)"
    assert_legible(figure, least=15)


def test_every_coil_is_named_with_its_current():
    axes = plot.coils(Scenario(), FIVE).axes[0]
    assert {"xp: 2 A", "xm: -1 A", "clamp: -3 A", "yp: 0.5 A, ym: 0 A"} <= {*words(axes)}


@pytest.mark.parametrize("name", ["xp", "xm", "clamp"])
@pytest.mark.parametrize("current", [1.0, -1.0])
def test_dots_and_crosses_are_the_directions_of_the_currents(name, current):
    currents = np.where(np.array(COIL_NAMES) == name, current, 0.0)
    axes = plot.coils(Scenario(), currents).axes[0]
    drawn = {"x": [], ".": [], "o": []}
    for line in axes.get_lines():
        if line.get_marker() in drawn:
            drawn[line.get_marker()].append(line.get_xydata()[0] * 1e-3)
    assert [len(drawn[each]) for each in "x.o"] == [1, 1, 6]
    # Ampere: around a current away from the reader, who sees x to the right and z upwards, the
    # field goes with the clock: to the right above it.
    for marker, sign in (("x", 1.0), (".", -1.0)):
        x, z = drawn[marker][0]
        above = Coils().field([x, 0.0, z + 1e-3], currents)
        assert sign * above[0] > 5.0 * abs(above[2])


@pytest.mark.parametrize("direction", ["+x", "-x"])
def test_currents_are_those_of_the_top_of_the_sawtooth(direction):
    drive = Drive(mode="IPP", peak=2.5e-3, base=0.5e-3, hold=1e-3, direction=direction)
    scenario = Scenario(drive=drive)
    (moment, field), outline = robot(plot.coils(scenario))
    # In the middle the peak and the holding field, but for the height of the robot's centre.
    way = 1.0 if direction == "+x" else -1.0
    assert "B = 2.69 mT" in words(inset(plot.coils(scenario).axes[0]))
    assert np.hypot(2.5, 1.0) == pytest.approx(2.69, abs=0.005)
    np.testing.assert_allclose(field / np.hypot(*field), [way * 2.5 / 2.69, -1.0 / 2.69], atol=0.01)
    assert moment[0] * way > 0.0
    assert moment[1] == pytest.approx(0.0, abs=1e-9)
    assert np.ptp(outline, axis=0) == pytest.approx([250.0, 100.0], abs=60.0)


def test_coils_of_ones_own_are_drawn_where_they_are():
    own = {"resistance": 20.0, "side": 0.1, "distance": 0.12}
    axes = plot.coils(Scenario(coil=Coil(xp=own))).axes[0]
    places = {tuple(np.round(line.get_xydata()[0], 6)) for line in axes.get_lines()}
    assert {(120.0, 50.0), (120.0, -50.0), (-99.0, 69.25), (-99.0, -69.25)} <= places
    program = Waveform.hold(0.1, {"xp": 8.0})
    scenario = Scenario(drive=Drive(mode="program", program=program), coil=Coil(xp=own))
    assert "xp: 0.4 A" in words(plot.coils(scenario).axes[0])


def test_currents_of_a_program_are_those_of_its_highest_voltages():
    program = Waveform.ramp(0.1, {"xp": 8.0}) + Waveform.ramp(0.1, {"ym": -3.0}, {"xp": 8.0})
    scenario = Scenario(drive=Drive(mode="program", program=program))
    ampere = 8.0 / scenario.coil.resistance
    assert f"xp: {ampere:.3g} A" in words(plot.coils(scenario).axes[0])


def test_the_robot_is_drawn_to_scale_as_it_begins():
    scenario = Scenario(initial=State(theta=0.5))
    figure = plot.coils(scenario)
    _, outline = robot(figure)
    edges = np.sort(np.hypot(*np.diff(outline, axis=0, append=outline[:1]).T))
    sizes = [scenario.robot.height * 1e6] * 2 + [scenario.robot.length * 1e6] * 2
    np.testing.assert_allclose(edges, sizes)
    assert outline[:, 1].min() == pytest.approx(0.0, abs=1e-9)
    axes = inset(figure.axes[0])
    bar = next(each for each in axes.get_lines() if each.get_linewidth() == 2.5)
    figure.draw_without_rendering()
    length = np.ptp(bar.get_xdata()) * np.ptp(axes.get_xlim())
    named = next(each for each in words(axes) if each.endswith("µm"))
    assert length == pytest.approx(float(named.split()[0]), rel=1e-6)


def robot(figure):
    """Arrows of the moment and of the field, and the corners of the body, µm."""
    axes = inset(figure.axes[0])
    arrows = [each for each in axes.patches if isinstance(each, FancyArrowPatch)]
    body = next(each for each in axes.patches if type(each) is Polygon)
    return [np.subtract(*each._posA_posB[::-1]) for each in arrows], body.get_xy()[:4]


def test_given_axes_are_drawn_in():
    figure = Figure()
    ax = figure.subplots()
    assert plot.coils(Scenario(), ax=ax) is figure
    assert ax.has_data()


def test_what_cannot_be_drawn_is_refused():
    with pytest.raises(ValueError, match="a Scenario"):
        plot.coils("scenario.toml")
    for currents in ([1.0], [np.nan, 0, 0, 0, 0]):
        with pytest.raises(ValueError, match="five finite numbers"):
            plot.coils(Scenario(), currents)
    with pytest.raises(ValueError, match="no coil has a current"):
        plot.coils(Scenario(drive=Drive(peak=0.0, hold=0.0)))


@pytest.fixture(scope="module")
def without_ym():
    """A map in which the coil at -y has zeros, as one that is not there."""
    points = grid(count=(3, 3, 3))
    fields = formula_fields(points)
    fields[:, COIL_NAMES.index("ym")] = 0.0
    return Coil(map=FieldMap.from_points(points, fields))


def test_a_coil_that_is_not_there_has_no_field_to_draw(without_ym):
    with pytest.raises(ValueError, match="no coil has a current that makes a field"):
        plot.coils(Scenario(coil=without_ym), [0.0, 0.0, 0.0, 1.0, 0.0])


def test_a_robot_that_begins_outside_of_a_map_is_drawn_without_a_field(without_ym):
    inside, outside = (
        inset(plot.coils(Scenario(coil=without_ym, initial=State(x=x)), FIVE).axes[0])
        for x in (0.007, 0.009)
    )
    for axes, shown in ((inside, 1), (outside, 0)):
        assert sum(word.startswith("B = ") for word in words(axes)) == shown
        arrows = [each for each in axes.patches if isinstance(each, FancyArrowPatch)]
        assert len(arrows) == 1 + shown


def test_a_robot_at_a_heading_is_seen_along_y():
    scenario = Scenario(drive=Drive(heading=0.7, direction="-x"))
    figure = plot.coils(scenario)
    (moment, _), _ = robot(figure)
    (inset,) = figure.axes[0].child_axes
    (body,) = (each for each in inset.patches if type(each) is Polygon)
    length, width = scenario.robot.length * 1e6, scenario.robot.width * 1e6
    seen = length * np.cos(0.7) + width * np.sin(0.7)
    assert np.ptp(body.get_xy(), axis=0) == pytest.approx([seen, scenario.robot.height * 1e6])
    assert moment[0] < 0.0
    assert moment[1] == pytest.approx(0.0, abs=1e-9)
    assert "heading 220 degrees" in [each.get_text() for each in inset.texts]
    begins = scenario.replace({"initial.heading": 1.0})
    (inset,) = plot.coils(begins).axes[0].child_axes
    assert "heading 57.3 degrees" in [each.get_text() for each in inset.texts]
