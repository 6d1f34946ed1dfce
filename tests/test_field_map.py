"""Coils whose field was measured: the fit of a map, and runs, sweeps and pictures with one."""

import math

import numpy as np
import pytest

from helpers import needs_arkode
from measured_maps import (
    COUNT,
    HALF,
    UNIT_FIELD,
    by,
    formula_fields,
    formula_map,
    grid,
    wire_fields,
    with_map,
)
from own_effects import (
    nothing,
    nothing_stays,  # noqa: F401 (around every test here)
    parameter,
    register,
)
from stickslip import (
    COIL_NAMES,
    Coil,
    Coils,
    Drive,
    FieldMap,
    Scenario,
    ScenarioError,
    Waveform,
    plot,
    simulate,
    simulate_batch,
    volts_per_tesla,
)
from stickslip.field.map_fit import _Basis

FIVE = np.array([2.0, -1.0, 0.5, 0.3, -3.0])
RUNS = {
    "IPP": {"drive.base": 0.5e-3, "drive.pulses": 20},
    "OPP": {"drive.mode": "OPP", "drive.frequency": 30.0, "drive.hold": 2.5e-3,
            "drive.edge": "fall", "drive.pulses": 12},
    "turned": {"drive.base": 0.5e-3, "drive.pulses": 20, "drive.direction": "-x"},
}  # fmt: skip


@pytest.fixture(scope="module")
def exact():
    return formula_map()


def coils_of(field_map):
    return Coils.of(Scenario(coil=Coil(map=field_map)))


def places(field_map, count=200, seed=1):
    return np.random.default_rng(seed).uniform(field_map.low, field_map.high, (count, 3))


def test_a_map_without_noise_gives_the_formula_back(exact):
    # What degrees above n leave falls as (9.0 mm, the corner, over 103 mm, the nearest wire)^n.
    assert min(exact.degrees) >= 4
    points, made = places(exact), coils_of(exact)
    size = UNIT_FIELD * np.abs(FIVE).sum()
    np.testing.assert_allclose(
        made.field(points, FIVE), Coils().field(points, FIVE), rtol=0, atol=3e-6 * size
    )
    np.testing.assert_allclose(
        made.gradient(points, FIVE), Coils().gradient(points, FIVE), rtol=0, atol=1e-3 * size
    )
    assert np.max(exact.relative_residual) < 1e-7
    assert made.centre_field_per_ampere == pytest.approx([UNIT_FIELD] * 5, rel=1e-5)


@pytest.mark.parametrize("case", RUNS)
def test_a_run_with_the_map_of_the_formula_goes_as_with_the_formula(exact, case):
    # The velocity follows the field by a factor of some 1: the error of the field bounds it.
    expected = simulate(Scenario().replace(RUNS[case]))
    found = simulate(Scenario(coil=Coil(map=exact)).replace(RUNS[case]))
    assert found.ok
    assert found.mean_velocity == pytest.approx(expected.mean_velocity, rel=1e-4)


UNEQUAL = [510.0, 400.0, 510.0, 510.0, 450.0]  # turns of the coils


@pytest.mark.parametrize("half", [HALF, (8e-3, 0.0, 3e-3)], ids=["solid", "flat"])
@pytest.mark.parametrize(
    ("direction", "heading"), [("+x", 0.0), ("-x", 0.0), ("+x", math.pi), ("-x", math.pi)]
)
@pytest.mark.parametrize("mode", ["IPP", "program"])
def test_unequal_coils_are_the_same_as_a_map_whichever_way_the_robot_faces(
    half, direction, heading, mode
):
    # A solid map makes the run one in the whole plane, in the world's frame; a flat one leaves it
    # in the robot's own. The map's residual is 1e-7, and the velocity follows the field by some 1.
    points = grid(half, tuple(n if h else 1 for n, h in zip(COUNT, half, strict=True)))
    coils = Coils(turns=UNEQUAL)
    fields = np.stack([coils.field(points, one) for one in np.eye(5)], axis=1)
    made = Coil(map=FieldMap.from_points(points, fields))
    if mode == "IPP":
        drive = Drive(base=0.5e-3, pulses=10, direction=direction, heading=heading)
    else:
        pulses = Waveform.ipp(base=0.5e-3, pulses=10)
        pulses = pulses.turned() if direction == "-x" else pulses
        drive = Drive(mode="program", program=pulses, direction=direction)
    own = Scenario(drive=drive).replace(
        {f"coil.{name}.turns": n for name, n in zip(COIL_NAMES, UNEQUAL, strict=True)}
    )
    expected = simulate(own)
    found = simulate(Scenario(drive=drive, coil=made))
    assert found.ok
    assert found.mean_velocity == pytest.approx(expected.mean_velocity, rel=1e-4)
    for name in ("field_max", "current_max", "voltage_max"):
        assert found.summary()[name] == pytest.approx(expected.summary()[name], rel=1e-4)


