"""``python sixth_object.py FOLDER``: a scenario that holds a sixth object, from a row of the table.

Whoever lists the objects on his own forgets this one.
"""

import pickle
import sys
from pathlib import Path

import pytest

from stickslip.scenario import held

KEY, FILE = "drag.curve", "drag.file"


class Curve(tuple):
    """A text, in characters."""

    def write(self, path):
        path.write_text(self.to_json())

    def to_json(self):
        return "".join(self)

    @classmethod
    def from_json(cls, text):
        return cls(text)

    @classmethod
    def from_file(cls, path):
        return cls(path.read_text())


class Sixth(held.Held):
    kind = Curve

    def to_core(self, given, core):
        pass


row = Sixth(KEY, "sixth:Curve.from_file", FILE, "curve.txt", "curve", "A curve.", "file: a curve")
held.HELD[KEY] = held.OBJECTS[KEY] = held.PATHS[FILE] = row

from stickslip import (  # noqa: E402
    Accelerations,
    Drag,
    Drive,
    Forces,
    Inner,
    Scenario,
    ScenarioError,
    Shake,
    Waveform,
    load,
    open_run,
    simulate,
    sweep,
)
from stickslip.cli.keys_command import FILES  # noqa: E402
from stickslip.cli.loading import load_with  # noqa: E402
from stickslip.sweeping.points import points_of  # noqa: E402

folder = Path(sys.argv[1])
wave = Waveform.hold(0.01, {"xp": 1.0})
scenario = Scenario(
    drive=Drive(mode="program", program=wave),
    shake=Shake(accelerations=Accelerations([[0, 0, 0], [0.005, 1, 0], [0.01, 0, 0]])),
    inner=Inner(mass=1e-9, forces=Forces([[0, 0], [0.01, 1e-9]])),
    drag=Drag(curve=Curve("abc")),
).in_fluid("water")

objects = {"drive.program", "shake.accelerations", "inner.forces", KEY}
assert {*scenario._held} == {*objects, "fluid"}
assert scenario.drag.curve == Curve("abc")
assert scenario.drag == Drag(**scenario.drag.as_dict())
assert scenario.drag != Drag(**{**scenario.drag.as_dict(), "curve": None})
assert "curve=('a', 'b', 'c')" in repr(scenario)
assert KEY in scenario._repr_html_()
assert FILES["drag"].startswith("file: a curve")

without = scenario.replace({KEY: None})
assert without.drag.curve is None
assert without != scenario
again = without.replace({KEY: Curve("abc")})
assert again == scenario
assert hash(again) == hash(scenario)
assert points_of(without, [{}]).identity() != points_of(scenario, [{}]).identity()

for made in (
    pickle.loads(pickle.dumps(scenario)),
    Scenario.of_document(scenario.document()),
    scenario.replace({"drive.direction": "-x"}).replace({"drive.direction": "+x"}),
    scenario.with_state(scenario.initial),
    scenario.with_uncertain(None),
    scenario.without_record(),
):
    assert made == scenario, made
    assert made.fluid == scenario.fluid
assert pickle.loads(pickle.dumps(scenario.drag)) == scenario.drag

assert {*Scenario(shake=scenario.shake)._held} == {"shake.accelerations"}
assert "A curve." in Drag.__doc__
with pytest.raises(ScenarioError, match=r"drive\.program"):
    Waveform.ipp(program=wave)
asked = Scenario().replace({"record.pull_share": "yes", "record.rate": 1e3})
assert asked.without_record() == Scenario().replace({"record.pull_share": "yes"})
recorded = scenario.replace({"record.rate": 1e3})
assert points_of(recorded, [{}]).identity() == points_of(scenario, [{}]).identity()

text = scenario.to_toml(folder / "s.toml")
assert 'file = "s.curve.txt"' in text
assert load(folder / "s.toml") == scenario
found, files = load_with(folder / "s.toml", {})
assert {file.name for file in files} == {
    "s.toml", "s.voltages.csv", "s.accelerations.csv", "s.forces.csv", "s.curve.txt",
}  # fmt: skip
(folder / "other.txt").write_text("x")
found, files = load_with(folder / "s.toml", {FILE: folder / "other.txt"})
assert found.drag.curve == Curve("x")
assert folder / "other.txt" in files

simulate(scenario.replace({"record.rate": 1e3}), out=folder / "run.nc")
assert open_run(folder / "run.nc").scenario.without_record() == scenario

for call in (
    lambda: Drag(curve=3),
    lambda: scenario.replace({KEY: "abc"}),
    lambda: scenario.replace({FILE: "abc"}),
    lambda: sweep(scenario, {KEY: [Curve("abc")]}),
    lambda: sweep(scenario, {FILE: ["abc"]}),
    lambda: load_with(folder / "s.toml", {FILE: 3}),
):
    with pytest.raises(ScenarioError, match=r"drag\."):
        call()
