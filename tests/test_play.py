"""The page to play with: its core beside the native one, and what a reader can do with it."""

import json
import re
import shutil
import subprocess
import warnings
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import numpy as np
import pytest

from play import browser as chromium
from stickslip import Scenario, ScenarioError, _core, load, simulate

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "play" / "index.html"
SOURCES = ROOT / "cpp" / "web"

_SPEC = spec_from_file_location("build_page", SOURCES / "build.py")
BUILD = module_from_spec(_SPEC)
_SPEC.loader.exec_module(BUILD)

NODE = shutil.which("node")
needs_node = pytest.mark.skipif(NODE is None, reason="needs node")
needs_chromium = pytest.mark.skipif(chromium.PROGRAM is None, reason="needs Chromium")

WALK = {"drive.peak": 1.5e-3, "drive.base": 0.5e-3, "drive.pulses": 12}
EFFECTS = (
    {},
    {"drive.frequency": 30, "drive.edge": "fall"},
    {"effects.surface_tilt.angle": 0.1},
    {"effects.eddy_lag.time": 1e-3},
    {"effects.friction_anisotropy.fraction": -0.4, "drive.direction": "-x"},
)
TEN = [{**WALK, "drive.mode": mode, **each} for mode in ("IPP", "OPP") for each in EFFECTS]


def in_node(scenarios):
    done = subprocess.run(
        [NODE, ROOT / "tests" / "play" / "core.js", PAGE],
        input=json.dumps(scenarios),
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout)


def native_velocity(changes):
    return simulate(Scenario().replace(changes)).mean_velocity


def is_old():
    return BUILD.fingerprint_of(PAGE.read_text(encoding="utf-8")) != BUILD.fingerprint()


@pytest.fixture
def same_core():
    """Skips a comparison of numbers with the page where its core is of other sources."""
    if is_old():
        said = "the core of docs/play/index.html is of other sources; make play builds it"
        warnings.warn(said, stacklevel=1)
        pytest.skip(said)


@pytest.mark.nightly
def test_the_core_of_the_page_is_of_these_sources():
    assert not is_old(), "make play builds the page"


def test_the_page_loads_nothing():
    text = PAGE.read_text(encoding="utf-8")
    assert not re.search(r"""\b(src|href)\s*=|@import|url\(""", text)


def test_the_page_holds_its_sources_as_they_are():
    text = PAGE.read_text(encoding="utf-8")
    sources = [*SOURCES.glob("*.js"), SOURCES / "page.css"]
    assert len(sources) > 5
    stale = [each.name for each in sources if each.read_text(encoding="utf-8") not in text]
    around = re.split(r"/\*\{.*?\}\*/", (SOURCES / "page.html").read_text(encoding="utf-8"))
    assert len(around) == 4
    stale += [part[:40] for part in around if part not in text]
    assert BUILD.notes() in text, "make play builds the page"
    assert not stale, "make play builds the page"


@needs_node
def test_ten_velocities_are_those_of_the_native_core(same_core):
    found = [each["mean_velocity"] for each in in_node(TEN)]
    native = [native_velocity(each) for each in TEN]
    assert len({round(v, 6) for v in native}) == len(TEN)
    assert found == pytest.approx(native, rel=1e-9), "make play builds the page"


@needs_node
@pytest.mark.parametrize(
    "changes",
    [{"drive.base": 3}, {"drive.mode": "up"}, {"drive.frequency": 0}, {"drive.pulses": 1.5}],
)
def test_the_page_refuses_what_the_package_refuses(same_core, changes):
    (said,) = in_node([changes])
    with pytest.raises(ScenarioError) as native:
        Scenario().replace(changes)
    (key,) = changes
    assert re.match(rf"{re.escape(key)} = .*: allowed is ", said["error"])
    assert key in str(native.value)


@pytest.fixture(scope="module")
def tab():
    with chromium.browser() as one:
        yield one


@pytest.fixture
def opened(tab):
    """Opens the page and waits for its first run, or its puzzle."""

    def open_page(fragment=""):
        tab.errors.clear()
        tab.open(PAGE, fragment)
        tab.wait_for("typeof core !== 'undefined' && !!core && !!(run || puzzle)")
        return tab

    yield open_page
    assert tab.errors == []


