"""Effects that nobody listed: they compete, are said, and are never claimed."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stickslip import Cause, Parameter, Prior, Series, Table, diagnose_model, instruments, models
from stickslip.diagnosis.model import ForwardModel

STEP, COUNT = 0.02, 300
T = STEP * np.arange(COUNT)


def torque(seed=3, size=0.3):
    """A torque that is new every 25 readings, N m."""
    return np.repeat(np.random.default_rng(seed).uniform(-size, size, COUNT // 25), 25)


def speed(u, friction, inertia=0.02, start=0.0):
    """Speed of a joint, rad/s, whose friction is a function of it: by another integrator."""
    found, v = [start], start
    for each in u[:-1]:
        law = lambda t, y, u=each: [(u - friction(y[0])) / inertia]  # noqa: E731
        v = solve_ivp(law, (0.0, STEP), [v], rtol=1e-9, atol=1e-12).y[0, -1]
        found.append(v)
    return np.array(found)


def joint(listed=("coulomb", "load", "late torque"), **known):
    """A joint with some listed causes."""
    model = models.joint(inertia=(0.02, 0.0005), viscous=(0.05, 0.002), **known)
    every = model.terms(Series(T, torque(), {"torque": torque()}, unit="rad/s"))[1]
    without = [cause.name for cause in every if cause.name not in listed]
    return models.joint(inertia=(0.02, 0.0005), viscous=(0.05, 0.002), without=without, **known)


def log(y, u, name="", seed=5):
    """A record with noise of a hundredth of its scatter."""
    noise = 0.01 * np.std(y) * np.random.default_rng(seed).standard_normal(len(y))
    return Series(T, y + noise, {"torque": u}, name=name, unit="rad/s")


FRICTIONS = {
    "v^3": lambda v: 0.05 * v + 4e-4 * v**3,
    "|v|": lambda v: 0.05 * v + 0.008 * abs(v),
    "sign v": lambda v: 0.05 * v + 0.012 * np.tanh(v / 0.05),
}


@pytest.mark.parametrize("records", [1, 2])
@pytest.mark.parametrize("shape", FRICTIONS)
@pytest.mark.daily("v^3-1", "|v|-2")
def test_a_friction_that_nobody_listed_is_said_by_its_shape(shape, records):
    # Listed is what resembles it: a constant friction, and a load.
    drives = [torque(3 + k) for k in range(records)]
    made = [log(speed(u, FRICTIONS[shape]), u, f"record {k}", k) for k, u in enumerate(drives)]
    listed = ["coulomb"] * (shape != "sign v") + ["load", "late torque", "quadratic"]
    found = diagnose_model(joint(listed), made)
    assert not found.verdict.claims
    assert f"unlisted torque as {shape}" in {
        name for fit in found.verdict.members for name in fit.names
    }
    if found.verdict.kind == "unexplained":
        assert f"an unlisted torque that goes with {shape}" in found.summary()


def test_a_listed_cause_is_named_beside_all_that_nobody_listed():
    u = torque()
    found = diagnose_model(joint(), log(speed(u, lambda v: 0.05 * v + 0.01 * np.sign(v)), u))
    assert (found.verdict.kind, found.verdict.causes) == ("named", ("coulomb",))
    rivals = [cause for cause in found.problem.causes if not cause.listed]
    assert len(rivals) > 15
    assert sum(cause.odds for cause in rivals) == pytest.approx(1.0)


SCALES = {
    "deg/s": (57.29578, 1.0, "readings", "deg/s"), "rpm": (9.549297, 1.0, "readings", "rpm"),
    "mN m": (1.0, 1e3, "torque", "mN m"), "a gear": (50.0, 1.0, "readings", None),
}  # fmt: skip


@pytest.mark.parametrize("what", SCALES)
@pytest.mark.daily("deg/s")
def test_another_scale_is_said_first_and_asks_for_a_unit(what):
    per_reading, per_input, of, unit = SCALES[what]
    u = torque()
    y = speed(u, lambda v: 0.05 * v + 0.01 * np.tanh(v / 0.01))
    record = log(per_reading * y, per_input * u)
    # With dry friction stated, a scale of the torque is none of the speed.
    found = diagnose_model(joint(coulomb=(0.01, 0.0005)), record)
    assert not found.verdict.claims
    notes = [note for note in found.verdict.reasons if note.code == "another-scale"]
    assert notes
    assert notes[0].value == pytest.approx(per_reading / per_input, rel=0.05) or (
        notes[0].value == pytest.approx(per_input / per_reading, rel=0.05)
    )
    headline = found.summary().splitlines()[0]
    assert str(notes[0]) in headline
    if unit and of in str(notes[0]):
        assert f"is the unit {unit}?" in headline


def test_what_does_the_same_as_a_listed_cause_does_not_take_its_name():
    # A wrong zero of a thermometer is a constant power.
    power = np.where(np.arange(COUNT) // 60 % 2, 20.0, 5.0)
    heater = models.thermal(capacity=(40.0, 0.4), loss=(0.5, 0.005), ambient=293.0)
    y = heater.simulate(T * 50.0, {"power": power}) + 1.5
    noise = 0.05 * np.random.default_rng(2).standard_normal(COUNT)
    record = Series(50.0 * T, y + noise, {"power": power}, sd=0.05, unit="K")
    found = diagnose_model(heater, record)
    assert (found.verdict.kind, found.verdict.causes) == ("named", ("zero",))
    assert "unlisted power as 1" in found.findings.models.twins.values() or (
        "unlisted reading as 1" in found.findings.models.twins.values()
    )


@pytest.mark.parametrize(
    ("shape", "values"),
    [("ln x", np.log1p), ("x^3", lambda z: z**3), ("a wave of x", lambda z: np.sin(2 * np.pi * z))],
)
@pytest.mark.daily("ln x")
def test_a_table_is_said_to_go_with_a_setting(shape, values):
    x = np.repeat(np.linspace(1.0, 5.0, 25), 2)
    y = 2.0 * x + 1.5 * values((x - 1.0) / 4.0)
    y = y + 0.02 * np.random.default_rng(4).standard_normal(len(x))
    step = Cause("step", Parameter("step.size", low=-9.0, high=9.0, size=0.3))
    slope, level = (Parameter(name, Prior("normal", value, 0.3), cause=False)
                    for name, value in (("slope", 2.0), ("level", 0.0)))  # fmt: skip

    def line(table, p):
        return p["slope"] * table["x"] + p["level"] + p["step.size"] * (table["x"] > 3.0)

    found = diagnose_model(line, Table({"x": x}, y, sd=0.02), [slope, level], [step])
    assert not found.verdict.claims
    assert found.verdict.leader.names == {f"unlisted reading as {shape}"}
    assert np.isfinite(found.predict({"x": [0.0, 9.0]})).all().all()


def test_an_input_that_is_read_and_does_nothing_keeps_when_it_switches():
    u = np.where(T > 1.0, 1.0, -1.0)
    idle = Cause("idle", Parameter("idle.size", low=-1.0, high=1.0, size=0.1), input="u",
                 read=lambda values, given, p, table: values + p["idle.size"])  # fmt: skip
    late = instruments.delay(size=0.01, input="u", name="late")
    p = {"late.time": 0.0073, "late.before": 0.0, "idle.size": 0.0}
    record = Series(T, T, {"u": u}, sd=1.0)

    def seen(*causes):
        names = [name for cause in causes for name in cause.names]
        model = ForwardModel(lambda table, p: table["u"], None, (), causes)
        return model(record, names, np.array([[p[name] for name in names]]))

    for causes in ((late, idle), (idle, late)):
        assert np.array_equal(seen(*causes), seen(late))
