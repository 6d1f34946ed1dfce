"""Notes of runs: each where its condition holds, with advice that helps, and none on sound runs."""

import json
import re

import numpy as np
import pytest
import xarray

from command_line import stickslip
from stickslip import Coils, Drive, Note, Scenario, Waveform, _core, predict, simulate, sweep
from stickslip.simulation.notes import CODES, MOST_SHOWN, by_seriousness, shown_lines

LIMITS = {
    row["code"]: (row["value"], row["above"])
    for row in _core.note_rows
    if "many" in row and "above" in row
}
REST, FEWEST_PULSES = 1e-3, 20

FIRST = {"drive.base": 0.5e-3}  # the first example of the documentation
PAIRS = {**FIRST, "drive.coils": "pairs"}
BRISK = {**PAIRS, "drive.frequency": 200.0, "drive.pulses": 40}
# Friction holds less than the gradient pulls for most of a pulse.
DRAGGED = {"drive.peak": 4e-3, "drive.base": 2e-3, "record.pull_share": "yes"}
# Its peaks of speed are hops.
HOPPER = {
    "robot.length": 0.4e-3, "robot.width": 0.25e-3, "robot.height": 0.15e-3, "drive.mode": "OPP",
    "contact.adhesion": 0.0,
}  # fmt: skip


def run_of(changes):
    return simulate(Scenario().replace(changes))


def codes(run):
    return [note.code for note in run.notes]


def slope_of_in_plane_coils(run, step=1e-5):
    """Gradient (T/m, n x 2) of the field's component along the heading, at each sample."""
    coils = Coils.of(run.scenario)
    currents = run.current.copy()
    currents[:, 4] = 0.0
    facing = np.stack([np.cos(run.heading), np.sin(run.heading)], axis=1)
    place = np.stack([run.x, run.y, run.z], axis=1)

    def along(shift):
        pairs = zip(place + shift, currents, facing, strict=True)
        return np.array([coils.field(at, amperes)[:2] @ face for at, amperes, face in pairs])

    return np.stack(
        [(along(each) - along(-each)) / (2.0 * step) for each in step * np.eye(3)[:2]], axis=1
    )


@pytest.mark.parametrize(
    "changes",
    [
        FIRST,
        PAIRS,
        {**FIRST, "drive.mode": "OPP", "drive.direction": "-x"},
        {**FIRST, "drive.heading": 0.6},
        {**FIRST, "effects.gradient_scale.fraction": 0.5},
        {**FIRST, "effects.mutual_inductance.coupling": 0.1, "coil.xp.inductance": 0.1},
    ],
)
def test_the_pull_is_that_of_the_gradient_over_what_friction_holds(changes):
    scenario = Scenario().replace({**changes, "drive.pulses": 12, "record.rate": 20e3})
    run = simulate(scenario)
    robot, contact = scenario.robot, scenario.contact
    moment = robot.magnetization * robot.length * robot.width * robot.height
    held = contact.static_friction * (robot.mass * 9.81 + contact.adhesion)
    slope = slope_of_in_plane_coils(run)
    scale = 1.0 + scenario.get("effects.gradient_scale.fraction")
    expected = scale * moment * np.hypot(*slope.T).max() / held
    # A sample misses the turn of a current by up to 25 us of some ms. The slope of a pair is that
    # of the robot's place, which is taken where a stretch of voltage ends.
    assert run.summary()["pull_ratio"] == pytest.approx(expected, rel=1e-3, abs=2e-4)


def test_the_pull_is_that_of_the_field_which_lags():
    # Held by adhesion, the robot feels the slope of one coil in proportion to its field.
    held = {"drive.hold": 0.0, "contact.adhesion": 1e-3}
    still, lagging = (
        run_of({**held, "effects.eddy_lag.time": lag}).summary() for lag in (0.0, 2e-3)
    )
    assert lagging["field_max"] < 0.97 * still["field_max"]
    ratio = lagging["field_max"] / still["field_max"]
    # The largest fields are found to 1e-6.
    assert lagging["pull_ratio"] / still["pull_ratio"] == pytest.approx(ratio, rel=2e-6)


