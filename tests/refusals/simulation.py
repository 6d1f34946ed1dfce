"""Refusals of `stickslip.simulation`: name, call with a folder, error, words of its one line."""

import math

import numpy as np

from stickslip import (
    STATE_COLUMNS,
    Drive,
    Record,
    Scenario,
    ScenarioError,
    Simulator,
    Snapshot,
    State,
    _core,
    _machines,
    open_run,
    rollout,
    simulate,
    simulate_batch,
)

STEP = 1e-3
ROWS = np.zeros((3, 5))
RECORDED = Scenario(drive=Drive(base=0.5e-3, pulses=4), record=Record(rate=1e3))


def stepped(*step, **more):
    return lambda _: Simulator(Scenario()).step(*step, **more)


def rolled(*arguments, **more):
    return lambda _: rollout(*arguments, **more)


def bound_rollout(scenarios, runs):
    """The core's function itself, without the checks of `rollout`."""
    out = np.zeros((runs, len(ROWS), 1))
    given = [Scenario().to_core()] * scenarios
    return lambda _: _core.rollout(given, runs, None, ROWS, STEP, "constant", [0], out, 1, None)


def bound_states(machine, times):
    """The states of a machine whose input changes at 0, without the checks of `Model.simulate`."""
    terms, starts = np.ones((1, len(_machines.terms[machine]))), {"heat": 1}.get(machine, 2)
    inputs = {"motion": 1, "heat": 2, "servo": 4}[machine]
    arrays = terms, np.zeros((1, starts)), np.array(times), np.zeros((1, 1))
    late = np.full((1, inputs), math.inf)
    return lambda _: _machines.states[machine](*arrays, np.zeros((1, 2, inputs)), late, False)


def until(condition, **drive):
    return lambda _: simulate(Scenario(drive=Drive(**drive)), until=condition)


def snapshot(**keys):
    return Simulator(Scenario().replace(keys)).snapshot()


def opened(data):
    def call(folder):
        (folder / "run.nc").write_bytes(data)
        open_run(folder / "run.nc")

    return call


def changed(change):
    """Opens the file of a run of which something was changed by xarray."""

    def call(folder):
        data = change(simulate(RECORDED).to_xarray())
        data.to_netcdf(folder / "run.nc", engine="h5netcdf")
        open_run(folder / "run.nc")

    return call


def recorded(name, **keys):
    return lambda folder: simulate(RECORDED.replace(keys), out=folder / name)


def saved(name):
    def call(folder):
        (folder / "folder.nc").mkdir()
        simulate(RECORDED).save(folder / name)

    return call


STATES = {
    "below the surface": (State(z=1e-6), "initial.z"),
    "stuck corner that moves": (State(theta=0.3, contact="corner_stick", vx=1e-3),
                                "initial.contact"),
    "tilted face": (State(theta=0.3, contact="face_stick"), "initial.theta"),
    "contact in the air": (State(z=1e-3, contact="corner_stick"), "initial.z"),
    "slip the other way": (State(theta=0.3, contact="corner_slip_backward", vx=1e-3),
                           "initial.contact"),
}  # fmt: skip
BEGUN = [
    *((name, lambda _, state=state: Scenario(initial=state), ScenarioError, [key, "allowed"])
      for name, (state, key) in STATES.items()),
    ("state of a rollout", lambda _: rollout(Scenario(), State(z=1e-6), ROWS, STEP), ScenarioError,
     ["initial.z", "allowed"]),
]  # fmt: skip
ROWS_OF_STATES = [
    (
        f"row {row}"[:20],
        lambda _, row=row: State.from_row(row),
        ScenarioError,
        ["row", "numbers in"],
    )
    for row in ([1.0, 2.0], ["a"] * len(STATE_COLUMNS), 3.0)
]