@pytest.mark.parametrize(
    ("direction", "heading"), [("+x", 0.0), ("-x", 0.0), ("+x", math.pi), ("-x", math.pi)]
)
def test_a_state_that_a_run_in_one_plane_has_left_is_of_that_plane(direction, heading):
    drive = Drive(base=0.5e-3, pulses=5, direction=direction, heading=heading)
    first = simulate(Scenario(drive=drive))
    assert not first.scenario.whole_plane
    assert not Scenario(drive=drive, initial=first.final_state).whole_plane


def test_noise_of_a_per_cent_changes_the_velocity_by_a_few_tenths_of_one():
    # 225 points of a coil give 675 numbers, of which the lowest degrees take 15: the field is known
    # to 1 % sqrt(15 / 675) = 0.15 %, and the velocity follows the field by a factor of some 1 to 2.
    expected = simulate(Scenario().replace(RUNS["IPP"])).mean_velocity
    errors = []
    for seed in range(6):
        noisy = formula_map(noise=0.01, seed=seed)
        assert max(noisy.degrees) <= 4
        assert noisy.residual == pytest.approx([0.01 * UNIT_FIELD] * 5, rel=0.15)
        run = simulate(with_map(noisy))
        errors.append(run.mean_velocity / expected - 1.0)
    assert 1e-5 < np.max(np.abs(errors)) < 5e-3


def test_the_error_of_prediction_is_that_of_fits_without_each_point():
    points = grid((8e-3, 3e-3, 3e-3), (4, 3, 3))
    fields = formula_fields(points)[:, 0]
    fields = fields + 1e-5 * np.random.default_rng(3).standard_normal(fields.shape)
    basis = _Basis(points.min(axis=0), points.max(axis=0), points)
    values = fields.reshape(-1, 1)
    found = basis._prediction_errors(values, basis._q.T @ values)[:, 0]
    for degree in (1, 2, 3):
        design = (basis._q @ basis._r)[:, : degree * (degree + 2)].reshape(len(points), 3, -1)
        squares = []
        for out in range(len(points)):
            kept = np.arange(len(points)) != out
            solution, *_ = np.linalg.lstsq(
                design[kept].reshape(-1, design.shape[2]), fields[kept].reshape(-1), rcond=None
            )
            squares.append(np.mean((fields[out] - design[out] @ solution) ** 2))
        assert found[degree - 1] == pytest.approx(np.mean(squares), rel=1e-8)


def turned_about_y(angle):
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
    return lambda corners: corners @ turn.T


def test_a_coil_that_is_turned_and_one_that_is_moved_are_as_by_their_wires():
    moved = {"xp": turned_about_y(0.05), "clamp": by(2e-3, 1e-3, -3e-3)}
    made = FieldMap.from_points(grid(), wire_fields(grid(), **moved))
    points = places(made, 50)
    expected = np.einsum("k,nki->ni", FIVE, wire_fields(points, **moved))
    found = coils_of(made).field(points, FIVE)
    np.testing.assert_allclose(found, expected, rtol=0, atol=5e-6 * UNIT_FIELD * 6.8)
    # The formula is off by the tilt, 5 % of 2 A.
    assert np.abs(Coils().field(points, FIVE) - expected).max() > 0.04 * 2 * UNIT_FIELD


def test_coils_that_are_all_moved_are_a_robot_that_starts_elsewhere():
    away = 3e-3  # m along x
    moved = dict.fromkeys(("xp", "xm", "yp", "ym", "clamp"), by(away, 0.0, 0.0))
    made = FieldMap.from_points(grid(), wire_fields(grid(), **moved))
    pulses = Waveform.ipp(base=0.5e-3, pulses=20)
    keys = {"drive.mode": "program", "drive.program": pulses}
    found = simulate(with_map(made, **keys))
    expected = simulate(Scenario().replace({**keys, "initial.x": -away}))
    assert found.ok
    assert found.mean_velocity == pytest.approx(expected.mean_velocity, rel=1e-4)
    centred = simulate(Scenario().replace(keys))
    assert abs(centred.mean_velocity / expected.mean_velocity - 1.0) > 1e-3


