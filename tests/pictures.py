"""Helpers of the tests of pictures: runs to draw, and their paths in the plane."""

import functools

import numpy as np

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
    """Distance along the heading from x = y = 0, by the trapezoidal rule, m."""
    psi = heading_of(run)
    speed = np.gradient(run.x, run.t) * np.cos(psi) + np.gradient(run.y, run.t) * np.sin(psi)
    return np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(run.t))])
