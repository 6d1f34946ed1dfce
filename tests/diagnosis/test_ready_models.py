"""The models of `stickslip.models`: closed forms, another integrator, and hidden effects."""

import inspect
import itertools
import math
import pickle
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.special import ellipk

import stickslip
from stickslip import Prior, ScenarioError, Series, Table, diagnose_model, events, models
from stickslip.cli.options import stated
from stickslip.diagnosis.data.signal import Signal
from stickslip.models.kinds import KINDS
from stickslip.models.model import Kind

T = np.linspace(0.0, 2.0, 201)
FACTORIES = {name: getattr(models, name) for name in KINDS}
LEAST = {
    "joint": {"inertia": 0.1, "reads": "angle"},
    "axis": {"mass": 2.0},
    "pendulum": {"length": 0.5},
    "oscillator": {"mass": 1.0, "stiffness": 40.0},
    "thermal": {"capacity": 200.0, "loss": 2.0, "ambient": 0.0},
    "servo": {"inertia": 0.02, "torque_constant": 1.0, "resistance": 3.0, "supply": 12.0,
              "gain": 3.0, "gravity": 0.5},
}  # fmt: skip


def constant(value):
    return np.full(len(T), value)


def random(seed):
    return np.random.default_rng([66, seed])


def staircase(seed, size, stair=20, count=201):
    return np.repeat(random(seed).uniform(-size, size, count // stair + 1), stair)[:count]


# Closed forms.


def test_a_joint_slows_down_and_speeds_up_with_its_time_constant():
    joint = models.joint(inertia=0.1, viscous=0.05)
    slows = joint.simulate(T, start_speed=3.0)
    assert slows == pytest.approx(3.0 * np.exp(-0.5 * T), rel=1e-12)
    driven = joint.simulate(T, {"torque": constant(0.2)})
    assert driven == pytest.approx(4.0 * (1.0 - np.exp(-0.5 * T)), rel=1e-12)
    turned = models.joint(inertia=0.1, viscous=0.05, reads="angle").simulate(T, start_speed=3.0)
    assert turned == pytest.approx(6.0 * (1.0 - np.exp(-0.5 * T)), rel=1e-12)


def test_dry_friction_holds_what_is_below_it_and_stops_what_moves():
    joint = models.joint(inertia=0.1, coulomb=0.3, asymmetry=0.1, reads="angle")
    for torque, angle in ((0.39, 0.0), (0.5, 0.5 * T**2), (-0.19, 0.0), (-0.3, -0.5 * T**2)):
        found = joint.simulate(T, {"torque": constant(torque)})
        assert found == pytest.approx(angle + 0.0 * T, rel=1e-12, abs=1e-14)
    # From 3 rad/s at -4 rad/s^2 it stops after 0.75 s, between two readings of an odd clock.
    t = np.linspace(0.0, 2.0, 138)
    moving = np.minimum(t, 0.75)
    found = joint.simulate(t, start_speed=3.0)
    assert found == pytest.approx(3.0 * moving - 2.0 * moving**2, abs=1e-13)


def test_an_elastic_joint_rings_about_its_common_motion():
    frequency = np.sqrt(1.0 / (2e-3 * 0.1 * 0.25))
    joint = models.joint(inertia=0.1, compliance=2e-3, damping_ratio=0.1)
    found = joint.simulate(T, {"torque": constant(0.5)})
    decay, turn = 0.1 * frequency, np.sqrt(0.99) * frequency
    ringing = 5.0 * np.exp(-decay * T) * np.sin(turn * T) / turn
    assert found == pytest.approx(5.0 * T + ringing, abs=1e-9)


def test_a_motor_has_a_dead_zone_and_a_limit_and_may_differ_by_direction():
    axis = models.axis(mass=2.0, viscous=4.0, gain=3.0, dead_zone=0.5, saturation=2.0,
                       gain_asymmetry=0.1, reads="speed")  # fmt: skip
    for command, force in ((0.4, 0.0), (1.5, 3.3), (9.0, 6.6), (-1.5, -2.7), (-9.0, -5.4)):
        found = axis.simulate(T, {"command": constant(command)})
        assert found == pytest.approx(0.25 * force * (1.0 - np.exp(-2.0 * T)), abs=1e-13)


@pytest.mark.parametrize("angle", [0.01, 1.0, 3.0])
def test_a_pendulum_swings_with_the_period_of_its_amplitude(angle):
    period = 4.0 * np.sqrt(0.5 / 9.81) * ellipk(np.sin(0.5 * angle) ** 2)
    t = np.linspace(0.0, 2.0 * period, 401)
    found = models.pendulum(length=0.5).simulate(t, start_position=angle)
    assert found[[100, 200, 300, 400]] == pytest.approx([-angle, angle, -angle, angle], rel=1e-6)
    assert found[50] == pytest.approx(0.0, abs=1e-6 * angle)


def test_an_oscillator_rings_and_dry_friction_takes_the_same_off_each_half_swing():
    damped = models.oscillator(mass=2.0, stiffness=200.0, viscous=0.8)
    turn = np.sqrt(100.0 - 0.04)
    expected = 0.3 * np.exp(-0.2 * T) * (np.cos(turn * T) + 0.2 / turn * np.sin(turn * T))
    assert damped.simulate(T, start_position=0.3) == pytest.approx(expected, abs=1e-12)
    dry = models.oscillator(mass=2.0, stiffness=200.0, coulomb=4.0)
    t = np.arange(8) * np.pi / 10.0
    swings = [0.3, -0.26, 0.22, -0.18, 0.14, -0.10, 0.06, -0.02]
    assert dry.simulate(t, start_position=0.3) == pytest.approx(swings, abs=1e-9)
    rest = dry.simulate(np.linspace(0.0, 9.0, 50), start_position=0.3)[-1]
    assert rest == pytest.approx(-0.02, abs=1e-9)


def test_a_heater_warms_up_and_cools_down():
    heater = models.thermal(capacity=200.0, loss=2.0, ambient=20.0)
    found = heater.simulate(50.0 * T, {"power": constant(60.0)}, start_temperature=20.0)
    assert found == pytest.approx(50.0 - 30.0 * np.exp(-0.5 * T), rel=1e-12)
    warm = heater.simulate(50.0 * T, {"ambient": constant(10.0)}, start_temperature=30.0)
    assert warm == pytest.approx(10.0 + 20.0 * np.exp(-0.5 * T), rel=1e-12)


def test_a_servo_follows_its_supply_and_coasts_when_it_is_switched_off():
    servo = models.servo(inertia=0.02, torque_constant=0.6, resistance=3.0, viscous=0.03,
                         reads="speed")  # fmt: skip
    inputs = {"duty": constant(0.5), "supply": np.where(T < 0.995, 12.0, 6.0),
              "torque enable": 1.0 * (T < 1.495)}  # fmt: skip
    v, expected = 0.0, []
    for k in range(len(T)):
        expected.append(v)
        end, rate = 1.2 * inputs["supply"][k] / 12.0 / 0.15, 7.5
        if not inputs["torque enable"][k]:
            end, rate = 0.0, 1.5
        v = end + (v - end) * np.exp(-0.01 * rate)
    assert servo.simulate(T, inputs) == pytest.approx(np.array(expected), abs=1e-8)


def test_a_servo_holds_an_arm_where_its_loop_and_friction_bear_the_weight():
    servo = models.servo(**{**LEAST["servo"], "hangs_at": 0.2, "damping_gain": 0.1})
    rest = servo.simulate(T, {"goal": constant(0.9)})[-1]
    assert 12.0 * (0.9 - rest) == pytest.approx(0.5 * np.sin(rest - 0.2), rel=1e-6)
    # A tenth of 0.5 sin(0.7) and of what the motor gives beside it.
    stuck = servo.simulate(T, {"goal": constant(0.925)}, start_position=0.9, load_friction=0.1)
    assert stuck == pytest.approx(0.9, abs=1e-15)
    moved = servo.simulate(T, {"goal": constant(0.94)}, start_position=0.9, load_friction=0.1)
    assert moved[-1] > 0.9


def test_an_input_that_changes_evenly_is_a_ramp():
    joint = models.joint(inertia=0.5, smooth=True)
    assert joint.simulate(T, {"torque": T}) == pytest.approx(T**2, abs=1e-12)


def test_a_mass_that_a_line_stops_between_two_readings_goes_on_when_it_lets_go():
    joint = models.joint(inertia=1.0, coulomb=3.0, smooth=True)
    # 0.2 - t + t^2 would be 0.2 again at the end; it rests from 0.276 s up to half a second.
    found = joint.simulate(np.array([0.0, 1.0, 2.0]), {"torque": [2.0, 4.0, 4.0]}, start_speed=0.2)
    assert found == pytest.approx([0.2, 0.25, 1.25], abs=1e-12)


@pytest.mark.parametrize("late", [0.0031, 0.0074, 0.0268])
@pytest.mark.parametrize("coulomb", [0.0, 0.3])
def test_the_change_of_a_reading_with_a_delay_is_that_with_time(late, coulomb):
    u, joint = np.sin(7.0 * T), models.joint(inertia=0.1, viscous=0.2, coulomb=coulomb)
    few = 1e-7
    less, v, more = (Acts(True, late + each).read(joint, {"torque": u}) for each in (-few, 0, few))
    acts = np.interp(T - late, T, u) - 0.2 * v
    pulls = np.where(v, acts - coulomb * np.sign(v), 0.0) / 0.1
    assert (more - less) / (2.0 * few) == pytest.approx(-pulls, abs=1e-6)


# Another integrator: SciPy's, from event to event, and the equations as they are written in the
# docstrings.


class Acts(NamedTuple):
    """An input at `T`, held or as lines, that is late and was 0.3 of its first value."""

    lines: bool
    late: float

    def values(self, seed, size):
        return np.clip(staircase(seed, size) + self.lines * random(seed).normal(
            0.0, 0.2 * size, len(T)), -size, size)  # fmt: skip

    def at(self, time, u):
        if time < self.late:
            return 0.3 * u[0]
        if self.lines:
            return np.interp(time - self.late, T, u)
        return u[np.searchsorted(T, time - self.late + 1e-9, side="right") - 1]

    def read(self, model, inputs, **start):
        """Readings of a model."""
        ((name, u),) = inputs.items()
        late, before = np.array([self.late]), np.array([0.3])
        acted = {name: lambda held: Signal.of(T, u[None], held).delayed(late, before)}
        record = Series(T, 0.0 * T, inputs, sd=1.0).acted_on(acted)
        model = replace(model, smooth=self.lines)
        return model(record, {key: np.array([[value]]) for key, value in start.items()})[0]


def integrated(slope, start, acts, u, margins=(), switch=None):
    """States at the readings, with events where a margin falls through zero."""
    ends = np.unique(np.concatenate([T, (T + acts.late)[T + acts.late < T[-1]]]).round(12))
    z, state, rows = np.array(start, dtype=float), None, []
    if switch:
        z, state = switch(z, acts.at(0.0, u), None, None)
    for begin, end in itertools.pairwise(ends):
        rows.append(z)
        # Held from the knot on, or the line on which both ends are.
        first = acts.at(begin, u)
        rise = (acts.at(end, u) - first) / (end - begin) if acts.lines and begin >= acts.late else 0

        def now(time, begin=begin, first=first, rise=rise):
            return first + rise * (time - begin)

        z, state = switch(z, first, state, None) if switch else (z, None)
        for _ in range(20):

            def event(number, begin=begin, state=state, now=now):
                # What begins at zero has not fallen through it.
                def margin(time, there):
                    return margins[number](there, now(time), state) + 1e-13 * (time == begin)

                margin.terminal, margin.direction = True, -1
                return margin

            found = solve_ivp(
                lambda time, z, state=state, now=now: slope(z, now(time), state), (begin, end), z,
                method="DOP853", rtol=1e-12, atol=1e-14, max_step=0.3 * (end - begin) + 1e-9,
                events=[event(number) for number in range(len(margins))] or None,
            )  # fmt: skip
            z, begin = found.y[:, -1], found.t[-1]
            if found.status != 1 or end - begin < 1e-15:
                break
            hit = next(n for n, times in enumerate(found.t_events) if len(times))
            z, state = switch(z, now(begin), state, hit)
    return np.array([*rows, z])[np.searchsorted(ends, T - 1e-11)]


def with_friction(force, friction, inertia, acts, u):
    """One inertia that sticks: `force(x, v, u)`, `friction(v, sign, x, u)`."""

    def margin(z, u, sign):
        pulls = force(z[0], 0.0, u)
        grip = abs(friction(0.0, np.sign(pulls), z[0], u))
        return sign * z[1] if sign else grip - abs(pulls)

    def switch(z, u, sign, hit):
        pulls = force(z[0], 0.0, u)
        if sign == 0 and hit is not None:
            return z, np.sign(pulls)
        if hit is not None or sign is None:
            sign = 0 if hit is not None else np.sign(z[1])
            z = np.array([z[0], 0.0 if hit is not None else z[1]])
        if sign == 0:
            sign = np.sign(pulls) * (margin(z, u, 0) < 0.0)
        return z, sign

    def slope(z, u, sign):
        pulls = force(*z, u) - friction(z[1], sign, z[0], u)
        return [z[1], pulls / inertia] if sign else [0.0, 0.0]

    return integrated(slope, (0.1, 0.2), acts, u, [margin], switch)


def of_joint(acts):
    p = {"inertia": 0.1, "viscous": 0.2, "viscous_asymmetry": 0.05, "coulomb": 0.3,
         "asymmetry": 0.08, "stribeck": 0.2, "stribeck_speed": 0.4, "quadratic": 0.02,
         "load": 0.1, "gravity": 0.7}  # fmt: skip
    u = acts.values(1, 2.5)

    def force(x, v, u):
        return u - 0.2 * v - 0.1 - 0.7 * np.sin(x)

    def friction(v, sign, *_):
        falls = 0.2 * np.exp(-((v / 0.4) ** 2))
        return sign * (0.3 + sign * 0.08 + falls) + 0.05 * sign * v + sign * 0.02 * v**2

    return models.joint(reads="angle", **p), {"torque": u}, with_friction(
        force, friction, 0.1, acts, u)[:, 0]  # fmt: skip


def of_axis(acts):
    u = acts.values(2, 4.0)
    model = models.axis(mass=2.0, gain=3.0, viscous=4.0, coulomb=2.0, dead_zone=0.3, load=0.5,
                        saturation=2.0, reads="speed")  # fmt: skip

    def force(x, v, u):
        acts = np.sign(u) * min(max(abs(u) - 0.3, 0.0), 2.0)
        return 3.0 * acts - 4.0 * v - 0.5

    return model, {"command": u}, with_friction(
        force, lambda v, sign, *_: 2.0 * sign, 2.0, acts, u)[:, 1]  # fmt: skip


def of_pendulum(acts):
    u = acts.values(3, 3.0)
    model = models.pendulum(length=0.5, viscous=0.3, coulomb=0.4, quadratic=0.1, stiffness=2.0)

    def force(x, v, u):
        return -9.81 / 0.5 * np.sin(x) - u / 0.5 * np.cos(x) - 0.3 * v - 2.0 * x

    return model, {"pivot": u}, with_friction(
        force, lambda v, sign, *_: sign * (0.4 + 0.1 * v**2), 1.0, acts, u)[:, 0]  # fmt: skip


def of_oscillator(acts):
    u = acts.values(4, 8.0)
    model = models.oscillator(mass=0.5, stiffness=60.0, viscous=0.3, coulomb=0.5, quadratic=0.2,
                              cubic_damping=0.1, quadratic_stiffness=40.0,
                              cubic_stiffness=300.0)  # fmt: skip

    def force(x, v, u):
        return u - 60.0 * x - 40.0 * x**2 - 300.0 * x**3 - 0.3 * v - 0.1 * v**3

    return model, {"force": u}, with_friction(
        force, lambda v, sign, *_: sign * (0.5 + 0.2 * v**2), 0.5, acts, u)[:, 0]  # fmt: skip


def of_heater(acts):
    u = np.abs(acts.values(5, 90.0))
    model = models.thermal(capacity=20.0, loss=2.0, ambient=20.0, loss_growth=0.05,
                           heater_capacity=5.0, coupling=8.0)  # fmt: skip

    def slope(z, u, _):
        over = z[0] - 20.0
        flow = 8.0 * (z[1] - z[0])
        return [(flow - 2.0 * over - 0.05 * over * abs(over)) / 20.0, (u - flow) / 5.0]

    return model, {"power": u}, integrated(slope, (20.0, 20.0), acts, u)[:, 0]


def of_room(acts):
    u = np.abs(acts.values(8, 90.0))
    model = models.thermal(capacity=20.0, loss=2.0, ambient=20.0, heater_capacity=5.0, coupling=8.0,
                           wall_capacity=60.0, wall_coupling=3.0)  # fmt: skip

    def slope(z, u, _):
        flow, back = 8.0 * (z[1] - z[0]), 3.0 * (z[2] - z[0])
        return [(flow + back - 2.0 * (z[0] - 20.0)) / 20.0, (u - flow) / 5.0, -back / 60.0]

    return model, {"power": u}, integrated(slope, (20.0, 20.0, 20.0), acts, u)[:, 0]


def with_play(drive, grip, hangs, masses, gap, acts, u, begun):
    """Motor and load with the phases of sticking and of contact, each with its own equation.

    Functions of state and input: what drives the motor, its dry friction, what the load resists.
    """
    motor, load = masses

    def together(z, u, sign):
        pulls = drive(z, u) - grip(z, u) * sign - hangs(z)
        return pulls / (motor + load) if sign else 0.0

    def pushes(z, u, state):
        return load * together(z, u, state[0]) + hangs(z)

    def slope(z, u, state):
        sign, side = state
        if side:
            a = together(z, u, sign)
            return [z[1] * abs(sign), a, z[3] * abs(sign), a]
        a = (drive(z, u) - grip(z, u) * sign) / motor if sign else 0.0
        return [z[1] * abs(sign), a, z[3], -hangs(z) / load]

    def settled(z, u, sign, side):
        for _ in range(3):
            pulls = drive(z, u) - hangs(z) * abs(side)
            if sign == 0 and abs(pulls) > grip(z, u):
                sign = np.sign(pulls)
            if side * pushes(z, u, (sign, side)) < 0.0:
                side = 0
                if z[1] == 0.0:
                    sign = np.sign(drive(z, u)) * (abs(drive(z, u)) > grip(z, u))
        return z, (sign, side)

    def switch(z, u, state, hit):
        z = z.copy()
        if state is None:
            side = begun(z, u)
            return settled(z, u, np.sign(z[1]), side)
        sign, side = state
        if hit == 0 and sign == 0:
            return z, (np.sign(drive(z, u) - hangs(z) * abs(side)), side)
        if hit == 0:
            z[1], sign = 0.0, 0
            z[3] = 0.0 if side else z[3]
        elif hit == 1 and side:
            side = 0
        elif hit == 1:
            side = np.sign(z[0] - z[2])
            z[1] = z[3] = (motor * z[1] + load * z[3]) / (motor + load)
            z[2], sign = z[0] - side * gap, np.sign(z[1])
        return settled(z, u, sign, side)

    margins = [
        lambda z, u, s: s[0] * z[1]
        if s[0] else grip(z, u) - abs(drive(z, u) - hangs(z) * abs(s[1])),
        lambda z, u, s: s[1] * pushes(z, u, s) if s[1] else gap - abs(z[0] - z[2]),
    ]  # fmt: skip
    return integrated(slope, (0.1, 0.2, 0.1, 0.2), acts, u, margins, switch)[:, 2]


def of_backlash(acts):
    u, gap = acts.values(6, 3.0), 0.02
    model = models.joint(inertia=0.1, load_share=0.4, viscous=0.2, coulomb=0.4, gravity=0.5,
                         backlash=2 * gap, reads="load angle")  # fmt: skip

    def begun(z, u):
        side = -1 if u < 0 else 1
        z[2] = z[0] - side * gap
        return side

    return model, {"torque": u}, with_play(
        lambda z, u: u - 0.2 * z[1], lambda z, u: 0.4, lambda z: 0.5 * np.sin(z[2]),
        (0.06, 0.04), gap, acts, u, begun)  # fmt: skip


def servo_torque(y, w, v, u, limit=0.7):
    """The torque of a servo that sees its load at `y` and `w`, and whose motor has the speed v."""
    duty = np.clip(2.5 * (u - y) - 0.02 * w, -limit, limit)
    return 0.9 / 3.0 * (11.0 * duty - 0.9 * v)


SERVO = {"torque_constant": 0.9, "resistance": 3.0, "supply": 11.0, "gain": 2.5,
         "damping_gain": 0.02, "gravity": 0.9, "hangs_at": 0.3, "mass_error": 0.1, "inertia": 0.02,
         "armature": 0.006, "viscous": 0.03, "coulomb": 0.08, "load_friction": 0.08}  # fmt: skip


def of_servo(acts):
    """An arm of which the loop, its limit and friction that grows with the load bear the weight."""
    u = acts.values(9, 1.2)
    model = models.servo(**SERVO, stribeck=0.06, stribeck_speed=0.4, duty_limit=0.7)

    def hangs(x):
        return 0.99 * np.sin(x - 0.3)

    def friction(v, sign, x, u):
        dry = 0.08 + 0.06 * np.exp(-((v / 0.4) ** 2))
        return sign * (dry + 0.08 * abs(servo_torque(x, v, v, u) + hangs(x)))

    return model, {"goal": u}, with_friction(
        lambda x, v, u: servo_torque(x, v, v, u) - 0.03 * v - hangs(x), friction, 0.028, acts, u
    )[:, 0]  # fmt: skip


def of_hunting(acts):
    """A servo whose loop sees its load across play, and hunts."""
    u, gap = acts.values(10, 0.2), 0.03
    model = models.servo(**{**SERVO, "viscous": 0.0, "load_friction": 0.3}, backlash=2 * gap)

    def hangs(z):
        return 0.99 * np.sin(z[2] - 0.3)

    def drive(z, u):
        return servo_torque(z[2], z[3], z[1], u, np.inf)

    def begun(z, u):
        side = np.sign(hangs(z))
        z[0] = z[2] + side * gap
        return side

    return model, {"goal": u}, with_play(
        drive, lambda z, u: 0.08 + 0.3 * abs(servo_torque(z[2], z[3], z[1], u, np.inf) + hangs(z)),
        hangs, (0.006, 0.022), gap, acts, u, begun)  # fmt: skip


def of_spring(acts):
    """A motor that sticks, and its load on a spring behind a gap."""
    u, gap = acts.values(7, 3.0), 0.01
    model = models.joint(inertia=0.1, load_share=0.4, viscous=0.2, coulomb=0.4, backlash=2 * gap,
                         compliance=0.01, damping_ratio=0.1, reads="load angle")  # fmt: skip
    damping = 2.0 * 0.1 * np.sqrt(100.0 * 0.04 * 0.06 / 0.1)

    def twist(z, side):
        return 100.0 * (z[0] - z[2] - side * gap) + damping * (z[1] - z[3]) if side else 0.0

    def slope(z, u, state):
        sign, side = state
        moment = twist(z, side)
        a = (u - 0.2 * z[1] - 0.4 * sign - moment) / 0.06 if sign else 0.0
        return [z[1] * abs(sign), a, z[3], moment / 0.04]

    def switch(z, u, state, hit):
        z = z.copy()
        if state is None:
            state = np.sign(z[1]), -1 if u < 0 else 1
            z[2] = z[0] - state[1] * gap
        sign, side = state
        if hit == 0:
            z[1], sign = (0.0, 0) if sign else (0.0, np.sign(u - twist(z, side)))
        elif hit == 1:
            side = 0 if side else np.sign(z[0] - z[2])
        if sign == 0 and abs(u - twist(z, side)) > 0.4:
            sign = np.sign(u - twist(z, side))
        return z, (sign, side)

    margins = [
        lambda z, u, s: s[0] * z[1] if s[0] else 0.4 - abs(u - twist(z, s[1])),
        lambda z, u, s: (s[1] * (z[0] - z[2]) - gap) * (1 if s[1] else -1)
        if s[1] else gap - abs(z[0] - z[2]),
    ]  # fmt: skip
    return model, {"torque": u}, integrated(
        slope, (0.1, 0.2, 0.1, 0.2), acts, u, margins, switch)[:, 2]  # fmt: skip


@pytest.mark.parametrize("acts", [Acts(False, 0.0268), Acts(True, 0.0031), Acts(True, 0.0268)])
@pytest.mark.parametrize(
    "case", [of_joint, of_axis, of_pendulum, of_oscillator, of_heater, of_room, of_backlash,
             of_spring, of_servo, of_hunting]
)  # fmt: skip
@pytest.mark.daily("acts0", "of_joint", "of_pendulum", "of_spring", "of_room")
def test_readings_are_those_of_another_integrator(case, acts):
    model, inputs, expected = case(acts)
    start = {"start_position": 0.1, "start_speed": 0.2}
    if "power" in inputs:
        start = {"start_temperature": 20.0}
    found = acts.read(model, inputs, **start)
    assert np.ptp(expected) > 1e-2
    assert found == pytest.approx(expected, abs=1e-8 * np.ptp(expected))


def test_many_vectors_are_each_its_own_and_what_cannot_be_computed_is_nan():
    torque = staircase(8, 2.0)
    log = Series(T, 0.0 * T, {"torque": np.stack([torque, 0.5 * torque])[0]}, sd=1.0)
    joint = models.joint(inertia=0.1)
    rows = {"coulomb": [0.1, 0.4, 0.4], "backlash": [0.0, 0.0, 0.02], "gravity": [0.3, 0.0, 0.0]}
    made = joint(log, {name: np.array(row)[:, None] for name, row in rows.items()})
    for k, row in enumerate(made):
        alone = {name: values[k] for name, values in rows.items()}
        assert np.array_equal(row, joint.simulate(T, {"torque": torque}, **alone))
    # Two vectors of an input, as where a cause acts on it.
    seen = log.with_inputs({"torque": np.stack([torque, 0.5 * torque])})
    assert np.array_equal(joint(seen, {})[1], joint.simulate(T, {"torque": 0.5 * torque}))
    stiff = models.pendulum(length=1e-15).simulate(T, start_position=0.1)
    assert np.isnan(stiff[1:]).all()
    runaway = models.oscillator(mass=1.0, stiffness=1.0, cubic_stiffness=-5.0)
    assert np.isnan(runaway.simulate(10.0 * T, start_position=3.0)[-1])


# Softening springs have no finite motion, no pendulum is read each 10 s, and a joint that turns
# below a weight some hundred times from a reading to the next is not followed.
@pytest.mark.parametrize("step", [1e-3, 0.1, 10.0])
@pytest.mark.parametrize("name", ["joint", "axis", "thermal", "servo"])
def test_a_model_computes_wherever_it_is_allowed_to(name, step):
    """Half of all effects at a time, of any size that is searched, and any start."""
    t, u = step * np.arange(80), np.abs(staircase(5, 1.0, 8, 80)) - 0.5 * (name != "thermal")
    stated = {"joint": {"inertia": 1.0}, "axis": {"mass": 1.0},
              "thermal": {"capacity": 1.0, "loss": 0.1 / step, "ambient": 0.0},
              "servo": {"inertia": 1.0, "torque_constant": 1.0, "resistance": step, "supply": 1.0,
                        "gain": 1.0 / step}}  # fmt: skip
    model = getattr(models, name)(**stated[name])
    inputs = {next(iter(model.kind.inputs)): u}
    record = Series(t, model.simulate(t, inputs), inputs, sd=1.0)
    uncertain, causes = model.terms(record)
    hangs = {"gravity"} if step > 1.0 else set()
    effects = [one for one in causes if not one.is_instrument and one.name not in hangs]
    draw, p = random(9), {}
    for one in (*uncertain, *(one for cause in effects for one in cause.parameters)):
        low, high = np.clip(one.limits, -4.5, 40.0)
        values = one.value(draw.uniform(low, high, 400))
        if one.is_amplitude:
            values = np.where(draw.random(400) < 0.5, values, one.absent)
        p[one.name] = values[:, None]
    assert {"stribeck_speed", "coupling"} & p.keys()
    assert np.isfinite(model(record, p)).all()


def test_uneven_clocks_have_exact_steps():
    t = np.sort(random(9).uniform(0.0, 2.0, 200))
    start = 3.0 * np.exp(-0.5 * t[0])
    for friction in (0.0, 0.05):
        joint = models.joint(inertia=0.1, viscous=0.05, coulomb=friction)
        found = joint.simulate(t, start_speed=start)
        rest = 10.0 * friction / 0.5
        moving = (start + rest) * np.exp(-0.5 * (t - t[0])) - rest
        assert found == pytest.approx(np.maximum(moving, 0.0), abs=1e-12)


# What is hidden is found, by the least that a user writes; other effects in `test_hidden`.


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("name", "true", "model", "inputs", "step", "noise"),
    [
        ("wall_capacity",
         models.thermal(capacity=200.0, loss=2.0, ambient=0.0, wall_capacity=300.0,
                        wall_coupling=4.0),
         models.thermal(capacity=(200.0, 10.0), loss=(2.0, 0.2), ambient=0.0),
         {"power": np.abs(staircase(2, 90.0, count=100))}, 2.0, 0.1),
        ("backlash",
         models.joint(inertia=0.1, viscous=0.2, backlash=0.1, reads="angle"),
         models.joint(inertia=(0.1, 0.002), viscous=(0.2, 0.05), reads="angle",
                      without=["stribeck", "quadratic", "viscous_asymmetry", "asymmetry",
                               "compliance", "gravity"]),
         {"torque": staircase(3, 1.0, count=150)}, 0.02, 0.003),
    ],
)  # fmt: skip
def test_a_hidden_effect_is_named_with_its_size(name, true, model, inputs, step, noise):
    (u,) = inputs.values()
    t = step * np.arange(len(u))
    y = true.simulate(t, inputs) + noise * random(9).standard_normal(len(t))
    result = diagnose_model(model, Series(t, y, inputs, unit=true.unit))
    assert (result.verdict.kind, result.verdict.causes) == ("named", (name,))
    low, high = result.conf_int(0.998).loc[name, ["low", "high"]]
    assert low < true.known[name] < high


@pytest.mark.parametrize("begins", [(0,), (87,), (37, 231)], ids=["rest", "motion", "two"])
@pytest.mark.parametrize(("kind", "rates", "gains", "stated"), [
    ("joint", [[-1.7]], [84.0], {"inertia": (0.012, 6e-4), "viscous": (0.02, 0.006)}),
    ("axis", [[0, 1], [0, -1.4]], [0.0, 1.04], {"mass": (1.0, 0.05), "viscous": (1.5, 0.4)}),
    ("oscillator", [[0, 1], [-41, -0.6]], [0.0, 1.0],
     {"mass": 1.0, "stiffness": (40.0, 1.2), "viscous": (0.5, 0.15)}),
    ("thermal", [[-1.2]], [1.02], {"capacity": (1.0, 0.05), "loss": (1.2, 0.1), "ambient": 0.0}),
])  # fmt: skip
@pytest.mark.daily("joint")
def test_no_log_tells_a_slow_input_from_a_slow_sensor(kind, rates, gains, stated, begins):
    """Both of a linear machine read the same, wherever a log begins: by exact steps from rest."""
    make, draw, n = getattr(models, kind), np.random.default_rng(len(kind)), len(gains)
    u, t = np.repeat(draw.uniform(-1.0, 1.0, 50), 10), 0.02 * np.arange(200)
    whole, states, y = np.zeros((n + 2, n + 2)), np.zeros(n + 2), []
    whole[:n, :n], whole[:n, n], whole[n, n:] = rates, gains, (-12.5, 12.5)
    step = expm(0.02 * whole)
    for each in u:
        y.append(states[0])
        states = step @ [*states[:-1], each]
    sd = 0.003 * float(np.std(y))
    y += sd * draw.standard_normal(500)
    model = make(**stated)
    key, sensor = next(iter(model.kind.inputs)), model.kind.sensors[-1].name
    logs = [Series(t, y[k : k + 200], {key: u[k : k + 200]}, sd=sd) for k in begins]
    slow = stickslip.instruments.lag(0.05, input=key, name="slow input")
    less = [one.name for one in model.terms(logs)[1] if one.name not in (sensor, f"late {key}")]
    verdict = diagnose_model(make(without=less, **stated), logs, causes=[slow]).verdict
    assert verdict.kind == "ambiguous"
    assert {"slow input", sensor} <= {*verdict.causes} <= {"slow input", sensor, f"late {key}"}


@pytest.mark.parametrize(
    ("name", "reading", "acts", "count", "code"),
    [*((name, 0.0, 0.0, 1, "all-zero") for name in FACTORIES), ("joint", 0.0, 0.1, 1, "all-zero"),
     ("joint", 1.0, 0.1, 1, "no-noise"), ("thermal", 2.0, 0.0, 1, "no-noise"),
     ("thermal", 0.1, 0.0, 2, "no-noise")],
)  # fmt: skip
@pytest.mark.daily("zero", "1.0", "2.0")
def test_a_record_at_rest_is_told_in_a_sentence(name, reading, acts, count, code):
    # What never changes has no error that a fit could tell, and is like a model in many units.
    model = FACTORIES[name](**LEAST[name])
    acting = [key for key in model.kind.inputs if key not in model.known]
    inputs = dict.fromkeys(acting, constant(acts)[::10])
    records = [Series(T[::10], constant(reading)[::10], inputs, name=f"{k}") for k in range(count)]
    verdict = diagnose_model(model, records).verdict
    assert (verdict.kind, [each.code for each in verdict.reasons]) == ("data-problem", [code])


def test_a_model_takes_more_causes_and_less_and_is_kept_with_its_diagnosis():
    t = 0.02 * np.arange(120)
    torque = staircase(10, 1.0, count=120)
    speed = models.joint(inertia=0.1, viscous=0.2).simulate(t, {"torque": torque})
    noise = 0.01 * random(11).standard_normal(120)
    log = Series(t, speed + 0.3 * (t > 1.1) + noise, {"torque": torque}, unit="rad/s")
    every = models.joint(inertia=0.1).terms(log)[1]
    less = [each.name for each in every if each.name not in ("coulomb", "viscous")]
    joint = models.joint(inertia=(0.1, 0.002), viscous=(0.2, 0.05), without=less)
    slips = events.step(0.3, 0.0, 2.4, unit="rad/s", name="slip")
    result = diagnose_model(joint, log, causes=[slips])
    listed = [each for each in result.problem.causes if each.listed and each.parameters]
    assert [each.name for each in listed] == ["coulomb", "slip"]
    assert result.verdict.causes == ("slip",)
    again = pickle.loads(pickle.dumps(result))
    assert np.array_equal(again.predict(log), result.predict(log))


@pytest.mark.parametrize("smooth", [False, True])
def test_a_lag_of_readings_is_told_with_the_step_by_which_a_held_input_may_switch_earlier(smooth):
    heater = models.thermal(capacity=(50.0, 0.5), loss=0.2, ambient=0.0, smooth=smooth)
    power = np.where(np.arange(40) < 20, 20.0, 0.0)
    log = Series(5.0 * np.arange(40), np.linspace(0.0, 30.0, 40), {"power": power}, sd=0.02)
    slow = next(cause for cause in heater.terms(log)[1] if cause.name == "slow thermometer")
    assert (slow.told is None) == smooth
    if not smooth:
        assert "17.3 ± 0.1 s; up to 5 s (one step) more if" in slow.told(17.3, "17.3 ± 0.1 s", 5.0)
        assert slow.told(17.3, "17.3 ± 0.1 s", 0.1).endswith("17.3 ± 0.1 s.")


@pytest.mark.parametrize("known", [Prior("uniform", 1.0, 1e6), Prior("uniform", 0.0, 1e6),
                                   Prior("log-uniform", 1.0, 1e6)])  # fmt: skip
def test_a_constant_reaches_all_of_its_range(known):
    # A floor at a part of the middle once left out a third of the range's decades.
    capacity = models.thermal(capacity=known, loss=1.0).terms(
        Series(T, np.sin(T), {"power": np.cos(T), "ambient": 0.0 * T}, unit="K")
    )[0][0]
    assert capacity.name == "capacity"
    assert 0.0 < capacity.low <= 1.0


@pytest.mark.parametrize("capacity", [Prior("uniform", 0.0, 1e5), Prior("log-uniform", 10.0, 1e6)])
@pytest.mark.parametrize("loss", [1.5, Prior("log-uniform", 0.1, 10.0)])
@pytest.mark.parametrize(("step", "still"), [(20.0, 0), (20.0, 2000), (1e7, 0)])
def test_a_usual_size_is_of_the_record_and_not_of_the_middle_of_a_range(
    capacity, loss, step, still
):
    k = np.arange(200 + still) - still
    t, power = step * (k + still), np.where(k < 0, 0.0, np.where(k // 40 % 2, 5.0, 40.0))
    true = models.thermal(capacity=400.0, loss=1.5, ambient=20.0, start_temperature=22.0)
    y = true.simulate(t, {"power": power}) + 0.1 * random(5).standard_normal(len(t))
    log = Series(t, y, {"power": power}, sd=0.1)

    def wall(known):
        causes = models.thermal(capacity=known, loss=loss, ambient=20.0).terms(log)[1]
        return next(each.parameters[0].size for each in causes if each.name == "wall_capacity")

    if step < 1e7:
        assert 400.0 / 4.0 < wall(capacity) / wall(1.0) < 400.0 * 4.0
    else:  # no capacity is seen beside another
        assert wall(capacity) == pytest.approx(wall(float(capacity.value(0.0))))


def test_what_is_stated_is_a_constant_and_what_is_not_is_a_cause():
    log = Series(T, np.sin(T), {"torque": np.cos(T)})
    joint = models.joint(inertia={"median": 0.1, "factor": 1.3}, coulomb=(0.2, 0.1), viscous=0.3,
                         stribeck=stated("stribeck", "0.1:0.2"), without=["gravity"])  # fmt: skip
    assert joint.known["inertia"] == Prior("log-normal", 0.1, 1.3)
    assert joint.known["stribeck"] == Prior("log-uniform", 0.1, 0.2)
    assert stated("zero", "-0.1:0.2") == Prior("uniform", -0.1, 0.2)
    uncertain, causes = joint.terms([log, log.named("other")])
    assert [each.name for each in uncertain] == [
        "inertia", "coulomb", "stribeck", "stribeck_speed", "start_speed"]  # fmt: skip
    names = {each.name for each in causes}
    assert {"late torque", "slow torque", "slow sensor", "backlash", "load"} <= names
    assert not {"viscous", "coulomb", "stribeck", "gravity"} & names
    # A free record has no torque that could be late, and gravity asks for a start angle.
    free = models.joint(inertia=0.1).terms(Series(T, np.sin(T)))
    assert "late torque" not in {each.name for each in free[1]}
    assert {"start_position", "start_speed"} <= {each.name for each in free[0]}


MOTOR = {"inertia": 0.002, "viscous": 0.004, "torque_constant": 0.05}
KNOWN = {"inertia": (0.002, 2e-5), "viscous": (0.004, 4e-4),
         "without": ["viscous_asymmetry", "asymmetry", "stribeck", "quadratic", "backlash",
                     "compliance", "gravity"]}  # fmt: skip


def of_currents(late=0, **more):
    """A log of a motor, and its currents."""
    i = staircase(31, 4.0, 20, 300)
    y = models.joint(**MOTOR | more).simulate(0.01 * np.arange(300), {"current": np.roll(i, late)})
    return y + 0.02 * np.std(y) * random(32).standard_normal(300), i


def of_the_motor(y, inputs, **known):
    log = Series(0.01 * np.arange(300), y, inputs, unit="rad/s")
    return diagnose_model(models.joint(**KNOWN | known), log)


def test_a_cause_hidden_in_currents_is_that_of_their_torques():
    y, i = of_currents(coulomb=0.02)
    found = of_the_motor(y, {"current": i}, torque_constant=0.05)
    assert (found.verdict.kind, found.verdict.causes) == ("named", ("coulomb",))
    low, high = found.conf_int(0.998).loc["coulomb", ["low", "high"]]
    assert low < 0.02 < high
    same = of_the_motor(y, {"torque": 0.05 * i})
    assert same.verdict.causes == found.verdict.causes
    np.testing.assert_array_equal(same.params["value"], found.params["value"])


def test_currents_tell_only_ratios_of_constants():
    y, i = of_currents()
    found = of_the_motor(y, {"current": i}, torque_constant=(0.05, 0.001), inertia=(0.002, 1e-4))
    assert found.verdict.kind == "none"
    (group,) = found.cannot_tell.groups
    assert set(group.names) == {"torque_constant", "inertia", "viscous"}
    assert len(group.known) == 2
    assert "the data tell only ratios" in found.summary()


@pytest.mark.nightly
@pytest.mark.parametrize(("key", "true", "size"), [
    ("torque_constant", {"torque_constant": 0.055}, 0.055),
    ("late current", {"late": 2}, 0.02)])  # fmt: skip
def test_what_is_wrong_with_a_current_is_named(key, true, size):
    y, i = of_currents(coulomb=0.02, **true)
    found = of_the_motor(y, {"current": i}, torque_constant=(0.05, 0.001), inertia=0.002,
                         coulomb=0.02)  # fmt: skip
    assert (found.verdict.kind, found.verdict.causes) == ("named", (key,))
    name = "late current.time" if key == "late current" else key
    low, high = found.conf_int(0.998).loc[name, ["low", "high"]]
    assert low < size < high


def test_a_current_acts_as_its_force_at_every_bend():
    i, more = random(33).uniform(-2.0, 2.0, len(T)), {"dead_zone": 0.3, "saturation": 1.1}
    for first in (-0.0, 0.0):  # on either side of the gap
        i[0] = first
        known = {"inertia": 0.1, "backlash": 0.2, "reads": "load angle"}
        found = models.joint(torque_constant=0.5, **known).simulate(T, {"current": i})
        same = models.joint(**known).simulate(T, {"torque": 0.5 * i})
        np.testing.assert_array_equal(found, same)
    for smooth in (False, True):
        known = {"mass": 2.0, "smooth": smooth, **more}
        found = models.axis(force_constant=3.0, **known).simulate(T, {"current": i})
        np.testing.assert_array_equal(
            found, models.axis(gain=3.0, **known).simulate(T, {"command": i}))  # fmt: skip


@pytest.mark.parametrize("length", [0.01, 50.0])
def test_usual_sizes_of_a_pendulum_are_those_of_one_of_another_length(length):
    def sizes(length):
        log = Series(T, 0.1 * np.sin(T), {"pivot": length * 300.0 * np.cos(T)})
        _, causes = models.pendulum(length=length).terms(log)
        return [one.size for cause in causes for one in cause.parameters if one.size]

    assert sizes(length) == pytest.approx(sizes(1.0), rel=1e-12)


@pytest.mark.parametrize("name", FACTORIES)
def test_every_term_is_in_the_docstring_and_acts(name):
    make, least = FACTORIES[name], LEAST[name]
    model = make(**least)
    assert isinstance(model.kind, Kind)
    text = inspect.getdoc(make)
    rng = random(20)
    inputs = {next(iter(model.kind.inputs)): rng.uniform(-1.0, 1.0, len(T))}
    states = {key: 0.3 for key, _ in model.kind.states}
    dull = {"load_share", "damping_ratio", "stribeck_speed", "coupling", "wall_coupling"}
    if model.kind.needs:  # a constant of another input
        dull |= {"torque_constant", "force_constant"}
    base = model.simulate(T, inputs, **states)
    for key, term in model.kind.every.items():
        assert key in text
        if key not in dull:
            value = {"saturation": 0.5, "stribeck_speed": 1.0}.get(key, 0.11)
            more = {shape.name: 1.0 for shape in (term.shape,) if shape}
            changed = make(**least).simulate(T, inputs, **{**states, key: value, **more})
            assert not np.array_equal(changed, base), key


LOG = Series(T, T, {"torque": T}, unit="rad/s")
# What the command refuses as well, `refusals.cli` has.
BAD = {
    "a current without its constant": (
        lambda: models.joint(inertia=1.0).terms(Series(T, T, {"current": T}, unit="rad/s")),
        "has torque .N m.; for a current state torque_constant=.VALUE, ERROR."),
    "a gain beside": (lambda: models.axis(mass=1.0, gain=2.0, force_constant=2.0), "is no gain"),
    "a negative constant": (lambda: models.axis(mass=-1.0), "mass = -1.0: allowed is a value"),
    "a negative size": (lambda: models.joint(inertia=1.0, viscous=-1.0), "viscous = -1.0.*from 0"),
    "no error": (lambda: models.joint(inertia=(1.0, 0.0)), "joint: inertia: mean = 1.*sd = 0"),
    "a text": (lambda: models.axis(mass=1.0, without="load"), "without = .load.: allowed is"),
    "no such cause": (
        lambda: models.joint(inertia=1.0, without=["wind"]).terms(LOG), "without = wind: allowed"),
    "another unit": (
        lambda: models.axis(mass=1.0).terms(LOG), "series: unit = .rad/s.: allowed is m"),
    "another input": (
        lambda: models.joint(inertia=1.0).terms(Series(T, T, {"torqe": T})),
        'input torqe: a joint has torque .N m.; did you mean "torque"'),
    "a table": (
        lambda: models.joint(inertia=1.0).terms(Table({"t": T}, T)), "joint: data = .*a Series"),
    "no record": (
        lambda: models.joint(inertia=1.0)(Table({"t": T}, T), {}), "joint: data = .*a Series"),
    "no data": (lambda: models.joint(inertia=1.0).terms([]), "joint: data = .*a Series"),
    "no parameters": (lambda: diagnose_model(lambda table, p: T, LOG), "uncertain: allowed is"),
    "no function": (lambda: models.vectorised(3), "vectorised = 3: allowed is a function"),
    "an uneven clock": (lambda: models.low_pass(T**2, T, 1.0), "t: row 1 = .*even step"),
    "a fast cutoff": (lambda: models.low_pass(T, T, 60.0), "cutoff = 60.0: .* from 1 to 49 Hz"),
    "no derivative": (lambda: models.low_pass(T, T, 1.0, derivatives=3), "derivatives = 3"),
    "a short row": (lambda: models.low_pass(T[:5], T[:5], 1.0), "t: 5 times; allowed are 12"),
}  # fmt: skip


@pytest.mark.parametrize("what", BAD)
def test_bad_input_is_refused_in_one_line(what):
    call, text = BAD[what]
    with pytest.raises(ScenarioError, match=text) as error:
        call()
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("kind", KINDS)
def test_a_simulation_refuses_what_its_model_refuses(kind):
    def refusal(call, *args, **values):
        with pytest.raises(ScenarioError) as error:
            call(*args, **values)
        return str(error.value)

    model = FACTORIES[kind](**LEAST[kind])
    bad = [{name: value} for name, term in KINDS[kind].every.items()
           for value in (math.nan, "much", *(() if term.signed else (-1.0,)),
                         *(() if term.signed or term.size else (0.0,)))]  # fmt: skip
    for values in [*bad, {"lod": 1.0}]:
        refused = refusal(FACTORIES[kind], **{**LEAST[kind], **values})
        assert refusal(model.simulate, T, **values) == refused
        assert "\n" not in refused


def test_a_model_of_one_vector_is_asked_for_one_after_another():
    def one(record, p):
        assert isinstance(p["rate"], float)
        return p["start"] * np.exp(-p["rate"] * record.t) + record["u"]

    log = Series(T, T, {"u": T}, sd=1.0)
    seen = log.with_inputs({"u": np.stack([T, 2.0 * T])})
    p = {"start": np.array([[1.0], [2.0]]), "rate": np.array([[0.5], [0.7]])}
    found = models.vectorised(one)(seen, p)
    assert np.array_equal(found, [np.exp(-0.5 * T) + T, 2.0 * np.exp(-0.7 * T) + 2.0 * T])


def test_a_low_pass_comes_at_no_time_late_and_leaves_half_of_the_power_at_its_cutoff():
    t = 0.001 * np.arange(4000)
    for frequency, kept in ((0.5, 1.0), (10.0, np.sqrt(0.5)), (100.0, 0.0)):
        wave = np.sin(2.0 * np.pi * frequency * t)
        inner = slice(500, 3500)
        assert models.low_pass(t, wave, 10.0)[inner] == pytest.approx(kept * wave[inner], abs=0.01)
    # As twice the filter of second order, whose frequencies are tangents, does it for all sines.
    rate, inner, waves = 1000.0, slice(1000, 3000), np.array([0.004, 0.03, 0.11, 0.26, 0.38, 0.47])
    for cutoff in (0.004, 0.02, 0.1, 0.25, 0.3, 0.4, 0.45, 0.49, 0.496):
        for part in (cutoff, *waves):
            wave = np.exp(2j * np.pi * part * rate * t)
            left = [models.low_pass(t, each, cutoff * rate) for each in (wave.real, wave.imag)]
            gain = np.vdot(wave[inner], (left[0] + 1j * left[1])[inner]).real / 2000.0
            ratio = np.tan(np.pi * part) / np.tan(np.pi * cutoff)
            assert gain == pytest.approx(1.0 / (1.0 + (np.sqrt(2.0) - 1.0) * ratio**4), abs=2e-3)
            if part == cutoff:
                assert gain**2 == pytest.approx(0.5, abs=4e-3)
    slow = models.low_pass(t, np.sin(t), 10.0, derivatives=1)[500:3500]
    assert slow == pytest.approx(np.cos(t[500:3500]), abs=1e-5)
    faster = models.low_pass(t, np.sin(t), 10.0, derivatives=2)[500:3500]
    assert faster == pytest.approx(-np.sin(t[500:3500]), abs=1e-4)


def test_a_servo_that_follows_a_goal_needs_its_gain():
    known = {name: value for name, value in LEAST["servo"].items() if name != "gain"}
    record = Series(T, 0.9 * np.sin(T), {"goal": np.sin(T)}, sd=1e-3, unit="rad")
    with pytest.raises(ScenarioError, match="gain is not stated: allowed is a value or a range"):
        models.servo(**known).terms(record)
    assert models.servo(**known, gain=Prior("log-normal", 3.0, 1.5)).terms(record)
