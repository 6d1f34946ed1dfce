"""The reference simulator against answers that can be derived, and the published check numbers."""

import numpy as np
import pytest

from . import (
    CENTRE_FIELD_PER_AMPERE,
    coil_field,
    coil_gradient,
    converge_reference,
    simulate_reference,
    voltages_of,
)
from .circuit import advance_circuits
from .contact import STICK, solve_two
from .effects import GRAVITY
from .field import COIL_NAMES, RESISTANCE
from .simulate import model_without_drive

IPP = {"mode": "IPP", "frequency": 100.0, "base": 0.5e-3, "hold": 1e-3, "pulses": 6}
NO_FIELD = {"peak": 0.0, "base": 0.0, "hold": 0.0, "frequency": 100.0, "ramp": 0.0}


@pytest.mark.parametrize("name", COIL_NAMES)
def test_every_coil_gives_the_closed_centre_field_along_its_positive_axis(name):
    field = coil_field(name, (0.0, 0.0, 0.0))
    axis = {"x": 0, "y": 1, "c": 2}[name[0]]
    assert field[axis] == pytest.approx(CENTRE_FIELD_PER_AMPERE, rel=1e-12)
    assert np.delete(field, axis) == pytest.approx(0.0, abs=1e-18)
    assert pytest.approx(0.96258e-3, rel=1e-5) == CENTRE_FIELD_PER_AMPERE


@pytest.mark.parametrize("name", COIL_NAMES)
def test_field_has_neither_divergence_nor_curl_off_the_wire(name):
    gradient = coil_gradient(name, (0.004, -0.007, 0.003))
    size = np.abs(gradient).max()
    # Truncation of the central difference: (offset / 0.1 m)^2.
    assert abs(np.trace(gradient)) < 1e-6 * size
    assert np.abs(gradient - gradient.T).max() < 1e-6 * size


def _level(volts, t):
    """Voltages (in-plane, clamp) at t; on a jump the value after it."""
    k = np.searchsorted(volts.start, t, side="right") - 1
    return volts.level[k] + volts.slope[k] * (t - volts.start[k])


@pytest.mark.parametrize(("edge", "after", "middle"), [("rise", 2.5, 1.5), ("fall", 0.5, 1.5)])
def test_sawtooth_jumps_where_its_edge_says(edge, after, middle):
    volts = voltages_of({**IPP, "edge": edge})
    per_millitesla = RESISTANCE / CENTRE_FIELD_PER_AMPERE * 1e-3
    for pulse in (0, 3):
        begin = 0.05 + pulse * 0.01 + 1e-12
        assert _level(volts, begin)[0] == pytest.approx(after * per_millitesla, rel=1e-8)
        assert _level(volts, begin + 0.005)[0] == pytest.approx(middle * per_millitesla, rel=1e-8)
    assert _level(volts, 0.07)[1] == pytest.approx(-per_millitesla)
    assert _level(volts, 0.025)[0] == pytest.approx(0.25 * per_millitesla)


def test_finite_edge_and_ramp_down():
    drive = {**IPP, "edge": "rise", "edge_time": 1e-3, "ramp_down": 0.02, "clamp": "up"}
    volts = voltages_of(drive)
    per_millitesla = RESISTANCE / CENTRE_FIELD_PER_AMPERE * 1e-3
    assert _level(volts, 0.0505) == pytest.approx([1.5 * per_millitesla, per_millitesla])
    assert _level(volts, 0.0555) == pytest.approx([1.5 * per_millitesla, per_millitesla])
    assert _level(volts, 0.12) == pytest.approx([0.25 * per_millitesla, per_millitesla])
    assert _level(volts, 0.2) == pytest.approx([0.0, per_millitesla])
    assert volts.end == pytest.approx(0.13)


