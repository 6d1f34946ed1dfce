"""The documentation: what its code does and prints, and whether all that is public is on it."""

import doctest
import importlib
import json
import pkgutil
import re
import sys
from pathlib import Path

import numpy as np
import pytest

import stickslip
from documentation_blocks import NOT_RUN, TIMED, blocks, pages, play, prints
from own_effects import nothing_stays  # noqa: F401
from stickslip import Drive, Scenario, simulate
from stickslip.scenario.effects import is_free_shape
from test_reference_agreement import AGREEMENT, SCENARIOS

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
sys.path.append(str(DOCS))
from take_results import COMMANDS  # noqa: E402

PAGES = [*pages(DOCS), ROOT / "README.md", ROOT / "CONTRIBUTING.md"]


def modules():
    found = pkgutil.walk_packages(stickslip.__path__, "stickslip.")
    return [each.name for each in found if not each.name.endswith(("__main__", "_core"))]


def _is_slow(page):
    # Whole diagnoses, and films.
    code = [block.text for block in blocks(page) if block.language != "text"]
    return any(word in text for text in code for word in ("diagnose", "animation("))


@pytest.mark.parametrize(
    "page",
    [pytest.param(page, marks=pytest.mark.nightly if _is_slow(page) else ()) for page in PAGES],
    ids=lambda page: str(page.relative_to(ROOT)),
)
def test_the_code_of_a_page_runs_and_prints_what_it_says(page):
    if any("import mujoco\n" in block.text for block in blocks(page)):
        pytest.importorskip("mujoco")
    with play(page):
        pass


@pytest.mark.parametrize("page", pages(DOCS), ids=lambda page: str(page.relative_to(ROOT)))
def test_no_line_of_code_is_wider_than_a_page(page):
    for block in blocks(page):
        for line in block.text.splitlines():
            assert len(line) <= 90 or block.language == "text", f"{block}: {line}"


def test_the_pages_have_code_of_every_kind():
    # Else the test above could pass for want of anything to run.
    languages = [block.language for page in PAGES for block in blocks(page)]
    for language in ("python", "console", "text", "toml", "csv", "sh"):
        assert languages.count(language) >= 1