REFUSALS = [
    *BEGUN, *ROWS_OF_STATES,
    ("coil", stepped({"zp": 1.0}, STEP), ScenarioError, ["zp"]),
    ("voltage", stepped({"xp": math.nan}, STEP), ScenarioError, ["finite"]),
    ("word for a voltage", stepped({"xp": "a"}, STEP), ScenarioError, ["number of V"]),
    ("one voltage", stepped([1.0], STEP), ScenarioError, ["five numbers"]),
    ("text of voltages", stepped("a", STEP), ScenarioError, ["mapping"]),
    ("duration", stepped({}, -1.0), ScenarioError, ["duration = -1"]),
    ("hold", stepped({}, STEP, "cubic"), ScenarioError, ["hold"]),
    ("start of a constant step", stepped({}, STEP, start={"xp": 1.0}), ScenarioError, ["linear"]),
    ("coil of a start", stepped({}, STEP, "linear", {"zz": 1.0}), ScenarioError, ['start: "zz"']),
    ("start", stepped({}, STEP, "linear", {"xp": math.nan}), ScenarioError, ["start: xp = nan"]),
    ("kind of start", stepped({}, STEP, "linear", 3), ScenarioError, ["start = 3"]),
    ("across", stepped({"yp": 2.0}, STEP), ScenarioError, ["yp = 2, ym = 0", "whole_plane"]),
    ("scenario of a simulator", lambda _: Simulator(3), ScenarioError, ["Scenario"]),
    ("state of a simulator", lambda _: Simulator(Scenario(), 3), ScenarioError, ["State"]),
    ("snapshot of another scenario",
     lambda _: Simulator(Scenario()).restore(snapshot(**{"robot.mass": 3e-8})), ScenarioError,
     ["another scenario"]),
    ("snapshot", lambda _: Simulator(Scenario()).restore(b""), ScenarioError, ["Snapshot"]),
    ("bytes", lambda _: Snapshot.from_bytes(b"none"), ScenarioError, ["no snapshot"]),
    ("text", lambda _: Snapshot.from_bytes("none"), ScenarioError, ["bytes of a snapshot"]),
    ("damaged snapshot", lambda _: Snapshot.from_bytes(snapshot().to_bytes()[:-1]), ScenarioError,
     ["damaged"]),
    ("four coils", rolled(Scenario(), None, ROWS[:, :4], STEP), ScenarioError, ["shape"]),
    ("no duration", rolled(Scenario(), None, ROWS, 0.0), ScenarioError, ["duration"]),
    ("states", rolled(Scenario(), np.zeros((2, 3)), ROWS, STEP), ScenarioError, ["shape"]),
    ("numbers of runs", rolled([Scenario()] * 2, None, np.zeros((3, 4, 5)), STEP), ScenarioError,
     ["2 scenarios and 3 voltages", "number of runs"]),
    ("column", rolled(Scenario(), None, ROWS, STEP, record=["w"]), ScenarioError,
     ["record", '"w"']),
    ("out", rolled(Scenario(), None, ROWS, STEP, out=np.zeros(3)), ScenarioError,
     ["out of shape (3,)"]),
    ("voltages of all", rolled([Scenario()] * 3, None, np.full((2, 5), np.nan), STEP),
     ScenarioError, ["voltages: xp = nan", "finite number"]),
    *((f"until {condition}", until(condition), ScenarioError,
       ["until", "theta <= -1.5"]) for condition in ("x = 3", "w >= 2", "x >= nan", "x >= 3 m", 3)),
    ("until a misspelt name", until("thet > 1"), ScenarioError, 'did you mean "theta"?'),
    ("until y", until("y >= 1e-3"), ScenarioError, ["until", "plane y = 0"]),
    ("until heading", until("heading >= 3.2", heading=0.3), ScenarioError, ["from -pi to pi"]),
    ("a file as scenario", lambda _: simulate("walk.toml"), ScenarioError,
     'scenario = "walk.toml": allowed is a Scenario, such as'),
    ("progress", lambda _: simulate(RECORDED, "progress"), ScenarioError,
     ['progress = "progress"', "a function of a fraction"]),
    ("path of a run", lambda _: open_run(3), ScenarioError, "path = 3: allowed is the name"),
    ("one scenario as batch", lambda _: simulate_batch(RECORDED), ScenarioError,
     ["scenarios = ", "a list of Scenarios"]),
    ("batch", lambda _: simulate_batch([RECORDED, "s.toml"]), ScenarioError, ["scenario 1"]),
    *((f"threads {n}", lambda _, n=n: simulate_batch([RECORDED], n), ValueError,
       ["threads"]) for n in (0, -1, 1.5, True)),
    ("record for memory", lambda _: simulate(RECORDED.replace({"record.rate": 1e9})), ScenarioError,
     ["record.rate = 1000000000.0", "10000000 samples in memory", "--out"]),
    *(
        ("field of no record", recorded(file, **{"record.fields": f"x,{name}"}), ScenarioError,
         [f'record.fields = "x, {name}": allowed is {name} only', words])
        for file in ("run.nc", "run.csv")
        for name, words in
        {"event": "events", "heading": "drive.heading", "inner_place": "mass"}.items()
    ),
    ("no record for a file", recorded("run.nc", **{"record.rate": "none"}), ScenarioError,
     ['record.rate = "none"', "allowed with out"]),
    ("suffix before all else", recorded("run.txt", **{"record.rate": "none"}), ValueError,
     ["run.txt", "names that end in", ".csv"]),
    ("no folder", recorded("missing/run.nc"), OSError, ["there is no folder"]),
    ("no folder for a table", recorded("missing/run.csv"), OSError, ["there is no folder"]),
    ("suffix to save", saved("run.txt"), ValueError, ["names that end in"]),
    ("folder in the way", saved("folder.nc"), OSError, ["folder.nc", "is a folder"]),
    ("no file", lambda folder: open_run(folder / "run.nc"), ScenarioError, ["No such file"]),
    *(
        (f"{len(data)} bytes", opened(data), ScenarioError, ["is no netCDF file", "allowed is"])
        for data in (b"", b"no netCDF file\n", b"\x89HDF\r\n\x1a\n" + bytes(600))
    ),
    ("no run", changed(lambda data: data.drop_attrs()), ScenarioError, ["is no run"]),
    ("no theta", changed(lambda d: d.drop_vars("theta")), ScenarioError, ["it has no theta"]),
    *((f"attribute {name}", changed(lambda data, name=name: data.assign_attrs({name: "{"})),
       ScenarioError, ["run.nc"]) for name in ("scenario", "complete", "events", "final_state")),
    ("no status",
     changed(lambda d: d.assign_attrs({"status": d.attrs.pop("status")}).drop_attrs(deep=False)),
     ScenarioError, ["is no run"]),
    *((f"{count} scenarios of {runs} runs", bound_rollout(count, runs), ValueError,
       "one for each run") for count, runs in ((0, 1), (2, 3))),
    *((f"{machine} at {time}", bound_states(machine, [0.0, time]), ValueError, ["not finite"])
      for machine in _machines.states for time in (math.inf, math.nan)),
]  # fmt: skip
