"""Every way in which a run can be computed, for the cases of `effect_table.py`.

A run has one motion, however it is computed: alone, in a pack, recorded, step by step, from a
snapshot on, in one plane or in the whole. Where one program computes it, the bits are the same;
where two do, the numbers are, within a tolerance.
"""

from __future__ import annotations

import functools
import itertools
import json
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from command_line import python_process
from effect_table import (
    BOX,
    OWN,
    SLICE,
    STEP,
    TURNED_COILS,
    Case,
    Table,
    across,
    field_map,
    first_difference,
    said,
    to_the_bit,
)
from stickslip import (
    STATE_COLUMNS,
    Accelerations,
    Run,
    Scenario,
    Simulator,
    Snapshot,
    rollout,
    simulate,
    simulate_batch,
    sweep,
)
from stickslip.scenario.keys import known_keys

Way = Callable[[Table], Iterator[str]]


def batch(table: Table) -> Iterator[str]:
    """Runs all at once on two threads, in packs as wide as the processor has."""
    runs = simulate_batch([case.scenario for case in table.to_the_bit], threads=2)
    return table.compare(runs, table.to_the_bit)


def packs(table: Table, width: int) -> Iterator[str]:
    """Runs all at once in packs of at most `width`, in an own process, which reads the limit."""
    code = f"import ways_to_run; ways_to_run.print_packed({table.choice!r})"
    limit = {"STICKSLIP_LANES": str(width)}
    done = python_process("-c", code, variables=limit, timeout=3600)
    assert done.returncode == 0, done.stderr
    packed = json.loads(done.stdout)
    for case in table.to_the_bit:
        # An effect of the user has no place in a pack, and the process knows none.
        what = "" if case.is_own else first_difference(packed[str(case)], table.said[case])
        if what:
            yield f"{case}: {what}"


def print_packed(choice: str) -> None:
    """Print the runs of a batch of the cases as JSON, for the process of `packs`."""
    chosen = to_the_bit(choice)
    runs = simulate_batch([case.scenario for case in chosen], threads=1)
    print(json.dumps({str(case): said(run) for case, run in zip(chosen, runs, strict=True)}))


RATE = 1024.0  # Hz; meets the ends of all measuring windows
ROUNDING = 1e-12


def recorded(table: Table) -> Iterator[str]:
    """Runs with a record on a grid, and with one of events."""
    for rate in (RATE, "events"):
        asked = [case.scenario.replace({"record.rate": rate}) for case in table.cases]
        runs = simulate_batch(asked, threads=1)
        yield from table.compare(runs, table.cases)
        for case, run in [*zip(table.cases, runs, strict=True)][::8]:
            alone = simulate(run.scenario)
            for name in ("t", "x", "theta", "omega", "normal_force", "contact"):
                if getattr(run, name).tobytes() != getattr(alone, name).tobytes():
                    yield f"{case}: {name} of a batch is not that alone"
        if rate == "events":
            continue
        for case, run in zip(table.cases, runs, strict=True):
            what = _misread(run, table.scale(case.drive))
            if what:
                yield f"{case}: {what}"


def _misread(run: Run, scale: float) -> str:
    """Difference of a record's last samples and window from final state and mean velocity."""
    start, end = run.scenario.to_core().window
    first, last = (int(np.argmin(np.abs(run.t - at))) for at in (start, end))
    velocity = (run.x[last] - run.x[first]) / (run.t[last] - run.t[first])
    expected = {
        "t": (run.t[-1], run.scenario.to_core().duration),
        "x": (run.x[-1], run.final_state.x),
        "theta": (run.theta[-1], run.final_state.theta),
    }
    for name, (value, other) in expected.items():
        if abs(value - other) > ROUNDING * (abs(other) + 1.0):
            return f"last {name} = {value!r} instead of {other!r}"
    # Lengths of 1e-4 m in double precision over 0.1 s.
    if abs(velocity - run.mean_velocity) > 1e-9 * scale:
        return f"velocity of the record {velocity!r} instead of {run.mean_velocity!r}"
    return ""