@pytest.mark.parametrize("lag", [0.0, 2e-3])
def test_circuit_meets_a_voltage_jump_inside_a_step(lag):
    circuit = model_without_drive(effects={"eddy_lag": {"time": lag}}).circuit
    start, volts = np.array([0.0, 2.5e-4]), np.array([[0.0, 0.0], [10.0, -10.0]])
    level = volts @ circuit.to_coils
    current, lagged = np.zeros(2), np.zeros(2)
    step, segment = 1e-4, 0
    decay = np.exp(-step / circuit.time_constant)
    for k in range(100):
        segment = advance_circuits(
            k * step, (k + 1) * step, decay, segment, start, level, 0 * level, current, lagged,
            circuit,
        )  # fmt: skip
    current, lagged = circuit.to_coils @ current, circuit.to_coils @ lagged
    since = 100 * step - 2.5e-4
    assert current == pytest.approx((1 - np.exp(-since / 7e-3)) * np.array([1, -1]), rel=1e-12)
    # Two first-order lags in a row; the step's linear input errs by (step / 7 ms)^2 / 12.
    expected = 1 - (7e-3 * np.exp(-since / 7e-3) - lag * np.exp(-since / max(lag, 1e-9))) / (
        7e-3 - lag
    )
    assert lagged[0] == pytest.approx(expected, rel=1e-4 if lag else 1e-12)


@pytest.mark.nightly
def test_block_held_inside_the_friction_cone_does_not_creep():
    weight, adhesion = 25.6e-9 * GRAVITY, 0.22e-6
    # sin(a) = 0.9 mu (cos(a) + adhesion / weight), solved to first order twice.
    angle = 0.9 * 0.2 * (1 + adhesion / weight)
    angle = np.arcsin(0.9 * 0.2 * (np.cos(angle) + adhesion / weight))
    run = simulate_reference(
        {**NO_FIELD, "pulses": 6000},
        effects={"surface_tilt": {"angle": angle}},
        dt=1e-4,
        rate=10.0,
    )
    assert run.t[-1] == pytest.approx(60.0)
    assert np.all(run.x == 0.0)
    assert np.all(run.theta == 0.0)


def test_block_slides_down_a_steep_tilt_as_newton_says():
    mass, adhesion, drag = 25.6e-9, 0.22e-6, 1e-5
    angle = 0.6
    run = simulate_reference(
        {**NO_FIELD, "pulses": 2},
        effects={"surface_tilt": {"angle": angle}},
        dt=1e-6,
        rate=1000.0,
    )
    push = mass * GRAVITY * np.sin(angle) - 0.145 * (mass * GRAVITY * np.cos(angle) + adhesion)
    slow = mass / drag
    # The velocity at rest is the one half a step before t = 0.
    t = run.t + 0.5e-6
    exact = push / drag * (t - slow * (1 - np.exp(-t / slow)))
    assert run.x[1:] == pytest.approx(exact[1:], rel=1e-6)


def test_flat_landing_on_a_second_corner_follows_momentum():
    # A block that turns about its sticking front corner falls flat: both normal velocities vanish.
    # Sticking would need friction H / L = 0.4 of the normal impulse; with mu 0.2 both corners slip.
    model = model_without_drive()
    a, b, omega = model.half_length, model.half_height, -100.0
    vx, vz = b * omega, a * omega
    end = solve_two(
        vx, vz, omega, np.array([a, -a]), -b, np.zeros(2), 1 / model.mass, 1 / model.inertia,
        np.array([STICK, STICK]), np.array([0.2, 0.145]), 0.145, 0.0,
    )  # fmt: skip
    assert (end.vz, end.omega) == (0.0, 0.0)
    assert end.p0 + end.p1 == pytest.approx(-model.mass * vz)
    assert end.vx == pytest.approx(vx - 0.145 * vz)
    assert min(end.p0, end.p1) > 0.0