def test_a_wrong_output_is_seen(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("```python\nprint(1 + 1)\n```\n\n```text\n3\n```\n")
    with pytest.raises(AssertionError, match="what is printed is\n2"), play(page):
        pass
    assert prints("a ... c\n", "a b  c\n")
    assert not prints("1.91\n", "1.92\n")


def test_a_command_that_is_not_there_is_seen(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("```sh\nstickslip run a.toml --no-such-option\n```\n")
    with pytest.raises(AssertionError, match="no-such-option"), play(page):
        pass
    page.write_text("```sh\nstickslip predict found/extended.toml --no-such-option\n```\n")
    with pytest.raises(AssertionError, match="no-such-option"), play(page):
        pass
    page.write_text("```console\n$ stickslip run no-such-file.toml\n```\n")
    with pytest.raises(AssertionError, match="no-such-file"), play(page):
        pass


def test_what_is_not_run_stands_on_a_page():
    commands = [
        line.removeprefix(f"{' '.join(TIMED)} ")
        for page in PAGES
        for block in blocks(page)
        if block.language == "sh"
        for line in block.text.replace("\\\n", " ").splitlines()
    ]
    for each in NOT_RUN:
        assert any(" ".join(line.split()).startswith(each) for line in commands), each


@pytest.mark.parametrize("name", modules())
def test_examples_in_docstrings(name):
    module = importlib.import_module(name)
    names = {each: getattr(stickslip, each) for each in stickslip.__all__}
    failed, _ = doctest.testmod(module, extraglobs=names, optionflags=doctest.ELLIPSIS)
    assert failed == 0


def test_every_public_name_is_on_one_page_of_the_interface():
    listed = [
        name
        for page in pages(DOCS / "reference" / "api")
        for name in re.findall(r"^\.\. auto\w+:: ([\w.]+)$", page.read_text(), re.MULTILINE)
    ]
    assert len(listed) == len(set(listed))
    names = set(stickslip.__all__) - {"__version__", "events", "instruments", "plot"}
    names |= {f"stickslip.plot.{name}" for name in stickslip.plot.__all__}
    for module, known in {"events": "step", "instruments": "scale"}.items():
        home = getattr(stickslip, module)
        made = {
            name
            for name, each in vars(home).items()
            if getattr(each, "__module__", "") == home.__name__ and not name.startswith("_")
        }
        assert known in made
        names |= {f"stickslip.{module}.{name}" for name in made}
    assert names <= set(listed), names - set(listed)


def test_every_table_of_measurements_is_there_with_its_day_machine_and_command():
    text = (DOCS / "accuracy.md").read_text()
    names = re.findall(r"^```\{bench-results\} (\S+)$", text, re.MULTILINE)
    assert names
    for name in names:
        result = json.loads((DOCS / "measured" / name).read_text())
        assert re.fullmatch(r"\d{4}-\d\d-\d\d", result["date"]), name
        assert result["machine"]["processor"], name
        assert COMMANDS[name] in text, name


def test_the_numbers_of_the_readme_are_those_of_the_tables():
    measured = json.loads((DOCS / "measured" / "speed.json").read_text())
    speed = {
        (each["method"], each["rtol"]): each["simulated_per_cpu_second"]
        for each in measured["tolerances"]
    }
    peers = json.loads((DOCS / "measured" / "peers.json").read_text())
    single = [each for each in peers["rows"] if each["unit"] == "CPU s / simulated s"]
    ratios = {
        name: sorted(each["ratio"] for each in single if each["peer"] == name)
        for name in ("scipy", "heyoka")
    }
    creep = {each["who"]: each["drift_mm"] for each in peers["creep"]}
    assert creep["stickslip"] == 0.0
    drift = creep["mujoco, step 40 us, impratio 1"]
    real = json.loads((DOCS / "measured" / "real.json").read_text())
    # 0.0325 ± 0.0031 rad (known: 0.0334)
    offset = real["rows"]["250 drops, heights, listed: yes"]["size"]
    found, error, known = (1e3 * float(each) for each in re.findall(r"[\d.]+", offset))
    stated = sum(not is_free_shape(each.name) for each in stickslip.effects())
    said = " ".join((ROOT / "README.md").read_text().split())
    for words in (
        "from 250 drops of a real square it found that the angle readings are too large by"
        f" {found:.1f} ± {error:.1f} mrad (known: {known:.1f})",
        f"{stated} optional effects",
        f"{speed['tsit5', 1e-6]:.0f} simulated seconds per CPU second at `rtol` 1e-6",
        f"{speed['tsit5', 1e-8]:.0f} at the default 1e-8",
        "{:.0f} to {:.0f} times faster than SciPy's".format(*np.round(ratios["scipy"][::2], -1)),
        f"{ratios['heyoka'][0]:.1f} to {ratios['heyoka'][-1]:.1f} times faster than heyoka",
        f"creeps by {1e3 * drift:.1f} um in a second",
        f"within {100 * AGREEMENT:g} % in velocity in each of {len(SCENARIOS)} different walks",
    ):
        assert words in said, words


def test_the_speeds_of_the_readme_are_those_of_the_film():
    film = Scenario(drive=Drive(frequency=50, base=0.3e-3, pulses=30))  # that of the gallery
    single, pairs = (
        1e3 * simulate(each).mean_velocity
        for each in (film, film.replace({"drive.coils": "pairs"}))
    )
    said = " ".join((ROOT / "README.md").read_text().split())
    assert f"walks at {single:.2g} mm/s (pulses of 50 Hz)" in said
    assert f"it walks at {pairs:.2g} mm/s" in said


def test_the_readme_is_one_page():
    assert len((ROOT / "README.md").read_text().splitlines()) <= 120


def test_the_citation_is_of_this_version():
    text = (ROOT / "CITATION.cff").read_text()
    assert f"\nversion: {stickslip.__version__}\n" in text
    for word in ("cff-version: 1.2.0", "Pawashe", "Floyd", "Sitti", "2008"):
        assert word in text
