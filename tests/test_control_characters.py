"""Characters that steer a terminal, or end a line, come out of no file that a user was given."""

import json
import re

import numpy as np
import pytest

from command_line import stickslip
from report_page import Page
from stickslip import Drive, Scenario, ScenarioError, Waveform, load
from stickslip._util.files import text_writer, write_together
from stickslip._util.text import json_text, printable, quoted
from stickslip._util.toml import parse_toml
from stickslip.diagnosis import Cause, Parameter, Prior, Table, diagnose_model
from stickslip.scenario.toml_file import write_scenario
from stickslip.walker import read_measurement

# Red letters in both spellings of a control sequence, DEL, ends of lines, and text from the right.
WILD = "a\x1b[31m\x9b31m\x7f\r\n\u2028\u202eb"
TAGS = re.findall(
    r"\w+",
    "html head meta title style body h1 h2 h3 p b i div svg g path line rect circle ellipse "
    "span polyline polygon text tspan defs clippath use image figure figcaption ul li nav a "
    "details summary table tr th td code script",
)
EVERY = "".join(map(chr, [*range(1, 0x3000), 0xFEFF, 0x1F916, 0xE0001]))


def test_control_characters_are_escaped_in_all_output():
    assert printable(EVERY).isprintable()
    assert printable(printable(EVERY)) == printable(EVERY)
    assert printable("90° ± 0.1 µm, naïve 机器人 🤖 \\n") == "90° ± 0.1 µm, naïve 机器人 🤖 \\n"
    assert printable("\x1b\n\udce9") == r"\x1b\n\udce9"


def test_texts_come_back_from_toml_and_json():
    assert quoted(EVERY).isprintable()
    assert parse_toml(f"text = {quoted(EVERY)}") == {"text": EVERY}
    text = json_text({EVERY: [EVERY]})
    assert text.replace("\n", "").isprintable()
    assert json.loads(text) == {EVERY: [EVERY]}


@pytest.mark.parametrize(
    "document",
    ["[drive]\n{name} = 1\n", "[{name}]\n[drive]\n", "[drive]\n[effects.{name}]\n",
     "[drive]\npeak = {{ {name} = {name} }}\n", '[drive]\nmode = "program"\nfile = {name}\n'],
)  # fmt: skip
def test_errors_of_a_scenario(tmp_path, document):
    path = tmp_path / WILD
    path.write_text("stickslip = 1\n" + document.format(name=quoted(WILD)))
    with pytest.raises(ScenarioError) as error:
        load(path)
    assert str(error.value).isprintable()
    assert str(error.value).startswith(printable(path))


def test_the_command_prints_one_line_of_letters(tmp_path):
    for arguments in (["run", WILD], ["keys", WILD], [WILD], ["keys", f"--{WILD}"]):
        done = stickslip(*arguments, cwd=tmp_path)
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr.endswith("\n")
        assert done.stderr[:-1].isprintable()
    done = stickslip("init", WILD, cwd=tmp_path)
    assert done.stdout == f"wrote {printable(WILD)}\n"
    assert (tmp_path / WILD).is_file()


def test_what_is_left_out_of_a_measurement(tmp_path):
    (tmp_path / "s.toml").write_text("stickslip = 1\n[drive]\n")
    path = tmp_path / "m.toml"
    path.write_text(
        f"stickslip_measurement = 1\nscenario = 's.toml'\n[[velocity]]\nfile = {quoted(WILD)}\n"
    )
    cells = WILD.replace("\r\n\u2028", "")
    (tmp_path / WILD).write_text(f"velocity,mode\n1e-3,IPP\n{cells},IPP\n1e-3,{cells}\n")
    with pytest.raises(ScenarioError, match="line 3, column velocity = ") as error:
        read_measurement(path)
    assert str(error.value).isprintable()
    (tmp_path / WILD).write_text(f"velocity,mode\n1e-3,IPP\nnan,IPP\n1e-3,{cells}\n")
    left_out = read_measurement(path).left_out
    assert len(left_out) >= 2
    assert all(str(fact).isprintable() for fact in left_out)
    (tmp_path / WILD).write_text(f"velocity,{cells}\n1e-3,dry\n")
    (fact,) = read_measurement(path).left_out
    assert printable(cells) in str(fact)
    assert str(fact).isprintable()


def test_a_scenario_that_is_written_is_read_back_whatever_it_is_called(tmp_path):
    drive = Drive(mode="program", program=Waveform.ipp(base=0.5e-3, pulses=2))
    scenario = Scenario(drive=drive)
    path = tmp_path / f'{WILD}"\\.toml'
    text = write_scenario(scenario, path, [f"from {WILD}", "gravity = 0\n[environment]"])
    assert all(line.isprintable() for line in text.split("\n"))
    again = load(path)
    assert again.to_toml() == scenario.to_toml()
    for k in (0, 1):
        read, written = (each.drive.program.points()[k] for each in (again, scenario))
        np.testing.assert_array_equal(read, written)


@pytest.mark.filterwarnings("error:Glyph", "error:constrained_layout")
def test_names_of_a_users_model_are_text_on_the_page_whatever_they_hold(tmp_path):
    name = f"<script>alert(1)</script>\"'>& {WILD} $\\frac{{$"
    x = np.linspace(0.2, 1.0, 24)

    def model(table, p):
        return p[f"slope {name}"] * table[name] + p[f"{name}.{name}"] * np.cos(6.0 * table[name])

    noise = 0.02 * np.random.default_rng(1).standard_normal(len(x))
    observed = 0.3 * x + 0.5 * np.cos(6.0 * x) + noise
    size = Parameter(f"{name}.{name}", size=0.3, unit=name, low=-3.0, high=3.0)
    causes = [Cause(name, size, name)]
    slope = Parameter(f"slope {name}", Prior("normal", 0.0, 1.0), name)
    table = Table({name: x}, observed, sd=0.02, name=name, unit=name)
    found = diagnose_model(model, table, [slope], causes)
    assert found.verdict.causes == (name,)
    found.save_report(tmp_path, title=name)
    page = (tmp_path / "report.html").read_text()
    assert all(line.isprintable() for line in page.split("\n"))
    assert page.count("<script") == 1
    assert "alert(1)" not in page.split("<script")[1]
    parsed = Page(tmp_path / "report.html")  # every tag is closed, and none was opened by a name
    assert {each["tag"] for each in parsed.elements} <= set(TAGS)
    assert all(each.isprintable() for each in found.summary().split("\n"))


def test_files_of_a_report_are_replaced_together(tmp_path):
    names = ["report.json", "report.html", "extended.toml"]
    for name in names:
        (tmp_path / name).write_text("old")

    def full(path):
        path.write_text("half")
        raise OSError(28, "No space left on device")

    writers = {tmp_path / name: text_writer("new") for name in names} | {tmp_path / names[2]: full}
    with pytest.raises(OSError, match=r"cannot write .*extended\.toml: No space left") as error:
        write_together(writers)
    assert str(error.value).count("cannot write") == 1
    assert {each.name: each.read_text() for each in tmp_path.iterdir()} == dict.fromkeys(
        names, "old"
    )
    write_together({path: text_writer("new") for path in writers})
    assert {each.name: each.read_text() for each in tmp_path.iterdir()} == dict.fromkeys(
        names, "new"
    )