@needs_chromium
def test_keys_change_a_slider_and_stop_the_film(same_core, opened):
    page = opened()
    page.evaluate("document.getElementById('set-drive.frequency').focus()")
    before = page.evaluate("run.mean_velocity")
    page.press("ArrowRight", "ArrowRight", 39)
    page.wait_for("run.mean_velocity !== " + repr(before))
    assert page.evaluate("run.mean_velocity") == pytest.approx(
        native_velocity({**page.evaluate("scenarioChanges()"), "drive.frequency": 31}), rel=1e-9
    )
    page.wait_for("location.hash === '#drive.frequency=31'")
    page.press(" ", "Space", 32, " ")
    assert page.evaluate("state.playing") is False
    stopped = page.evaluate("state.t")
    page.press(".", "Period", 190, ".")
    assert page.evaluate("state.t") > stopped
    page.press("r", "KeyR", 82, "r")
    page.wait_for("location.hash === '' && state.playing")


@needs_chromium
@pytest.mark.parametrize(
    "fragment",
    [
        "foo=1",
        "drive.frequency=fast",
        "drive.frequency=1e4",
        "drive.base=0.003",  # above the peak
        "guess=some",
        "%",
    ],
)
def test_a_broken_address_shows_the_default_and_says_so(opened, fragment):
    page = opened(fragment)
    assert page.evaluate("document.getElementById('alert').hidden") is False
    said = page.evaluate("document.getElementById('alert').textContent")
    assert re.fullmatch(r"The address of this page cannot be read \(.*\)\. .*", said)
    assert page.evaluate("state.changes") == {}
    assert page.evaluate("run.status") == "ok"


@needs_chromium
def test_copied_scenarios_give_the_number_of_the_page(same_core, opened, tmp_path, capsys):
    page = opened("drive.frequency=80&drive.mode=OPP&drive.edge=fall&drive.edge_time=0.002")
    velocity = page.evaluate("run.mean_velocity")
    file = tmp_path / "copied.toml"
    file.write_text(page.evaluate("toml(scenarioChanges())"))
    assert load(file).get("drive.edge_time") == 0.002
    assert simulate(load(file)).mean_velocity == pytest.approx(velocity, rel=1e-9)
    exec(page.evaluate("python(scenarioChanges())"), {})
    assert float(capsys.readouterr().out) == pytest.approx(velocity, rel=1e-9)


@needs_chromium
def test_the_examples_do_what_their_names_say(opened):
    found = opened().evaluate("""PRESETS.map(([name, values]) => {
      const changes = { ...START, ...values }, run = playRun(changes);
      return [name, { forward: run.mean_velocity, flight: run.shares.flight,
                      rolls: run.events.roll_over }];
    })""")
    found = dict(found)
    for name in ("Walks", "Walks by OPP", "Climbs"):
        assert found[name]["forward"] > 1e-4
        assert found[name]["flight"] < 0.2
    assert found["Slides back"]["forward"] < -1e-4
    assert found["Flies"]["flight"] > 0.5
    assert found["Tips over"]["rolls"] > 2
    assert abs(found["Rides a stage"]["forward"]) > 1e-4
    for name in ("weak magnet", "steady field", "adhesion"):
        assert abs(found[f"Stays: {name}"]["forward"]) < 1e-5


SLIDE = {"effects.surface_tilt.angle": 0.26, "contact.static_friction": 0.1,
         "contact.kinetic_friction": 0.1, "contact.adhesion": 0.0, "drive.hold": 0.0,
         "drive.base": 0.0, "drive.peak": 0.0}  # fmt: skip
WEIGHTLESS = {"contact.static_friction": 0.0, "contact.kinetic_friction": 0.0}
BACK = {"drive.mode": "OPP", "drive.frequency": 60.0}
NOTED = [
    {}, {"drive.coils": "pairs"}, BACK, {**BACK, "drive.direction": "-x", "drive.coils": "pairs"},
    SLIDE, WEIGHTLESS, {"drive.hold": 0.0}, {"drive.base": 0.00145}, {"drive.base": 0.0015},
    {"drive.base": 0.0, "drive.peak": 0.0, "drive.hold": 0.0}, {"robot.magnetization": 0.0},
    {"robot.magnetization": 2e4}, {"contact.adhesion": 3e-6},
    {"drive.base": 0.0, "drive.peak": 2.5e-3}, {**BACK, "drive.clamp": "up"},
    {"contact.static_friction": 1.5, "contact.kinetic_friction": 1.5}, {"robot.mass": 1e-7},
    {"robot.length": 80e-6, "robot.height": 30e-6},
    *({"drive.frequency": 150.0, "drive.base": 0.5e-3, "drive.peak": peak, "contact.adhesion": 0.0,
       "contact.restitution": 0.6} for peak in (1e-3, 1.5e-3, 2e-3, 2.5e-3, 3e-3, 5e-3)),
]  # fmt: skip


