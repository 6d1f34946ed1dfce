"""The checks of a record (laws.py) find the fault in false ones, and nothing else."""

import dataclasses

import numpy as np
import pytest

import laws
from effect_table import ACROSS, BACK, IPP, MEETING, OPP, rows
from fine_record import CORNER_STICK, FLIGHT, recorded
from stickslip import Scenario

HOPPING = {
    "drive.mode": "OPP", "drive.hold": 2.5e-3, "drive.edge": "fall", "drive.frequency": 30.0,
    "drive.pulses": 3, "contact.restitution": 0.3,
}  # fmt: skip


@pytest.fixture(scope="module")
def record():
    (made,) = recorded([Scenario().replace(HOPPING)], 1e-10)
    assert made.fine
    assert set(made.contact) >= {FLIGHT, CORNER_STICK}
    assert np.any(made.slips)
    assert laws.contact_violations(made) == []
    assert laws.unbalanced(made) == []
    return made


def _in_mode(record, mode):
    """A sample in the middle of the longest stretch in a mode."""
    longest = max(
        (ends for ends in laws.stretches(record) if record.contact[ends[0]] in mode),
        key=lambda ends: ends[1] - ends[0],
    )
    return sum(longest) // 2


# What is done to one sample of the record: the column, in which modes, by how much.
FALSE = {
    "a corner is below the surface": ("z", (FLIGHT,), lambda r, i: -r.z[i]),
    "what touches is not at the surface": ("z", (CORNER_STICK,), lambda r, i: 1e-3 * r.radius),
    "the surface pulls": ("normal", (2, 3), lambda r, i: -r.normal[i] - 0.01 * r.force),
    "there is a force in flight": ("normal", (FLIGHT,), lambda r, i: 1e-15),
    "a stick is outside the friction cone": ("friction", (CORNER_STICK,),
                                             lambda r, i: 0.5 * r.force),
    "a stick slips": ("slip", (CORNER_STICK,), lambda r, i: 1e-12),
    "a stick drifts": ("contact_x", (CORNER_STICK,), lambda r, i: 1e-15),
    "friction of a slip is not kinetic": ("friction", (2, 3), lambda r, i: 1e-2 * r.force),
    "a slip runs against its mode": ("slip", (2, 3), lambda r, i: -r.slips[i] - r.slip[i]),
    "the contact does not move with the body": ("vx", (CORNER_STICK,),
                                                lambda r, i: 1e-6 * r.fastest),
    "the position jumps": ("x", (FLIGHT,), lambda r, i: 0.2 * r.radius),
    "the field is not that of the currents": ("bx", (0, 1, 2, 3), lambda r, i: 1e-9),
    "is not finite": ("omega", (CORNER_STICK,), lambda r, i: np.nan),
}  # fmt: skip


@pytest.mark.parametrize("said", FALSE)
def test_a_false_sample_is_found(record, said):
    column, modes, change = FALSE[said]
    values = getattr(record, column).copy()
    where = _in_mode(record, modes)
    # The field is looked at in some of the samples.
    some = slice(None) if column == "bx" else where
    values[some] += change(record, where)
    found = laws.contact_violations(dataclasses.replace(record, **{column: values}))
    assert any(said in line for line in found), found


@pytest.mark.parametrize(
    ("key", "factor", "said"),
    [
        ("drag.linear", 1.1, "momentum along x"),
        ("environment.gravity", 1.001, "momentum across"),
        ("robot.magnetization", 1.001, "spin"),
        ("drag.rotational", 1.5, "energy is not balanced"),
    ],
)
def test_a_motion_under_other_forces_is_found(record, key, factor, said):
    other = record.scenario.replace({key: factor * record.scenario.get(key)})
    found = laws.unbalanced(dataclasses.replace(record, scenario=other))
    assert any(said in line for line in found), found


def test_energy_that_an_impact_adds_is_found(record):
    # Just after the fastest event, an impact that takes a part of the energy, all is faster.
    where = np.argmax(np.where(record.after_event, record.pace, 0.0))
    faster = {column: getattr(record, column).copy() for column in ("vx", "vz", "omega")}
    for values in faster.values():
        values[where] *= 1.1
    found = laws.unbalanced(dataclasses.replace(record, **faster))
    assert any("gained across an event" in line for line in found), found


DRIVES = {
    "OPP fall": {**OPP, "drive.edge": "fall"},
    "IPP -x": {**IPP, **BACK},
    "OPP hopping": {**OPP, "contact.restitution": 0.5},
}
# What touches is no corner where the contact has a place of its own.
PLANAR = [
    names
    for names in [*((name,) for name in rows()), *MEETING]
    if not {*ACROSS, "free_contact_place"} & set(names)
]


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("effects", PLANAR, ids=" + ".join)
def test_every_effect_keeps_the_laws(effects, drive):
    # A tight tolerance sees a parameter that is off by 2 %.
    keys = {**DRIVES[drive], "drive.pulses": 3}
    for name in effects:
        keys |= rows()[name]
    (record,) = recorded([Scenario().replace(keys)], 1e-10)
    assert record.fine
    assert laws.contact_violations(record) + laws.unbalanced(record) == []