def test_the_pull_of_a_held_field_is_that_of_its_formula():
    # One coil at 2.5 mT without a clamp: 76 of 94 nN.
    still = {"drive.base": 2.5e-3, "drive.hold": 0.0, "drive.ramp": 0.5, "drive.pulses": 4}
    run = run_of({**still, "contact.adhesion": 0.22e-6})
    per_ampere = Coils.of(run.scenario).field([[1e-5, 0, 0], [0, 0, 0]], [1.0, 0, 0, 0, 0])[:, 0]
    slope = 2.5e-3 * (per_ampere[0] / per_ampere[1] - 1.0) / 1e-5
    pull = 500e3 * 250e-6 * 130e-6 * 100e-6 * slope
    assert pull == pytest.approx(76e-9, rel=0.01)
    assert run.summary()["pull_ratio"] == pytest.approx(pull / 94.2e-9, rel=5e-3)
    free = {"contact.static_friction": 0.0, "contact.kinetic_friction": 0.0}
    slides = run_of({**still, **free})
    assert slides.summary()["pull_ratio"] == 0.0
    assert "no-friction" in codes(slides)


@pytest.mark.parametrize(
    "changes", [{"drive.pulses": 300}, {"drive.pulses": 300, "drive.heading": 0.6}]
)
def test_the_change_of_the_field_is_that_between_the_places_of_start_and_end(changes):
    run = run_of({**FIRST, **changes})
    end, scenario = run.final_state, run.scenario
    # Voltages at the tops of in-plane and holding coil.
    _, volts, _ = scenario.to_core().program().blocks[1]
    largest = volts[np.argmax(np.abs(volts), axis=0), np.arange(5)]
    coils = Coils.of(scenario)
    resistance = scenario.coil.resistance
    places = [[0.0, 0.0, 0.5 * scenario.robot.height], [end.x, end.y, end.z]]
    before, after = (coils.field(place, largest / resistance) for place in places)
    expected = np.linalg.norm(after - before) / np.linalg.norm(before)
    assert run.summary()["field_change"] == pytest.approx(expected, rel=1e-6)


def test_the_growth_is_the_least_from_quarter_to_quarter():
    scenario = Scenario().replace({**FIRST, "drive.pulses": 43, "record.rate": 100.0})
    run = simulate(scenario)
    at = np.searchsorted(run.t, scenario.window[0] + 0.1 * np.arange(5) - 1e-9)
    speed = np.abs(np.diff(run.x[at])) / 0.1
    expected = np.diff(speed).min() / speed.max()
    assert run.summary()["velocity_growth"] == pytest.approx(expected, rel=1e-6)
    for pulses in (3, 6):  # fewer than four in the window
        assert run_of({**FIRST, "drive.pulses": pulses}).summary()["velocity_growth"] == 0.0


# Changes that make a robot be noted, and what the note says to do.
ADVICE = {
    "flight": (
        {**HOPPER, "drive.frequency": 115.0},
        lambda s, _: s.replace({"drive.base": 0.5 * (s.drive.base + s.drive.peak)}),
    ),
    "dragged": (DRAGGED, lambda s, _: s.replace({"drive.coils": "pairs"})),
    "pulled": (FIRST, lambda s, _: s.replace({"drive.coils": "pairs"})),
    "field-change": (
        {**FIRST, "drive.pulses": 2000},
        lambda s, _: s.replace({"drive.pulses": 100}),
    ),
    "no-pulses": ({"drive.base": 2.5e-3}, lambda s, _: s.replace({"drive.base": 0.5e-3})),
    "rest-no-field": (
        {"drive.peak": 0.0, "drive.hold": 0.0},
        lambda s, _: s.replace({"drive.peak": 2.5e-3, "drive.hold": 1e-3}),
    ),
    "rest-no-moment": (
        {**PAIRS, "robot.magnetization": 0.0},
        lambda s, _: s.replace({"robot.magnetization": 500e3}),
    ),
    "rest-torque": ({"drive.peak": 1e-5, "drive.hold": 1e-5}, lambda s, named: s.replace(named)),
    "rest-friction": (
        {**PAIRS, "drive.mode": "OPP", "contact.static_friction": 2.0,
         "contact.kinetic_friction": 2.0},
        lambda s, _: s.replace({"contact.static_friction": 0.5, "contact.kinetic_friction": 0.5}),
    ),
    "rest-drag": (
        {**PAIRS, "drag.linear": 1e-2, "drag.rotational": 1e-11},
        lambda s, _: s.replace({"drag.linear": 1e-5, "drag.rotational": 1e-14}),
    ),
}  # fmt: skip