@needs_chromium
def test_page_and_package_have_the_same_notes(same_core, opened):
    page = opened()
    start = page.evaluate("START")
    codes = {row["code"] for row in _core.note_rows}
    seen, shares = set(), []
    for changes in NOTED:
        run = simulate(Scenario().replace({**start, **changes}))
        expected = [note.code for note in run.notes if note.code in codes]
        given = json.dumps({**start, **changes})
        found = page.evaluate(f"notesOf({given}, playRun({given}))")
        assert [note["code"] for note in found] == expected, changes
        said = " ".join(note["text"] for note in found)
        assert not re.search(r"[{}]|NaN|undefined|\b(drive|contact|robot)\.", said), said
        seen |= {*expected}
        shares.append(run.summary()["airborne_fraction"])
    assert any(0.2 < share < 0.5 for share in shares)  # which is no hop
    assert seen >= {
        "backward", "steep-surface", "no-friction", "flight", "density", "rest-torque",
        "rest-adhesion", "rest-no-field", "no-pulses", "pulled", "roll-over",
    }  # fmt: skip


@needs_chromium
@pytest.mark.parametrize("coils", ["single", "pairs"])
@pytest.mark.parametrize("direction", ["+x", "-x"])
def test_the_forces_on_the_page_move_the_robot(opened, coils, direction):
    page = opened(f"drive.coils={coils}&drive.direction={direction}")
    names = ("vx", "magnetic_x", "friction_force")
    vx, magnetic, friction = (np.array(page.evaluate(f"Array.from(run.{n})")) for n in names)
    robot, step = Scenario(), 1.0 / page.evaluate("run.rate")
    force = robot.robot.mass * (vx[2:] - vx[:-2]) / (2.0 * step)
    rest = force - (magnetic + friction - robot.drag.linear * vx)[1:-1]
    # Half of the samples have no change of contact beside them.
    assert np.median(np.abs(rest)) < 0.02 * np.median(np.abs(magnetic + friction))


@needs_chromium
def test_each_effect_and_setting_is_taken_at_both_ends(opened):
    refused = opened().evaluate("""[...SETTINGS.values()].filter((s) => !s.words).flatMap((s) =>
      [s.min, s.max].map((end) => toSI(s, end)).filter((value) => {
        if (checked(s.key, String(value)) !== value) return true;
        const changes = { ...START, ...inOrder({ [s.key]: value }), "drive.pulses": 4 };
        const own = core.measure(changes);
        return changes[s.key] !== value || own.error !== undefined;
      }).map((value) => [s.key, value]))""")
    assert refused == []


@needs_chromium
def test_the_puzzle_hides_a_cause_and_scores_an_answer(opened):
    page = opened("guess=5")
    causes = page.evaluate("Array.from({length: 40}, (_, i) => new Puzzle(i).cause.name)")
    assert len(set(causes)) == 6
    assert page.evaluate("new Puzzle(5).points") == page.evaluate("puzzle.points")
    answer = """(index) => {
      document.querySelector('#experiment button').click();
      document.querySelectorAll('#answer input')[index].click();
      document.querySelector('#answer button').click();
      return [puzzle.score, puzzle.left, document.getElementById('verdict').textContent];
    }"""
    right = page.evaluate(f"({answer})(CAUSES.indexOf(puzzle.cause))")
    assert right[:2] == [20 + 10 * 7, 7]
    assert right[2].startswith("Right")
    page.evaluate("document.getElementById('next-puzzle').click()")
    wrong = page.evaluate(f"({answer})((CAUSES.indexOf(puzzle.cause) + 1) % 6)")
    assert wrong[0] == 0
    assert wrong[2].startswith("It was another one")