def test_a_field_across_turns_the_robot():
    # 2 mm beside the plane, a clamp coil of 1 mT has B_y of half its gradient there, 19 uT: beside
    # a base of 0.5 mT that turns the robot by 2 degrees.
    aside = {"clamp": by(0.0, 2e-3, 0.0)}
    made = FieldMap.from_points(grid(), wire_fields(grid(), **aside))
    run = simulate(with_map(made, record__rate=1e3))
    assert run.ok
    place = np.array([run.x[-1], run.y[-1], run.z[-1]])
    field = np.einsum("k,nki->i", run.current[-1], wire_fields(place[None], **aside))
    assert run.by[-1] == pytest.approx(field[1], rel=1e-3)
    assert run.heading[-1] == pytest.approx(math.atan2(field[1], field[0]), rel=1e-3)
    assert abs(field[1]) > 1e-5


@pytest.mark.parametrize("direction", ["+x", "-x"])
def test_a_robot_that_comes_to_the_end_of_the_map_ends_its_run(direction):
    small = formula_map(half=(4e-4, 1e-3, 1e-3), count=(5, 5, 5))
    # In packs and alone.
    many = [with_map(small, drive__direction=direction, drive__frequency=f) for f in (90.0, 100.0)]
    for run in (*simulate_batch(many), simulate(many[1])):
        assert run.status == "left_workspace"
        assert 4e-4 <= abs(run.final_state.x) < 4.1e-4
        assert "the robot left coil.map, which has the field from x = -0.0004 to 0.0004 m" in (
            run.message
        )
    above = formula_map(half=(4e-3, 1e-3, 1e-5), count=(5, 5, 5))
    assert simulate(with_map(above)).status == "left_workspace"  # its centre is 50 um high


def test_a_map_that_begins_at_the_surface_suffices():
    points = grid(half=(8e-3, 2e-3, 2e-3)) + np.array([0.0, 0.0, 2e-3])
    above = FieldMap.from_points(points, formula_fields(points))
    assert above.low[2] == 0.0
    expected = simulate(Scenario().replace(RUNS["IPP"])).mean_velocity
    assert simulate(with_map(above)).mean_velocity == pytest.approx(expected, rel=1e-4)


@needs_arkode
def test_both_integrators_take_a_map(exact):
    one, other = (simulate(with_map(exact, solver__method=each)) for each in ("tsit5", "arkode"))
    assert other.mean_velocity == pytest.approx(one.mean_velocity, rel=1e-5)


def test_coils_that_are_not_there_have_zeros(exact):
    points = grid()
    fields = formula_fields(points)
    fields[:, 1:4] = 0.0
    made = FieldMap.from_points(points, fields)
    assert made.relative_residual[1] == 0.0
    assert made.degrees[1:4] == (1, 1, 1)
    run = simulate(with_map(made))
    assert run.mean_velocity == pytest.approx(simulate(with_map(exact)).mean_velocity, rel=1e-12)
    with pytest.raises(ScenarioError, match=r"coil\.map: coil xm has 0 T/A along its axis"):
        with_map(made, drive__direction="-x")


def test_a_run_says_whose_field_it_had(exact):
    assert "map" in [note.code for note in simulate(with_map(exact)).notes]
    assert "map" in with_map(exact)._repr_html_()
    assert "map" in repr(coils_of(exact))
    assert volts_per_tesla(Coil(map=exact)) == pytest.approx(volts_per_tesla(), rel=1e-5)


def test_outside_of_the_map_there_is_no_field(exact):
    made = coils_of(exact)
    assert made.box == ([-8e-3, -3e-3, -3e-3], [8e-3, 3e-3, 3e-3])
    with pytest.raises(ValueError, match=r"point \(0.0081, 0, 0\) m lies outside of the field map"):
        made.field([8.1e-3, 0, 0], FIVE)


def test_a_map_takes_the_place_of_the_geometry(exact):
    base = with_map(exact)
    same = base.replace({"coil.resistance": 12.0, "coil.xp.inductance": 0.05})
    assert simulate(same).ok
    register(nothing, parameter("distance"), name="recoil")
    uncertain = {"effects.recoil.distance": {"mean": 0.1, "sd": 0.01}}
    assert base.with_uncertain(uncertain).uncertain.names == ("effects.recoil.distance",)
    again = Scenario(drive=base.drive, coil=base.coil)  # sections of another scenario
    assert again == base
    assert simulate(again).summary() == simulate(base).summary()
    assert base.replace({"coil.map": None}).coil == Coil()


def test_the_coils_of_a_map_are_drawn_where_it_is(exact):
    figure = plot.coils(Scenario(coil=Coil(map=exact)), FIVE)
    axes = figure.axes[0]
    corners = axes.collections[0].get_coordinates()
    assert np.abs(corners[..., 0]).max() == pytest.approx(8.0, rel=1e-9)
    assert np.abs(corners[..., 1]).max() == pytest.approx(3.0, rel=1e-9)
    assert "xp: 2 A" in axes.get_title()