@pytest.mark.parametrize("code", ADVICE)
def test_the_advice_of_a_note_helps(code):
    changes, advised = ADVICE[code]
    run = run_of({"drive.pulses": 40, **changes})
    (note,) = [each for each in run.notes if each.code == code]
    named = {}
    if code == "rest-torque":
        words = dict(re.findall(r"(drive\.\w+) = ([0-9.e-]+)", note.text))
        named = {key: float(value) for key, value in words.items()}
    better = simulate(advised(run.scenario, named))
    assert not {*codes(better)} & {code, "rest", "rest-torque", "rest-friction", "rest-drag"}
    if code.startswith(("rest", "no-pulses")):
        assert abs(better.mean_velocity) > 10.0 * abs(run.mean_velocity)
        assert abs(better.mean_velocity) > REST * 250e-6 * 100.0
    else:
        number, limit = LIMITS[code]
        assert better.summary()[number] < limit < run.summary()[number] == note.value


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        ({"drive.hold": 0.0}, "rest-torque"),
        ({"contact.static_friction": 100.0}, "rest-friction"),
        ({"contact.static_friction": 100.0, "contact.kinetic_friction": 100.0}, "rest-friction"),
        ({"drag.linear": 0.05}, "rest-drag"),
        ({"drag.linear": 9e-4, "drag.rotational": 0.0, **BRISK}, "rest-drag"),
        ({"contact.adhesion": 1e-3}, "rest-adhesion"),
        ({"robot.magnetization": 500.0}, "rest-torque"),
    ],
)
def test_the_constant_that_is_far_off_is_what_holds_a_robot(changes, code):
    run = run_of({**FIRST, **changes})
    (note,) = [each for each in run.notes if each.code.startswith("rest")]
    assert note.code == code
    assert next(iter(changes)) in note.text
    assert "rotational" not in note.text
    assert note.value != 0.0
    assert "pulled" not in codes(run)


@pytest.mark.parametrize("magnetization", [1e-320, 1e-300, 1.0])
def test_a_moment_next_to_none_has_a_note_too(magnetization):
    weak = {"robot.magnetization": magnetization, "contact.adhesion": 1e-2}
    teeth = 20 * Waveform.sawtooth(0.01, {"xp": 1.0}, {"xp": 5.0})
    for drive in (Drive(mode="program", program=teeth), Drive(base=0.5e-3, pulses=20)):
        run = simulate(Scenario(drive=drive).replace(weak))
        assert codes(run)[0] in ("rest", "rest-no-moment")


def test_a_velocity_that_still_grows_is_noted_until_it_is_steady():
    # Without friction the robot glides down a slope on its face, braked by drag alone: its speed
    # nears its limit as 1 - exp(-t/tau), tau = mass/drag.linear = 0.256 s here.
    glide = {
        "contact.static_friction": 0.0, "contact.kinetic_friction": 0.0, "contact.adhesion": 0.0,
        "drag.linear": 1e-7, "robot.magnetization": 0.0, "effects.surface_tilt.angle": -1e-4,
    }  # fmt: skip
    run = run_of({**glide, "drive.pulses": 40})
    (note,) = [each for each in run.notes if each.code == "velocity-grows"]
    assert note.value == run.summary()["velocity_growth"] > 0.03
    assert "more drive.pulses" in note.text
    assert "no-slip" not in codes(run)
    assert "velocity-grows" not in codes(run_of({**glide, "drive.pulses": 3 + 4 * 100}))
    # Too few pulses to tell from chance.
    few = run_of({**glide, "drive.pulses": FEWEST_PULSES + 2})
    assert few.summary()["velocity_growth"] > 0.03
    assert "velocity-grows" not in codes(few)