def swept(table: Table) -> Iterator[str]:
    """Runs as points of sweeps on two threads; a sweep has one map and one program."""

    def together(case: Case) -> tuple[int, ...]:
        scenario = case.scenario
        return (
            id(scenario.coil.map), hash(scenario.drive.program), id(scenario.shake.accelerations),
            id(scenario.inner.forces),
        )  # fmt: skip

    for _, group in itertools.groupby(sorted(table.to_the_bit, key=together), key=together):
        members = list(group)
        laws = {name: law for case in members for name, law in case.scenario.laws.items()}
        absent = {f"laws.{name}": {**vars(law), "fraction": 0.0} for name, law in laws.items()}
        base = members[0].scenario.replace(absent)
        data = sweep(base, [_changes(base, case.scenario) for case in members], threads=2)
        for place, case in enumerate(members):
            run = table.alone[case]
            assert "mean_velocity" in data
            for name, value in run.summary().items():
                measured = run.ok or name == "simulated_time"
                if name not in data or not isinstance(value, float) or not measured:
                    continue
                found = float(data[name].values[place])
                if repr(found) != repr(value):
                    yield f"{case}: {name} = {found!r} instead of {value!r}"
                    break


def _changes(base: Scenario, scenario: Scenario) -> dict[str, Any]:
    """The keys in which a scenario differs from another with the same map and program."""
    keys = [key for key in known_keys() if not key.startswith("record.")]
    changed = {key: scenario.get(key) for key in keys if scenario.get(key) != base.get(key)}
    # A change of all coils is none of single ones.
    made = base.replace({key: each for key, each in changed.items() if key.count(".") == 1})
    of_one = [key for key in keys if key.startswith("coil.") and key.count(".") == 2]
    own = {key: scenario.get(key) for key in of_one if scenario.get(key) != made.get(key)}
    own |= {f"laws.{name}.fraction": law.fraction for name, law in scenario.laws.items()}
    return {key: each for key, each in changed.items() if key not in of_one} | own


# Each program has its own error: rtol = 1e-8 in each of the some hundred steps of a pulse, whose
# sum moves the place of an event and so the slip after it. Beside rtol = 1e-11 the velocities of
# the single effects are wrong by 1e-7 in the median; the worst by 6e-6 in one plane and by 5e-5 in
# the whole. An effect that is missing moves more than 1e-3.
TWO_PROGRAMS = 1e-4


# A corner that slows down to some um/s sticks in one plane and slips on in the whole, a thousandth
# of the velocity, of slips that are small themselves.
SLIPS = 20.0


# Steps cut what the converter holds, or what is late, and clipped voltages bend at instants that
# are rounded otherwise: other steps of the integrator, and so another program.
NOT_TO_THE_BIT = ("sample_hold", "amplifier_limit", "late")


def pieces(scenario: Scenario) -> Iterator[tuple[list[float], list[float], float]]:
    """The drive as steps: voltages at the begin and at the end, V, and duration, s.

    As the amplifiers are asked for them: what they clip is theirs to do.
    """
    asked = scenario.replace({"effects.amplifier_limit.voltage": 0.0})
    for times, volts, repeats in asked.to_core().program().blocks:
        once = [
            (volts[k].tolist(), volts[k + 1].tolist(), float(times[k + 1] - times[k]))
            for k in range(len(times) - 1)
            if times[k + 1] > times[k]
        ]
        yield from once * repeats
    # Until all of it has come.
    if scenario.drive.latency > 0.0:
        yield once[-1][1], once[-1][1], scenario.drive.latency


def stepped(table: Table) -> Iterator[str]:
    """Step by step, each step a piece of the drive."""
    for case in table.cases:
        run = table.alone[case]
        what = _stepped_otherwise(case, run, table.scale(case.drive))
        if what:
            yield f"{case}: {what}"