def test_direction_mirrors_the_motion_exactly():
    plus = simulate_reference(IPP, dt=1e-6, rate=1000.0)
    minus = simulate_reference({**IPP, "direction": "-x"}, dt=1e-6, rate=1000.0)
    assert np.array_equal(minus.x, -plus.x)
    assert np.array_equal(minus.theta, plus.theta)
    assert minus.mean_velocity == -plus.mean_velocity


def test_opposite_clamp_tilts_the_nose_the_other_way():
    # Held 2.5 mT forward and 2.5 mT down for long: near 45 degrees, lowered by the weight.
    held = {"peak": 2.5e-3, "base": 2.5e-3, "hold": 2.5e-3, "pulses": 40}
    down = simulate_reference({**held, "clamp": "down"}, dt=1e-6, rate=100.0)
    up = simulate_reference({**held, "clamp": "up"}, dt=1e-6, rate=100.0)
    assert np.pi / 4 - 0.05 < down.theta[-1] < np.pi / 4 + 0.05
    assert -np.pi / 4 - 0.05 < up.theta[-1] < -np.pi / 4 + 0.05
    # Once the rocking has died out a constant field moves nothing.
    assert abs(down.x[-1] - down.x[-20]) < 1e-13


def test_window_of_the_mean_velocity():
    run = simulate_reference(IPP, dt=1e-6, rate=100.0)
    assert run.mean_velocity == pytest.approx((run.x[11] - run.x[8]) / 0.03, rel=1e-12)
    assert np.isnan(simulate_reference({**IPP, "pulses": 3}, dt=1e-5).mean_velocity)


def test_words_that_are_not_known_are_refused():
    with pytest.raises(ValueError, match="frequncy"):
        simulate_reference({"frequncy": 30.0})
    with pytest.raises(ValueError, match="edge"):
        simulate_reference({"edge": "up"})
    with pytest.raises(ValueError, match="mu"):
        simulate_reference({}, contact={"mu": 0.2})


# mode, frequency, base (mT), hold (mT), edge, clamp, velocity (mm/s): two programs agree on these
# within 0.05 %, an event-driven one and one that steps in time.
CHECK_NUMBERS = [
    ("IPP", 100.0, 0.5, 1.0, "rise", "down", 1.9128),
    ("IPP", 30.0, 0.5, 1.0, "fall", "up", 0.5986),
    ("OPP", 30.0, 0.5, 2.5, "fall", "down", 0.7186),
    ("OPP", 100.0, 0.0, 2.5, "rise", "up", 3.0680),
]


@pytest.mark.parametrize(("mode", "frequency", "base", "hold", "edge", "clamp", "v"), CHECK_NUMBERS)
def test_check_numbers(mode, frequency, base, hold, edge, clamp, v):
    drive = {
        "mode": mode, "frequency": frequency, "base": base * 1e-3, "hold": hold * 1e-3,
        "edge": edge, "clamp": clamp, "pulses": 20,
    }  # fmt: skip
    # The last case passes within 3e-5 of the friction limit; steps above 1.5e-7 s take it for slip,
    # which changes the velocity by 0.1 %.
    assert simulate_reference(drive, dt=1e-7).mean_velocity * 1e3 == pytest.approx(v, rel=5e-4)


def test_short_visit_to_the_friction_limit():
    drive = {"mode": "OPP", "frequency": 100.0, "hold": 1e-3, "edge": "fall", "pulses": 8}
    contact = {"static_friction": 1.8, "kinetic_friction": 1.305}
    run = simulate_reference(drive, contact=contact, dt=1e-7)
    assert run.mean_velocity * 1e3 == pytest.approx(0.7571, rel=5e-4)


def test_own_error_estimate_covers_the_difference_to_a_much_finer_step():
    report = converge_reference(IPP, dt=4e-6)
    finest = simulate_reference(IPP, dt=1e-7).mean_velocity
    assert report.relative_error < 1e-3
    assert abs(report.velocity[-1] - finest) < 2 * report.error