@pytest.mark.parametrize("direction", ["+x", "-x"])
@pytest.mark.parametrize(
    ("mode", "edge", "better"), [("OPP", "rise", "fall"), ("IPP", "fall", "rise")]
)
def test_a_robot_that_slides_back_is_told_the_edge_with_which_it_walks(
    mode, edge, better, direction
):
    drive = {"drive.frequency": 60.0, "drive.base": 0.5e-3, "drive.peak": 1.5e-3}
    drive |= {"drive.mode": mode, "drive.direction": direction, "drive.pulses": 12}
    run = run_of({**drive, "drive.edge": edge})
    (note,) = [each for each in run.notes if each.code == "backward"]
    assert note.value == run.velocity[0] < 0.0
    other = run_of({**drive, "drive.edge": better})
    assert f'drive.edge = "{better}" it walks {1e3 * other.velocity[0]:.3g} mm/s' in note.text
    assert "backward" not in codes(other)


def test_a_slide_downhill_is_no_walk():
    slope = {
        "effects.surface_tilt.angle": 0.26, "contact.static_friction": 0.1,
        "contact.kinetic_friction": 0.1, "contact.adhesion": 0.0,
    }  # fmt: skip
    for changes in ({}, {"drive.edge": "fall"}, {"effects.surface_tilt.angle": -0.26}):
        found = codes(run_of({**FIRST, **slope, **changes}))
        assert "steep-surface" in found
        assert "backward" not in found
    # A trial that slides is none either: with a quarter of the friction it would.
    held = {
        **slope, "contact.static_friction": 1.0, "contact.kinetic_friction": 1.0,
        "drive.base": 0.1e-3, "drive.peak": 0.2e-3, "drive.hold": 0.5e-3, "drive.coils": "pairs",
    }  # fmt: skip
    assert codes(run_of({**held, "drive.pulses": 20})) == ["rest"]


def test_sound_scenarios_get_none():
    """About the paper's, driven by pairs of coils: 300 that walk or creep."""
    random = np.random.default_rng(46)
    for _ in range(300):
        static = random.uniform(0.15, 0.3)
        changes = {
            "drive.frequency": random.uniform(10.0, 120.0),
            "drive.base": random.uniform(0.4e-3, 0.8e-3), "drive.peak": random.uniform(2e-3, 3e-3),
            "drive.hold": random.uniform(0.8e-3, 1.2e-3),
            "drive.pulses": int(random.integers(6, 80)), "drive.coils": "pairs",
            "drive.clamp": str(random.choice(["down", "up"])),
            "robot.length": 250e-6 * random.uniform(0.9, 1.1),
            "robot.height": 100e-6 * random.uniform(0.9, 1.1),
            "robot.mass": 25.6e-9 * random.uniform(0.9, 1.1), "contact.static_friction": static,
            "contact.kinetic_friction": static * random.uniform(0.6, 0.9),
            "contact.adhesion": random.uniform(0.0, 0.3e-6),
        }  # fmt: skip
        run = run_of(changes)
        assert run.notes == [], (changes, run.notes)


def test_a_program_never_gets_advice_on_keys_that_it_refuses():
    random = np.random.default_rng(2)
    seen = set()
    for size in (0.0, 0.01, 0.1, 10.0, 60.0):
        for _ in range(4):
            low, high = (size * random.uniform(-1.0, 1.0, 5) for _ in range(2))
            teeth = 20 * Waveform.sawtooth(random.uniform(3e-3, 3e-2), low, high)
            drive = Drive(mode="program", program=Waveform.ramp(0.05, low) + teeth)
            for run in (
                simulate(Scenario(drive=drive)),
                simulate(Scenario(drive=drive).replace({"robot.magnetization": 0.0})),
            ):
                seen |= {*codes(run)}
                assert not any("drive." in note.text for note in run.notes), run.notes
    drive = Drive(mode="program", program=Waveform.opp(frequency=115.0, pulses=40))
    run = run_of({**HOPPER, "drive.mode": "program", "drive.program": drive.program})
    seen |= {*codes(run)}
    assert not any("drive." in note.text for note in run.notes), run.notes
    assert {"rest-no-field", "rest-no-moment", "rest-torque", "flight", "pulled"} <= seen