def _stepped_otherwise(case: Case, run: Run, scale: float) -> str:
    scenario = case.scenario
    start, _ = scenario.to_core().window
    simulator = Simulator(scenario)
    at_start = simulator.state
    for first, last, duration in pieces(scenario):
        if simulator.time <= start + 1e-9:
            at_start = simulator.state
        held = (last, duration) if first == last else (last, duration, "linear", first)
        state = simulator.step(*held)
    span = simulator.time - start
    velocity = (state.x - at_start.x) / span
    exact = not set(NOT_TO_THE_BIT) & set(case.effects)
    if exact and state != run.final_state:
        names = (n for n in STATE_COLUMNS if getattr(state, n) != getattr(run.final_state, n))
        name = next(names)
        return f"{name} = {getattr(state, name)!r} instead of {getattr(run.final_state, name)!r}"
    if abs(velocity - run.mean_velocity) > (ROUNDING if exact else TWO_PROGRAMS) * scale:
        return f"velocity = {velocity!r} instead of {run.mean_velocity!r}"
    return ""


def restored(table: Table) -> Iterator[str]:
    """Step by step, restored from the bytes of a snapshot in the middle, to the last bit."""
    for case in table.cases:
        steps = list(pieces(case.scenario))
        whole, rest = Simulator(case.scenario), Simulator(case.scenario)
        for number, (first, last, duration) in enumerate(steps):
            if number == len(steps) // 2:
                # What it did before must leave nothing behind. (A sudden field turns it too fast.)
                if not case.scenario.whole_plane:
                    rest.step(last, 0.4 * duration, "linear", first)
                rest.restore(Snapshot.from_bytes(whole.snapshot().to_bytes()))
            state = whole.step(last, duration, "linear", first)
            if number < len(steps) // 2:
                continue
            gone_on = rest.step(last, duration, "linear", first)
            if gone_on != state or rest.time != whole.time:
                yield f"{case}: {gone_on} after step {number} instead of {state}"
                break


# They know the time since the run began, or how the voltage came to where it is, or will.
NOT_BEGUN_AGAIN = {*("late", "sample_hold", "free_friction_age", "free_field_time", *OWN)}


def begun_again(table: Table) -> Iterator[str]:
    """Step by step, the second half by a simulator that begins with the state of the first."""
    for case in table.cases:
        if NOT_BEGUN_AGAIN & set(case.effects):
            continue
        steps, simulator = list(pieces(case.scenario)), Simulator(case.scenario)
        for number, (first, last, duration) in enumerate(steps):
            if number == len(steps) // 2:
                simulator = Simulator(case.scenario, simulator.state)
            state = simulator.step(last, duration, "linear", first)
        whole, scale = table.alone[case].final_state, table.scale(case.drive)
        limits = {"x": scale * simulator.time, "y": scale * simulator.time, "theta": 1.0}
        for name, size in limits.items():
            found, expected = getattr(state, name), getattr(whole, name)
            if not abs(found - expected) <= TWO_PROGRAMS * size:
                yield f"{case}: {name} = {found!r} instead of {expected!r}"


def rolled_out(table: Table) -> Iterator[str]:
    """Programs as rollouts of all their cases at once, in packs."""
    chosen = [
        case
        for case in table.cases
        if case.scenario.drive.mode == "program" and not set(NOT_TO_THE_BIT) & set(case.effects)
    ]
    if not chosen:
        return
    # All waveforms of the table have as many steps.
    volts = np.stack([case.scenario.drive.program.blocks[0][1][1:] for case in chosen])
    result = rollout(
        [case.scenario for case in chosen],
        None,
        volts,
        STEP,
        hold="linear",
        record=STATE_COLUMNS,
        threads=2,
    )
    for case, states, status in zip(chosen, result.states, result.status, strict=True):
        final = table.alone[case].final_state.row
        if status != 0 or states[-1].tolist() != final:
            yield f"{case}: {states[-1].tolist()} instead of {final}"


# A corner that slows down to the capture speed, 1 um/s, sticks in the whole plane and may slip on
# in one: rare, and a difference of this share of the velocity at most.
CAPTURED = 5e-3
RARE = 0.005


