"""How much of a motion is the pull of the field's gradient."""

import numpy as np
import pytest
from scipy.integrate import simpson

from command_line import stickslip
from stickslip import Coils, Scenario, Waveform, predict, simulate, simulate_batch, sweep

TEXT = "stickslip = 1\n[drive]\nbase = 0.5e-3\npulses = 6\n"  # see `scenario` of conftest
MOMENT = 5e5 * 250e-6 * 130e-6 * 100e-6  # A m^2
ASKED = {"record.pull_share": "yes"}
WALK = {"drive.base": 0.5e-3, "drive.pulses": 20}
# In the window the surface stops a fall: a fifth more than what presses the robot down.
LANDS = {
    **WALK, "drive.pulses": 3, "drive.ramp": 1e-4, "drag.linear": 0.0,
    "initial.contact": "flight", "initial.z": 2e-4, "initial.vz": -0.1,
}  # fmt: skip
# Steady current in one coil, ahead: a block that lies flat, and which the gradient drags along.
DRAGGED = {
    "drive.peak": 2.5e-3, "drive.base": 2.5e-3, "drive.hold": 0.0, "drive.ramp": 0.1,
    "drive.pulses": 10, "contact.static_friction": 0.15, "contact.kinetic_friction": 0.15,
}  # fmt: skip


def share(changes):
    return simulate(Scenario().replace({**ASKED, **changes})).summary()["pull_share"]


@pytest.mark.parametrize("direction", ["+x", "-x"])
def test_a_dragged_block_is_pulled_by_its_friction_and_its_drag(direction):
    scenario = Scenario().replace({**ASKED, **DRAGGED, "drive.direction": direction})
    run = simulate(scenario.replace({"record.rate": 1e5}))
    found = run.summary()
    assert found["events"]["lift_off"] == 0
    start, end = scenario.window
    within = (run.t >= start - 1e-9) & (run.t <= end + 1e-9)
    first, last = np.flatnonzero(within)[[0, -1]]
    # By Newton's second law along the surface, of a block that lies flat all the time.
    normal = simpson(run.normal_force[within], x=run.t[within])
    gained = scenario.robot.mass * (run.vx[last] - run.vx[first])
    dragged = scenario.drag.linear * (run.x[last] - run.x[first])
    pulled = abs(gained + dragged) + 0.15 * normal
    assert found["pull_share"] == pytest.approx(pulled / (0.15 * normal), rel=1e-6)
    assert 1.0 < found["pull_share"] < 1.2


@pytest.mark.parametrize("changes", [WALK, LANDS])
def test_a_share_is_that_of_the_gradient_at_the_places_of_a_record(changes):
    run = simulate(Scenario().replace({**ASKED, **changes, "record.rate": 2e5}))
    found = run.summary()
    start, end = run.scenario.window
    within = (run.t >= start - 1e-9) & (run.t <= end + 1e-9)
    coils, robot = Coils.of(run.scenario), run.scenario.robot
    place = np.stack([run.x, run.y, run.z], axis=1)[within][::5]
    amperes, theta = run.current[within][::5], run.theta[within][::5]
    slope = np.array([coils.gradient(at, each) for at, each in zip(place, amperes, strict=True)])
    force = MOMENT * (np.cos(theta) * slope[:, 0, 0] - np.sin(theta) * slope[:, 2, 0])
    lift = MOMENT * (np.cos(theta) * slope[:, 0, 2] - np.sin(theta) * slope[:, 2, 2])
    touching = 1.0 - found["airborne_fraction"]
    pressing = 9.81 * robot.mass + touching * run.scenario.contact.adhesion - lift.mean()
    stopped = robot.mass * np.diff(run.vz[within][[0, -1]])[0] / (end - start)
    expected = force.mean() / (0.2 * (pressing + stopped))
    assert found["pull_share"] == pytest.approx(expected, rel=2e-3)
    assert 0.1 < found["pull_share"] < 0.5