def test_a_robot_that_is_shaken_without_a_drive_gets_no_advice_on_a_sawtooth():
    run = run_of({"drive.mode": "none", "drive.pulses": 20, "shake.frequency": 100.0,
                  "shake.amplitude_z": 1e-4, "contact.adhesion": 0.0})  # fmt: skip
    assert codes(run) == ["flight"]
    assert run.notes[0].text.endswith("shake it by less")


def test_notes_come_by_how_serious_they_are_and_at_most_four_are_shown(tmp_path):
    odd = {
        **FIRST, "drive.peak": 22e-3, "drive.pulses": 3, "solver.rtol": 1e-4,
        "contact.tangential_restitution": 0.5, "robot.mass": 25.6e-12,
    }  # fmt: skip
    run = run_of(odd)
    found = codes(run)
    assert len(found) > MOST_SHOWN
    assert found == sorted(found, key=CODES.index)
    assert run.notes == by_seriousness(reversed(run.notes))
    path = tmp_path / "odd.toml"
    run.scenario.to_toml(path)
    printed = stickslip("run", path).stdout
    lines = [line.split(maxsplit=1)[1] for line in printed.splitlines() if line[:4] == "note"]
    assert lines == shown_lines(run.notes)
    assert lines[:4] == [note.text for note in run.notes[:4]]
    assert lines[4].startswith(f"{len(found) - 4} more")
    told = json.loads(stickslip("run", path, "--json").stdout)["notes"]
    assert [Note(**each) for each in told] == run.notes


def test_sweeps_and_predictions_say_how_many(tmp_path):
    base = Scenario().replace({**HOPPER, "drive.pulses": 20, "robot.mass": 25.6e-9})
    frequencies = [30.0, 115.0, 150.0]
    runs = [simulate(base.replace({"drive.frequency": each})) for each in frequencies]
    data = sweep(base, {"drive.frequency": frequencies}, out=tmp_path / "sweep.nc")
    notes = {each["code"]: each for each in json.loads(data.attrs["notes"])}
    for code in LIMITS:
        count = sum(code in codes(run) for run in runs)
        assert (code in notes) == (count > 0)
        if count:
            assert notes[code]["value"] == count
            assert notes[code]["text"].startswith(f"{count} of 3 points: ")
    assert "flight" in notes
    assert xarray.open_dataset(tmp_path / "sweep.nc").attrs["notes"] == data.attrs["notes"]
    # What holds for the scenario, whatever is varied, is said once; what is varied is not.
    heavy = base.replace({"robot.mass": 25.6e-6})
    about = json.loads(sweep(heavy, {"drive.frequency": [30.0, 5e3]}).attrs["notes"])
    assert [each["code"] for each in about if each["code"] not in (*LIMITS, "rest")] == ["density"]
    base.to_toml(tmp_path / "s.toml")
    vary = ["--vary", "drive.frequency=30,115,150"]
    text = stickslip("sweep", tmp_path / "s.toml", *vary).stdout
    assert notes["flight"]["text"] in text
    told = json.loads(stickslip("sweep", tmp_path / "s.toml", *vary, "--json").stdout)
    assert told["notes"] == json.loads(data.attrs["notes"])
    drawn = base.with_uncertain({"contact.kinetic_friction": {"mean": 0.145, "sd": 0.01}})
    found = predict(drawn, {"drive.frequency": frequencies}, draws=4)
    said = {each["code"]: each["text"] for each in json.loads(found.attrs["notes"])}
    assert "of 12 simulations: in flight for more than half" in said["flight"]