def in_both_planes(table: Table) -> Iterator[str]:
    """Runs in the whole plane, where the field moves the robot as in one."""
    pushed = [case for case in table.alone if case.push]

    def apart(case: Case, tolerance: float) -> str:
        run, planar = table.alone[case], table.alone[case.planar]
        return _apart(run, planar, 1.0, table.scale(case.drive), tolerance)

    differences = {case: what for case in pushed if (what := apart(case, TWO_PROGRAMS))}
    many = len(differences) > RARE * len(pushed)
    for case, what in differences.items():
        if many or apart(case, CAPTURED):
            yield f"{case}: {what}"


# What points somewhere along the surface of the world.
TURNED_KEYS = (
    "effects.ambient_field.Bx", "effects.ambient_field.By", "effects.surface_tilt.angle",
    "effects.friction_patches.amplitude", "shake.amplitude_x",
)  # fmt: skip


def turned(scenario: Scenario) -> Scenario:
    """The scenario seen from behind: world, coils, map and robot turned by pi about z."""
    changes: dict[str, Any] = {}
    for key in TURNED_KEYS:
        changes[key] = -float(scenario.get(key))
    for coil, other in TURNED_COILS.items():
        for key in known_keys().values():
            if key.section == f"coil.{coil}":
                name = key.name.rpartition(".")[2]
                changes[f"coil.{other}.{name}"] = scenario.get(key.name)
    changes["drive.direction"] = "+x" if scenario.drive.direction == "-x" else "-x"
    if scenario.drive.program is not None:
        changes["drive.program"] = scenario.drive.program.turned()
    shaken = scenario.shake.accelerations
    if shaken is not None:
        changes["shake.accelerations"] = Accelerations(shaken.rows * [1.0, -1.0, 1.0])
    for box in (BOX, SLICE):
        if scenario.coil.map is not None and scenario.coil.map == field_map(box):
            changes["coil.map"] = field_map(box, turned=True)
    return scenario.replace(changes)


def from_behind(table: Table) -> Iterator[str]:
    """Runs with the whole world turned by pi, which turns the motion too.

    An effect of the user may know where +x is.
    """
    chosen = [case for case in table.cases if not case.is_own]
    runs = simulate_batch([turned(case.scenario) for case in chosen], threads=1)
    for case, run in zip(chosen, runs, strict=True):
        what = _apart(run, table.alone[case], -1.0, table.scale(case.drive))
        if what:
            yield f"{case}: {what}"


def _apart(run: Run, other: Run, sign: float, scale: float, tolerance: float = TWO_PROGRAMS) -> str:
    """How a run differs from one that another program computed, whose x is `sign` times its own.

    Velocities relative to `scale` or to the own one, whichever is larger.
    """
    scale = max(scale, abs(other.mean_velocity))
    if run.status != other.status:
        return f"{run.status} instead of {other.status}"
    pairs = {
        "mean_velocity": (run.mean_velocity, sign * other.mean_velocity, scale),
        "theta_min": (run.summary()["theta_min"], other.summary()["theta_min"], 1.0),
        "theta_max": (run.summary()["theta_max"], other.summary()["theta_max"], 1.0),
    }
    for name in ("slip_up", "slip_down"):
        slips = (_ahead(each) * each.summary()[name] for each in (run, other))
        pairs[name] = (*slips, SLIPS * scale)
    if run.scenario.whole_plane and other.scenario.whole_plane:
        pairs["mean_velocity_y"] = (across(run), sign * across(other), scale)
    for name, (value, expected, size) in pairs.items():
        if not abs(value - expected) <= tolerance * size:
            share = abs(value - expected) / size
            return f"{name} = {value:.8g} instead of {expected:.8g} ({share:.1e} of {size:.3g})"
    return ""


def _ahead(run: Run) -> float:
    """The way of the robot's front, beside that along which the summary counts slips."""
    return -1.0 if run.scenario.drive.direction == "-x" and not run.scenario.whole_plane else 1.0


WAYS: dict[str, Way] = {
    "batch": batch,
    **{f"packs of {width}": functools.partial(packs, width=width) for width in (1, 4, 8)},
    "recorded": recorded, "swept": swept, "stepped": stepped, "restored": restored,
    "begun again": begun_again, "rolled out": rolled_out,
    "in both planes": in_both_planes,
    "from behind": from_behind,
}  # fmt: skip