def test_pairs_of_coils_leave_the_pull_of_the_clamp():
    """Held from below, whose field spreads: dBx/dx = -1/2 dBz/dz is against a moment along +x."""
    run = simulate(
        Scenario().replace({**ASKED, **WALK, "drive.coils": "pairs", "record.rate": 2e4})
    )
    found, contact = run.summary(), run.scenario.contact
    theta = run.theta[run.t > run.scenario.window[0]]
    field, slope = (
        each(np.zeros(3), [0.0, 0.0, 0.0, 0.0, 1.0])
        for each in (Coils.of(run.scenario).field, Coils.of(run.scenario).gradient)
    )
    spread = -1e-3 / field[2] * slope[0, 0] * MOMENT
    pressing = 9.81 * run.scenario.robot.mass - 2.0 * spread * np.sin(theta).mean()
    pressing += (1.0 - found["airborne_fraction"]) * contact.adhesion
    expected = spread * np.cos(theta).mean() / (0.2 * pressing)
    assert found["pull_share"] == pytest.approx(expected, rel=0.03)
    assert expected < -0.1


def test_a_share_is_about_zero_without_a_gradient():
    # Both coils alike, and a clamp too weak to count beside the weight.
    free = {**WALK, "drive.coils": "pairs", "drive.hold": 1e-5, "contact.adhesion": 0.0}
    assert abs(share(free)) < 0.01


@pytest.mark.parametrize("changes", [WALK, {**WALK, "drive.mode": "OPP", "drive.hold": 2.5e-3}])
def test_a_share_is_the_same_whichever_way_the_robot_is_driven(changes):
    ahead = share(changes)
    assert share({**changes, "drive.direction": "-x"}) == pytest.approx(ahead, rel=1e-12)
    # In the whole plane it is another program, whose steps add up otherwise.
    assert share({**changes, "drive.heading": np.pi / 2}) == pytest.approx(ahead, rel=1e-4)


def test_asking_changes_no_other_number_and_packs_agree_to_the_bit():
    drives = [{**WALK, "drive.frequency": float(f)} for f in range(60, 160, 5)]
    asked = [Scenario().replace({**ASKED, **each}) for each in drives]
    together = simulate_batch(asked, threads=1)
    for scenario, packed, each in zip(asked, together, drives, strict=True):
        alone = simulate(scenario).summary()
        assert repr(packed.summary()) == repr(alone)
        plain = simulate(Scenario().replace(each)).summary()
        assert alone.pop("pull_share") > 0.0
        plain["notes"] = alone["notes"]  # which go by the share where it is known
        assert repr(plain) == repr(alone)


def test_sweeps_and_predictions_have_it_where_the_scenario_asks(scenario):
    base, at = Scenario().replace(WALK), {"drive.frequency": [60.0, 100.0]}
    alone = [share({**WALK, "drive.frequency": each}) for each in at["drive.frequency"]]
    assert "pull_share" not in sweep(base, at)
    assert sweep(base.replace(ASKED), at).pull_share.values.tolist() == alone
    prior = {"drag.linear": {"mean": 1e-5, "sd": 1e-12}}
    bands = predict(base.replace(ASKED), at, 2, uncertain=prior)
    np.testing.assert_allclose(bands.pull_share.sel(quantile=0.5), alone, rtol=1e-3)
    file = scenario.parent / "u.toml"
    file.write_text('[uncertain]\n"drag.linear" = { mean = 1e-5, sd = 1e-6 }')
    bands = "predict", scenario, "--draws=2", "--uncertain", file
    for values in ("60,100", "60:100:51"):  # the second so many that their ends are printed
        more = f"--vary=drive.frequency={values}", "--set", "record.pull_share=yes"
        for command, name in ((("sweep", scenario), "pull_share"), (bands, "pull_share_q50")):
            lines = stickslip(*command, *more).stdout.partition("\n\n")[0].split("\n")
            assert name in lines[-4].split()  # above units and two rows
    done = stickslip(*bands, "--figures=pull_share")
    assert "pull_share needs --set record.pull_share=yes, left out" in done.stderr


def test_without_friction_contact_or_motion_there_is_no_share():
    free = {"contact.static_friction": 0.0, "contact.kinetic_friction": 0.0}
    assert share({**WALK, **free}) == 0.0
    # What presses a robot that falls through the whole window and its momentum cancel.
    assert share({**LANDS, "initial.z": 2e-3, "initial.vz": 0.0, "drag.linear": 1e-5}) == 0.0
    still = Waveform.ramp(0.1, {})
    assert share({"drive.mode": "program", "drive.program": still}) == 0.0
